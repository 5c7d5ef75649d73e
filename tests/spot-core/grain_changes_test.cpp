// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that somebody else brings, takes, moves, renames or holds, while spots go on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>

#include "invariants.hpp"
#include "ranks_of_threads.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace {

using spot::Bytes;
using spot::Grain;
using spot::GrainChanges;
using spot::InvalidPacking;
using spot::TimeOrderedDrainage;
using spot::Vector3;
using spot::WindowedDrainage;
using testing::AllOf;
using testing::HasSubstr;

constexpr double half_width = 6.0, half_depth = 4.0, window = 0.02;

std::vector<Grain> filling() { return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 14.0}, 0.01, 2); }

spot::SpotParameters spots() {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.step_height = 0.8;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spots.fixed_volume = 77;
  spots.dilation = 0.03;
  return spots;
}

template <typename Start>
std::unique_ptr<WindowedDrainage> windowed(const Start& start, std::shared_ptr<spot::Communicator> ranks) {
  return std::make_unique<WindowedDrainage>(spots(), scenes::loose_relaxation(), spot::DrainageLimits{-1.0}, window, 1,
                                            scenes::small_silo(half_width, half_depth), 1.0, 100.0, start,
                                            std::move(ranks));
}

std::unique_ptr<WindowedDrainage> windowed(const std::vector<Grain>& start) {
  return windowed(start, std::make_shared<spot::Alone>());
}

std::unique_ptr<TimeOrderedDrainage> time_ordered(const std::vector<Grain>& start) {
  return std::make_unique<TimeOrderedDrainage>(spots(), scenes::loose_relaxation(), spot::DrainageLimits{-1.0},
                                               scenes::small_silo(half_width, half_depth),
                                               spot::Packing(1.0, 100.0, start));
}

using Places = std::map<std::int64_t, Grain>;

Places places(const spot::Drainage& drainage) {
  Places all;
  drainage.visit_grains([&](const Grain& grain) { all.emplace(grain.id, grain); });
  return all;
}

/// What happens at each of the times: grains come from above, beyond the grid to all sides of it, others go or are
/// moved.
struct Event {
  double time;
  std::vector<std::int64_t> gone;
  std::vector<Grain> come;
};

std::vector<Event> events() {
  const auto at = filling();
  const auto above = [](std::int64_t first, double z) {
    std::vector<Grain> come;
    for (std::int64_t k = 0; k < 20; ++k)
      come.push_back({first + k, {-5.0 + 1.05 * static_cast<double>(k % 10), k < 10 ? -2.0 : 2.0, z}});
    return come;
  };
  Event mixed{1.0, {400, 500, 600}, above(1000000, 22.0)};
  mixed.come.push_back({500, at[499].position + Vector3(0, 0, 12.0)});  // moved
  return {{0.5, {}, above(2000000, 17.0)}, mixed, {1.5, {1000003, 2000004}, above(3000000, 40.0)}};
}

GrainChanges part_of(const Event& event, int rank, int ranks) {
  GrainChanges changes;
  for (std::size_t k = 0; k < event.gone.size(); ++k)
    if (static_cast<int>(k) % ranks == rank) changes.gone.push_back(event.gone[k]);
  for (std::size_t k = 0; k < event.come.size(); ++k)
    if (static_cast<int>(k) % ranks == rank) changes.come.push_back(event.come[k]);
  return changes;
}

/// Drains on so many ranks; saves, and goes on from what was saved, at `restart`.
Places drain(int ranks, double restart) {
  Places outcome;
  std::mutex mutex;
  invariants::Followed followed;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const int rank = communicator->rank();
    std::vector<Grain> part;
    const auto all = filling();
    for (std::size_t i = 0; i < all.size(); ++i)
      if (static_cast<int>(i) % ranks == rank) part.push_back(all[i]);
    auto drainage = windowed(part, communicator);
    for (const Event& event : events()) {
      drainage->advance_to(event.time);
      drainage->change_grains(part_of(event, rank, ranks));
      EXPECT_EQ(followed.check(*drainage), -1);
      if (restart > event.time && restart < event.time + 0.5) {
        drainage->advance_to(restart);
        std::vector<Bytes> parts = communicator->share_with_all(drainage->save());
        drainage = windowed(parts, communicator);
      }
    }
    drainage->advance_to(2.0);
    EXPECT_EQ(followed.check(*drainage), -1);
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [id, grain] : places(*drainage)) EXPECT_TRUE(outcome.emplace(id, grain).second) << id;
  });
  return outcome;
}

class GrainChangesInvariance : public testing::TestWithParam<int> {};

TEST_P(GrainChangesInvariance, RanksAndRestartsChangeNothing) {
  static const Places alone = drain(1, 0.0);
  EXPECT_GT(alone.count(3000005), 0u);
  for (const double restart : {0.0, 0.7, 1.2}) EXPECT_TRUE(drain(GetParam(), restart) == alone) << restart;
}

INSTANTIATE_TEST_SUITE_P(Ranks, GrainChangesInvariance,
                         testing::ValuesIn(scenes::sanitized() ? std::vector<int>{3} : std::vector<int>{1, 2, 3, 6}));

/// Two layers of the packing go, just below where two of the ranks meet: whoever stood on them comes down.
TEST(GrainChangesInvariance, WhoeverLosesItsGroundOnAnotherRankComesDown) {
  const auto rest = [](int ranks) {
    Places outcome;
    std::mutex mutex;
    scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
      const bool brings = communicator->rank() == 0;
      const auto drainage = windowed(brings ? filling() : std::vector<Grain>{}, communicator);
      GrainChanges changes;
      for (const Grain& grain : filling())
        if (brings && grain.position.z() >= 5.0 && grain.position.z() < 6.5) changes.gone.push_back(grain.id);
      drainage->change_grains(changes);
      const std::lock_guard<std::mutex> lock(mutex);
      for (const auto& [id, grain] : places(*drainage)) outcome.emplace(id, grain);
    });
    return outcome;
  };
  const Places alone = rest(1);
  for (const auto& [id, grain] : alone) EXPECT_LT(grain.position.z(), 13.5) << id << " has not come down";
  EXPECT_TRUE(rest(6) == alone);
}

/// Last corrections and counts of unrelaxed moves of all others stay: a grain that lies where nobody comes by changes
/// nothing when it goes.
TEST(GrainChangesInvariance, OthersGoOnAsIfNothingHadHappened) {
  auto grains = filling();
  const Grain far{77777, {5.5, 3.5, 60.0}, true}, near{77778, {-5.5, 3.5, 50.0}, true};
  grains.push_back(far);
  const auto kept = windowed(grains), changed = windowed(grains);
  for (const double time : {0.5, 1.0, 2.0}) {
    kept->advance_to(time);
    changed->advance_to(time);
    if (time == 0.5) changed->change_grains({{far.id}, {}});
    if (time == 1.0) changed->change_grains({{}, {near}});
  }
  Places others = places(*changed), expected = places(*kept);
  EXPECT_EQ(others.erase(near.id), 1u);
  EXPECT_EQ(expected.erase(far.id), 1u);
  EXPECT_TRUE(others == expected);
}

/// A grain that gets another id, and one that is held for a while, keep what is remembered of them.
TEST(GrainChangesInvariance, AnotherIdChangesNothingElse) {
  const auto kept = windowed(filling()), renamed = windowed(filling());
  kept->advance_to(1.0);
  renamed->advance_to(1.0);
  GrainChanges changes;
  for (const auto& [id, grain] : places(*renamed)) {
    changes.gone.push_back(id);
    changes.come.push_back({id + 5000, grain.position});
  }
  renamed->change_grains(changes);
  kept->advance_to(2.0);
  renamed->advance_to(2.0);
  const Places expected = places(*kept), found = places(*renamed);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [id, grain] : expected) EXPECT_EQ(found.at(id + 5000).position, grain.position) << id;
}

TEST(GrainChangesUnit, AHeldGrainStaysAndGoesOnWhenItIsHeldNoMore) {
  for (const bool order : {false, true}) {
    std::unique_ptr<spot::Drainage> drainage;
    if (order)
      drainage = time_ordered(filling());
    else
      drainage = windowed(filling());
    std::int64_t id = 0;  // over the orifice
    for (const auto& [other, grain] : places(*drainage))
      if ((grain.position - Vector3(0, 0, 6)).norm() < 0.9) id = other;
    ASSERT_NE(id, 0);
    Grain grain = places(*drainage).at(id);
    grain.held = true;
    drainage->change_grains({{id}, {grain}});
    drainage->advance_to(0.5);
    EXPECT_EQ(places(*drainage).at(id), grain);
    grain.held = false;
    drainage->change_grains({{id}, {grain}});
    drainage->advance_to(1.0);
    EXPECT_LT(places(*drainage).at(id).position.z(), grain.position.z() - 0.05);
  }
}

/// Both drivers put grains into the same places.
TEST(GrainChangesInvariance, BothDriversAgree) {
  const auto one = windowed(filling());
  const auto other = time_ordered(filling());
  const GrainChanges changes = {{100, 101, 102, 700}, events()[0].come};
  one->change_grains(changes);
  other->change_grains(changes);
  const Places a = places(*one), b = places(*other);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [id, grain] : a) EXPECT_LT((b.at(id).position - grain.position).norm(), 1e-6) << id;
}

TEST(GrainChangesUnit, WhatCannotBeIsNamed) {
  const auto refused = [](const GrainChanges& changes) {
    return scenes::text_of<InvalidPacking>([&] { windowed(filling())->change_grains(changes); });
  };
  const Vector3 high(0.0, 0.0, 20.0);
  EXPECT_THAT(refused({{}, {{9000, {7.0, 0.0, 20.0}}}}), AllOf(HasSubstr("grain 9000 "), HasSubstr("outside")));
  EXPECT_THAT(refused({{}, {{9000, {0.0, 0.0, 200.0}}}}), AllOf(HasSubstr("grain 9000 "), HasSubstr("beyond")));
  EXPECT_THAT(refused({{}, {{9000, high}, {9000, {2.0, 0.0, 20.0}}}}), HasSubstr("grain 9000 comes twice"));
  EXPECT_THAT(refused({{}, {{100, high}}}), HasSubstr("grain 100 is there already"));
  EXPECT_THAT(refused({{123456}, {}}), HasSubstr("not there"));
  const Vector3 there = filling()[299].position;
  EXPECT_THAT(refused({{}, {{9000, there + Vector3(0.1, 0.0, 0.0)}}}),
              AllOf(HasSubstr("9000 overlap by 0.9"), HasSubstr("at most 0.03")));
}

}  // namespace
