// SPDX-License-Identifier: GPL-2.0-or-later
// Containers made of shapes where space repeats: the same as without a period, but with images of all shapes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/repeated_solid.hpp"
#include "spot/geometry/round_hole.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::InvalidContainer;
using spot::Outlet;
using spot::Outlets;
using spot::Periodic;
using spot::ShapedContainer;
using spot::Solid;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;

constexpr double half = 6.0, period = 2.0 * half, infinite = std::numeric_limits<double>::infinity();
const Vector3 y = Vector3::UnitY();
const spot::SpotBuffers buffers{0.7, 1.0};

/// The cell along y, or both.
Periodic cell(bool both = false) {
  const spot::Interval interval{-half, half};
  return both ? Periodic(interval, interval) : Periodic({}, interval);
}

Solid wedge(double sign) { return spot::half_space({sign * 5.0, 0.0, 0.0}, {sign, 0.0, -0.5}); }

Solid repeated_wedge(double sign, const Periodic& periodic) {
  return repeated(wedge(sign), Vector3::Constant(-infinite), Vector3::Constant(infinite), periodic);
}

const Vector3 low(-9.0, -half, 0.0), high(9.0, half, 20.0);

/// A wedge that goes from end to end; with a ball and a pillar near the ends of the cell, and a round hole, to all of
/// which images are near.
Solid with_obstacles(const Periodic& periodic) {
  const Vector3 centre(2.5, -4.7, 6.0), foot(-4.0, 5.0, -1.0), head(-4.0, 5.0, 21.0);
  const Vector3 r = Vector3::Constant(1.2), s(0.9, 0.9, 0.0);
  return repeated(spot::block(low, high), low, high, periodic) & ~repeated_wedge(-1.0, periodic) &
         ~repeated_wedge(1.0, periodic) & ~repeated(spot::sphere(centre, 1.2), centre - r, centre + r, periodic) &
         ~repeated(spot::cylinder_between(foot, head, 0.9), foot - s, head + s, periodic);
}

ShapedContainer periodic_silo() {
  return {with_obstacles(cell()), Outlet(spot::Orifice{{0.0, 3.0, 0.0}, 2.8}), buffers, cell()};
}

/// Five cells, in space that does not repeat.
ShapedContainer long_silo() {
  Solid solid =
      spot::block({low.x(), -5.0 * half, low.z()}, {high.x(), 5.0 * half, high.z()}) & ~wedge(-1.0) & ~wedge(1.0);
  std::vector<Outlet> outlets;
  for (int k = -2; k <= 2; ++k) {
    const Vector3 on = k * period * y;
    solid = solid & ~spot::sphere(Vector3(2.5, -4.7, 6.0) + on, 1.2) &
            ~spot::cylinder_between(Vector3(-4.0, 5.0, -1.0) + on, Vector3(-4.0, 5.0, 21.0) + on, 0.9);
    outlets.emplace_back(spot::Orifice{Vector3(0.0, 3.0, 0.0) + on, 2.8});
  }
  return {solid, Outlets(outlets), buffers};
}

std::vector<spot::WallContact> sorted_contacts(const spot::Container& silo, const Vector3& at, double reach) {
  spot::WallContacts contacts;
  silo.contacts(at, reach, contacts);
  std::vector<spot::WallContact> all(contacts.begin(), contacts.end());
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
  return all;
}

TEST(RepeatedShapesBruteForce, WallsAreThoseOfManyCells) {
  const ShapedContainer repeats = periodic_silo(), all = long_silo();
  scenes::Draws draws(41);
  int contacts = 0, walls = 0, across = 0, steps = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vector3 at = draws.in_box({low.x(), -3.0 * half, -0.5}, {high.x(), 3.0 * half, high.z()});
    ASSERT_EQ(repeats.contains(at), all.contains(at)) << at.transpose();
    ASSERT_EQ(repeats.may_have_left_to(at), all.may_have_left_to(at)) << at.transpose();
    if (!all.contains(at)) continue;
    const auto of_one = sorted_contacts(repeats, at, 1.5), of_all = sorted_contacts(all, at, 1.5);
    ASSERT_EQ(of_one.size(), of_all.size()) << at.transpose();
    for (std::size_t i = 0; i < of_all.size(); ++i) EXPECT_NEAR(of_one[i].distance, of_all[i].distance, 1e-9);
    contacts += static_cast<int>(of_all.size());

    const Vector3 to = at + draws.in_box({-4.0, -6.0, -4.0}, {4.0, 6.0, 4.0});
    const auto a = repeats.first_wall(at, to), b = all.first_wall(at, to);
    ASSERT_EQ(a.has_value(), b.has_value()) << at.transpose() << " to " << to.transpose();
    if (a) {
      EXPECT_NEAR(a->share, b->share, 1e-9);
      EXPECT_LT((a->normal - b->normal).norm(), 1e-8);
      ++walls;
      across += std::floor((at.y() + half) / period) != std::floor((to.y() + half) / period);
    }
    const Vector3 step = at + draws.in_box({-0.9, -0.9, -0.2}, {0.9, 0.9, 0.9});
    const Vector3 end = all.keep_spot_inside(at, step);
    EXPECT_LT((repeats.keep_spot_inside(at, step) - end).norm(), 1e-8) << at.transpose();
    steps += end != step;
  }
  EXPECT_GT(contacts, 1000);
  EXPECT_GT(walls, 1000);
  EXPECT_GT(across, 300);
  EXPECT_GT(steps, 300);
}

/// Along both axes there are nine images of an obstacle.
TEST(RepeatedShapesBruteForce, ImagesAlongBothAxes) {
  const Vector3 below(-half, -half, 0.0), above(half, half, 20.0), centre(5.0, -5.2, 8.0), r = Vector3::Constant(0.8);
  const ShapedContainer silo(repeated(spot::block(below, above), below, above, cell(true)) &
                                 ~repeated(spot::sphere(centre, 0.8), centre - r, centre + r, cell(true)),
                             Outlet(spot::Orifice{{0.0, 0.0, 0.0}, 2.8}), buffers, cell(true));
  scenes::Draws draws(42);
  int near = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vector3 at = draws.in_box({-3.0 * half, -3.0 * half, 4.0}, {3.0 * half, 3.0 * half, 12.0});
    const double distance = silo.periodic().nearest(Vector3(at - centre)).norm() - 0.8;
    ASSERT_EQ(silo.contains(at), distance >= 0.0) << at.transpose();
    if (distance < 0.0) continue;
    const auto contacts = sorted_contacts(silo, at, 2.0);
    ASSERT_EQ(contacts.size(), distance < 2.0 ? 1u : 0u) << at.transpose();
    if (distance >= 2.0) continue;
    EXPECT_NEAR(contacts[0].distance, distance, 1e-9);
    ++near;
  }
  EXPECT_GT(near, 100);
}

/// Across the ends of the cell as elsewhere, around a pillar that stands at one.
TEST(RepeatedShapesStatistical, AWalkWithoutDriftIsUniform) {
  const Vector3 foot(-2.0, 5.0, -1.0), head(2.0, 6.0, 21.0);
  const ShapedContainer silo(
      repeated(spot::block(low, high), low, high, cell()) & ~repeated(spot::block(foot, head), foot, head, cell()),
      Outlet({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(6.0, 6.0)), {0.0, 0.0}, cell());
  scenes::Draws draws(43);
  std::vector<int> columns(18 * 12);
  for (int walk = 0; walk < 5000; ++walk) {
    Vector3 at;
    do at = draws.in_box({low.x(), low.y(), 8.0}, {high.x(), high.y(), 8.0});
    while (!silo.contains(at));
    for (int step = 0; step < 150; ++step)
      at = silo.keep_spot_inside(at, at + draws.in_box({-0.6, -0.6, 0.0}, {0.6, 0.6, 0.0}));
    ASSERT_TRUE(silo.contains(at)) << at.transpose();
    const Vector3 place = silo.periodic().wrap(at) - low;
    ++columns[static_cast<std::size_t>(std::min(17.0, place.x())) * 12 +
              static_cast<std::size_t>(std::min(11.0, place.y()))];
  }
  for (std::size_t x = 7; x < 11; ++x) {
    EXPECT_EQ(columns[x * 12 + 11], 0) << "in the pillar";
    columns[x * 12 + 11] = -1;
  }
  columns.erase(std::remove(columns.begin(), columns.end(), -1), columns.end());
  EXPECT_LT(scenes::deviation_from_equal_counts(columns), scenes::bound);
}

TEST(RepeatedShapesUnit, ASlotFromEndToEndHasNoEnds) {
  const Outlets outlets = Outlets(Outlet({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(6.0, period))).repeated(cell());
  const ShapedContainer silo(repeated(spot::block(low, high), low, high, cell()) & ~repeated_wedge(1.0, cell()),
                             outlets, buffers, cell());
  for (const double at : {-half, -5.9, 0.0, 5.9, half, 3.0 * half}) {
    EXPECT_TRUE(sorted_contacts(silo, {0.0, at, 0.2}, 0.9).empty()) << at;
    EXPECT_EQ(sorted_contacts(silo, {2.7, at, 0.2}, 0.9).size(), 1u) << "the rim, at " << at;
    EXPECT_FALSE(silo.first_wall({0.0, at, 2.0}, {0.0, at + 7.0, -2.0})) << at;
  }
}

std::string refusal(const Solid& shape, const Vector3& from, const Vector3& to) {
  return scenes::text_of<InvalidContainer>([&] { repeated(shape, from, to, cell()); });
}

TEST(RepeatedShapesUnit, ShapesThatChangeOnTheirWayAcrossAreRefused) {
  const Vector3 far = Vector3::Constant(infinite), r = Vector3::Constant(2.0), beside(0.0, 5.0, 3.0);
  EXPECT_THAT(refusal(spot::sphere(beside, 2.0), beside - r, beside + r),
              AllOf(HasSubstr("along y, from -6 to 6"), HasSubstr("from 3 to 7"), HasSubstr("without a change")));
  EXPECT_THAT(refusal(spot::half_space({0, 0, 0}, {0, 0.1, 1}), -far, far), HasSubstr("without a change along y"));
  EXPECT_THAT(refusal(spot::half_space({0, -7, 0}, {0, 1, 0}), -far, far), HasSubstr("without a change along y"));
  EXPECT_THAT(refusal(spot::block({-1, -6, 0}, {1, 6.5, 2}) & ~spot::sphere({0, 0, 0}, 0.5), {-1, -6, 0}, {1, 6.5, 2}),
              HasSubstr("from -6 to 6.5"));
  // Along x nothing repeats, and a block may go beyond both ends.
  EXPECT_NO_THROW(repeated(spot::block({-90, -7, 0}, {90, 6, 2}), {-90, -7, 0}, {90, 6, 2}, cell()));
  EXPECT_NO_THROW(repeated(spot::cylinder_between({0, -6, 3}, {0, 6, 3}, 2.0), {-2, -6, 1}, {2, 6, 5}, cell()));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                ShapedContainer(with_obstacles(cell()), Outlet(spot::Orifice{{0.0, 3.3, 0.0}, 2.8}), buffers, cell());
              }),
              AllOf(HasSubstr("orifice of radius 2.8"), HasSubstr("reaches out of the cell")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                spot::cylinder_silo(0.0, 0.5, 5.6, Outlet(spot::Orifice{{0.0, 0.0, 0.0}, 2.8}), buffers, cell());
              }),
              AllOf(HasSubstr("a cylinder from -5.1 to 6.1 reaches out"), HasSubstr("along y from -6 to 6")));
}

}  // namespace
