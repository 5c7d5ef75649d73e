// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/boundary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "random_solid.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"

namespace {

using scenes::infinity;
using scenes::RandomSolid;
using spot::Boundary;
using spot::InvalidContainer;
using spot::Solid;
using spot::Vector3;
using spot::WallContact;
using spot::WallContacts;
using testing::AllOf;
using testing::HasSubstr;

constexpr double reach = 0.6;

const int solids = scenes::sanitized() ? 1000 : 10000;

/// Evenly spread over the sphere (Fibonacci).
std::vector<Vector3> directions(int n) {
  std::vector<Vector3> spread;
  for (int k = 0; k < n; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / n, angle = 2.399963229728653 * k, r = std::sqrt(1.0 - z * z);
    spread.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return spread;
}

/// The least distance at which a ray meets the boundary, from one direction on downhill.
double closest_hit(const RandomSolid& random, const Vector3& place, Vector3 direction, double wide) {
  double least = random.first_change({place, direction});
  static const std::vector<Vector3> around = directions(12);
  for (double step = wide; step > 1e-8; step *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (const Vector3& aside : around) {
        const Vector3 tried = (direction + step * aside).normalized();
        const double distance = random.first_change({place, tried});
        if (distance >= least - 1e-13) continue;
        least = distance;
        direction = tried;
        better = true;
      }
    }
  return least;
}

/// The least and the greatest distance of the boundary along a few rays around a direction, of those that meet it
/// before `limit`.
std::pair<double, double> hits_around(const RandomSolid& random, const Vector3& place, const Vector3& direction,
                                      double limit) {
  static const std::vector<Vector3> around = directions(40);
  std::pair<double, double> hits{infinity, -infinity};
  for (const double step : {0.0, 1e-5, 3e-4})
    for (const Vector3& aside : around) {
      const double distance = random.first_change({place, (direction + step * aside).normalized()});
      if (distance > limit) continue;
      hits.first = std::min(hits.first, distance);
      hits.second = std::max(hits.second, distance);
    }
  return hits;
}

/// Distance to the nearest point of the boundary by rays alone; an upper bound.
double distance_by_rays(const RandomSolid& random, const Vector3& place) {
  static const std::vector<Vector3> spread = directions(150);
  double least = infinity;
  Vector3 best = spread.front();
  for (const Vector3& direction : spread) {
    const double distance = random.first_change({place, direction});
    if (distance >= least) continue;
    least = distance;
    best = direction;
  }
  return least < 2.0 * reach ? closest_hit(random, place, best, 0.1) : least;
}

/// How many were checked.
struct Found {
  int near = 0;
  int walls = 0;
  int odd = 0;     ///< contacts beside a minimum, as where surfaces touch without crossing
  int unseen = 0;  ///< contacts with a tip so thin, or without any volume, that no ray meets it
};

/// What is wrong with the distances from one place, or nothing.
std::string check_distances(RandomSolid& random, const Boundary& boundary, Found& found) {
  const Vector3 place = random.draws().in_box({-2.0, -2.0, -2.0}, {2.0, 2.0, 2.0});
  const bool inside = random.contains(place);
  std::ostringstream from;
  from.precision(17);
  from << "from " << place.transpose() << (inside ? " inside: " : " outside: ");
  if (boundary.contains(place) != inside) return from.str() + "the boundary says otherwise";
  WallContacts contacts;
  boundary.add_contacts(place, reach, contacts);
  double least = infinity;
  for (const WallContact& contact : contacts) {
    const double distance = inside ? contact.distance : -contact.distance;
    if (!(distance >= 0.0 && distance < reach) || std::abs(contact.normal.norm() - 1.0) > 1e-12)
      return from.str() + spot::message("a contact at ", distance);
    least = std::min(least, distance);
    const Vector3 towards = inside ? Vector3(-contact.normal) : contact.normal;
    const auto [low, high] = hits_around(random, place, towards, distance + 0.02);
    if (high < 0.0) ++found.unseen;
    if (low < distance - 1e-9) ++found.odd;
  }
  const double by_rays = distance_by_rays(random, place);
  if (std::min(least, by_rays) < reach) ++found.near;
  // Rays that graze the point of a cone are not known better.
  if (by_rays < reach && least > by_rays + 1e-8)
    return from.str() + spot::message("contacts from ", least, " on, but rays find ", by_rays, ", ", by_rays - least);
  return {};
}

using Check = std::function<std::string(RandomSolid&, const Boundary&)>;

/// SPOT_SOLID=seed checks that one alone.
void check_solids(const Check& check) {
  const char* alone = std::getenv("SPOT_SOLID");
  const std::uint64_t first = alone ? std::strtoull(alone, nullptr, 10) : 1, last = alone ? first : solids;
  int wrong = 0, refused = 0;
  for (std::uint64_t seed = first; seed <= last && wrong < 10; ++seed) {
    RandomSolid random(seed);
    std::optional<Boundary> boundary;
    try {
      boundary.emplace(random.solid(), 1.0);
    } catch (const InvalidContainer&) {
      ++refused;  // almost parallel
      continue;
    }
    const std::string fault = check(random, *boundary);
    if (fault.empty()) continue;
    ++wrong;
    ADD_FAILURE() << "solid " << seed << ", " << random.description() << ": " << fault;
  }
  EXPECT_LE(refused, solids / 100);
}

/// What is wrong with the first wall on one path, or nothing.
std::string check_path(RandomSolid& random, const Boundary& boundary, Found& found) {
  const Vector3 from = random.draws().in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5});
  const Vector3 to = from + random.draws().in_box({-2.0, -2.0, -2.0}, {2.0, 2.0, 2.0});
  const auto wall = boundary.first_wall(from, to);
  std::ostringstream path;
  path.precision(17);
  path << "from " << from.transpose() << " to " << to.transpose() << ": ";
  if (!random.contains(from)) return wall && wall->share == 0.0 ? "" : path.str() + "begins outside without a wall";
  const auto at = [&](double share) { return Vector3(from + share * (to - from)); };
  constexpr int places = 800;
  double inside = 0.0, outside = 2.0;
  for (int k = 1; k <= places && outside > 1.0; ++k) {
    const double share = static_cast<double>(k) / places;
    (random.contains(at(share)) ? inside : outside) = share;
  }
  if (outside <= 1.0 && !wall) return path.str() + spot::message("leads outside at ", outside, " without a wall");
  if (!wall) return {};
  ++found.walls;
  for (double low = inside, high = outside; outside <= 1.0 && high - low > 1e-13;) {
    const double middle = 0.5 * (low + high);
    (random.contains(at(middle)) ? low : high) = middle;
    inside = low;
  }
  if (wall->share > inside + 1e-9) return path.str() + spot::message("a wall at ", wall->share, ", not at ", inside);
  // The walker may step over what is thin: then there is a place outside just behind the wall.
  if (random.contains(at(wall->share + 1e-9)) && random.contains(at(wall->share + 1e-7))) ++found.unseen;
  if (std::abs(wall->normal.norm() - 1.0) > 1e-12 || wall->normal.dot(to - from) > 0.0)
    return path.str() + spot::message("a wall at ", wall->share, " with a wrong normal");
  const double off = 1e-7 / std::max(1e-3, -wall->normal.dot((to - from).normalized()));
  if (!random.contains(at(wall->share) + off * wall->normal)) ++found.unseen;
  return {};
}

TEST(BoundaryBruteForce, DistancesAreThoseThatRaysFindAndFirstWallsWhereWalkersLeave) {
  Found found;
  check_solids([&](RandomSolid& random, const Boundary& boundary) {
    const std::string fault = check_distances(random, boundary, found);
    return fault.empty() ? check_path(random, boundary, found) : fault;
  });
  EXPECT_GT(found.near, solids / 5);
  EXPECT_GT(found.walls, solids / 12);
  EXPECT_LE(found.odd, solids / 1000);
  EXPECT_LE(found.unseen, solids / 1000);
}

const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ(), none = Vector3::Zero();

/// All contacts, nearest first.
std::vector<WallContact> contacts_of(const Solid& solid, const Vector3& place, double within = 0.9) {
  WallContacts contacts;
  Boundary(solid, 1.0).add_contacts(place, within, contacts);
  return {contacts.begin(), contacts.end()};
}

void expect_only(const Solid& solid, const Vector3& place, double distance, const Vector3& normal) {
  const auto contacts = contacts_of(solid, place);
  ASSERT_EQ(contacts.size(), 1u) << place.transpose();
  EXPECT_NEAR(contacts[0].distance, distance, 1e-12) << place.transpose();
  EXPECT_LT((contacts[0].normal - normal).norm(), 1e-12) << place.transpose() << ": " << contacts[0].normal.transpose();
}

TEST(BoundaryAnalytic, PlanesHaveTwoSides) {
  const Solid above = spot::half_space({5.0, 3.0, 1.0}, {0.0, 0.0, 2.0});
  expect_only(above, {7.0, 8.0, 1.25}, 0.25, z);
  expect_only(above, {7.0, 8.0, 0.75}, -0.25, z);
  expect_only(~above, {7.0, 8.0, 0.75}, 0.25, -z);
  expect_only(spot::half_space(none, Vector3(3.0, 4.0, 0.0)), {0.3, 0.4, 7.0}, 0.5, Vector3(0.6, 0.8, 0.0));
}

TEST(BoundaryAnalytic, SpheresHaveAnInsideAndAnOutside) {
  const Solid ball = spot::sphere({1.0, 0.0, 0.0}, 2.0);
  expect_only(ball, {2.5, 0.0, 0.0}, 0.5, -x);
  expect_only(ball, {3.5, 0.0, 0.0}, -0.5, -x);
  expect_only(~ball, {1.0, 0.0, -2.25}, 0.25, -z);
  EXPECT_TRUE(contacts_of(ball, {1.0, 0.0, 0.0}).empty());
  EXPECT_EQ(contacts_of(spot::sphere(none, 0.5), none).size(), 1u) << "all directions are as good";
}

TEST(BoundaryAnalytic, CylindersMayLieInAnyDirection) {
  const Vector3 axis = Vector3(1.0, 2.0, 2.0) / 3.0, out = Vector3(2.0, 1.0, -2.0) / 3.0;
  const Solid pipe = spot::cylinder({1.0, 1.0, 1.0}, 5.0 * axis, 2.0);
  const Vector3 on_axis = Vector3(1.0, 1.0, 1.0) + 7.0 * axis;
  expect_only(pipe, on_axis + 1.5 * out, 0.5, -out);
  expect_only(~pipe, on_axis + 2.5 * out, 0.5, out);
  const Solid can = spot::cylinder_between(on_axis, on_axis + 4.0 * axis, 2.0);
  expect_only(can, on_axis + 0.5 * axis, 0.5, axis);
  EXPECT_EQ(contacts_of(can, on_axis + 0.5 * axis + 1.7 * out).size(), 2u) << "not the edge, which is farther in";
  // From outside the rim is the nearest.
  expect_only(~can, on_axis - 0.3 * axis + 2.4 * out, 0.5, -0.6 * axis + 0.8 * out);
}

TEST(BoundaryAnalytic, ConesHaveASideAndAPoint) {
  const Solid funnel = spot::cone(none, z, 0.75);  // half angle with sine 0.6, cosine 0.8
  expect_only(funnel, {0.0, 1.5 - 0.5, 2.0}, 0.4, Vector3(0.0, -0.8, 0.6));
  expect_only(~funnel, {1.5 + 0.5, 0.0, 2.0}, 0.4, Vector3(0.8, 0.0, -0.6));
  expect_only(~funnel, {0.0, 0.0, -0.5}, 0.5, -z);
  expect_only(~funnel, Vector3(0.3, 0.0, -0.6), std::sqrt(0.45), Vector3(0.3, 0.0, -0.6).normalized());
  const Solid frustum = spot::cone_between({0.0, 0.0, 4.0}, 3.0, {0.0, 0.0, 2.0}, 1.5);
  expect_only(frustum, {0.0, 0.0, 2.5}, 0.5, z);
  expect_only(frustum, {0.0, 3.0 * 0.75 - 0.5, 3.0}, 0.4, Vector3(0.0, -0.8, 0.6));
  expect_only(~frustum, {0.0, 1.1, 1.6}, 0.4, -z);
  expect_only(~frustum, {1.5 + 0.03, 0.0, 1.5}, std::hypot(0.03, 0.5), Vector3(0.03, 0.0, -0.5).normalized());
}

/// Two half spaces: their intersection has a corner that is never nearest from inside, their union an edge that is.
TEST(BoundaryAnalytic, EdgesCountWhereTheyStandOut) {
  const Solid a = spot::half_space(none, x), b = spot::half_space(none, y);
  EXPECT_EQ(contacts_of(a & b, {0.3, 0.4, 9.0}).size(), 2u);
  expect_only(a & b, {-0.3, -0.4, 9.0}, -0.5, Vector3(0.6, 0.8, 0.0));
  expect_only(a | b, {0.3, 0.4, 9.0}, 0.5, Vector3(0.6, 0.8, 0.0));
  expect_only(a | b, {-0.3, 0.4, 9.0}, 0.4, y);
  const Solid room = ~spot::block(none, {1.0, 1.0, 1.0});
  expect_only(room, {-0.2, -0.3, -0.6}, 0.7, Vector3(-2.0, -3.0, -6.0) / 7.0);
  expect_only(room, {-0.3, -0.4, 0.6}, 0.5, Vector3(-0.6, -0.8, 0.0));
}

/// The other side of a thin plate is no wall, nor is anything behind it.
TEST(BoundaryAnalytic, WallsBehindWallsDoNotCount) {
  const Solid room =
      spot::block({-5.0, -5.0, 0.0}, {5.0, 5.0, 10.0}) & ~spot::block({-4.0, -4.0, 0.3}, {4.0, 4.0, 0.4});
  expect_only(room, {0.0, 0.0, 0.6}, 0.2, z);
  EXPECT_EQ(contacts_of(room, {0.0, 0.0, 0.1}).size(), 2u);
  const auto wall = Boundary(room, 1.0).first_wall({0.0, 0.0, 2.4}, {0.0, 0.0, -1.6});
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->share, 0.5, 1e-12);
  EXPECT_LT((wall->normal - z).norm(), 1e-12);
}

/// A silo on a hopper: no wall between them, whatever the numbers are rounded to.
TEST(BoundaryAnalytic, ShapesThatTouchHaveNoGap) {
  for (const double height : {0.1, 1.0 / 3.0, 2.7}) {
    const Vector3 seam = none + height * z;
    const Boundary silo(spot::cone_between(none, 0.2, seam, 1.3) | spot::cylinder_between(seam, seam + 3.0 * z, 1.3),
                        1.0);
    EXPECT_FALSE(silo.first_wall({0.3, 0.1, height + 2.0}, {0.1, -0.1, 0.5 * height}));
    EXPECT_FALSE(silo.first_wall({0.3, 0.1, height}, {0.9, -0.4, height})) << "along the seam";
    EXPECT_TRUE(silo.contains({1.29, 0.0, height}));
    WallContacts contacts;
    silo.add_contacts({0.0, 0.0, height}, 0.09, contacts);
    EXPECT_EQ(contacts.begin(), contacts.end()) << "at the seam";
  }
}

TEST(BoundaryUnit, BadShapesAreNamed) {
  const auto text = [](const std::function<void()>& act) { return scenes::text_of<InvalidContainer>(act); };
  EXPECT_THAT(text([] { spot::half_space(none, none); }), AllOf(HasSubstr("normal of a plane"), HasSubstr("not zero")));
  EXPECT_THAT(text([] { spot::half_space({infinity, 0.0, 0.0}, x); }), HasSubstr("must be finite"));
  EXPECT_THAT(text([] { spot::sphere(none, 0.0); }),
              AllOf(HasSubstr("radius of a sphere is 0"), HasSubstr("positive")));
  EXPECT_THAT(text([] { spot::cylinder(none, z, -2.0); }), HasSubstr("radius of a cylinder is -2"));
  EXPECT_THAT(text([] { spot::cylinder_between(x, x, 1.0); }), HasSubstr("axis of a cylinder"));
  EXPECT_THAT(text([] { spot::cone(none, z, std::nan("")); }), HasSubstr("slope of a cone"));
  EXPECT_THAT(text([] { spot::cone_between(none, 1.0, z, 1.0); }), AllOf(HasSubstr("1 and 1"), HasSubstr("different")));
  EXPECT_THAT(text([] { spot::cone_between(none, -1.0, z, 1.0); }), HasSubstr("-1 and 1"));
  EXPECT_THAT(text([] { spot::block(none, {1.0, 0.0, 1.0}); }), HasSubstr("must increase"));
}

/// What cannot be found exactly is refused.
TEST(BoundaryUnit, SurfacesThatAreAlmostTheSameOrAlmostParallelAreNamed) {
  const auto text = [](const Solid& solid) { return scenes::text_of<InvalidContainer>([&] { Boundary(solid, 1.0); }); };
  EXPECT_THAT(text(spot::half_space(none, z) | spot::half_space(1e-6 * z, -z)),
              AllOf(HasSubstr("1e-06 apart"), HasSubstr("at least 0.0001")));
  EXPECT_THAT(text(spot::cylinder(none, z, 1.0) & spot::half_space(0.5 * x, x + 1e-5 * z)),
              HasSubstr("axis of a cylinder"));
  EXPECT_THAT(text(spot::cone(none, z, 1.0) & spot::half_space(1e-5 * x, x)), HasSubstr("point of a cone"));
  Solid many = spot::sphere(none, 1.0);
  for (int k = 1; k <= 64; ++k) many = many | spot::sphere(3.0 * k * x, 1.0);
  EXPECT_THAT(text(many), HasSubstr("more than 64"));
}

}  // namespace
