// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace spot {

/// Memory that begins with a cache line, and is backed by huge pages where it is long and the system has them. Throws
/// std::bad_alloc.
void* allocate_aligned(std::size_t bytes);
void free_aligned(void* memory);

template <typename Value>
struct AlignedAllocator {
  using value_type = Value;

  AlignedAllocator() = default;
  template <typename Other>
  AlignedAllocator(const AlignedAllocator<Other>&) {}

  Value* allocate(std::size_t n) { return static_cast<Value*>(allocate_aligned(n * sizeof(Value))); }
  void deallocate(Value* values, std::size_t) { free_aligned(values); }

  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
  friend bool operator!=(const AlignedAllocator&, const AlignedAllocator&) { return false; }
};

/// For what vector kernels read here and there: a pack that lies across two cache lines costs two of them, and every
/// page that is touched costs an entry in a short table of the processor.
template <typename Value>
using AlignedVector = std::vector<Value, AlignedAllocator<Value>>;

}  // namespace spot
