// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace spot {

/// Memory that begins with a cache line, or where it is long with a huge page, by which it is backed if the system has
/// them. Throws std::bad_alloc.
void* allocate_aligned(std::size_t bytes);
/// As many bytes as were allocated.
void free_aligned(void* memory, std::size_t bytes);

template <typename Value>
struct AlignedAllocator {
  using value_type = Value;

  AlignedAllocator() = default;
  template <typename Other>
  AlignedAllocator(const AlignedAllocator<Other>&) {}

  Value* allocate(std::size_t n) { return static_cast<Value*>(allocate_aligned(n * sizeof(Value))); }
  void deallocate(Value* values, std::size_t n) { free_aligned(values, n * sizeof(Value)); }

  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
  friend bool operator!=(const AlignedAllocator&, const AlignedAllocator&) { return false; }
};

/// For what is read here and there, of every grain or cell: a pack that lies across two cache lines costs two of them,
/// and every page that is touched costs an entry in a short table of the processor.
template <typename Value>
using AlignedVector = std::vector<Value, AlignedAllocator<Value>>;

}  // namespace spot
