// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/nonaffine_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "scenes.hpp"

namespace {

using spot::NonaffineMotion;

NonaffineMotion motion_of(double strength, double length, std::uint64_t seed = 1) {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.nonaffine = strength;
  spots.nonaffine_length = length;
  spots.seed = seed;
  return NonaffineMotion(spots);
}

NonaffineMotion::Tilt tilt_at(const NonaffineMotion& motion, std::int64_t id, double z) {
  NonaffineMotion::Tilt tilt{};
  motion.update(tilt, id, z);
  return tilt;
}

bool same(const NonaffineMotion::Tilt& a, const NonaffineMotion::Tilt& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.level == b.level;
}

TEST(NonaffineMotionUnit, IsOffWithoutAStrength) {
  EXPECT_FALSE(motion_of(0.0, 0.0).on());
  EXPECT_TRUE(motion_of(0.1, 0.5).on());
}

/// 40,000 grains: means within four standard errors of 0, variances within four of 1 (the fourth moment is 1.8).
TEST(NonaffineMotionStatistics, TiltsHaveMeanZeroAndVarianceOne) {
  const NonaffineMotion motion = motion_of(0.2, 0.5);
  constexpr int n = 40000;
  spot::Vector3 sum = spot::Vector3::Zero(), squares = spot::Vector3::Zero();
  spot::Vector3 products = spot::Vector3::Zero();
  for (std::int64_t id = 1; id <= n; ++id) {
    const NonaffineMotion::Tilt tilt = tilt_at(motion, id, 3.7);
    const spot::Vector3 t = motion.unit() / 0.2 * spot::Vector3(tilt.x, tilt.y, tilt.z);
    sum += t;
    squares += t.cwiseProduct(t);
    products += spot::Vector3(t.y() * t.z(), t.z() * t.x(), t.x() * t.y());
    EXPECT_LE(0.2 * t.norm(), motion.largest() * (1.0 + 1e-12));
  }
  EXPECT_LT((sum / n).cwiseAbs().maxCoeff(), 4.0 / std::sqrt(n));
  EXPECT_LT((squares / n - spot::Vector3::Ones()).cwiseAbs().maxCoeff(), 4.0 * std::sqrt(0.8 / n));
  EXPECT_LT((products / n).cwiseAbs().maxCoeff(), 4.0 / std::sqrt(n));
}

TEST(NonaffineMotionUnit, AGrainKeepsItsWayForALengthOfFall) {
  const NonaffineMotion motion = motion_of(0.2, 0.5);
  for (std::int64_t id = 1; id <= 100; ++id) {
    int changes = 0;
    double first = 0.0, last = 0.0;
    NonaffineMotion::Tilt before = tilt_at(motion, id, 10.0);
    for (int k = 1; k <= 1000; ++k) {
      const double z = 10.0 - 0.01 * k;
      const NonaffineMotion::Tilt tilt = tilt_at(motion, id, z);
      if (same(tilt, before)) continue;
      if (changes++ == 0) first = z;
      last = z;
      before = tilt;
    }
    EXPECT_EQ(changes, 20);
    EXPECT_NEAR(first - last, 19 * 0.5, 0.011);
    EXPECT_LE(10.0 - first, 0.511);
  }
}

/// If all drew at the same heights, whole layers would.
TEST(NonaffineMotionStatistics, GrainsChangeTheirWaysAtDifferentHeights) {
  const NonaffineMotion motion = motion_of(0.2, 0.5);
  int changed = 0;
  for (std::int64_t id = 1; id <= 1000; ++id)
    changed += same(tilt_at(motion, id, 10.0), tilt_at(motion, id, 9.9)) ? 0 : 1;
  EXPECT_NEAR(changed, 200, 10);  // phases are a Weyl sequence, so closer than random ones
}

TEST(NonaffineMotionUnit, WhatIsDrawnDependsOnSeedGrainAndLevelAlone) {
  const NonaffineMotion motion = motion_of(0.2, 0.5), other = motion_of(0.2, 0.5, 2);
  NonaffineMotion::Tilt went = tilt_at(motion, 7, 4.0);
  motion.update(went, 7, -3.0);
  motion.update(went, 7, 4.0);
  EXPECT_TRUE(same(went, tilt_at(motion, 7, 4.0)));
  EXPECT_FALSE(same(went, tilt_at(other, 7, 4.0)));
  EXPECT_FALSE(same(went, tilt_at(motion, 8, 4.0)));
  EXPECT_GT(tilt_at(motion, 7, -1e6).level, 0);
  EXPECT_GT(tilt_at(motion, 7, 1e6).level, 0);
}

}  // namespace
