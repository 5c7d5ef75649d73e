// SPDX-License-Identifier: GPL-2.0-or-later
// Every build of the kernels gives the bits of the plain one.
#include "../../spot-core/src/kernels.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "scenes.hpp"
#include "spot/quantum.hpp"

namespace spot::kernels {
extern const Kernels base;
#ifdef SPOT_X86_KERNELS
extern const Kernels v3, v4;
#endif
}  // namespace spot::kernels

namespace {

using spot::Point;
using spot::kernels::Kernels;

/// The builds that this processor can run, the plain one first.
std::vector<const Kernels*> builds() {
  std::vector<const Kernels*> all = {&spot::kernels::base};
#ifdef SPOT_X86_KERNELS
  if (__builtin_cpu_supports("x86-64-v3")) all.push_back(&spot::kernels::v3);
  if (__builtin_cpu_supports("x86-64-v4")) all.push_back(&spot::kernels::v4);
#endif
  return all;
}

constexpr Point nobody = {0x1p+500, 0x1p+500, 0x1p+500, 0.0};

/// Random points in a box, every fifth place empty, the last one too.
std::vector<Point> points_in_box(std::size_t n, double edge, std::uint64_t seed) {
  scenes::Draws draws(seed);
  const spot::Quantum quantum(1.0, 100.0);
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) {
    const spot::Vector3 at = draws.in_box({0, 0, 0}, {edge, edge, edge});
    const Point point = {quantum.snap(at.x()), quantum.snap(at.y()), quantum.snap(at.z()), 0.0};
    points.push_back(i % 5 == 4 || i + 1 == n ? nobody : point);
  }
  return points;
}

void expect_same(const std::vector<Point>& a, const std::vector<Point>& b, const Kernels& build) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x, b[i].x) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].y, b[i].y) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].z, b[i].z) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].depth, b[i].depth) << build.instruction_set << ", point " << i;
  }
}

TEST(KernelsInvariance, DisplacementIsTheSameInEveryBuild) {
  const spot::Quantum quantum(1.0, 100.0);
  const Point by = {quantum.round(1.7e-3), quantum.round(-2.5e-4), quantum.round(3e-5), 0.0};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto start = points_in_box(400, 6.0, seed);
    auto plain = start;
    const int moved = spot::kernels::base.displace(plain.data(), plain.size(), {3, 3, 3, 0}, 2.6, by);
    EXPECT_GT(moved, 20);
    for (const Kernels* build : builds()) {
      auto points = start;
      EXPECT_EQ(build->displace(points.data(), points.size(), {3, 3, 3, 0}, 2.6, by), moved);
      expect_same(points, plain, *build);
    }
  }
}

TEST(KernelsInvariance, PushesAreTheSameInEveryBuild) {
  constexpr std::uint32_t capacity = 16;
  const spot::Quantum quantum(1.0, 100.0);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto points = points_in_box(200, 4.0, seed);
    scenes::Draws draws(seed);
    std::vector<std::uint32_t> lists(points.size() * capacity, static_cast<std::uint32_t>(points.size() - 1));
    std::vector<std::uint8_t> sizes(points.size());
    std::vector<std::uint32_t> grains;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      grains.push_back(i);
      sizes[i] = static_cast<std::uint8_t>(draws.below(capacity + 1));
      for (std::uint32_t k = 0; k < sizes[i]; ++k) {
        const auto other = static_cast<std::uint32_t>(draws.below(points.size()));
        lists[i * capacity + k] = other == i ? static_cast<std::uint32_t>(points.size() - 1) : other;
      }
    }
    const spot::kernels::Push push{1.0, 0.4, quantum.shift()};
    std::vector<Point> plain(points.size());
    spot::kernels::base.push_off_neighbours(points.data(), grains.data(), grains.size(),
                                            {lists.data(), sizes.data(), capacity}, push, plain.data());
    int pushed = 0;
    for (std::size_t i = 0; i < points.size(); ++i) pushed += points[i].x < 10.0 && plain[i].depth > 0.0;
    EXPECT_GT(pushed, 20);
    for (const Kernels* build : builds()) {
      std::vector<Point> pushes(points.size());
      build->push_off_neighbours(points.data(), grains.data(), grains.size(), {lists.data(), sizes.data(), capacity},
                                 push, pushes.data());
      // An empty place gets no push that matters: nobody applies it.
      for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].x > 10.0) pushes[i] = plain[i];
      expect_same(pushes, plain, *build);
    }
  }
}

TEST(KernelsInvariance, WanderersAreTheSameInEveryBuild) {
  const auto references = points_in_box(64, 4.0, 1);
  for (const Kernels* build : builds()) {
    auto points = references;
    EXPECT_FALSE(build->any_beyond(points.data(), references.data(), points.size(), 0.1));
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].x > 10.0) continue;
      points[i].y += 0.11;
      EXPECT_TRUE(build->any_beyond(points.data(), references.data(), points.size(), 0.1)) << i;
      EXPECT_FALSE(build->any_beyond(points.data(), references.data(), points.size(), 0.12)) << i;
      points[i] = references[i];
    }
  }
}

}  // namespace
