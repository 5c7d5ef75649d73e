// SPDX-License-Identifier: GPL-2.0-or-later
// Walks of spots between walls of any shape: where spots are uniform they stay so, and nothing holds them for ever.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/silos.hpp"

namespace {

using spot::Container;
using spot::Orifice;
using spot::ShapedContainer;
using spot::SpotBuffers;
using spot::Vector3;

const Orifice orifice{{0.0, 0.0, 0.0}, 4.0};
const SpotBuffers buffers{0.25, 2.0};
constexpr double height = 200.0;

/// A step of the deck's parabolic spots, 1.2 d high and sqrt(4 b dz) = 2.66 d wide; down with the chance `down`.
Vector3 draw_step(scenes::Draws& draws, double down) {
  Vector3 step(0.0, 0.0, draws.uniform(0.0, 1.0) < down ? -1.2 : 1.2);
  step[draws.below(2) == 0 ? 0 : 1] = draws.below(2) == 0 ? 2.66 : -2.66;
  return step;
}

struct Walks {
  Vector3 low, high;  // corners of where walks begin
  double down;        // 0: they climb; 0.5: no drift
  int number, steps;
  std::function<bool(const Vector3&)> begins;  // there, of those between the corners
  std::function<int(const Vector3&)> bin;      // of the places where they end, all as large; -1: not counted
  std::size_t bins;
};

/// How many walks end in each bin, of walks that begin uniform.
std::vector<int> ends(const Container& container, const Walks& walks) {
  scenes::Draws draws(31);
  std::vector<int> counts(walks.bins);
  for (int k = 0; k < walks.number; ++k) {
    Vector3 place = draws.in_box(walks.low, walks.high);
    while (!walks.begins(place)) place = draws.in_box(walks.low, walks.high);
    for (int step = 0; step < walks.steps; ++step)
      place = container.keep_spot_inside(place, place + draw_step(draws, walks.down));
    if (const int bin = walks.bin(place); bin >= 0) ++counts[static_cast<std::size_t>(bin)];
  }
  return counts;
}

/// In rings of the same area. Steps are a third of the radius, so a curved wall that reflected spots would take a
/// seventh of them out of the outermost ring.
class SpotsInTubesStatistical : public testing::TestWithParam<double> {};  // chance of a step down

TEST_P(SpotsInTubesStatistical, StayUniform) {
  const double radius = 8.0, inside = radius - buffers.side;
  const auto share = [inside](const Vector3& place) { return place.head<2>().squaredNorm() / (inside * inside); };
  const Walks walks{{-inside, -inside, 60.0},
                    {inside, inside, 60.0},
                    GetParam(),
                    20000,
                    40,
                    [&](const Vector3& place) { return share(place) < 1.0; },
                    [&](const Vector3& place) { return std::min(7, static_cast<int>(8.0 * share(place))); },
                    8};
  const ShapedContainer shape(spot::cylinder_between({0, 0, 0}, {0, 0, height}, radius), orifice, buffers);
  EXPECT_LT(scenes::deviation_from_equal_counts(ends(shape, walks)), scenes::bound);
  const auto wall = spot::cylinder_silo(0.0, 0.0, radius, orifice, buffers);
  EXPECT_LT(scenes::deviation_from_equal_counts(ends(*wall, walks)), scenes::bound);
}

INSTANTIATE_TEST_SUITE_P(Down, SpotsInTubesStatistical, testing::Values(0.0, 0.5));

/// Without a drift, in layers along a flat wall that leans by 30 degrees: a mirror keeps any walk uniform whose steps
/// are as likely as their opposites. Walks begin farther from all other walls than they come.
TEST(SpotsAtLeaningWallsStatistical, WithoutADriftTheyStayUniform) {
  const double lean = scenes::pi / 6.0;
  const Vector3 foot(-20.0, 0.0, 60.0), normal(std::cos(lean), 0.0, -std::sin(lean));
  const auto distance = [&](const Vector3& place) { return normal.dot(place - foot); };
  const ShapedContainer silo(spot::block({-60, -10, 0}, {60, 10, height}) & spot::half_space(foot, normal), orifice,
                             buffers);
  const Walks walks{{-60.0, -9.75, 20.0},
                    {45.0, 9.75, 100.0},
                    0.5,
                    60000,
                    16,
                    [&](const Vector3& place) { return distance(place) > buffers.side; },
                    [&](const Vector3& place) {
                      if (std::abs(place.z() - foot.z()) > 18.0) return -1;
                      const double layer = (distance(place) - buffers.side) / 1.5;
                      return layer < 8.0 ? static_cast<int>(layer) : -1;
                    },
                    8};
  EXPECT_LT(scenes::deviation_from_equal_counts(ends(silo, walks)), scenes::bound);
}

/// Without a drift, in a hopper that widens upwards from 4 d, whose walls lean by an angle: its inside is scaled with
/// the height, and so are the places in it in which walks that end 24 to 34 d up are counted.
std::vector<int> ends_in_hopper(const spot::Solid& hopper, double slope, int number, std::size_t bins,
                                const std::function<int(double, double)>& bin) {
  const ShapedContainer container(hopper, orifice, buffers);
  const double gap = buffers.side * std::hypot(1.0, slope), wide = 4.0 + 60.0 * slope;
  const auto scaled = [=](const Vector3& place) -> Vector3 { return place / (4.0 + place.z() * slope - gap); };
  const auto bin_of = [&](const Vector3& place) { return bin(scaled(place).x(), scaled(place).y()); };
  return ends(container, {{-wide, -wide, 3.0},
                          {wide, wide, 57.0},
                          0.5,
                          number,
                          16,
                          [&](const Vector3& place) { return bin_of(place) >= 0; },
                          [&](const Vector3& place) { return place.z() > 24 && place.z() < 34 ? bin_of(place) : -1; },
                          bins});
}

double sum(const std::vector<int>& counts) { return std::accumulate(counts.begin(), counts.end(), 0.0); }

/// Mirrors in a cone are curved, but less than in a tube: the radius of curvature is that of the cone over the cosine.
TEST(SpotsInConesStatistical, WithoutADriftTheyStayUniform) {
  for (const double angle : {scenes::pi / 6.0, scenes::pi / 3.0}) {
    const double slope = std::tan(angle);
    const auto ring = [](double x, double y) { return x * x + y * y < 1 ? static_cast<int>(8 * (x * x + y * y)) : -1; };
    const auto cone = spot::cone_between({0, 0, 0}, 4.0, {0, 0, 60}, 4.0 + 60.0 * slope);
    const auto counts = ends_in_hopper(cone, slope, 150000, 8, ring);
    EXPECT_LT(scenes::deviation_from_equal_counts(counts), scenes::bound);
  }
}

/// Four flat walls that lean. Into the corners, where a mirror follows on another, some steps find no way: a tenth
/// fewer are there.
TEST(SpotsInPyramidsStatistical, WithoutADriftTheyStayUniform) {
  for (const double angle : {scenes::pi / 6.0, scenes::pi / 3.0}) {
    const double slope = std::tan(angle), c = std::cos(angle), s = std::sin(angle);
    const double wide = 4.0 + 60.0 * slope;
    spot::Solid pyramid = spot::block({-wide, -wide, 0}, {wide, wide, 60});
    for (const Vector3& side : {Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)})
      pyramid = pyramid & spot::half_space(4.0 * side, -c * side + s * Vector3(0, 0, 1));
    const auto cell = [](double x, double y) {
      return std::max(std::abs(x), std::abs(y)) < 1 ? 8 * static_cast<int>(4 * (x + 1)) + static_cast<int>(4 * (y + 1))
                                                    : -1;
    };
    const auto counts = ends_in_hopper(pyramid, slope, 150000, 64, cell);
    EXPECT_LT(scenes::deviation_from_equal_counts(counts), scenes::bound);
    EXPECT_GT(counts[0] + counts[7] + counts[56] + counts[63], 0.8 * 4.0 / 64.0 * sum(counts));
  }
}

/// Of spots that climb from over the orifice, how many end above `z`, in a silo less an obstacle.
int above(double z, const spot::Solid& obstacle, int number, int steps) {
  const ShapedContainer silo(spot::block({-12, -4, 0}, {12, 4, height}) & ~obstacle, orifice, buffers);
  const auto anywhere = [](const Vector3&) { return true; };
  const auto bin = [z](const Vector3& place) { return place.z() > z ? 0 : -1; };
  return ends(silo, {{-2.0, -2.0, 4.0}, {2.0, 2.0, 4.0}, 0.0, number, steps, anywhere, bin, 1})[0];
}

/// A beam across the silo, 6 d wide, right over the orifice: spots go sideways under it until they are past it.
TEST(SpotsUnderRoofsStatistical, FindTheirWayAround) {
  EXPECT_EQ(above(13.0, spot::block({-3, -5, 10}, {3, 5, 13}), 2000, 200), 2000);
}

/// Where there is no way around, spots stay, and none gets through.
TEST(SpotsUnderRoofsStatistical, DoNotGetThroughALid) {
  EXPECT_EQ(above(10.0, spot::block({-13, -5, 10}, {13, 5, 13}), 500, 100), 0);
}

}  // namespace
