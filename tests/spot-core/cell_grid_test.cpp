// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cell_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "scenes.hpp"

namespace {

using spot::CellGrid;
using spot::InvalidPacking;
using spot::Vector3;
using testing::HasSubstr;

/// A grid and the points in it, for comparison with a look at all points.
struct Scene {
  CellGrid grid;
  std::vector<Vector3> points;

  void insert(const Vector3& point) {
    grid.insert(grid.cell_of(point.x(), point.y(), point.z()), static_cast<std::uint32_t>(points.size()));
    points.push_back(point);
  }

  /// How often each point within reach was visited must be once.
  void expect_all_visited_once(const Vector3& centre, double reach) const {
    std::vector<int> visits(points.size());
    grid.visit_near(centre, reach, [&](std::uint32_t i) { ++visits[i]; });
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_LE(visits[i], 1) << "visited twice";
      if ((points[i] - centre).norm() <= reach) {
        ASSERT_EQ(visits[i], 1) << "point " << points[i].transpose() << " is within " << reach << " of "
                                << centre.transpose();
      }
    }
  }
};

const Vector3 low(-3.0, -2.0, 0.5), high(4.0, 2.5, 9.0);

TEST(CellGridBruteForce, VisitsEveryPointWithinReach) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    scenes::Draws draws(seed);
    Scene scene{CellGrid(low, high, 1.2), {}};
    for (int i = 0; i < 400; ++i) scene.insert(draws.in_box(low, high));
    for (int k = 0; k < 300; ++k) scene.expect_all_visited_once(draws.in_box(low, high), draws.uniform(0.0, 4.0));
  }
}

/// Grains fall out of the box that the grid was laid over, and spots are born below it.
TEST(CellGridBruteForce, VisitsPointsBeyondTheBoxOnEverySide) {
  const Vector3 margin = Vector3::Constant(4.0);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    scenes::Draws draws(seed);
    Scene scene{CellGrid(low, high, 1.2), {}};
    for (int i = 0; i < 400; ++i) scene.insert(draws.in_box(low - margin, high + margin));
    for (int k = 0; k < 300; ++k)
      scene.expect_all_visited_once(draws.in_box(low - margin, high + margin), draws.uniform(0.0, 4.0));
  }
}

TEST(CellGridBruteForce, FlatAndPointLikeBoxes) {
  for (const Vector3& size : {Vector3(5.0, 5.0, 0.0), Vector3(5.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)}) {
    scenes::Draws draws(3);
    Scene scene{CellGrid(low, low + size, 1.2), {}};
    for (int i = 0; i < 50; ++i) scene.insert(draws.in_box(low, low + size));
    for (int k = 0; k < 100; ++k) scene.expect_all_visited_once(draws.in_box(low, low + size), draws.uniform(0.0, 4.0));
  }
}

TEST(CellGridBruteForce, SkipsMostOfTheFarCells) {
  Scene scene{CellGrid({0.0, 0.0, 0.0}, {20.0, 20.0, 20.0}, 1.2), {}};
  scenes::Draws draws(4);
  for (int i = 0; i < 8000; ++i) scene.insert(draws.in_box({0.0, 0.0, 0.0}, {20.0, 20.0, 20.0}));
  int visited = 0;
  scene.grid.visit_near({10.0, 10.0, 10.0}, 2.6, [&](std::uint32_t) { ++visited; });
  EXPECT_LT(visited, 500) << "a cube around the ball, widened by a cell on each side, would hold 512";
}

TEST(CellGridUnit, ErasedPointsAreNotVisited) {
  Scene scene{CellGrid(low, high, 1.2), {}};
  for (int i = 0; i < 3; ++i) scene.insert({0.1 * i, 0.0, 1.0});
  scene.grid.erase(scene.grid.cell_of(0.1, 0.0, 1.0), 1);
  std::vector<std::uint32_t> visited;
  scene.grid.visit_near({0.0, 0.0, 1.0}, 0.5, [&](std::uint32_t i) { visited.push_back(i); });
  EXPECT_THAT(visited, testing::UnorderedElementsAre(0u, 2u));
}

TEST(CellGridUnit, CellsGrowWithTheirMembers) {
  Scene scene{CellGrid(low, high, 1.2), {}};
  scenes::Draws draws(5);
  for (int i = 0; i < 100; ++i) scene.insert(draws.in_box({0.61, 0.41, 1.71}, {0.65, 0.45, 1.75}));
  scene.insert({3.0, 2.0, 8.0});
  scene.expect_all_visited_once({0.6, 0.4, 1.7}, 0.5);
  scene.expect_all_visited_once({3.0, 2.0, 8.0}, 0.5);
}

TEST(CellGridUnit, AnEmptyGridVisitsNothing) {
  CellGrid().visit_near({0.0, 0.0, 0.0}, 1.0, [](std::uint32_t) { FAIL(); });
  CellGrid(low, high, 1.2).visit_near({0.0, 0.0, 0.0}, 1.0, [](std::uint32_t) { FAIL(); });
}

TEST(CellGridUnit, RefusesTooManyCellsAndCollapsedCells) {
  EXPECT_THAT(scenes::text_of<InvalidPacking>([] {
                CellGrid({0.0, 0.0, 0.0}, {1e4, 1e4, 1e4}, 1.2);
              }),
              HasSubstr("at most 1.07374182e+09"));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([] {
                CellGrid grid(low, high, 1.2);
                for (std::uint32_t i = 0; i < 300; ++i) grid.insert(0, i);
              }),
              HasSubstr("collapsed"));
}

}  // namespace
