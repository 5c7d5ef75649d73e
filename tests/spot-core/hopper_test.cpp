// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/hopper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/silo_width.hpp"
#include "spot/geometry/silos.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::hopper_slope;
using spot::Orifice;
using spot::Outlet;
using spot::ShapedContainer;
using spot::SpotBuffers;
using spot::Vector3;

const Orifice orifice{{1.0, 2.0, 0.5}, 4.0};
const SpotBuffers buffers{0.25, 2.0};

/// A cone from a radius at the height of the orifice on, whose wall recedes by `slope` for each length of height.
ShapedContainer cone(double slope, double radius = 4.0) {
  const Vector3 up(0.0, 0.0, 6.0);
  return {spot::cone_between(orifice.centre, radius, orifice.centre + up, radius + 6.0 * slope), orifice, buffers};
}

TEST(HopperAnalytic, TheSlopeIsThatOfTheCone) {
  for (const double slope : {0.2, 0.577, 1.0, 1.732, 5.0})
    EXPECT_NEAR(hopper_slope(cone(slope), orifice).value_or(-1.0), slope, 1e-9) << slope;
}

TEST(HopperAnalytic, AWedgeIsOneAcrossItsSlot) {
  const Outlet slot({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(8.0, 32.0));
  const auto wedge = [&](double left, double right) {
    const spot::Solid block = spot::block({-20.0, -16.0, 0.0}, {20.0, 16.0, 60.0});
    return ShapedContainer(block & ~spot::half_space({4.0, 0.0, 0.0}, {1.0, 0.0, -right}) &
                               ~spot::half_space({-4.0, 0.0, 0.0}, {-1.0, 0.0, -left}),
                           slot, buffers);
  };
  EXPECT_NEAR(hopper_slope(wedge(0.7, 0.7), slot).value_or(-1.0), 0.7, 1e-9);
  EXPECT_FALSE(hopper_slope(wedge(0.7, 0.9), slot)) << "one side is steeper";
}

TEST(HopperUnit, OtherWallsAreNone) {
  EXPECT_FALSE(hopper_slope(*spot::cylinder_silo(1.0, 2.0, 12.0, orifice, buffers), orifice)) << "a flat base";
  EXPECT_FALSE(hopper_slope(*spot::box_silo(-60.0, 60.0, -6.0, 8.0, orifice, buffers), orifice));
  EXPECT_FALSE(hopper_slope(cone(0.5, 5.0), orifice)) << "a ledge around the orifice";
  const Vector3 up(0.0, 0.0, 2.0), top(0.0, 0.0, 9.0);
  const ShapedContainer bent(spot::cone_between(orifice.centre, 4.0, orifice.centre + up, 8.0) |
                                 spot::cylinder_between(orifice.centre + up, orifice.centre + top, 8.0),
                             orifice, buffers);
  EXPECT_FALSE(hopper_slope(bent, orifice)) << "it ends too low";
  EXPECT_EQ(hopper_slope(*spot::cylinder_silo(1.0, 2.0, 4.05, orifice, buffers), orifice), 0.0) << "a pipe";
}

TEST(HopperAnalytic, TheFactorIsTheFormula) {
  const double pi = std::acos(-1.0);
  for (const double degrees : {1.0, 24.0, 45.0, 60.0, 89.0})
    EXPECT_NEAR(spot::tangent(degrees), std::tan(degrees * pi / 180.0), 1e-12 * spot::tangent(degrees)) << degrees;
  EXPECT_NEAR(spot::hopper_factor(spot::tangent(30.0), spot::tangent(24.0)),
              std::pow(std::tan(pi / 6.0) * std::tan(24.0 * pi / 180.0), -0.35), 1e-12);
  EXPECT_NEAR(spot::hopper_factor(spot::tangent(65.999), spot::tangent(24.0)), 1.0, 1e-4);
  EXPECT_EQ(spot::hopper_factor(spot::tangent(80.0), spot::tangent(24.0)), 1.0) << "as over a flat base";
}

TEST(SiloWidthAnalytic, TheNearestWallCountsOnBothSides) {
  const auto width = [](const auto& silo, const Outlet& outlet) {
    return spot::silo_width(*silo, outlet).value_or(-1.0);
  };
  EXPECT_NEAR(width(spot::box_silo(-60.0, 60.0, -6.0, 8.0, orifice, buffers), orifice), 12.0, 1e-9);
  EXPECT_NEAR(width(spot::cylinder_silo(0.0, 2.0, 12.0, orifice, buffers), orifice), 22.0, 1e-9);
  EXPECT_FALSE(spot::silo_width(*spot::box_silo(-300.0, 300.0, -200.0, 200.0, orifice, buffers), orifice))
      << "far away";
  const Outlet slot({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(8.0, 32.0));
  EXPECT_NEAR(width(spot::box_silo(-20.0, 25.0, -16.0, 16.0, slot, buffers), slot), 40.0, 1e-9) << "across the slot";
}

}  // namespace
