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
#include "scenes.hpp"

namespace {

using scenes::infinity;
using scenes::RandomSolid;
using spot::Boundary;
using spot::InvalidContainer;
using spot::Vector3;
using spot::WallContact;
using spot::WallContacts;

constexpr double reach = 0.6;

#ifdef __SANITIZE_ADDRESS__
constexpr int solids = 1000;
#else
constexpr int solids = 10000;
#endif

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
  int wrong = 0;
  for (std::uint64_t seed = first; seed <= last && wrong < 10; ++seed) {
    RandomSolid random(seed);
    const std::string fault = check(random, Boundary(random.solid(), 1.0));
    if (fault.empty()) continue;
    ++wrong;
    ADD_FAILURE() << "solid " << seed << ", " << random.description() << ": " << fault;
  }
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

}  // namespace
