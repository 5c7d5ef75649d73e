// SPDX-License-Identifier: GPL-2.0-or-later
// Silos that drain through two outlets, of which one is closed for some time, and through a slot.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "invariants.hpp"
#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using spot::Bytes;
using spot::Drainage;
using spot::Grain;
using spot::Injection;
using spot::Outlet;
using spot::Outlets;
using spot::RateSchedule;
using spot::Spot;
using spot::SpotParameters;
using spot::Vector3;
using spot::WindowedDrainage;

constexpr double window = 0.05;
const spot::DrainageLimits limits{0.0};

/// A round hole at the left that is always open, and a slot at the right that opens at 1 and closes at 2.
constexpr double opens = 1.0, closes = 2.0;

std::shared_ptr<const spot::Container> silo() {
  return spot::box_silo(
      -11.0, 11.0, -4.0, 4.0,
      Outlets({spot::Orifice{{-6.0, 0.0, 0.0}, 3.5}, Outlet({6.0, 0.0, 0.0}, std::make_shared<spot::Slot>(6.0, 7.0))}),
      spot::SpotBuffers{1.0, 2.6});
}

SpotParameters spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.step_height = 0.4;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spots.fixed_volume = 77;
  spots.injection_rate = Injection({300.0, RateSchedule({{0.0, 0.0}, {opens, 600.0}, {closes, 0.0}})});
  return spots;
}

std::vector<Grain> filling() { return scenes::dense_grains({-10.5, -3.5, 0.5}, {10.5, 3.5, 8.0}, 0.01, 3); }

spot::RelaxationParameters relaxation() {
  spot::RelaxationParameters parameters;
  parameters.momentum = 0.6;
  return parameters;
}

template <typename Start>
WindowedDrainage windowed(const Start& start, int threads, std::shared_ptr<spot::Communicator> ranks) {
  return {spots(), relaxation(), limits, window, threads, silo(), 1.0, 100.0, start, std::move(ranks)};
}

WindowedDrainage windowed() { return windowed(filling(), 1, std::make_shared<spot::Alone>()); }

spot::TimeOrderedDrainage time_ordered() {
  const auto container = silo();
  return {spots(), {}, limits, container, spot::Packing(1.0, 100.0, filling())};
}

/// How many spots are on the side of each outlet.
std::array<int, 2> count_by_side(const std::vector<Spot>& all) {
  std::array<int, 2> counts = {0, 0};
  for (const Spot& spot : all) ++counts[spot.position.x() < 0.0 ? 0 : 1];
  return counts;
}

/// Every invariant, at many times; and where spots and grains are.
void follow(Drainage& drainage, double end) {
  const auto container = silo();
  invariants::Ledger ledger(drainage.grains(), 1.0, limits, *container);
  std::array<int, 2> drained = {0, 0}, drained_at_close = {0, 0};
  std::map<std::int64_t, Vector3> standing;  // of the closed slot
  const int windows = static_cast<int>(end / window + 0.5);
  for (int k = 1; k <= windows; ++k) {
    const double time = k * window;
    std::map<std::int64_t, Grain> left;
    for (const Grain& grain : drainage.grains()) left.emplace(grain.id, grain);
    drainage.advance_to(time);
    ASSERT_EQ(ledger.check(drainage), "") << "at " << time;
    for (const Grain& grain : drainage.grains()) left.erase(grain.id);
    for (const auto& [id, grain] : left) {
      const std::size_t side = grain.position.x() < 0.0 ? 0 : 1;
      EXPECT_LT(container->outlets()[side].distance(grain.position), 1.0) << "it was between the outlets before";
      ++drained[side];
    }
    const auto spots_of_side = count_by_side(drainage.spots());
    EXPECT_GT(spots_of_side[0], 0);
    if (time <= opens) {
      EXPECT_EQ(drained[1], 0) << "closed at " << time;
      EXPECT_EQ(spots_of_side[1], 0) << "closed at " << time;
    }
    if (time <= closes) drained_at_close = drained;
    EXPECT_EQ(drained[1], drained_at_close[1]) << "closed again at " << time;
    if (time > closes)
      for (const Spot& spot : drainage.spots()) {
        if (spot.outlet == 0) continue;
        const auto [before, is_new] = standing.emplace(spot.id, spot.position);
        EXPECT_EQ(spot.position, before->second) << "it goes on behind a closed outlet";
        EXPECT_TRUE(!is_new || time < closes + 1.5 * window);
      }
  }
  EXPECT_GT(drained_at_close[0], 20);
  EXPECT_GT(drained_at_close[1], 20);
  EXPECT_GT(standing.size(), 20u);
  if (end > closes + 4.0) {
    EXPECT_GT(drained[0], drained_at_close[0] + 50);
  }
}

TEST(SeveralOutletsUnit, GrainsLeaveBelowThoseThatAreOpen) {
  WindowedDrainage drainage = windowed();
  follow(drainage, 8.0);
}

TEST(SeveralOutletsUnit, GrainsLeaveBelowThoseThatAreOpenInTheOrderOfTime) {
  spot::TimeOrderedDrainage drainage = time_ordered();
  follow(drainage, 2.5);
}

/// All that there is at the end.
struct Outcome {
  std::map<std::int64_t, Grain> grains, drained;
  std::map<std::int64_t, Spot> spots;
  std::vector<Bytes> saved;
};

template <typename StartOfRank>
Outcome drain(int ranks, int threads, double time, const StartOfRank& start_of_rank) {
  Outcome outcome;
  outcome.saved.resize(static_cast<std::size_t>(ranks));
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    WindowedDrainage drainage = windowed(start_of_rank(communicator->rank()), threads, communicator);
    drainage.advance_to(time);
    const std::lock_guard<std::mutex> lock(mutex);
    drainage.visit_grains([&](const Grain& grain) { outcome.grains.emplace(grain.id, grain); });
    for (const Grain& grain : drainage.take_drained()) outcome.drained.emplace(grain.id, grain);
    for (const Spot& spot : drainage.spots()) outcome.spots.emplace(spot.id, spot);
    outcome.saved[static_cast<std::size_t>(communicator->rank())] = drainage.save();
  });
  return outcome;
}

Outcome drain(int ranks, int threads, double time) {
  return drain(ranks, threads, time, [&](int rank) { return rank == 0 ? filling() : std::vector<Grain>{}; });
}

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.grains, b.grains);
  ASSERT_EQ(a.spots.size(), b.spots.size());
  for (const auto& [id, spot] : a.spots) {
    ASSERT_TRUE(b.spots.count(id)) << id;
    EXPECT_EQ(spot.position, b.spots.at(id).position) << id;
    EXPECT_EQ(spot.next_step, b.spots.at(id).next_step) << id;
  }
}

TEST(SeveralOutletsInvariance, RanksAndThreadsChangeNothing) {
  const Outcome alone = drain(1, 1, 2.5);
  ASSERT_GT(alone.drained.size(), 50u);
  for (const auto& [ranks, threads] : {std::pair(1, 3), std::pair(3, 1)}) {
    const Outcome shared = drain(ranks, threads, 2.5);
    expect_same(shared, alone);
    EXPECT_EQ(shared.drained, alone.drained);
  }
}

/// Within each step of a schedule, saved on one number of ranks and gone on from on another.
TEST(SeveralOutletsInvariance, SavedRunsGoOnInTheMiddleOfASchedule) {
  const Outcome whole = drain(1, 1, 2.5);
  for (const double time : {0.5, 1.5, 2.25}) {
    const Outcome first = drain(2, 1, time);
    const Outcome second = drain(1, 1, 2.5, [&](int) { return first.saved; });
    expect_same(second, whole);
  }
}

TEST(SeveralOutletsInvariance, SavedRunsGoOnInTheOrderOfTime) {
  spot::TimeOrderedDrainage whole = time_ordered(), first = time_ordered();
  first.advance_to(1.25);
  spot::TimeOrderedDrainage second(spots(), {}, limits, silo(), 1.0, 100.0, first.save());
  whole.advance_to(1.5);
  second.advance_to(1.5);
  EXPECT_EQ(second.grains(), whole.grains());
  EXPECT_EQ(second.save(), whole.save());
}

/// Those of a gate that shuts between 0.5 and 1, and the heights of its spots then and later.
template <typename Make>
void expect_to_go_on(const Make& make) {
  SpotParameters parameters = spots();
  parameters.injection_rate = Injection({300.0, RateSchedule({{0.0, 600.0}, {0.5, 0.0}, {1.0, 600.0}})});
  const auto drainage = make(parameters);
  const auto heights = [&](double time) {
    drainage->advance_to(time);
    std::map<std::int64_t, double> of_spots;
    for (const Spot& spot : drainage->spots())
      if (spot.outlet == 1) of_spots.emplace(spot.id, spot.position.z());
    return of_spots;
  };
  const auto closed = heights(0.5), opened = heights(1.0), later = heights(1.5);
  EXPECT_GT(closed.size(), 20u);
  EXPECT_EQ(opened, closed);
  double climbed = 0.0;
  for (const auto& [id, height] : closed)
    if (later.count(id)) climbed += (later.at(id) - height) / static_cast<double>(closed.size());
  EXPECT_GT(climbed, 0.5 * 0.5 * parameters.speed);
}

TEST(SeveralOutletsUnit, SpotsGoOnOnceTheirGateHasOpenedAgain) {
  expect_to_go_on([](const SpotParameters& parameters) {
    return std::make_unique<WindowedDrainage>(parameters, relaxation(), limits, window, 1, silo(), 1.0, 100.0,
                                              filling());
  });
  expect_to_go_on([](const SpotParameters& parameters) {
    return std::make_unique<spot::TimeOrderedDrainage>(parameters, spot::RelaxationParameters{}, limits, silo(),
                                                       spot::Packing(1.0, 100.0, filling()));
  });
}

TEST(SeveralOutletsUnit, ASlotDrains) {
  const std::shared_ptr<const spot::Container> container =
      spot::box_silo(-6.0, 6.0, -4.0, 4.0, Outlet({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(6.0, 8.0)),
                     spot::SpotBuffers{1.0, 2.6});
  SpotParameters one = spots();
  one.injection_rate = 200.0;
  const auto grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.01, 4);
  WindowedDrainage drainage(one, relaxation(), limits, window, 1, container, 1.0, 100.0, grains);
  invariants::Ledger ledger(grains, 1.0, limits, *container);
  for (int k = 1; k <= 60; ++k) {
    drainage.advance_to(k * window);
    ASSERT_EQ(ledger.check(drainage), "") << k;
  }
  EXPECT_GT(ledger.drained(), 50u);
}

TEST(SeveralOutletsUnit, ASlotWithoutEndsDrainsAllAlong) {
  const spot::Periodic periodic(std::nullopt, spot::Interval{-5.0, 5.0});
  const std::shared_ptr<const spot::Container> container =
      spot::box_silo(spot::Interval{-6.0, 6.0}, std::nullopt, periodic,
                     Outlet({0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(6.0, 10.0)), spot::SpotBuffers{1.0, 2.6});
  SpotParameters one = spots();
  one.injection_rate = 250.0;
  const auto grains = scenes::dense_grains({-5.5, -4.5, 0.5}, {5.5, 4.5, 8.0}, 0.01, 4);
  WindowedDrainage drainage(one, relaxation(), limits, window, 1, container, 1.0, 100.0, grains);
  invariants::Ledger ledger(grains, 1.0, limits, *container);
  int at_ends = 0, in_middle = 0;
  for (int k = 1; k <= 60; ++k) {
    drainage.advance_to(k * window);
    ASSERT_EQ(ledger.check(drainage), "") << k;
    for (const spot::Spot& spot : drainage.spots()) ++(std::abs(spot.position.y()) > 2.5 ? at_ends : in_middle);
  }
  EXPECT_GT(ledger.drained(), 60u);
  // As many there as here; a few hundred spots, each seen in many windows.
  EXPECT_NEAR(at_ends, in_middle, 0.2 * (at_ends + in_middle));
}

TEST(SeveralOutletsUnit, GrainsMayBeInAnyOfThemAndNotBetween) {
  const spot::GrainChecks checks({-1.0}, silo(), 1.0);
  const auto refusal = [&](const Vector3& place) {
    return scenes::text_of<spot::InvalidPacking>([&] { checks.require_valid_place({7, place}); });
  };
  EXPECT_NO_THROW(checks.require_valid_place({7, {-6.0, 3.4, -0.5}}));
  EXPECT_NO_THROW(checks.require_valid_place({7, {8.9, 3.4, -0.5}})) << "in a corner of the slot";
  EXPECT_NE(refusal({0.0, 0.0, -0.5}).find("grain 7 at (0, 0, -0.5)"), std::string::npos);
  EXPECT_NO_THROW(checks.require_left_through_orifice({{1, {-6.0, 0.0, -1.1}}, {2, {9.0, 3.0, -1.1}}}));
  EXPECT_NO_THROW(checks.require_left_through_orifice({{1, {-2.3, 0.0, -0.05}}})) << "drawn past the rim by 0.2 d";
  EXPECT_THROW(checks.require_left_through_orifice({{1, {-2.2, 0.0, -0.05}}}), spot::CollapsedPacking);
  const std::string beside = scenes::text_of<spot::CollapsedPacking>([&] {
    checks.require_left_through_orifice({{1, {-6.0, 0.0, -1.1}}, {2, {1.5, 0.0, -1.1}}});
  });
  EXPECT_NE(beside.find("grain 2 at (1.5, 0, -1.1) left through the base, beside the slot of 6 by 7 at (6, 0, 0)"),
            std::string::npos)
      << beside;
}

TEST(SeveralOutletsUnit, ContainersAreReplacedByThoseWithAsManyOutlets) {
  WindowedDrainage drainage = windowed();
  const std::string refusal =
      scenes::text_of<spot::InvalidContainer>([&] { drainage.replace_container(scenes::small_silo(11.0, 4.0)); });
  EXPECT_NE(refusal.find("with 1 outlets cannot take the place of one with 2"), std::string::npos) << refusal;
  EXPECT_NO_THROW(drainage.replace_container(silo()));
}

/// Each outlet has its own largest flow in a window.
TEST(SeveralOutletsUnit, WindowsAreShortEnoughForTheLargestFlowOfAnyOutlet) {
  const auto container = silo();
  const SpotParameters parameters = spots();
  const auto flow = [&](double rate, const Outlet& outlet) {
    SpotParameters one = parameters;
    one.injection_rate = rate;
    return WindowedDrainage::flow_through_orifice(one, 1.0, 1.0, outlet);
  };
  const Outlets& outlets = container->outlets();
  const double first = flow(300.0, outlets[0]), second = flow(600.0, outlets[1]);
  EXPECT_EQ(WindowedDrainage::flow_through_orifice(parameters, 1.0, 1.0, outlets), std::max(first, second));
  EXPECT_NEAR(second / first, 2.0 * scenes::pi * 3.5 * 3.5 / 42.0, 1e-12);
  // Though the first step of the schedule would fit.
  const std::string refusal = scenes::text_of<spot::InvalidParameter>(
      [&] { WindowedDrainage(parameters, relaxation(), limits, 1.1 / second, 1, container, 1.0, 100.0, filling()); });
  EXPECT_NE(refusal.find("diameters pass the orifice"), std::string::npos) << refusal;
}

}  // namespace
