// SPDX-License-Identifier: GPL-2.0-or-later
// Drainages of unequal grains and in space that repeats. A scene that fails is named by its seed.
#include "general_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "invariants.hpp"
#include "ranks_of_threads.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"
#include "spot/drivers/recirculation.hpp"

namespace {

using spot::Grain;
using spot::Packing;
using spot::TimeOrderedDrainage;
using spot::Vector3;

/// Grains placed at random are looser than any packing at rest; where there are enough of them, spots are told so.
void expect_looser_at_rest(const spot::InvalidParameter& error) {
  EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("critical packing fraction is "),
                                           testing::HasSubstr("the packing at rest has 0.")));
}

const std::uint64_t scenes_in_ci = scenes::sanitized() ? 16 : 60;

/// Every invariant, as the drainage goes on; and the same once more, from a saved state half way.
TEST(GeneralScenesInvariance, HoldWhatEveryDrainageHolds) {
  std::size_t drained = 0, moves = 0, collapsed = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= scenes_in_ci; ++seed) {
    const scenes::GeneralScene scene(seed);
    SCOPED_TRACE(scene.description());
    try {
      const auto drainage = scene.start_time_ordered();
      invariants::Ledger ledger(scene.grains(), scene.diameter(), scene.limits(), *scene.silo());
      spot::Bytes half_way;
      for (int k = 1; k <= 6; ++k) {
        drainage->advance_to(0.15 * k);
        ASSERT_EQ(ledger.check(*drainage), "");
        ASSERT_LT(ledger.overlaps().largest, scene.limits().largest_overlap_in_flow);
        for (const Grain& grain : drainage->grains())
          ASSERT_EQ(drainage->packing().periodic().wrap(grain.position), grain.position) << "out of the cell";
        for (const spot::Spot& spot : drainage->spots())
          ASSERT_EQ(scene.silo()->periodic().wrap(spot.position), spot.position) << "out of the cell";
        if (k == 3) half_way = drainage->save();
      }
      TimeOrderedDrainage again(scene.spots(), scene.relaxation(), scene.limits(), scene.silo(), scene.diameter(),
                                scene.extent(), half_way);
      again.advance_to(0.15 * 6);
      ASSERT_EQ(again.grains(), drainage->grains());
      drained += ledger.drained();
      moves += static_cast<std::size_t>(drainage->counters().moves);
    } catch (const spot::CollapsedPacking&) {
      ++collapsed;
    } catch (const spot::InvalidParameter& error) {
      expect_looser_at_rest(error);
      ++refused;
    }
  }
  EXPECT_LE(collapsed, 1u);
  EXPECT_LE(refused, 8u);
  EXPECT_GT(drained, 900 * scenes_in_ci / 60);
  EXPECT_GT(moves, 20000 * scenes_in_ci / 60);
}

/// Grains in the order of ids, of all ranks.
using All = std::map<std::int64_t, Grain>;

void add_grains(const spot::Drainage& drainage, All& all) {
  drainage.visit_grains([&](const Grain& grain) { EXPECT_TRUE(all.emplace(grain.id, grain).second) << grain.id; });
}

/// Goes on from a saved state, of one rank or more, on so many ranks until a time; `saved` is what they save then.
All on_ranks(const scenes::GeneralScene& scene, int ranks, double time, std::vector<spot::Bytes>& saved) {
  All all;
  std::mutex mutex;
  const std::vector<spot::Bytes> from = saved;
  saved.assign(static_cast<std::size_t>(ranks), {});
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto drainage = from.empty() ? scene.start_windowed(1, communicator) : scene.go_on(from, 1, communicator);
    drainage->advance_to(time);
    const std::lock_guard<std::mutex> lock(mutex);
    saved[static_cast<std::size_t>(communicator->rank())] = drainage->save();
    add_grains(*drainage, all);
  });
  return all;
}

/// And on threads, and on ranks of another number half way.
TEST(GeneralScenesInvariance, TheWindowedDriverHoldsThemToo) {
  std::size_t drained = 0, shared = 0, collapsed = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= scenes_in_ci; ++seed) {
    const scenes::GeneralScene scene(seed);
    SCOPED_TRACE(scene.description());
    try {
      const auto drainage = scene.start_windowed(1 + static_cast<int>(seed % 3));
      invariants::Ledger ledger(scene.grains(), scene.diameter(), scene.limits(), *scene.silo());
      invariants::Followed followed;
      for (int k = 1; k <= 6; ++k) {
        drainage->advance_to(0.15 * k);
        ASSERT_EQ(followed.check(*drainage), -1);
        ASSERT_EQ(ledger.check(*drainage), "");
        ASSERT_LT(ledger.overlaps().largest, scene.limits().largest_overlap_in_flow);
        for (const Grain& grain : drainage->grains())
          ASSERT_EQ(scene.silo()->periodic().on(drainage->quantum()).wrap(grain.position), grain.position);
      }
      drained += ledger.drained();
      if (seed % 4 != 0) continue;
      All alone;
      add_grains(*drainage, alone);
      std::vector<spot::Bytes> saved;
      on_ranks(scene, 1 + static_cast<int>(seed % 3), 0.45, saved);
      EXPECT_TRUE(on_ranks(scene, 3, 0.9, saved) == alone);
      ++shared;
    } catch (const spot::CollapsedPacking&) {
      ++collapsed;
    } catch (const spot::InvalidParameter& error) {
      expect_looser_at_rest(error);
      ++refused;
    }
  }
  EXPECT_LE(collapsed, 2u);
  EXPECT_LE(refused, 8u);
  EXPECT_GT(drained, 900 * scenes_in_ci / 60);
  EXPECT_GE(shared, 10 * scenes_in_ci / 60);
}

spot::SpotParameters dyadic_spots() {
  spot::SpotParameters spots;
  spots.radius = 2.0;
  spots.influence = 0.02;
  spots.step_width = 0.75;
  spots.step_height = 0.125;
  spots.speed = 3.0;
  spots.injection_rate = 100.0;
  spots.fixed_volume = 20.0;
  spots.dilation = 0.05;
  return spots;
}

/// All lengths are multiples of 2^-40, so that everything half a period farther on is exactly that.
TEST(GeneralScenesInvariance, MovingEverythingAlongAPeriodMovesTheResult) {
  const Vector3 low(-6.0, -4.0, 0.0), high(6.0, 4.0, 10.0);
  for (const bool both : {false, true}) {
    const auto drained_at = [&](double x) {
      const auto silo = scenes::repeated_silo(low, high, true, both, {{x, 0.5, 0.0}, 2.0}, {0.5, 1.0});
      auto grains = scenes::unequal_grains(700, low, high, silo->periodic(), 4);
      for (Grain& grain : grains)
        for (double& at : grain.position) at = std::nearbyint(at * 0x1p20) * 0x1p-20;
      for (Grain& grain : grains) grain.position.x() += x;
      TimeOrderedDrainage drainage(dyadic_spots(), {}, {0.0}, silo, Packing(1.0, 100.0, grains, silo->periodic()));
      drainage.advance_to(2.0);
      EXPECT_GT(drainage.counters().drained, 5);
      std::vector<Grain> moved_back = drainage.grains();
      for (Grain& grain : moved_back) grain.position.x() = silo->periodic().wrap(grain.position.x() - x, 0);
      return moved_back;
    };
    scenes::expect_identical(drained_at(3.0), drained_at(-3.0));
  }
}

/// From half way on, what drains comes in again, from above or right above the bed.
All recirculate(const scenes::GeneralScene& scene, bool on_surface, int ranks, std::int64_t& put_back) {
  All all;
  std::mutex mutex;
  invariants::Followed followed;
  put_back = 0;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto drainage = scene.start_windowed(1, communicator);
    const double d = scene.diameter();
    spot::Inlet inlet{scene.low(), scene.high() + Vector3(0.0, 0.0, 40.0 * d), on_surface, {}, "the top"};
    if (!on_surface) inlet.low.z() = scene.high().z() + 8.0 * d;
    const spot::Recirculation recirculation(scene.spots().seed, inlet, scene.silo(), d);
    EXPECT_EQ(followed.check(*drainage), -1);
    std::int64_t own = 0;
    for (int k = 1; k <= 6; ++k) {
      drainage->advance_to(0.15 * k);
      const auto drained = drainage->take_drained();
      if (k < 3) continue;
      recirculation.put_back(*drainage, drained, k, *communicator);
      own += static_cast<std::int64_t>(drained.size());
      EXPECT_EQ(followed.check(*drainage), -1);
    }
    drainage->require_inside();
    const std::lock_guard<std::mutex> lock(mutex);
    put_back += own;
    add_grains(*drainage, all);
  });
  return all;
}

TEST(GeneralScenesInvariance, GrainsGoRound) {
  std::int64_t all_put_back = 0, put_back = 0;
  std::size_t shared = 0, collapsed = 0;
  for (std::uint64_t seed = 1; seed <= scenes_in_ci / 2; ++seed) {
    const scenes::GeneralScene scene(seed);
    SCOPED_TRACE(scene.description());
    try {
      const All alone = recirculate(scene, seed % 2 == 0, 1, put_back);
      all_put_back += put_back;
      const auto plain = scene.start_windowed(1);
      plain->advance_to(0.3);
      EXPECT_EQ(alone.size(), plain->grains().size()) << "no more are lost than had drained before";
      if (seed % 3 != 0) continue;
      EXPECT_TRUE(recirculate(scene, seed % 2 == 0, 3, put_back) == alone);
      ++shared;
    } catch (const spot::CollapsedPacking&) {
      ++collapsed;
    } catch (const spot::InvalidParameter& error) {
      expect_looser_at_rest(error);
    }
  }
  EXPECT_LE(collapsed, 1u);
  EXPECT_GE(shared, 7 * scenes_in_ci / 60);
  EXPECT_GT(all_put_back, static_cast<std::int64_t>(200 * scenes_in_ci / 60));
}

/// A heap in the middle of a wide base, which nothing leaves on any side.
TEST(GeneralScenesInvariance, WhatNothingCrossesIsAsBetweenWalls) {
  const Vector3 low(-30.0, -30.0, 0.0), high(30.0, 30.0, 20.0);
  const auto grains = scenes::unequal_grains(500, {-5, -4, 0}, {5, 4, 8}, {}, 7);
  const auto drained = [&](bool x, bool y) {
    const auto silo = scenes::repeated_silo(low, high, x, y, {{0, 0, 0}, 3.0}, {0.5, 1.0});
    spot::SpotParameters spots = dyadic_spots();
    spots.dilation = 0.0;
    TimeOrderedDrainage drainage(spots, {}, {0.0}, silo, Packing(1.0, 100.0, grains, silo->periodic()));
    drainage.advance_to(2.0);
    EXPECT_GT(drainage.counters().drained, 5);
    return drainage.grains();
  };
  const auto expected = drained(false, false);
  for (const auto& [x, y] : {std::pair(true, false), std::pair(false, true), std::pair(true, true)})
    scenes::expect_identical(drained(x, y), expected);
}

TEST(GeneralScenesUnit, RefusesPeriodsThatDoNotFit) {
  const Vector3 low(-3.5, -6.0, 0.0), high(3.5, 6.0, 10.0);
  const auto narrow = scenes::repeated_silo(low, high, true, false, {{0, 0, 0}, 2.0}, {0.5, 1.0});
  EXPECT_THAT(scenes::text_of<spot::InvalidContainer>([&] {
                TimeOrderedDrainage(dyadic_spots(), {}, {0.0}, narrow, Packing(1.0, 100.0, {}, narrow->periodic()));
              }),
              testing::AllOf(testing::HasSubstr("along x is 7"), testing::HasSubstr("at least 8")));
  const auto wide = scenes::repeated_silo(2.0 * low, 2.0 * high, true, false, {{0, 0, 0}, 2.0}, {0.5, 1.0});
  EXPECT_THROW(TimeOrderedDrainage(dyadic_spots(), {}, {0.0}, wide, Packing(1.0, 100.0, {})), spot::InvalidContainer);
}

}  // namespace
