// SPDX-License-Identifier: GPL-2.0-or-later
// Holes of any shape, several in one base, and the containers that have them.
#include "spot/geometry/outlets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/round_hole.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::BasePlate;
using spot::Hole;
using spot::InvalidContainer;
using spot::Orifice;
using spot::Outlet;
using spot::Outlets;
using spot::RoundHole;
using spot::Slot;
using spot::SpotBuffers;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();
const SpotBuffers buffers{1.0, 2.6};

std::vector<std::shared_ptr<const Hole>> holes() {
  return {std::make_shared<RoundHole>(3.0), std::make_shared<Slot>(8.0, 6.0), std::make_shared<Slot>(5.5, 12.0)};
}

/// A round hole and a slot.
Outlets two() {
  return Outlets({Orifice{{-6.0, 0.0, 0.0}, 3.0}, Outlet({5.0, 1.0, 0.0}, std::make_shared<Slot>(8.0, 6.0))});
}

/// Is there a hole in their base?
bool open(double x, double y) {
  return (x + 6.0) * (x + 6.0) + y * y <= 9.0 || (std::abs(x - 5.0) <= 4.0 && std::abs(y - 1.0) <= 3.0);
}

TEST(HoleBruteForce, DistancesAreThoseOfTheNearestPoint) {
  scenes::Draws draws(31);
  for (const auto& hole : holes())
    for (int k = 0; k < 200; ++k) {
      const Vector3 place = draws.in_box({-8.0, -8.0, -1.0}, {8.0, 8.0, 1.0});
      const double distance = hole->distance(place);
      // Of all points of a fine grid, those on the other side of the rim.
      double least = infinity;
      for (double x = -12.0; x <= 12.0; x += 0.05)
        for (double y = -12.0; y <= 12.0; y += 0.05)
          if ((hole->distance({x, y, 0.0}) <= 0.0) != (distance <= 0.0))
            least = std::min(least, std::hypot(place.x() - x, place.y() - y));
      EXPECT_NEAR(std::abs(distance), least, 0.075) << hole->name() << " at " << place.transpose();
      if (distance >= 0.0) continue;
      const Vector3 rim = place - distance * hole->to_rim(place);
      EXPECT_NEAR(hole->distance(rim), 0.0, 1e-12) << "straight to the rim";
      EXPECT_EQ(hole->to_rim(place).z(), 0.0);
    }
}

TEST(HoleAnalytic, SlotsHaveTheMeasuresOfRectangles) {
  const Slot slot(8.0, 6.0);
  EXPECT_EQ(slot.distance({0.0, 0.0, 7.0}), -3.0);
  EXPECT_EQ(slot.distance({3.5, 0.0, 0.0}), -0.5);
  EXPECT_EQ(slot.distance({-4.0, 3.0, 0.0}), 0.0);
  EXPECT_EQ(slot.distance({7.0, -7.0, 0.0}), 5.0) << "from the corner";
  EXPECT_EQ(slot.to_rim({-3.5, 0.0, 0.0}), Vector3(-1.0, 0.0, 0.0));
  EXPECT_EQ(slot.to_rim({0.0, 2.5, 0.0}), Vector3(0.0, 1.0, 0.0));
  EXPECT_EQ(slot.widest_radius(), 3.0);
  EXPECT_NEAR(slot.equivalent_radius(), std::sqrt(48.0 / scenes::pi), 1e-14);
  EXPECT_EQ(slot.half_width(0), 4.0);
  EXPECT_EQ(slot.half_width(1), 3.0);
  EXPECT_EQ(slot.farthest({1.0, -1.0, 9.0}), std::hypot(5.0, 4.0));
  EXPECT_EQ(slot.keep_inside(1.0, {2.0, -1.5, 9.0}), Vector3(2.0, -1.5, 9.0));
  EXPECT_EQ(slot.keep_inside(1.0, {3.5, -2.5, 9.0}), Vector3(2.5, -1.5, 9.0)) << "from both sides";
  EXPECT_EQ(slot.keep_inside(1.0, {-20.0, 0.0, 9.0}), Vector3(0.0, 0.0, 9.0)) << "never past the centre";
  EXPECT_EQ(slot.keep_inside(5.0, {3.5, 2.0, 9.0}), Vector3(0.0, 0.0, 9.0)) << "where there is no room";
}

TEST(HoleStatistical, PointsAreUniformInsideTheMargin) {
  scenes::Draws draws(32);
  for (const auto& hole : holes()) {
    // Squares of a grid that lie inside the margin as a whole are hit alike.
    constexpr double margin = 1.0, side = 0.5;
    constexpr int half = 24;
    std::vector<int> counts(4 * half * half);
    for (int k = 0; k < 40000; ++k) {
      const Vector3 point = hole->point(margin, draws.uniform(0.0, 1.0), draws.uniform(0.0, 1.0));
      ASSERT_LE(hole->distance(point), -margin + 1e-12);
      ++counts[static_cast<std::size_t>((std::floor(point.x() / side) + half) * 2 * half +
                                        std::floor(point.y() / side) + half)];
    }
    std::vector<int> inside;
    for (int x = -half; x < half; ++x)
      for (int y = -half; y < half; ++y) {
        bool whole = true;
        for (const Vector3& corner :
             {Vector3(x, y, 0), Vector3(x + 1, y, 0), Vector3(x, y + 1, 0), Vector3(x + 1, y + 1, 0)})
          whole = whole && hole->distance(side * corner) <= -margin;
        if (whole) inside.push_back(counts[static_cast<std::size_t>((x + half) * 2 * half + y + half)]);
      }
    ASSERT_GT(inside.size(), 20u);
    EXPECT_LT(std::abs(scenes::deviation_from_equal_counts(inside)), scenes::bound) << hole->name();
  }
}

TEST(HoleBruteForce, ColumnsAreWhatIsOverTheHole) {
  scenes::Draws draws(33);
  for (const auto& hole : holes()) {
    const Vector3 centre(1.0, 2.0, 3.0);
    const spot::Solid column = hole->column(centre);
    for (int k = 0; k < 1000; ++k) {
      const Vector3 place = draws.in_box({-8.0, -8.0, -9.0}, {8.0, 8.0, 9.0});
      EXPECT_EQ(column.contains(centre + place), hole->distance(place) <= 0.0);
    }
  }
}

TEST(OutletsBruteForce, APlateWithTwoHolesIsWhatIsLeftOfIt) {
  const Outlets outlets = two();
  const BasePlate plate(outlets);
  scenes::Draws draws(34);
  for (int k = 0; k < 200; ++k) {
    const Vector3 centre = draws.in_box({-11.0, -6.0, -1.0}, {11.0, 6.0, 2.0});
    double least = infinity;
    for (double x = -12.0; x <= 12.0; x += 0.05)
      for (double y = -7.0; y <= 7.0; y += 0.05)
        if (!open(x, y)) least = std::min(least, (centre - Vector3(x, y, 0.0)).norm());
    EXPECT_NEAR(plate.nearest(centre).distance, least, 0.075) << centre.transpose();
    EXPECT_NEAR(plate.nearest(centre).normal.norm(), 1.0, 1e-12);
    const Vector3 from(centre.x(), centre.y(), -1.0), to(centre.x(), centre.y(), 1.0);
    const bool through = open(centre.x(), centre.y());
    EXPECT_EQ(!plate.meet(from, to), through);
    EXPECT_EQ(!plate.meet(to, from), through);
    EXPECT_EQ(plate.may_have_left_to({centre.x(), centre.y(), 0.0}), through);
    // Spots that rise are kept in a hole.
    const Vector3 kept = plate.reflect_spot(2.6, {centre.x(), centre.y(), -0.5});
    EXPECT_LE(outlets.nearest(kept).distance(kept), -2.6);
  }
  EXPECT_TRUE(plate.may_have_left_to({9.5, 1.0, -0.6})) << "spread as far as it has come down";
  EXPECT_FALSE(plate.may_have_left_to({9.5, 1.0, -0.4}));
  EXPECT_FALSE(plate.may_have_left_to({-1.0, 0.0, -0.5})) << "between them";
}

TEST(OutletsUnit, PlacesAreOverTheNearestImageWhereSpaceRepeats) {
  spot::WalledContainer space(two());
  space.add(std::make_unique<BasePlate>(two()), 2.6);
  EXPECT_TRUE(space.is_over_outlet({-8.9, 0.0, 5.0}));
  EXPECT_FALSE(space.is_over_outlet({-9.1, 0.0, 5.0}));
  EXPECT_TRUE(space.is_over_outlet({-9.1, 0.0, -5.0}, 0.2));
  EXPECT_TRUE(space.is_over_outlet({8.9, 3.9, 5.0}));
  EXPECT_FALSE(space.is_over_outlet({29.0, 0.0, 5.0}));
  space.repeat({spot::Interval{-10.0, 10.0}, {}});
  EXPECT_TRUE(space.is_over_outlet({28.9, 3.9, 5.0}));
  EXPECT_TRUE(space.is_over_outlet({11.2, 0.0, 5.0}));
  EXPECT_FALSE(space.is_over_outlet({30.0, 0.0, 5.0}));
  EXPECT_TRUE(space.may_have_left_to({11.2, 0.0, -0.5}));
  EXPECT_FALSE(space.may_have_left_to({30.0, 0.0, -0.5}));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                space.repeat({spot::Interval{-8.5, 10.0}, {}});
              }),
              AllOf(HasSubstr("orifice of radius 3 at (-6, 0, 0)"), HasSubstr("-8.5"), HasSubstr("along x")));
}

template <typename Act>
std::string refusal_of(const Act& act) {
  return scenes::text_of<InvalidContainer>(act);
}

TEST(OutletsUnit, ThoseThatDoNotFitAreNamedWithTheirBound) {
  const auto slot = std::make_shared<Slot>(8.0, 6.0);
  EXPECT_THAT(refusal_of([] { Outlets(std::vector<Outlet>{}); }), HasSubstr("at least one"));
  EXPECT_THAT(refusal_of([&] {
                Outlets({Orifice{{-6.0, 0.0, 0.0}, 3.0}, Outlet({5.0, 0.0, 0.5}, slot)});
              }),
              AllOf(HasSubstr("z = 0 and z = 0.5"), HasSubstr("one height")));
  EXPECT_THAT(refusal_of([&] {
                Outlets({Orifice{{-6.0, 0.0, 0.0}, 3.0}, Outlet({0.9, 0.0, 0.0}, slot)});
              }),
              AllOf(HasSubstr("orifice of radius 3 at (-6, 0, 0)"), HasSubstr("slot of 8 by 6 at (0.9, 0, 0)"),
                    HasSubstr("overlap")));
  EXPECT_NO_THROW(Outlets({Orifice{{-6.0, 0.0, 0.0}, 3.0}, Outlet({1.0, 0.0, 0.0}, slot)})) << "side by side";
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THAT(refusal_of([&] { RoundHole{bad}; }), AllOf(HasSubstr("radius"), HasSubstr("positive and finite")));
    EXPECT_THAT(refusal_of([&] { Slot(bad, 1.0); }), AllOf(HasSubstr("along x"), HasSubstr("positive and finite")));
    EXPECT_THAT(refusal_of([&] { Slot(1.0, bad); }), AllOf(HasSubstr("along y"), HasSubstr("positive and finite")));
  }
  EXPECT_THAT(refusal_of([&] { Outlet({0.0, infinity, 0.0}, slot); }), HasSubstr("must be finite"));
  EXPECT_THAT(refusal_of([&] {
                spot::WalledContainer(Outlet({0.0, 0.0, 0.0}, slot)).require_entrance(3.1);
              }),
              AllOf(HasSubstr("orifice radius is 3 "), HasSubstr("3.1"), HasSubstr("slot of 8 by 6")));
  EXPECT_THAT(refusal_of([&] { spot::box_silo(-9.0, 8.9, -4.0, 4.0, two(), buffers); }),
              AllOf(HasSubstr("slot of 8 by 6"), HasSubstr("8.9")));
  EXPECT_NO_THROW(spot::box_silo(-9.0, 9.0, -3.0, 4.0, two(), buffers));
  EXPECT_THAT(refusal_of([&] {
                spot::cylinder_silo(0.0, 0.0, 4.9, Outlet({0.0, 0.0, 0.0}, slot), buffers);
              }),
              AllOf(HasSubstr("reaches 5 "), HasSubstr("4.9")));
  // Its corners are outside, and nothing else.
  const spot::Solid pipe = spot::cylinder({0.0, 0.0, 0.0}, Vector3::UnitZ(), 4.99);
  EXPECT_THAT(refusal_of([&] {
                spot::ShapedContainer(pipe, Outlet({0.0, 0.0, 0.0}, slot), buffers);
              }),
              AllOf(HasSubstr("slot of 8 by 6"), HasSubstr("does not open")));
}

/// Silos of shapes have the same walls as those of walls.
TEST(OutletsBruteForce, ShapedContainersAreOpenAtAllOfThem) {
  const auto walls = spot::box_silo(-10.0, 10.0, -6.0, 6.0, two(), buffers);
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY();
  const spot::Solid box = spot::half_space(-10.0 * x, x) & spot::half_space(10.0 * x, -x) &
                          spot::half_space(-6.0 * y, y) & spot::half_space(6.0 * y, -y);
  const spot::ShapedContainer shaped(box, two(), buffers);
  scenes::Draws draws(35);
  int paths = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3 at = draws.in_box({-10.0, -6.0, -0.5}, {10.0, 6.0, 3.0});
    const Vector3 to = at + draws.in_box({-3.0, -3.0, -3.0}, {3.0, 3.0, 3.0});
    ASSERT_EQ(shaped.contains(at), walls->contains(at)) << at.transpose();
    ASSERT_EQ(shaped.may_have_left_to(at), walls->may_have_left_to(at)) << at.transpose();
    const auto first = shaped.first_wall(at, to), same = walls->first_wall(at, to);
    ASSERT_EQ(first.has_value(), same.has_value()) << at.transpose() << " to " << to.transpose();
    if (!first) continue;
    ++paths;
    ASSERT_NEAR(first->share, same->share, 1e-9);
  }
  EXPECT_GT(paths, 500);
}

TEST(OutletsUnit, ASlotAsLongAsThePeriodHasNoEnds) {
  const spot::Periodic periodic(std::nullopt, spot::Interval{-6.0, 10.0});
  const auto silo = spot::box_silo(spot::Interval{-9.0, 9.0}, std::nullopt, periodic,
                                   Outlet({1.0, 0.0, 0.0}, std::make_shared<Slot>(8.0, 16.0)), {0.5, 2.0});
  const Outlet& outlet = silo->outlets()[0];
  EXPECT_EQ(outlet.hole->name(), "slot of 8 by 16 without ends along y");
  EXPECT_EQ(outlet.hole->half_width(1), 8.0);
  EXPECT_EQ(outlet.hole->widest_radius(), 4.0);
  // Where the cells meet there is no rim, for grains, spots or paths; along x there is.
  for (const double y : {-6.0, 9.9, 10.0, 2.0}) {
    spot::WallContacts contacts;
    silo->contacts({1.0, y, 0.1}, 0.6, contacts);
    EXPECT_EQ(contacts.begin(), contacts.end()) << y;
    EXPECT_TRUE(silo->is_over_outlet({4.9, y, -1.0}));
    EXPECT_FALSE(silo->is_over_outlet({5.1, y, -1.0}));
    EXPECT_FALSE(silo->first_wall({1.0, y - 0.3, 0.5}, {1.0, y + 0.3, -0.5}).has_value());
    EXPECT_TRUE(silo->first_wall({5.1, y - 0.3, 0.5}, {5.1, y + 0.3, -0.5}).has_value());
    EXPECT_EQ(silo->keep_spot_inside({1.0, y, 0.2}, {1.0, y + 0.4, 0.4}), Vector3(1.0, y + 0.4, 0.4));
    EXPECT_LT(silo->keep_spot_inside({2.5, y, 0.2}, {3.9, y, 0.4}).x(), 3.2);
    silo->contacts({4.8, y, 0.1}, 0.6, contacts);
    EXPECT_EQ(std::distance(contacts.begin(), contacts.end()), 1) << y;
  }
  // Spots are born up to the ends of the cell along y, a margin off the rims along x.
  double least = 99.0, most = -99.0;
  for (int k = 0; k <= 1000; ++k) {
    const Vector3 place = outlet.centre + outlet.hole->point(2.6, 0.001 * k, 0.001 * k);
    least = std::min(least, place.y());
    most = std::max(most, place.y());
    EXPECT_LE(std::abs(place.x() - 1.0), 1.4 + 1e-12);
  }
  EXPECT_EQ(least, -6.0);
  EXPECT_EQ(most, 10.0);
  // Beverloo's law takes nothing off a length that has no ends.
  const spot::BeverlooLaw law;
  EXPECT_NEAR(outlet.hole->discharge(law, 1.0), law.slot * 16.0 * std::pow(8.0 - law.margin, 1.5), 1e-12);
  EXPECT_THAT(refusal_of([&] {
                spot::box_silo(spot::Interval{-9.0, 9.0}, std::nullopt, periodic,
                               Outlet({1.0, 2.0, 0.0}, std::make_shared<Slot>(8.0, 16.1)), {0.5, 2.0});
              }),
              testing::HasSubstr("reaches out of the cell"));
}

}  // namespace
