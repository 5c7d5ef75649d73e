// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/shaped_container.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "invariants.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::half_space;
using spot::InvalidContainer;
using spot::Orifice;
using spot::ShapedContainer;
using spot::SpotBuffers;
using spot::Vector3;
using spot::WallContact;
using spot::WallContacts;
using testing::AllOf;
using testing::HasSubstr;

const Orifice orifice{{0.0, 0.0, 0.0}, 4.0};
const SpotBuffers buffers{1.0, 2.6};

spot::Solid endless_box(double half_width, double half_depth) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY();
  return half_space(-half_width * x, x) & half_space(half_width * x, -x) & half_space(-half_depth * y, y) &
         half_space(half_depth * y, -y);
}

/// A cone from the orifice up to a wide cylinder.
spot::Solid hopper() {
  const Vector3 rim(0.0, 0.0, 4.0), top(0.0, 0.0, 40.0);
  return spot::cone_between(orifice.centre, orifice.radius, rim, 7.5) | spot::cylinder_between(rim, top, 7.5);
}

/// Silos made of shapes see the same walls as those made of walls.
TEST(ShapedContainerBruteForce, SilosOfShapesAreThoseOfWalls) {
  const Vector3 up = Vector3::UnitZ();
  const std::shared_ptr<const spot::Container> walls[] = {spot::box_silo(-8.0, 8.0, -5.0, 5.0, orifice, buffers),
                                                          spot::cylinder_silo(0.5, 0.0, 6.0, orifice, buffers)};
  const ShapedContainer shapes[] = {ShapedContainer(endless_box(8.0, 5.0), orifice, buffers),
                                    ShapedContainer(spot::cylinder({0.5, 0.0, 0.0}, up, 6.0), orifice, buffers)};
  scenes::Draws draws(21);
  int contacts = 0, paths = 0;
  for (int silo = 0; silo < 2; ++silo)
    for (int k = 0; k < 20000; ++k) {
      const Vector3 at = draws.in_box({-8.0, -5.0, -0.5}, {8.0, 5.0, 3.0});
      ASSERT_EQ(shapes[silo].contains(at), walls[silo]->contains(at)) << at.transpose();
      if (walls[silo]->contains(at)) {
        WallContacts of_walls, of_shape;
        walls[silo]->contacts(at, 0.7, of_walls);
        shapes[silo].contacts(at, 0.7, of_shape);
        ASSERT_EQ(of_walls.end() - of_walls.begin(), of_shape.end() - of_shape.begin()) << at.transpose();
        for (const WallContact& contact : of_walls)
          EXPECT_TRUE(std::any_of(of_shape.begin(), of_shape.end(), [&](const WallContact& other) {
            return std::abs(contact.distance - other.distance) < 1e-9 && (contact.normal - other.normal).norm() < 1e-8;
          })) << at.transpose();
        contacts += static_cast<int>(of_walls.end() - of_walls.begin());
      } else if (at.z() >= 0.0) {
        continue;
      }
      const Vector3 to = at + draws.in_box({-3.0, -3.0, -3.0}, {3.0, 3.0, 3.0});
      const auto a = walls[silo]->first_wall(at, to), b = shapes[silo].first_wall(at, to);
      ASSERT_EQ(a.has_value(), b.has_value()) << at.transpose() << " to " << to.transpose();
      if (!a) continue;
      ++paths;
      EXPECT_NEAR(a->share, b->share, 1e-9);
      EXPECT_LT((a->normal - b->normal).norm(), 1e-8);
    }
  EXPECT_GT(contacts, 3000);
  EXPECT_GT(paths, 3000);
}

TEST(ShapedContainerAnalytic, HopperHasAConeAnEdgeAndACylinder) {
  const ShapedContainer silo(hopper(), orifice, buffers);
  const double slope = 3.5 / 4.0, cosine = 1.0 / std::sqrt(1.0 + slope * slope);
  WallContacts contacts;
  const auto only = [&](const Vector3& at) {
    silo.contacts(at, 0.7, contacts);
    EXPECT_EQ(contacts.end() - contacts.begin(), 1) << at.transpose();
    return *contacts.begin();
  };
  const WallContact cone = only({5.0, 0.0, 2.0});  // radius 5.75 at this height
  EXPECT_NEAR(cone.distance, 0.75 * cosine, 1e-12);
  EXPECT_LT((cone.normal - Vector3(-cosine, 0.0, slope * cosine)).norm(), 1e-12);
  const WallContact wall = only({0.0, -7.2, 8.0});
  EXPECT_NEAR(wall.distance, 0.3, 1e-12);
  EXPECT_LT((wall.normal - Vector3(0.0, 1.0, 0.0)).norm(), 1e-12);
  const WallContact rim = only({3.7, 0.0, 0.05});
  EXPECT_NEAR(rim.distance, std::hypot(0.3, 0.05), 1e-12) << "the cone would be nearest below the rim";
  silo.contacts({0.0, 0.0, 0.3}, 0.7, contacts);
  EXPECT_EQ(contacts.begin(), contacts.end()) << "over the orifice";
}

TEST(ShapedContainerAnalytic, SpotsStayInsideTheHopper) {
  const ShapedContainer silo(hopper(), orifice, SpotBuffers{1.0, 1.0});
  scenes::Draws draws(22);
  int held = 0, nearer = 0;
  for (int spot = 0; spot < 300; ++spot) {
    Vector3 at(0.0, 0.0, 0.0);
    for (int step = 0; step < 80; ++step) {
      Vector3 target = at + Vector3(0.0, 0.0, 0.3);
      target[draws.below(2) == 0 ? 0 : 1] += draws.below(2) == 0 ? 1.0 : -1.0;
      const Vector3 next = silo.keep_spot_inside(at, target);
      ASSERT_FALSE(silo.first_wall(at, next)) << at.transpose() << " to " << next.transpose();
      ASSERT_TRUE(silo.contains(next)) << next.transpose();
      held += next == at;
      WallContacts contacts;
      silo.contacts(next, 1.0 - 1e-9, contacts);
      nearer += contacts.begin() != contacts.end() && next.z() > 1.5;
      at = next;
    }
  }
  EXPECT_EQ(held, 0);
  EXPECT_EQ(nearer, 0) << "than the buffer";
}

std::vector<spot::Grain> grains_in(const ShapedContainer& silo, double height) {
  std::vector<spot::Grain> grains;
  for (const spot::Grain& grain : scenes::dense_grains({-7.0, -7.0, 0.5}, {7.0, 7.0, height}, 0.01, 23)) {
    WallContacts contacts;
    if (silo.contains(grain.position)) silo.contacts(grain.position, 0.5, contacts);
    if (silo.contains(grain.position) && contacts.begin() == contacts.end()) grains.push_back(grain);
  }
  return grains;
}

constexpr double window = 0.1, end = 4.0;

/// Every invariant after every window; some grains drain, and all that are left are off the walls.
void drain(spot::Drainage& drainage, const ShapedContainer& silo, const spot::DrainageLimits& limits) {
  invariants::Ledger ledger(drainage.grains(), 1.0, limits, silo);
  for (int k = 1; k * window <= end; ++k) {
    drainage.advance_to(k * window);
    ASSERT_EQ(ledger.check(drainage), "") << "window " << k;
    ASSERT_LT(ledger.overlaps().largest, limits.largest_overlap_in_flow);
  }
  EXPECT_GT(ledger.drained(), 50u);
  int in_wall = 0;
  for (const spot::Grain& grain : drainage.grains()) {
    if (grain.position.z() < 0.0) continue;
    WallContacts contacts;
    silo.contacts(grain.position, 0.4, contacts);
    in_wall += contacts.begin() != contacts.end();
  }
  EXPECT_LE(in_wall, 3) << "deeper than a tenth of a diameter";
}

TEST(ShapedContainerInvariance, AHopperDrainsWithBothDrivers) {
  const auto silo = std::make_shared<const ShapedContainer>(hopper(), orifice, SpotBuffers{1.0, 1.0});
  const std::vector<spot::Grain> grains = grains_in(*silo, 14.0);
  ASSERT_GT(grains.size(), 1500u);
  const spot::DrainageLimits limits{-1.0};
  const spot::SpotParameters spots = scenes::paper_spots();
  const spot::RelaxationParameters relaxation;
  spot::TimeOrderedDrainage in_order(spots, relaxation, limits, silo, spot::Packing(1.0, 60.0, grains));
  ASSERT_NO_FATAL_FAILURE(drain(in_order, *silo, limits));
  spot::WindowedDrainage one(spots, relaxation, limits, window, 1, silo, 1.0, 60.0, grains);
  ASSERT_NO_FATAL_FAILURE(drain(one, *silo, limits));
  spot::WindowedDrainage three(spots, relaxation, limits, window, 3, silo, 1.0, 60.0, grains);
  three.advance_to(end);
  ASSERT_NO_FATAL_FAILURE(scenes::expect_identical(three.grains(), one.grains()));
  // The same spots, in one order or another.
  const double a = static_cast<double>(in_order.counters().drained), b = static_cast<double>(one.counters().drained);
  EXPECT_NEAR(a, b, 0.1 * std::max(a, b));
}

TEST(ShapedContainerUnit, OrificesThatDoNotOpenAreNamed) {
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                ShapedContainer(hopper(), Orifice{{0.5, 0.0, 0.0}, 4.0}, buffers);
              }),
              AllOf(HasSubstr("orifice of radius 4 at (0.5, 0, 0)"), HasSubstr("does not open"),
                    HasSubstr("walls leave no inside")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                ShapedContainer(hopper(), Orifice{{0.0, 0.0, 0.0}, -1.0}, buffers);
              }),
              AllOf(HasSubstr("radius of the orifice is -1"), HasSubstr("positive")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                ShapedContainer(hopper(), orifice, SpotBuffers{-1.0, 0.0});
              }),
              AllOf(HasSubstr("buffer is -1"), HasSubstr("zero or positive")));
}

/// No spot would walk in them: each would go straight up.
TEST(ShapedContainerUnit, BuffersAsWideAsHalfAnOutletAreNamed) {
  for (const double side : {4.0, 4.5, 1e9})
    EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                  ShapedContainer(hopper(), orifice, SpotBuffers{side, 2.6});
                }),
                AllOf(HasSubstr(spot::message("buffer of spots from side walls is ", side, " ")),
                      HasSubstr("must be below 4,"), HasSubstr("orifice of radius 4")));
  EXPECT_NO_THROW(ShapedContainer(hopper(), orifice, SpotBuffers{3.9, 2.6}));
  const spot::Outlet slot({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(8.0, 6.0));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                ShapedContainer(endless_box(8.0, 5.0), slot, SpotBuffers{3.5, 2.6});
              }),
              AllOf(HasSubstr("must be below 3,"), HasSubstr("slot of 8 by 6")));
}

}  // namespace
