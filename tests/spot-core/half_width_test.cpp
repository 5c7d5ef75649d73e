// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/half_width.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "general_scene.hpp"
#include "scenes.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/silos.hpp"

namespace {

using spot::half_width;
using spot::Orifice;
using spot::SpotBuffers;
using spot::Vector3;

const Orifice orifice{{0.0, 0.0, 0.0}, 2.0};
const SpotBuffers buffers{0.25, 2.0};

TEST(HalfWidthAnalytic, InABoxItIsTheAreaOverThePerimeter) {
  const auto box = spot::box_silo(-25.0, 25.0, -4.0, 4.0, orifice, buffers);
  const double expected = 50.0 * 8.0 / (2.0 * (50.0 + 8.0));
  for (const Vector3& at : {Vector3(0, 0, 10), Vector3(20, 3, 1), Vector3(-24.9, -3.9, 80)})
    EXPECT_NEAR(half_width(*box, at, 100.0), expected, 1e-12) << at.transpose();
}

TEST(HalfWidthAnalytic, InACylinderItIsHalfTheRadius) {
  const auto pipe = spot::cylinder_silo(1.0, 2.0, 12.0, Orifice{{1.0, 2.0, 0.0}, 2.0}, buffers);
  for (const Vector3& at : {Vector3(1, 2, 10), Vector3(7, 2, 10), Vector3(-9, 6, 3), Vector3(1, 13.99, 80)})
    EXPECT_NEAR(half_width(*pipe, at, 100.0), 6.0, 1e-9) << at.transpose();
}

TEST(HalfWidthAnalytic, InAConeItGrowsWithHeight) {
  const Vector3 rim(0.0, 0.0, 0.0), shoulder(0.0, 0.0, 10.0);
  const spot::ShapedContainer cone(spot::cone_between(rim, 2.0, shoulder, 12.0), orifice, buffers);
  for (const double z : {1.0, 4.0, 9.0}) EXPECT_NEAR(half_width(cone, {0.0, 0.0, z}, 100.0), 0.5 * (2.0 + z), 1e-9);
}

TEST(HalfWidthUnit, WaysEndAtTheFarthest) {
  const auto space = scenes::empty_space();
  EXPECT_NEAR(half_width(*space, {0.0, 0.0, 5.0}, 60.0), 30.0, 1e-12);
}

/// Between walls along x alone, whatever the period along y.
TEST(HalfWidthUnit, WhereSpaceRepeatsNoWallEndsAWay) {
  const auto slab =
      scenes::repeated_silo({-16.0, -8.0, 0.0}, {16.0, 8.0, 90.0}, false, true, {{0.0, 0.0, 0.0}, 4.0}, buffers);
  const double far = 1e4;
  EXPECT_NEAR(half_width(*slab, {3.0, 7.0, 20.0}, far), 1.0 / (1.0 / 16.0 + 1.0 / far), 1e-9);
}

}  // namespace
