// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/aligned_vector.hpp"

#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace spot {

namespace {

constexpr std::align_val_t cache_line{64};

/// Advice only: where it is not taken, pages stay small.
void ask_for_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t page = 4096, huge_page = std::uintptr_t{1} << 21;
  if (bytes < 2 * huge_page) return;
  const auto first = (reinterpret_cast<std::uintptr_t>(memory) + page - 1) / page * page;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / page * page;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
#endif
}

}  // namespace

void* allocate_aligned(std::size_t bytes) {
  void* memory = ::operator new(bytes, cache_line);
  ask_for_huge_pages(memory, bytes);
  return memory;
}

void free_aligned(void* memory) { ::operator delete(memory, cache_line); }

}  // namespace spot
