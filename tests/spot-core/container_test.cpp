// SPDX-License-Identifier: GPL-2.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/cylinder_wall.hpp"
#include "spot/geometry/plane_wall.hpp"
#include "spot/geometry/round_hole.hpp"
#include "spot/geometry/silos.hpp"

namespace {

using spot::BasePlate;
using spot::box_silo;
using spot::cylinder_silo;
using spot::CylinderWall;
using spot::InvalidContainer;
using spot::Orifice;
using spot::PlaneWall;
using spot::SpotBuffers;
using spot::Vector3;
using spot::WallContact;
using spot::WallContacts;
using spot::WalledContainer;
using spot::WallOnPath;
using testing::AllOf;
using testing::HasSubstr;

const double infinity = std::numeric_limits<double>::infinity();
const Orifice orifice{{0.0, 0.0, 0.0}, 4.0};
const SpotBuffers buffers{1.0, 2.6};

void expect_contact(const WallContact& contact, double distance, const Vector3& normal) {
  EXPECT_NEAR(contact.distance, distance, 1e-14);
  EXPECT_NEAR((contact.normal - normal).norm(), 0.0, 1e-14)
      << "normal " << contact.normal.transpose() << ", expected " << normal.transpose();
}

TEST(ContainerAnalytic, PlaneGivesSignedDistanceAndUnitNormal) {
  const PlaneWall wall({0.0, 0.0, 1.0}, {0.0, 0.0, 5.0});
  expect_contact(wall.nearest({7.0, -3.0, 3.5}), 2.5, {0.0, 0.0, 1.0});
  expect_contact(wall.nearest({7.0, -3.0, 0.5}), -0.5, {0.0, 0.0, 1.0});
  const double s = std::sqrt(0.5);
  const PlaneWall funnel({1.0, 0.0, 0.0}, {1.0, 0.0, 1.0});
  expect_contact(funnel.nearest({2.0, 9.0, 1.0}), 2.0 * s, {s, 0.0, s});
}

TEST(ContainerAnalytic, CylinderPointsToItsAxis) {
  const CylinderWall wall(1.0, 2.0, 5.0);
  expect_contact(wall.nearest({4.0, 6.0, 9.0}), 0.0, {-0.6, -0.8, 0.0});
  expect_contact(wall.nearest({1.0, 4.0, -3.0}), 3.0, {0.0, -1.0, 0.0});
  expect_contact(wall.nearest({8.0, 2.0, 0.0}), -2.0, {-1.0, 0.0, 0.0});
}

TEST(ContainerAnalytic, CylinderHasAUnitNormalOnItsAxis) {
  const WallContact contact = CylinderWall(1.0, 2.0, 5.0).nearest({1.0, 2.0, 0.0});
  EXPECT_EQ(contact.distance, 5.0);
  EXPECT_EQ(contact.normal.norm(), 1.0);
}

TEST(ContainerAnalytic, BasePlateBesideTheHoleIsAPlaneWithTwoSides) {
  const BasePlate plate(orifice);
  expect_contact(plate.nearest({5.0, 0.0, 0.5}), 0.5, {0.0, 0.0, 1.0});
  expect_contact(plate.nearest({0.0, -6.0, -0.25}), 0.25, {0.0, 0.0, -1.0});
}

TEST(ContainerAnalytic, BasePlateOverTheHoleIsItsRim) {
  const BasePlate plate(orifice);
  expect_contact(plate.nearest({1.0, 0.0, 4.0}), 5.0, {-0.6, 0.0, 0.8});
  expect_contact(plate.nearest({0.0, 3.7, 0.4}), 0.5, {0.0, -0.6, 0.8});
  expect_contact(plate.nearest({0.0, -3.0, 0.0}), 1.0, {0.0, 1.0, 0.0});
  expect_contact(plate.nearest({3.0, 0.0, -1.0}), std::sqrt(2.0), {-std::sqrt(0.5), 0.0, -std::sqrt(0.5)});
}

TEST(ContainerAnalytic, BasePlateNormalTurnsSteadilyAcrossTheEdge) {
  const BasePlate plate(orifice);
  for (const double height : {0.01, 0.3, -0.3}) {
    const WallContact inside = plate.nearest({4.0 - 1e-9, 0.0, height});
    const WallContact outside = plate.nearest({4.0 + 1e-9, 0.0, height});
    EXPECT_NEAR(inside.distance, outside.distance, 1e-9);
    EXPECT_LT((inside.normal - outside.normal).norm(), 1e-6);
  }
}

/// The nearest point of every wall, found by looking at many of its points.
TEST(ContainerBruteForce, BasePlateDistanceIsThatOfItsNearestPoint) {
  const BasePlate plate(orifice);
  scenes::Draws draws(5);
  for (int k = 0; k < 200; ++k) {
    const Vector3 centre = draws.in_box({-6.0, -6.0, -1.0}, {6.0, 6.0, 3.0});
    const double angle = std::atan2(centre.y(), centre.x());
    double least = infinity;
    for (int a = -20; a <= 20; ++a)  // turns around the axis: the nearest point lies in the plane of axis and centre
      for (double r = orifice.radius; r < 10.0; r += 1e-3) {
        const double around = angle + 1e-2 * a;
        least = std::min(least, (centre - Vector3(r * std::cos(around), r * std::sin(around), 0.0)).norm());
      }
    EXPECT_NEAR(plate.nearest(centre).distance, least, 2e-3);
    EXPECT_NEAR(plate.nearest(centre).normal.norm(), 1.0, 1e-12);
  }
}

/// Distance grows at rate one along the normal: both come from the same nearest point.
TEST(ContainerAnalytic, DistanceGrowsAlongTheNormal) {
  const PlaneWall plane({0.3, 0.2, 0.1}, {1.0, 2.0, 3.0});
  const CylinderWall cylinder(0.5, -0.5, 9.0);
  const BasePlate plate(orifice);
  scenes::Draws draws(6);
  for (int k = 0; k < 1000; ++k) {
    const Vector3 centre = draws.in_box({-6.0, -6.0, 0.1}, {6.0, 6.0, 5.0});
    for (const spot::Wall* wall : {static_cast<const spot::Wall*>(&plane), static_cast<const spot::Wall*>(&cylinder),
                                   static_cast<const spot::Wall*>(&plate)}) {
      const WallContact here = wall->nearest(centre);
      if (std::abs(here.distance) < 1e-3) continue;
      { EXPECT_NEAR(wall->nearest(centre + 1e-6 * here.normal).distance - here.distance, 1e-6, 1e-9); }
    }
  }
}

TEST(ContainerAnalytic, PlaneReflectsSpotsAtTheirBuffer) {
  const PlaneWall wall({0.0, -4.0, 0.0}, {0.0, 1.0, 0.0});
  EXPECT_EQ(wall.reflect_spot(1.0, {5.0, -3.0, 2.0}), Vector3(5.0, -3.0, 2.0)) << "on the surface";
  EXPECT_EQ(wall.reflect_spot(1.0, {5.0, -3.25, 2.0}), Vector3(5.0, -2.75, 2.0));
  EXPECT_EQ(wall.reflect_spot(1.0, {5.0, 2.0, 2.0}), Vector3(5.0, 2.0, 2.0)) << "far away";
}

TEST(ContainerAnalytic, RoundHolesKeepInsideByReflection) {
  const spot::RoundHole hole(4.0);
  EXPECT_EQ(hole.keep_inside(2.5, {1.0, 0.0, 6.0}), Vector3(1.0, 0.0, 6.0));
  EXPECT_LT((hole.keep_inside(2.5, {2.0, 0.0, 6.0}) - Vector3(1.0, 0.0, 6.0)).norm(), 1e-14);
  EXPECT_LT((hole.keep_inside(2.5, {8.0, 0.0, 6.0}) - Vector3(0.0, 0.0, 6.0)).norm(), 1e-14) << "never past the axis";
}

TEST(ContainerAnalytic, BasePlateKeepsRisingSpotsAwayFromTheRimAtConstantHeight) {
  const BasePlate plate(orifice);
  scenes::Draws draws(7);
  for (int k = 0; k < 10000; ++k) {
    const Vector3 target = draws.in_box({-3.0, -3.0, -2.6}, {3.0, 3.0, 4.0});
    const Vector3 kept = plate.reflect_spot(2.6, target);
    EXPECT_EQ(kept.z(), target.z());
    if (kept.z() <= 0.0) {
      EXPECT_LE(kept.head<2>().norm(), 1.4 + 1e-12);
    } else {
      EXPECT_GE(plate.nearest(kept).distance, 2.6 - 1e-12);
    }
    if (target.head<2>().norm() <= 1.4 || (target.z() > 0.0 && plate.nearest(target).distance >= 2.6)) {
      EXPECT_LT((kept - target).norm(), 1e-12) << "far enough already";
    }
  }
  EXPECT_EQ(plate.reflect_spot(2.6, {3.9, 0.0, 2.6}), Vector3(3.9, 0.0, 2.6)) << "at its buffer above the base";
}

TEST(ContainerAnalytic, SpotsStayAtTheirBufferInsideTheBox) {
  const auto silo = box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers);
  scenes::Draws draws(8);
  for (int k = 0; k < 10000; ++k) {
    const Vector3 kept = silo->keep_spot_inside({0.0, 0.0, 10.0}, draws.in_box({-8.5, -4.5, 3.0}, {8.5, 4.5, 20.0}));
    EXPECT_LE(std::abs(kept.x()), 7.0 + 1e-12);
    EXPECT_LE(std::abs(kept.y()), 3.0 + 1e-12);
  }
}

TEST(ContainerAnalytic, SpotsStayAtTheirBufferInsideTheCylinder) {
  const auto silo = cylinder_silo(1.0, -1.0, 8.0, Orifice{{1.0, -1.0, 0.0}, 4.0}, buffers);
  scenes::Draws draws(9);
  for (int k = 0; k < 10000; ++k) {
    const Vector3 kept = silo->keep_spot_inside({1.0, -1.0, 10.0}, draws.in_box({-7.0, -9.0, 3.0}, {9.0, 7.0, 20.0}));
    EXPECT_LE(std::hypot(kept.x() - 1.0, kept.y() + 1.0), 7.0 + 1e-12);
  }
}

/// A step of 0.68 across a gap of 0.2 is folded back several times.
TEST(ContainerAnalytic, SpotsStayInsideANarrowGap) {
  const auto silo = box_silo(-8.0, 8.0, -4.0, 4.0, orifice, SpotBuffers{3.9, 2.6});
  for (double y = -0.78; y <= 0.78; y += 0.01) {
    const Vector3 kept = silo->keep_spot_inside({0.0, 0.0, 9.9}, {0.0, y, 10.0});
    EXPECT_LE(std::abs(kept.y()), 0.1 + 1e-12) << y;
  }
}

/// The first of many places along a path that is behind a wall: at a height from that of the orifice upwards, or where
/// it passes that height beside the orifice.
double share_before_wall(const Vector3& from, const Vector3& to, const Orifice& hole, bool (*inside)(const Vector3&)) {
  constexpr int places = 20000;
  bool was_above = from.z() >= hole.centre.z();
  for (int k = 1; k <= places; ++k) {
    const Vector3 at = from + (static_cast<double>(k) / places) * (to - from);
    const bool above = at.z() >= hole.centre.z();
    if (above != was_above && (at - hole.centre).head<2>().norm() > hole.radius) return (k - 0.5) / places;
    if (above && !inside(at)) return (k - 0.5) / places;
    was_above = above;
  }
  return infinity;
}

TEST(ContainerBruteForce, FirstWallIsWhereAPathPassesOne) {
  struct Case {
    std::unique_ptr<WalledContainer> silo;
    bool (*inside)(const Vector3&);
  };
  std::vector<Case> cases;
  cases.push_back({box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers),
                   [](const Vector3& p) { return std::abs(p.x()) <= 8.0 && std::abs(p.y()) <= 4.0; }});
  cases.push_back({cylinder_silo(1.0, 0.5, 7.0, orifice, buffers),
                   [](const Vector3& p) { return std::hypot(p.x() - 1.0, p.y() - 0.5) <= 7.0; }});
  scenes::Draws draws(11);
  for (const Case& c : cases) {
    int walls = 0, free = 0;
    for (int k = 0; k < 1500; ++k) {
      const Vector3 from = draws.in_box({-8.0, -4.0, -3.0}, {8.0, 4.0, 9.0});
      const Vector3 to = draws.in_box({-12.0, -8.0, -3.0}, {12.0, 8.0, 9.0});
      if (from.z() >= 0.0 && !c.inside(from)) continue;
      const double share = share_before_wall(from, to, orifice, c.inside);
      const auto wall = c.silo->first_wall(from, to);
      ASSERT_EQ(wall.has_value(), share < 1.0) << from.transpose() << " to " << to.transpose();
      (wall ? walls : free) += 1;
      if (!wall) continue;
      EXPECT_NEAR(wall->share, share, 1e-4) << from.transpose() << " to " << to.transpose();
      EXPECT_NEAR(wall->normal.norm(), 1.0, 1e-12);
      EXPECT_LT(wall->normal.dot(to - from), 0.0);
    }
    EXPECT_GT(walls, 200);
    EXPECT_GT(free, 200);
  }
}

/// A thin plate across the silo, from which spots are not reflected.
class Shelf : public BasePlate {
 public:
  using BasePlate::BasePlate;
  Vector3 reflect_spot(double, const Vector3& target) const override { return target; }
};

/// No step leads through the shelf or the base, and a spot under the shelf stays there.
TEST(ContainerAnalytic, SpotsNeverPassAWall) {
  WalledContainer silo(orifice);
  silo.add(std::make_unique<BasePlate>(orifice), 0.0);
  silo.add(std::make_unique<Shelf>(Orifice{{0.0, 0.0, 8.0}, 1.0}), 0.0);
  silo.add(std::make_unique<CylinderWall>(0.0, 0.0, 6.0), 0.25);
  scenes::Draws draws(12);
  int passed = 0, held = 0;
  for (int spot = 0; spot < 500; ++spot) {
    Vector3 at = draws.in_box({-1.0, -1.0, -3.0}, {1.0, 1.0, -2.0});
    for (int step = 0; step < 60; ++step) {
      Vector3 target = at + Vector3(0.0, 0.0, 0.7);
      target[draws.below(2) == 0 ? 0 : 1] += draws.below(2) == 0 ? 1.7 : -1.7;
      const Vector3 next = silo.keep_spot_inside(at, target);
      for (const Orifice& hole : {orifice, Orifice{{0.0, 0.0, 8.0}, 1.0}}) {
        if ((at.z() < hole.centre.z()) == (next.z() < hole.centre.z())) continue;
        const double share = (hole.centre.z() - at.z()) / (next.z() - at.z());
        EXPECT_LE((at + share * (next - at)).head<2>().norm(), hole.radius + 1e-9);
        passed += hole.centre.z() > 0.0;
      }
      held += next == at;
      at = next;
    }
  }
  EXPECT_GT(passed, 5) << "through the hole of the shelf";
  EXPECT_GT(held, 1000) << "under it";
}

TEST(ContainerUnit, ContainsIsTheInnerSideOfEveryWall) {
  const auto silo = box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers);
  EXPECT_TRUE(silo->contains({7.9, -3.9, 0.1}));
  EXPECT_TRUE(silo->contains({0.0, 0.0, 1000.0})) << "there is no lid";
  EXPECT_FALSE(silo->contains({8.1, 0.0, 1.0}));
  EXPECT_FALSE(silo->contains({0.0, -4.1, 1.0}));
  EXPECT_FALSE(silo->contains({6.0, 0.0, -0.1}));
  EXPECT_FALSE(silo->contains({0.0, 0.0, -0.1})) << "below the orifice";
  EXPECT_FALSE(silo->contains({std::nan(""), 0.0, 1.0}));
  const auto round = cylinder_silo(0.0, 0.0, 8.0, orifice, buffers);
  EXPECT_TRUE(round->contains({5.6, 5.6, 0.1}));
  EXPECT_FALSE(round->contains({5.7, 5.7, 0.1}));
}

TEST(ContainerUnit, ContactsAreTheWallsWithinReach) {
  const auto silo = box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers);
  WallContacts contacts;
  const auto count = [&](const Vector3& centre, double reach) {
    silo->contacts(centre, reach, contacts);
    return contacts.end() - contacts.begin();
  };
  EXPECT_EQ(count({0.0, 0.0, 10.0}, 0.5), 0);
  EXPECT_EQ(count({7.6, 0.0, 10.0}, 0.5), 1);
  EXPECT_NEAR(contacts.begin()->distance, 0.4, 1e-14);
  EXPECT_EQ(count({7.6, 3.7, 0.3}, 0.5), 3) << "a corner";
  EXPECT_EQ(count({0.0, 0.0, 10.0}, 100.0), 5) << "earlier contacts are cleared";
}

/// Planes across axes have a short cut; what it leaves out is what other_contacts() gives.
TEST(ContainerUnit, AxisPlanesAndOtherContactsAreAllContacts) {
  WalledContainer odd(orifice);
  odd.add(std::make_unique<PlaneWall>(Vector3(3.0, 9.0, 0.0), Vector3(-2.0, 0.0, 0.0)), 0.0);
  odd.add(std::make_unique<PlaneWall>(Vector3(0.0, -3.5, 1.0), Vector3(0.0, 1.0, 0.0)), 0.0);
  odd.add(std::make_unique<PlaneWall>(Vector3(0.0, 0.0, 6.0), Vector3(0.0, 0.0, -0.5)), 0.0);
  odd.add(std::make_unique<PlaneWall>(Vector3(0.0, 0.0, -1.0), Vector3(0.0, 0.1, 1.0)), 0.0);
  odd.add(std::make_unique<CylinderWall>(0.0, 0.0, 5.0), 0.0);
  const auto box = box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers);
  const auto round = cylinder_silo(0.0, 0.0, 8.0, orifice, buffers);
  EXPECT_EQ(odd.axis_planes().size(), 3u);
  EXPECT_EQ(box->axis_planes().size(), 4u);
  EXPECT_TRUE(round->axis_planes().empty());
  scenes::Draws draws(10);
  int planes = 0, others = 0;
  for (const spot::Container* container :
       {static_cast<const spot::Container*>(&odd), static_cast<const spot::Container*>(box.get()),
        static_cast<const spot::Container*>(round.get())})
    for (int k = 0; k < 3000; ++k) {
      const Vector3 centre = draws.in_box({-9.0, -5.0, -1.0}, {9.0, 5.0, 7.0});
      WallContacts all, parts;
      container->contacts(centre, 0.7, all);
      container->other_contacts(centre, 0.7, parts);
      others += static_cast<int>(parts.end() - parts.begin());
      for (const spot::AxisPlane& plane : container->axis_planes()) {
        const double distance = (centre[plane.axis] - plane.at) * (plane.grains_below ? -1.0 : 1.0);
        if (distance >= 0.7) continue;
        Vector3 normal = Vector3::Zero();
        normal[plane.axis] = plane.grains_below ? -1.0 : 1.0;
        parts.add({distance, normal});
        ++planes;
      }
      ASSERT_EQ(parts.end() - parts.begin(), all.end() - all.begin()) << centre.transpose();
      for (const WallContact& contact : all)
        EXPECT_TRUE(std::any_of(parts.begin(), parts.end(), [&](const WallContact& part) {
          return std::abs(part.distance - contact.distance) < 1e-12 && (part.normal - contact.normal).norm() < 1e-12;
        })) << centre.transpose();
    }
  EXPECT_GT(planes, 500);
  EXPECT_GT(others, 500);
}

/// A container of another kind has no planes unless it says so: all its walls are others.
TEST(ContainerUnit, ContainersHaveNoAxisPlanesUnlessTheySaySo) {
  class Bowl : public spot::Container {
   public:
    bool contains(const Vector3&) const override { return true; }
    void contacts(const Vector3& centre, double, WallContacts& contacts) const override {
      contacts.clear();
      contacts.add({centre.z(), {0.0, 0.0, 1.0}});
    }
    const spot::Outlets& outlets() const override { return outlets_; }
    std::optional<WallOnPath> first_wall(const Vector3&, const Vector3&) const override { return std::nullopt; }

   private:
    spot::Outlets outlets_ = ::orifice;
    std::optional<Vector3> reflect_spot(const Vector3&, const Vector3& target) const override { return target; }
  } bowl;
  EXPECT_TRUE(bowl.axis_planes().empty());
  EXPECT_TRUE(bowl.concurrent());
  WallContacts contacts;
  bowl.other_contacts({0.0, 0.0, 0.25}, 0.5, contacts);
  ASSERT_EQ(contacts.end() - contacts.begin(), 1);
  EXPECT_EQ(contacts.begin()->distance, 0.25);
}

TEST(ContainerUnit, TooManyWallsAtOneGrainAreAnError) {
  WalledContainer container(orifice);
  for (int i = 0; i <= WallContacts::capacity; ++i)
    container.add(std::make_unique<PlaneWall>(Vector3(0.0, 0.0, 0.0), Vector3(1.0, 0.1 * i, 0.0)), 0.0);
  WallContacts contacts;
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                container.contacts({0.0, 0.0, 0.0}, 0.5, contacts);
              }),
              HasSubstr("8 walls"));
}

TEST(ContainerUnit, WallsInTheWrongOrderAreNamed) {
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] { box_silo(8.0, -8.0, -4.0, 4.0, orifice, buffers); }),
              AllOf(HasSubstr("along x"), HasSubstr("8 and -8"), HasSubstr("increasing")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] { box_silo(-8.0, 8.0, 4.0, 4.0, orifice, buffers); }),
              AllOf(HasSubstr("along y"), HasSubstr("increasing")));
  EXPECT_THROW(box_silo(-8.0, infinity, -4.0, 4.0, orifice, buffers), InvalidContainer);
  EXPECT_THROW(box_silo(std::nan(""), 8.0, -4.0, 4.0, orifice, buffers), InvalidContainer);
}

TEST(ContainerUnit, OrificeWiderThanTheBaseIsNamed) {
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] { box_silo(-8.0, 8.0, -3.9, 4.0, orifice, buffers); }),
              AllOf(HasSubstr("orifice of radius 4"), HasSubstr("wider than the base"), HasSubstr("-3.9")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                cylinder_silo(0.0, 0.0, 5.0, Orifice{{2.0, 0.0, 0.0}, 4.0}, buffers);
              }),
              AllOf(HasSubstr("reaches 6"), HasSubstr("radius 5")));
  EXPECT_NO_THROW(box_silo(-8.0, 8.0, -4.0, 4.0, orifice, buffers)) << "exactly as wide is allowed";
  EXPECT_NO_THROW(cylinder_silo(0.0, 0.0, 4.0, orifice, buffers));
}

TEST(ContainerUnit, BadShapesAreNamed) {
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THAT(scenes::text_of<InvalidContainer>([&] { CylinderWall(0.0, 0.0, bad); }),
                AllOf(HasSubstr("cylinder radius"), HasSubstr("positive and finite")));
    EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                  WalledContainer(Orifice{{0.0, 0.0, 0.0}, bad});
                }),
                AllOf(HasSubstr("radius of the orifice"), HasSubstr("positive and finite")));
  }
  EXPECT_THROW(PlaneWall({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}), InvalidContainer);
  EXPECT_THROW(PlaneWall({0.0, 0.0, std::nan("")}, {0.0, 0.0, 1.0}), InvalidContainer);
  EXPECT_THROW(PlaneWall({0.0, 0.0, 0.0}, {0.0, 0.0, infinity}), InvalidContainer);
}

TEST(ContainerUnit, BuffersThatLeaveNoRoomAreNamed) {
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                box_silo(-8.0, 8.0, -4.0, 4.0, orifice, SpotBuffers{4.5, 2.6});
              }),
              AllOf(HasSubstr("along y"), HasSubstr("4.5"), HasSubstr("at least 9")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                cylinder_silo(0.0, 0.0, 5.0, orifice, SpotBuffers{5.5, 2.6});
              }),
              AllOf(HasSubstr("radius is 5"), HasSubstr("5.5")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] {
                box_silo(-8.0, 8.0, -4.0, 4.0, orifice, SpotBuffers{-1.0, 2.6});
              }),
              AllOf(HasSubstr("buffer is -1"), HasSubstr("zero or positive")));
}

TEST(ContainerUnit, OrificeNarrowerThanTheSpotsIsNamed) {
  const auto silo = box_silo(-8.0, 8.0, -4.0, 4.0, Orifice{{0.0, 0.0, 0.0}, 2.5}, buffers);
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] { silo->require_entrance(2.6); }),
              AllOf(HasSubstr("orifice radius is 2.5"), HasSubstr("2.6")));
  EXPECT_NO_THROW(silo->require_entrance(2.5));
}

TEST(ContainerUnit, GrainsLeaveThroughTheHoleAlone) {
  const auto silo = spot::box_silo(-6.0, 6.0, -4.0, 4.0, spot::Orifice{{1.0, 0.0, 2.0}, 3.0}, spot::SpotBuffers{1, 1});
  EXPECT_TRUE(silo->may_have_left_to({1.0, 0.0, 1.99}));
  EXPECT_TRUE(silo->may_have_left_to({3.99, 0.0, 1.99}));
  EXPECT_FALSE(silo->may_have_left_to({1.0, -3.02, 1.99}));
  // Below it they spread.
  EXPECT_TRUE(silo->may_have_left_to({1.0, -3.02, 1.5}));
  EXPECT_FALSE(silo->may_have_left_to({1.0, -3.6, 1.5}));
}

}  // namespace
