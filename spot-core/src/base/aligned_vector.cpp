// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/aligned_vector.hpp"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace spot {

namespace {

constexpr std::size_t cache_line = 64, huge_page = std::size_t{1} << 21;

std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{bytes < huge_page ? cache_line : huge_page}; }

}  // namespace

void* allocate_aligned(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment(bytes));
#ifdef MADV_HUGEPAGE
  // Advice only: where it is not taken, pages stay small, as those after the last whole huge page do.
  if (bytes >= huge_page) madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_aligned(void* memory, std::size_t bytes) { ::operator delete(memory, alignment(bytes)); }

}  // namespace spot
