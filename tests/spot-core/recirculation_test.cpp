// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that have drained come in again.
#include "spot/drivers/recirculation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <mutex>

#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::Bytes;
using spot::Grain;
using spot::Inlet;
using spot::InvalidContainer;
using spot::InvalidPacking;
using spot::Recirculation;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;

constexpr double half_width = 6.0, half_depth = 4.0, window = 0.05;
constexpr std::uint64_t seed = 5;
const Vector3 low(-half_width, -half_depth, 0.0), high(half_width, half_depth, 40.0);

std::vector<Grain> filling() { return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 9.0}, 0.01, 2); }

/// Every third one is small.
std::vector<Grain> unequal_filling() {
  std::vector<Grain> grains = filling();
  for (std::size_t k = 0; k < grains.size(); ++k) grains[k].radius = k % 3 == 0 ? 0.35 : 0.5;
  return grains;
}

spot::SpotParameters spots() {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.seed = seed;
  spots.influence = 1e-2;
  spots.injection_rate = 15.0;
  spots.step_height = 0.8;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spots.fixed_volume = 77;
  return spots;
}

std::shared_ptr<const spot::Container> silo() { return scenes::small_silo(half_width, half_depth); }

/// Repeats along x, and has two outlets.
std::shared_ptr<const spot::Container> periodic_silo() {
  const spot::Periodic periodic(spot::Interval{-half_width, half_width}, {});
  const auto slot = std::make_shared<spot::Slot>(5.2, 5.2);
  return spot::box_silo({}, spot::Interval{-half_depth, half_depth}, periodic,
                        spot::Outlets({{{-3.0, 0.0, 0.0}, slot}, {{3.0, 0.0, 0.0}, slot}}),
                        spot::SpotBuffers{1.0, 2.6});
}

template <typename Start>
std::unique_ptr<spot::WindowedDrainage> windowed(const Start& start, std::shared_ptr<const spot::Container> container,
                                                 std::shared_ptr<spot::Communicator> ranks,
                                                 const spot::SpotParameters& parameters = spots()) {
  return std::make_unique<spot::WindowedDrainage>(parameters, scenes::loose_relaxation(), spot::DrainageLimits{-1.0},
                                                  window, 1, std::move(container), 1.0, 100.0, start, std::move(ranks));
}

Inlet surface() { return {low, high, true, {}, "the surface"}; }

using Places = std::map<std::int64_t, Grain>;

Places places(const spot::Drainage& drainage) {
  Places all;
  drainage.visit_grains([&](const Grain& grain) { all.emplace(grain.id, grain); });
  return all;
}

/// All grains are there once, inside, and none is deep in another.
void expect_all(spot::Drainage& drainage, const std::vector<Grain>& start) {
  const std::vector<Grain> now = drainage.grains();
  ASSERT_EQ(now.size(), start.size());
  Places before;
  for (const Grain& grain : start) before.emplace(grain.id, grain);
  for (std::size_t k = 0; k < now.size(); ++k) {
    ASSERT_TRUE(k == 0 || now[k - 1].id < now[k].id) << "twice";
    ASSERT_TRUE(before.count(now[k].id)) << now[k].id;
    ASSERT_EQ(spot::radius_in(1.0, now[k]), spot::radius_in(1.0, before.at(now[k].id)));
  }
  drainage.require_inside();
  ASSERT_LT(drainage.largest_overlap().depth, 0.1);
}

/// The part that grains fill between two heights, each with its whole volume where its centre is.
double packing_fraction(const spot::Drainage& drainage, double bottom, double top) {
  double volume = 0.0;
  drainage.visit_grains([&](const Grain& grain) {
    const double radius = spot::radius_in(1.0, grain);
    if (grain.position.z() >= bottom && grain.position.z() < top)
      volume += 4.0 / 3.0 * scenes::pi * radius * radius * radius;
  });
  return volume / (4.0 * half_width * half_depth * (top - bottom));
}

/// Three turnovers; after the first the bed stays as dense as it is then.
void turn_over(spot::Drainage& drainage, const std::vector<Grain>& start, const Recirculation& recirculation,
               double rate) {
  spot::Alone alone;
  const int turnovers = 3;
  std::vector<double> sums(turnovers + 1), samples(turnovers + 1);
  const auto each = static_cast<double>(start.size());
  std::map<std::int64_t, int> passages;
  for (int step = 1; static_cast<double>(drainage.counters().drained) < turnovers * each; ++step) {
    ASSERT_LT(step * 0.2, 2.0 * turnovers * each / rate) << "flow has ceased";
    drainage.advance_to(step * 0.2);
    const auto drained = drainage.take_drained();
    for (const Grain& grain : drained) ++passages[grain.id];
    recirculation.put_back(drainage, drained, step, alone);
    if (step % 16 != 0) continue;
    ASSERT_NO_FATAL_FAILURE(expect_all(drainage, start));
    const auto turnover = static_cast<std::size_t>(static_cast<double>(drainage.counters().drained) / each);
    sums[turnover] += packing_fraction(drainage, 1.5, 5.0);
    ++samples[turnover];
  }
  ASSERT_NO_FATAL_FAILURE(expect_all(drainage, start));
  std::int64_t all = 0;
  for (const auto& [id, count] : passages) all += count;
  EXPECT_EQ(all, drainage.counters().drained);
  EXPECT_GT(static_cast<double>(passages.size()), 0.7 * each);
  const double settled = sums[1] / samples[1];
  EXPECT_GT(settled, 0.53);
  for (int turnover = 2; turnover < turnovers; ++turnover) {
    const auto k = static_cast<std::size_t>(turnover);
    ASSERT_GT(samples[k], 5.0);
    EXPECT_NEAR(sums[k] / samples[k], settled, 0.01) << turnover;
  }
}

TEST(RecirculationInvariance, NoGrainIsLostAndTheBedStaysAsDense) {
  const double rate = 15.0 * 1e-2 * 77;
  for (const auto& start : {filling(), unequal_filling()}) {
    const Recirculation recirculation(seed, surface(), silo(), 1.0);
    ASSERT_NO_FATAL_FAILURE(
        turn_over(*windowed(start, silo(), std::make_shared<spot::Alone>()), start, recirculation, rate));
  }
  spot::SpotParameters two = spots();
  two.injection_rate = spot::Injection({8.0, 8.0});
  const Recirculation recirculation(seed, surface(), periodic_silo(), 1.0);
  ASSERT_NO_FATAL_FAILURE(turn_over(*windowed(filling(), periodic_silo(), std::make_shared<spot::Alone>(), two),
                                    filling(), recirculation, rate));
}

TEST(RecirculationInvariance, InTheOrderOfTime) {
  const auto start = filling();
  spot::TimeOrderedDrainage drainage(spots(), spot::RelaxationParameters(), spot::DrainageLimits{-1.0}, silo(),
                                     spot::Packing(1.0, 100.0, start));
  const Recirculation recirculation(seed, Inlet{low + Vector3(0, 0, 14), high, false, {}, "above"}, silo(), 1.0);
  spot::Alone alone;
  for (int step = 1; step <= 60; ++step) {
    drainage.advance_to(0.2 * step);
    recirculation.put_back(drainage, drainage.take_drained(), step, alone);
  }
  ASSERT_NO_FATAL_FAILURE(expect_all(drainage, start));
  EXPECT_GT(drainage.counters().drained, 60);
}

/// On so many ranks; saves, and goes on from what was saved, after half of the steps.
Places drain(int ranks, bool restart, std::int64_t& drained) {
  Places outcome;
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto all = filling();
    std::vector<Grain> part;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (static_cast<int>(i) % ranks == communicator->rank()) part.push_back(all[i]);
    auto drainage = windowed(part, silo(), communicator);
    const Recirculation recirculation(seed, surface(), silo(), 1.0);
    for (int step = 1; step <= 60; ++step) {
      drainage->advance_to(0.5 * step);
      recirculation.put_back(*drainage, drainage->take_drained(), step, *communicator);
      if (!restart || step != 30) continue;
      const std::vector<Bytes> parts = communicator->share_with_all(drainage->save());
      drainage = windowed(parts, silo(), communicator);
    }
    const std::int64_t total = drainage->total().drained;
    const std::lock_guard<std::mutex> lock(mutex);
    drained = total;
    outcome.merge(places(*drainage));
  });
  return outcome;
}

TEST(RecirculationInvariance, SameBitsOnRanksAndOverARestart) {
  std::int64_t drained = 0, more = 0;
  const Places one = drain(1, false, drained);
  EXPECT_EQ(one.size(), filling().size());
  EXPECT_GT(drained, 200);
  for (const int ranks : {1, 3}) {
    EXPECT_TRUE(drain(ranks, true, more) == one) << ranks;
    EXPECT_EQ(more, drained);
  }
}

/// One grain after the other, onto the base of an empty silo, and away again.
TEST(RecirculationStatistical, GrainsComeInUniformly) {
  const auto drainage = windowed(std::vector<Grain>(), silo(), std::make_shared<spot::Alone>());
  const Recirculation recirculation(seed, surface(), silo(), 1.0);
  spot::Alone alone;
  std::vector<int> columns(11 * 7);  // of the places that its centre can have
  for (int time = 1; time <= 7700; ++time) {
    const std::int64_t id = 1000000 + time;  // which decides how it rolls
    recirculation.put_back(*drainage, {{id, Vector3::Zero()}}, time, alone);
    const Vector3 at = places(*drainage).at(id).position;
    ASSERT_NEAR(at.z(), 0.5, 0.01) << "it has come down";
    ++columns[static_cast<std::size_t>(std::clamp(at.x() + 5.5, 0.0, 10.9)) * 7 +
              static_cast<std::size_t>(std::clamp(at.y() + 3.5, 0.0, 6.9))];
    drainage->change_grains({{id}, {}});
  }
  EXPECT_LT(scenes::deviation_from_equal_counts(columns), scenes::bound);
}

TEST(RecirculationUnit, OfAnInletOnlyWhatCountsIsUsed) {
  std::vector<Grain> few = {{1, {0.0, 0.0, 0.5}, true}};
  const auto drainage = windowed(few, silo(), std::make_shared<spot::Alone>());
  Inlet corner{low + Vector3(0, 0, 5), high - Vector3(0, 0, 30), false, {}, "the corner"};
  corner.contains = [](const Vector3& at) { return at.x() < -3.0 && at.y() > 1.0; };
  spot::Alone alone;
  std::vector<Grain> drained;
  for (std::int64_t id = 10; id < 20; ++id) drained.push_back({id, Vector3::Zero()});
  Recirculation(seed, corner, silo(), 1.0).put_back(*drainage, drained, 1, alone);
  const Places now = places(*drainage);
  ASSERT_EQ(now.size(), 11u);
  for (const auto& [id, grain] : now)
    if (id >= 10) {
      EXPECT_LT(grain.position.x(), -1.0) << "came down from where it was put to";
      EXPECT_GT(grain.position.y(), -1.0);
    }
}

TEST(RecirculationUnit, InletsWithoutRoomAreNamed) {
  const auto refusal = [](const Inlet& inlet) {
    return scenes::text_of<InvalidContainer>([&] { Recirculation(seed, inlet, silo(), 1.0); });
  };
  EXPECT_THAT(refusal({{7.0, 0.0, 5.0}, {9.0, 2.0, 9.0}, false, {}, "the annexe"}),
              AllOf(HasSubstr("the annexe has no place inside the walls"), HasSubstr("diameter 1")));
  EXPECT_THAT(refusal({{-1.0, 3.6, 5.0}, {1.0, 3.9, 9.0}, false, {}, "the gap"}), HasSubstr("the gap has no place"));
  EXPECT_THAT(refusal({low, high, true, [](const Vector3&) { return false; }, "nothing"}), HasSubstr("nothing has"));

  const auto start = filling();
  const auto drainage = windowed(start, silo(), std::make_shared<spot::Alone>());
  const Recirculation full(seed, {{-1.0, -1.0, 2.0}, {1.0, 1.0, 4.0}, false, {}, "the middle"}, silo(), 1.0);
  spot::Alone alone;
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                full.put_back(*drainage, {{4711, Vector3::Zero()}, {4712, Vector3::Zero()}}, 1, alone);
              }),
              AllOf(HasSubstr("the middle has no free place for grain 4711"), HasSubstr("1024 were drawn")));
  ASSERT_NO_FATAL_FAILURE(expect_all(*drainage, start));
}

}  // namespace
