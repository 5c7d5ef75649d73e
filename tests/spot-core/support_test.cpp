// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/support.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "scenes.hpp"

namespace {

using spot::holds;
using spot::Vector3;

/// From the horizontal by this many degrees, towards this azimuth in degrees.
Vector3 normal(double elevation, double azimuth) {
  const double e = elevation * scenes::pi / 180.0, a = azimuth * scenes::pi / 180.0;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

TEST(SupportUnit, NothingHoldsAGrainThatTouchesNobody) { EXPECT_FALSE(holds({})); }

TEST(SupportUnit, AGrainRollsOffOneOther) {
  EXPECT_FALSE(holds({normal(90, 0)}));
  EXPECT_FALSE(holds({normal(80, 0)}));
}

TEST(SupportUnit, AGrainRollsOffTheSaddleOfTwoOthers) {
  EXPECT_FALSE(holds({normal(40, 0), normal(40, 180)}));
  EXPECT_FALSE(holds({normal(40, 0), normal(40, 150)}));
}

TEST(SupportUnit, AHollowOfThreeHolds) {
  EXPECT_TRUE(holds({normal(54, 0), normal(54, 120), normal(54, 240)}));
  EXPECT_FALSE(holds({normal(54, 0), normal(54, 60), normal(54, 120)})) << "all on one side";
}

TEST(SupportUnit, AWallHelps) {
  EXPECT_FALSE(holds({normal(60, 10), normal(60, -10)}));
  EXPECT_TRUE(holds({normal(60, 40), normal(60, -40), normal(0, 180)}));
}

TEST(SupportUnit, WhatIsAboveDoesNotHold) { EXPECT_FALSE(holds({normal(-30, 0), normal(-30, 120), normal(-30, 240)})); }

/// Is this direction a sum of at most three of the normals with positive weights? (Caratheodory)
bool is_sum(const Vector3& up, const std::vector<Vector3>& normals) {
  const auto n = normals.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j)
      for (std::size_t k = j; k < n; ++k) {
        Eigen::MatrixXd columns(3, 3);
        columns << normals[i], normals[j], normals[k];
        const Eigen::VectorXd weights = columns.completeOrthogonalDecomposition().solve(up);
        if ((columns * weights - up).norm() < 1e-9 && weights.minCoeff() > -1e-9) return true;
      }
  return false;
}

bool holds_plainly(const std::vector<Vector3>& normals) {
  return is_sum({0.1, 0.0, 1.0}, normals) && is_sum({-0.1, 0.0, 1.0}, normals) && is_sum({0.0, 0.1, 1.0}, normals) &&
         is_sum({0.0, -0.1, 1.0}, normals);
}

/// Slopes of less than three degrees apart, on which the two need not agree.
TEST(SupportBruteForce, AgreesWithAllTriplesOfContacts) {
  scenes::Draws draws(7);
  int held = 0, level = 0;
  for (int scene = 0; scene < 2000; ++scene) {
    std::vector<Vector3> normals;
    for (std::size_t n = 1 + draws.below(6); n > 0; --n)
      normals.push_back(normal(draws.uniform(-60.0, 90.0), draws.uniform(0.0, 360.0)));
    const bool plainly = holds_plainly(normals);
    held += plainly ? 1 : 0;
    if (holds(normals) == plainly) continue;
    EXPECT_FALSE(plainly) << "scene " << scene;
    ++level;
  }
  EXPECT_GT(held, 200);
  EXPECT_LT(level, 100) << "scenes in which the way down is nearly level";
}

}  // namespace
