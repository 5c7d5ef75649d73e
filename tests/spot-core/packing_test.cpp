// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/packing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "scenes.hpp"
#include "spot/packing/displacement.hpp"

namespace {

using spot::Grain;
using spot::InvalidPacking;
using spot::Overlap;
using spot::Packing;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;
using Pairs = std::set<std::pair<std::int64_t, std::int64_t>>;

constexpr double skin = 0.2;  // of the neighbour lists, in diameters

Pairs pairs_closer_than(const Packing& packing, double distance) {
  Pairs pairs;
  for (std::size_t i = 0; i < packing.slots(); ++i)
    for (std::size_t j = 0; j < packing.slots(); ++j)
      if (i != j && packing.present(i) && packing.present(j) &&
          packing.distance_squared(i, packing.position(j)) < distance * distance)
        pairs.emplace(packing.id(i), packing.id(j));
  return pairs;
}

/// The pairs of all lists; a neighbour that is listed twice, was removed or is the grain itself fails the test.
Pairs listed_pairs(const Packing& packing) {
  Pairs pairs;
  for (std::size_t i = 0; i < packing.slots(); ++i) {
    const auto [first, last] = packing.neighbours(i);
    if (!packing.present(i)) {
      EXPECT_EQ(first, last) << "a removed grain has neighbours";
    }
    for (const std::uint32_t* j = first; j != last; ++j) {
      EXPECT_NE(*j, i);
      EXPECT_TRUE(packing.present(*j)) << "a removed grain is listed";
      EXPECT_TRUE(pairs.emplace(packing.id(i), packing.id(*j)).second) << "a neighbour is listed twice";
    }
  }
  return pairs;
}

bool includes(const Pairs& all, const Pairs& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

void expect_symmetric(const Pairs& pairs) {
  for (const auto& [a, b] : pairs) EXPECT_TRUE(pairs.count({b, a})) << a << " lists " << b << " but not the reverse";
}

Overlap slow_largest_overlap(const Packing& packing) {
  Overlap largest;
  for (std::size_t i = 0; i < packing.slots(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (!packing.present(i) || !packing.present(j)) continue;
      const double depth = packing.diameter() - std::sqrt(packing.distance_squared(i, packing.position(j)));
      if (depth > largest.depth)
        largest = {depth, std::min(packing.id(i), packing.id(j)), std::max(packing.id(i), packing.id(j))};
    }
  return largest;
}

std::vector<std::int64_t> ids_of(const Packing& packing, const std::vector<std::uint32_t>& indices) {
  std::vector<std::int64_t> ids;
  for (const std::uint32_t i : indices) ids.push_back(packing.id(i));
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::vector<std::int64_t> slow_find_movable(const Packing& packing, const Vector3& point, double reach) {
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < packing.slots(); ++i)
    if (packing.present(i) && !packing.held(i) && packing.distance_squared(i, point) <= reach * reach)
      ids.push_back(packing.id(i));
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(PackingBruteForce, FreshListsAreExactlyThePairsCloserThanDiameterAndSkin) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const double d : {1.0, 3e-3}) {
      std::vector<Grain> grains =
          scenes::random_grains(300, {-4.0 * d, -3.0 * d, 0.0}, {4.0 * d, 3.0 * d, 8.0 * d}, 0.7 * d, seed);
      Packing packing(d, 100.0 * d, grains);
      packing.refresh(*scenes::empty_space());
      EXPECT_EQ(listed_pairs(packing), pairs_closer_than(packing, (1.0 + skin) * d));
    }
}

/// Many rounds of random moves, small and large, and removals; the grains wander out of the box that the cells
/// were laid over, and come to lie in memory in another order.
TEST(PackingBruteForce, ListsHoldEveryTouchingPairAfterManyMovesAndRemovals) {
  const auto container = scenes::small_silo(8.0, 4.0);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    scenes::Draws draws(seed);
    Packing packing(1.0, 100.0, scenes::random_grains(200, {-4.0, -3.0, 1.0}, {4.0, 3.0, 6.0}, 0.8, seed));
    packing.refresh(*container);
    std::size_t expected_size = packing.size();
    for (int round = 0; round < 60; ++round) {
      const double reach = round % 3 == 0 ? 0.8 : 0.03;
      for (std::uint32_t i = 0; i < packing.slots(); ++i) {
        if (!packing.present(i) || draws.uniform(0.0, 1.0) < 0.3) continue;
        const auto shift = [&] { return packing.quantum().round(draws.uniform(-reach, reach)); };
        const double dx = shift(), dy = shift(), dz = shift();
        packing.move(i, dx, dy, dz);
      }
      if (round % 2 == 0)
        packing.refresh(*container);
      else
        packing.update_lists(*container);
      if (round % 5 == 0) {
        const std::uint32_t victim = scenes::all_movable(packing)[draws.below(packing.size())];
        packing.remove(victim);
        --expected_size;
      }
      ASSERT_EQ(packing.size(), expected_size);
      ASSERT_EQ(packing.grains().size(), expected_size);

      const Pairs listed = listed_pairs(packing);
      expect_symmetric(listed);
      ASSERT_TRUE(includes(listed, pairs_closer_than(packing, 1.0))) << "seed " << seed << ", round " << round;
      // References closer than d + skin, each at most half a skin from its grain.
      ASSERT_TRUE(includes(pairs_closer_than(packing, 1.0 + 2.0 * skin), listed));

      const Overlap fast = packing.largest_overlap(), slow = slow_largest_overlap(packing);
      ASSERT_EQ(fast.depth, slow.depth);
      ASSERT_EQ(fast.first, slow.first);
      ASSERT_EQ(fast.second, slow.second);

      std::vector<std::uint32_t> found;
      for (int k = 0; k < 10; ++k) {
        const Vector3 point = draws.in_box({-8.0, -6.0, -5.0}, {8.0, 6.0, 12.0});
        const double radius = draws.uniform(0.0, 5.0);
        packing.find_movable(point, radius, found);
        ASSERT_EQ(ids_of(packing, found), slow_find_movable(packing, point, radius))
            << "seed " << seed << ", round " << round << ", around " << point.transpose() << " within " << radius;
      }
    }
  }
}

/// Wall marks follow the same rule as lists: every grain that overlaps a wall is marked.
TEST(PackingBruteForce, GrainsThatOverlapAWallAreMarked) {
  const auto container = scenes::small_silo(6.0, 4.0);
  scenes::Draws draws(3);
  Packing packing(1.0, 100.0, scenes::random_grains(300, {-5.5, -3.5, 0.5}, {5.5, 3.5, 6.0}, 0.8, 3));
  for (int round = 0; round < 50; ++round) {
    packing.refresh(*container);
    int marked = 0;
    for (std::uint32_t i = 0; i < packing.slots(); ++i) {
      spot::WallContacts contacts;
      container->contacts(packing.position(i), 0.5, contacts);
      if (contacts.begin() != contacts.end()) {
        ASSERT_TRUE(packing.near_wall(i)) << packing.position(i).transpose();
      }
      marked += packing.near_wall(i);
    }
    ASSERT_LT(marked, static_cast<int>(packing.size()));
    for (std::uint32_t i = 0; i < packing.slots(); ++i) {
      const double dx = packing.quantum().round(draws.uniform(-0.04, 0.04));
      const double dy = packing.quantum().round(draws.uniform(-0.04, 0.04));
      packing.move(i, dx, dy, 0.0);
    }
  }
}

TEST(PackingBruteForce, ListsGrowWithCrowding) {
  Packing packing(1.0, 100.0, scenes::random_grains(120, {-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}, 0.0, 1));
  packing.refresh(*scenes::empty_space());
  EXPECT_EQ(listed_pairs(packing), pairs_closer_than(packing, 1.0 + skin));
  EXPECT_EQ(packing.largest_overlap().depth, slow_largest_overlap(packing).depth);
}

TEST(PackingBruteForce, DisplacesExactlyTheGrainsInTheSphere) {
  scenes::Draws draws(4);
  const auto container = scenes::empty_space();
  Packing packing(1.0, 100.0, scenes::random_grains(400, {-4.0, -4.0, 0.0}, {4.0, 4.0, 8.0}, 0.8, 4));
  const double q = packing.quantum().length();
  std::vector<std::uint32_t> near;
  for (int k = 0; k < 300; ++k) {
    std::vector<Grain> expected = packing.grains();
    const spot::Move move{0.0, k, draws.in_box({-3.0, -3.0, 1.0}, {3.0, 3.0, 7.0}),
                          draws.in_box({-0.7, -0.7, 0.1}, {0.7, 0.7, 0.1})};
    int inside = 0;
    for (Grain& grain : expected) {
      const Vector3 apart = grain.position - move.middle;
      if (apart.x() * apart.x() + apart.y() * apart.y() + apart.z() * apart.z() > 2.6 * 2.6) continue;
      for (int axis = 0; axis < 3; ++axis) grain.position[axis] -= std::nearbyint(2.5e-3 * move.step[axis] / q) * q;
      ++inside;
    }
    packing.refresh(*container);
    packing.find_movable(move.middle, 3.6, near);
    EXPECT_EQ(spot::displace(packing, near, move, {2.6, 2.5e-3}), inside * spot::grain_volume);
    scenes::expect_identical(packing.grains(), expected);
  }
}

TEST(PackingUnit, GrainsComeBackInOrderOfIdsOnTheQuantum) {
  const std::vector<Grain> given = scenes::random_grains(100, {0.0, 0.0, 0.0}, {5.0, 5.0, 5.0}, 0.8, 1);
  const Packing packing(1.0, 10.0, given);
  const std::vector<Grain> grains = packing.grains();
  ASSERT_EQ(grains.size(), given.size());
  for (std::size_t i = 1; i < grains.size(); ++i) EXPECT_LT(grains[i - 1].id, grains[i].id);
  for (const Grain& grain : given) {
    const auto same = std::find_if(grains.begin(), grains.end(), [&](const Grain& g) { return g.id == grain.id; });
    ASSERT_NE(same, grains.end());
    EXPECT_LT((same->position - grain.position).norm(), packing.quantum().length());
  }
}

TEST(PackingUnit, HeldGrainsAreNeighboursButNotMovable) {
  Packing packing(1.0, 10.0, {{1, {0.0, 0.0, 0.0}}, {2, {1.0, 0.0, 0.0}, true}});
  packing.refresh(*scenes::empty_space());
  std::vector<std::uint32_t> found;
  packing.find_movable({0.0, 0.0, 0.0}, 3.0, found);
  EXPECT_EQ(ids_of(packing, found), std::vector<std::int64_t>{1});
  EXPECT_EQ(listed_pairs(packing).size(), 2u);
  EXPECT_TRUE(packing.grains()[1].held);
}

TEST(PackingUnit, RemovedGrainsAreHandedBackAndGone) {
  const auto container = scenes::empty_space();
  Packing packing(1.0, 10.0, {{7, {0.0, 0.0, 0.0}}, {8, {0.9, 0.0, 0.0}}, {9, {1.8, 0.0, 0.0}}});
  packing.refresh(*container);
  const Grain removed = packing.remove(scenes::index_of(packing, 8));
  EXPECT_EQ(removed.id, 8);
  EXPECT_NEAR(removed.position.x(), 0.9, 1e-12);
  EXPECT_EQ(packing.size(), 2u);
  EXPECT_EQ(packing.largest_overlap().depth, 0.0);
  packing.refresh(*container);
  EXPECT_TRUE(listed_pairs(packing).empty());
}

TEST(PackingUnit, AnEmptyPackingWorks) {
  Packing packing(1.0, 10.0, {});
  packing.refresh(*scenes::empty_space());
  std::vector<std::uint32_t> found = {1, 2};
  packing.find_movable({0.0, 0.0, 0.0}, 3.0, found);
  EXPECT_TRUE(found.empty());
  EXPECT_EQ(packing.size(), 0u);
  EXPECT_EQ(packing.largest_overlap().depth, 0.0);
  EXPECT_GE(packing.memory(), 0u);
}

TEST(PackingUnit, BadGrainsAreNamed) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (int axis = 0; axis < 3; ++axis) {
      Vector3 position(1.0, 1.0, 1.0);
      position[axis] = bad;
      EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                    Packing(1.0, 10.0, {{1, {0, 0, 0}}, {4711, position}});
                  }),
                  AllOf(HasSubstr("grain 4711"), HasSubstr("not finite")));
    }
  EXPECT_THAT(scenes::text_of<InvalidPacking>([] {
                Packing(1.0, 10.0, {{4711, {0.0, -10.5, 0.0}}});
              }),
              AllOf(HasSubstr("grain 4711"), HasSubstr("10")));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([] {
                Packing(1.0, 10.0, {{5, {0, 0, 0}}, {6, {2, 0, 0}}, {5, {4, 0, 0}}});
              }),
              HasSubstr("id 5 occurs twice"));
  for (const std::int64_t bad : {std::int64_t{-1}, std::numeric_limits<std::int64_t>::min()})
    EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                  Packing(1.0, 10.0, {{0, {0, 0, 0}}, {bad, {2, 0, 0}}});
                }),
                HasSubstr("grain id " + std::to_string(bad) + " is negative"));
  EXPECT_THROW(Packing(0.0, 10.0, {}), spot::InvalidParameter);
}

}  // namespace
