// SPDX-License-Identifier: GPL-2.0-or-later
// Whether a drainage knows how much memory it takes: against all that this program allocates.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace {

std::atomic<std::size_t> allocated{0};

void* noted(void* memory) {
  if (!memory) throw std::bad_alloc();
  allocated += malloc_usable_size(memory);
  return memory;
}

void release(void* memory) {
  allocated -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t n) { return noted(std::malloc(n)); }
// The standard library asks for memory in this way, too, and gives it back by delete.
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  void* memory = std::malloc(n);
  if (memory) allocated += malloc_usable_size(memory);
  return memory;
}
void* operator new(std::size_t n, std::align_val_t alignment) {
  void* memory = nullptr;
  return noted(posix_memalign(&memory, static_cast<std::size_t>(alignment), n) == 0 ? memory : nullptr);
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace {

const auto grains = scenes::dense_grains({-11.5, -7.5, 0.5}, {11.5, 7.5, 40.0}, 0.01, 2);
const spot::DrainageLimits limits{-1.0};

/// Looks at the start, and when much has happened.
template <typename Make>
void expect_right(const Make& make) {
  const std::size_t before = allocated;
  const auto drainage = make();
  for (const double time : {0.0, 0.5, 2.0}) {
    drainage->advance_to(time);
    const auto taken = static_cast<double>(allocated - before);
    EXPECT_NEAR(static_cast<double>(drainage->memory()) / taken, 1.0, 0.1) << time;
  }
}

TEST(MemoryUnit, OfTheWindowedDriver) {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.step_height = 0.8;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spot::RelaxationParameters relaxation;
  relaxation.tolerance = 4e-3;
  for (const int threads : {1, 3})
    expect_right([&] {
      return std::make_unique<spot::WindowedDrainage>(spots, relaxation, limits, 0.02, threads,
                                                      scenes::small_silo(12.0, 8.0), 1.0, 100.0, grains);
    });
}

TEST(MemoryUnit, OfTheTimeOrderedDriver) {
  expect_right([&] {
    return std::make_unique<spot::TimeOrderedDrainage>(scenes::paper_spots(), spot::RelaxationParameters(), limits,
                                                       scenes::small_silo(12.0, 8.0),
                                                       spot::Packing(1.0, 100.0, grains));
  });
}

}  // namespace
