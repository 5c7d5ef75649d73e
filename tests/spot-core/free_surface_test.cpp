// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/free_surface.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "general_scene.hpp"
#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/base/errors.hpp"
#include "spot/walk/spot_walk.hpp"

namespace {

using spot::FreeSurface;
using spot::SpotParameters;
using spot::Vector3;

SpotParameters steered_spots(double exponent = 3.0) {
  SpotParameters spots = scenes::paper_spots();
  spots.profile = spot::InfluenceProfile::parabolic;
  spots.surface_exponent = exponent;
  return spots;
}

std::vector<Vector3> grains_under(double slope, std::uint64_t seed, std::size_t number = 4000) {
  scenes::Draws draws(seed);
  std::vector<Vector3> grains;
  for (std::size_t k = 0; k < number; ++k) {
    Vector3 grain = draws.in_box({-8.0, -4.0, 0.0}, {8.0, 4.0, 10.0});
    grain.z() *= 1.0 + 0.1 * slope * grain.x();
    grains.push_back(grain);
  }
  return grains;
}

/// The highest centre of a column, 2 wide and with one around the axis, or the outlets' height.
double highest(const std::vector<Vector3>& grains, int x, int y) {
  double height = 0.0;
  for (const Vector3& grain : grains)
    if (std::floor(0.5 * grain.x() + 0.5) == x && std::floor(0.5 * grain.y() + 0.5) == y)
      height = std::max(height, grain.z());
  return height;
}

FreeSurface surface_of(const std::vector<Vector3>& grains, const SpotParameters& spots,
                       const spot::Container& container) {
  FreeSurface surface(spots, container, 1.0);
  for (const Vector3& grain : grains) surface.add(grain);
  spot::Alone alone;
  surface.gather(alone);
  return surface;
}

TEST(FreeSurfaceBruteForce, IsTheHighestGrainOfEachColumn) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const auto grains = grains_under(0.5, 1);
  const FreeSurface surface = surface_of(grains, steered_spots(), *silo);
  for (int x = -3; x <= 3; ++x)
    for (int y = -1; y <= 1; ++y)
      EXPECT_EQ(surface.height({2.0 * x, 2.0 * y, 0.0}), highest(grains, x, y)) << x << ' ' << y;
  // Between the columns' axes.
  const double a = highest(grains, 1, 0), b = highest(grains, 2, 0), c = highest(grains, 1, 1),
               d = highest(grains, 2, 1);
  EXPECT_NEAR(surface.height({2.5, 1.0, 0.0}), 0.5 * (0.75 * a + 0.25 * b) + 0.5 * (0.75 * c + 0.25 * d), 1e-12);
  // Beyond the last column it goes on as it is.
  EXPECT_EQ(surface.height({30.0, 0.0, 0.0}), highest(grains, 4, 0));
}

TEST(FreeSurfaceUnit, WithoutGrainsItIsAtTheOutlets) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  EXPECT_EQ(surface_of({}, steered_spots(), *silo).height({1.0, 1.0, 5.0}), 0.0);
  EXPECT_EQ(surface_of({{0.0, 0.0, -3.0}, {6.0, 0.0, 7.0}}, steered_spots(), *silo).height({0.0, 0.0, 5.0}), 0.0)
      << "grains that fall out of the orifice are no surface";
}

TEST(FreeSurfaceAnalytic, StepsWeighAsPowersOfTheirShareBelow) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  std::vector<Vector3> grains;
  for (int x = -4; x <= 4; ++x)
    for (int y = -2; y <= 2; ++y) grains.emplace_back(2.0 * x, 2.0 * y, x < 0 ? 10.0 : 11.0);
  for (const double exponent : {1.0, 3.0}) {
    const SpotParameters spots = steered_spots(exponent);
    const FreeSurface surface = surface_of(grains, spots, *silo);
    EXPECT_NEAR(surface.weight({-6.0, 0.0, 10.0}), std::pow(spots.profile->part_above(0.0), exponent), 1e-12);
    EXPECT_NEAR(surface.weight({6.0, 0.0, 10.0}), std::pow(spots.profile->part_above(1.0 / spots.radius), exponent),
                1e-12);
    EXPECT_NEAR(surface.weight({6.0, 0.0, 2.0}), 1.0, 1e-12) << "deep below";
    EXPECT_EQ(surface.weight({6.0, 0.0, 50.0}), 0.0) << "high above";
  }
}

TEST(FreeSurfaceUnit, FarBelowItAllStepsAreAsWithoutIt) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const SpotParameters spots = steered_spots(), free = steered_spots(0.0);
  const FreeSurface surface = surface_of(grains_under(0.5, 1), spots, *silo);
  const FreeSurface none = surface_of({}, free, *silo);
  const spot::FlowField flow(spots, *silo, 1.0);
  const spot::SpotWalk steered(spots, *silo), unsteered(free, *silo);
  EXPECT_FALSE(surface.is_near({0.0, 0.0, -3.0}));
  int different = 0;
  for (std::int64_t id = 0; id < 200; ++id) {
    spot::Spot one = steered.birth(id, 0.0, *silo), other = unsteered.birth(id, 0.0, *silo);
    for (int step = 0; step < 200; ++step) {
      const bool near = surface.is_near(one.position);
      steered.step(one, *silo, surface, flow);
      unsteered.step(other, *silo, none, flow);
      if (!near && different == 0) {
        EXPECT_EQ(one.position, other.position);
      }
      if (one.position != other.position) {
        ++different;
        break;
      }
    }
  }
  EXPECT_GT(different, 100);
}

/// Spots that start in the middle of a slope go to the higher side: with beta = 3 and a slope of 1, 2010's rule gives
/// probabilities far from even.
TEST(FreeSurfaceStatistical, SpotsGoWhereItIsHigher) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const SpotParameters spots = steered_spots();
  const FreeSurface surface = surface_of(grains_under(0.5, 2, 20000), spots, *silo);
  const spot::SpotWalk walk(spots, *silo);
  const spot::FlowField flow(spots, *silo, 1.0);
  int up = 0, down = 0;
  for (std::int64_t id = 0; id < 4000; ++id) {
    spot::Spot spot = walk.birth(id, 0.0, *silo);
    spot.position = {0.0, 0.0, 10.0};
    const spot::Move move = walk.step(spot, *silo, surface, flow);
    up += move.step.x() > 0.0;
    down += move.step.x() < 0.0;
  }
  EXPECT_GT(up - down, 4.0 * std::sqrt(up + down)) << "4 standard errors";
}

TEST(FreeSurfaceInvariance, RanksSeeTheSame) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const auto grains = grains_under(0.5, 3);
  const FreeSurface whole = surface_of(grains, steered_spots(), *silo);
  scenes::on_ranks(3, [&](const std::shared_ptr<spot::Communicator>& communicator) {
    FreeSurface part(steered_spots(), *silo, 1.0);
    for (std::size_t k = 0; k < grains.size(); ++k)
      if (static_cast<int>(k) % 2 == communicator->rank()) part.add(grains[k]);  // the third has none
    part.gather(*communicator);
    for (double x = -8.0; x <= 8.0; x += 0.37) EXPECT_EQ(part.height({x, 1.3, 0.0}), whole.height({x, 1.3, 0.0}));
  });
}

TEST(FreeSurfaceUnit, ItRepeatsWithSpace) {
  const auto silo =
      scenes::repeated_silo({-8.0, -8.0, 0.0}, {8.0, 8.0, 20.0}, true, true, {{0.0, 0.0, 0.0}, 4.0}, {0.25, 2.0});
  scenes::Draws draws(4);
  std::vector<Vector3> grains;
  for (int k = 0; k < 3000; ++k) grains.push_back(draws.in_box({-8.0, -8.0, 0.0}, {8.0, 8.0, 10.0}));
  const FreeSurface surface = surface_of(grains, steered_spots(), *silo);
  for (const Vector3& grain : grains)
    for (const Vector3& period : {Vector3(16.0, 0.0, 0.0), Vector3(0.0, -16.0, 0.0), Vector3(16.0, 16.0, 0.0)})
      EXPECT_NEAR(surface.height(grain), surface.height(Vector3(grain + period)), 1e-9);
}

TEST(FreeSurfaceInvariance, ASavedOneComesBack) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const FreeSurface surface = surface_of(grains_under(0.5, 5), steered_spots(), *silo);
  spot::Bytes bytes;
  surface.save(bytes);
  FreeSurface other(steered_spots(), *silo, 1.0);
  spot::ByteReader reader(bytes);
  other.restore(reader);
  for (double x = -8.0; x <= 8.0; x += 0.37) EXPECT_EQ(other.height({x, 1.3, 0.0}), surface.height({x, 1.3, 0.0}));
  spot::Bytes damaged = bytes;
  damaged[0] = 99;  // the first column
  spot::ByteReader damaged_reader(damaged);
  EXPECT_THROW(other.restore(damaged_reader), spot::InvalidState);
}

}  // namespace
