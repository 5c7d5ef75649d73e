// SPDX-License-Identifier: GPL-2.0-or-later
// Rates of births that are changed during a run, held against schedules that have known the changes all the time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/base/random.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/walk/next_birth.hpp"
#include "spot/walk/outflow_control.hpp"

namespace {

using spot::Bytes;
using spot::Drainage;
using spot::Grain;
using spot::Injection;
using spot::InvalidParameter;
using spot::Orifice;
using spot::RateSchedule;
using spot::RateStep;
using spot::SpotParameters;
using spot::WindowedDrainage;
using testing::AllOf;
using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(ChangedRatesUnit, ARateHoldsFromItsTimeOn) {
  RateSchedule rate({{0.0, 2.0}, {1.0, 3.0}, {4.0, 5.0}});
  EXPECT_TRUE(rate.change(2.0, 0.0)) << "instead of what was to come";
  EXPECT_EQ(rate.births(0.0, 10.0), 2.0 + 3.0);
  EXPECT_FALSE(rate.change(3.0, 0.0));
  EXPECT_TRUE(rate.change(2.0, 3.0)) << "at the same time once more";
  EXPECT_EQ(rate.steps().size(), 2u) << "no step that changes nothing";
  EXPECT_TRUE(rate.change(0.0, 7.0));
  EXPECT_EQ(rate.births(0.0, 2.0), 14.0);
}

TEST(ChangedRatesUnit, WhatIsForgottenCountsAsWhatCameLater) {
  RateSchedule rate({{0.0, 2.0}, {1.0, 3.0}, {4.0, 5.0}});
  rate.forget_before(1.5);
  EXPECT_EQ(rate.at(0.0), 3.0);
  EXPECT_EQ(rate.births(1.5, 5.0), 7.5 + 5.0);
  rate.forget_before(4.0);
  EXPECT_EQ(rate.steps().size(), 1u);
  EXPECT_EQ(rate.at(0.0), 5.0);
}

TEST(ChangedRatesUnit, RefusesOutletsAndRatesThatThereAreNot) {
  Injection rates({RateSchedule(1.0), RateSchedule(2.0)});
  const auto refusal = [&](std::size_t outlet, double rate) {
    return scenes::text_of<InvalidParameter>([&] { rates.change(outlet, 1.0, rate); });
  };
  EXPECT_THAT(refusal(2, 1.0), AllOf(HasSubstr("no outlet 3"), HasSubstr("from 1 to 2")));
  for (const double bad : {-1.0, infinity, std::nan("")})
    EXPECT_THAT(refusal(1, bad), AllOf(HasSubstr("at outlet 2 from time 1"), HasSubstr("finite and not negative")));
  EXPECT_EQ(rates.at(1, 1.0), 2.0) << "and changes nothing then";
}

TEST(NextBirthAnalytic, WhatWasExpectedBeforeAChangeCounts) {
  const Injection slow = 1.0, fast = 4.0, none = 0.0;
  spot::NextBirth birth;
  birth.await(0.0, 3.0, slow, {1.0});
  EXPECT_EQ(birth.time(), 3.0);
  birth.change(1.0, slow, fast);
  EXPECT_EQ(birth.time(), 1.5);
  birth.change(1.25, fast, none);
  EXPECT_EQ(birth.time(), infinity);
  birth.change(7.0, none, slow);
  EXPECT_EQ(birth.time(), 8.0);
  birth.await(8.0, 1.0, slow, {2.0});
  EXPECT_EQ(birth.time(), 8.5) << "factors multiply rates";
  birth.change(8.25, slow, fast);
  EXPECT_EQ(birth.time(), 8.25 + 0.5 / 8.0);
}

/// Births at both outlets, one of which is changed in steps.
TEST(NextBirthInvariance, BirthsAreThoseOfASchedule) {
  const std::vector<RateStep> steps = {{0.0, 3.0}, {0.7, 0.0}, {1.9, 11.0}, {2.0, 0.1}, {2.3, 7.0}};
  const RateSchedule other({{0.0, 1.0}, {1.5, 0.0}, {2.1, 2.0}});
  const Injection all_known({RateSchedule(steps), other});
  Injection rates({RateSchedule(steps[0].rate), other});
  std::size_t next = 1;
  spot::NextBirth birth;
  double before = 0.0;
  for (std::uint64_t id = 0; before < 20.0; ++id) {
    const double expected = spot::exponential(spot::uniform(5, spot::RandomPurpose::birth, id, 0)[0], 1.0);
    birth.await(before, expected, rates, {1.0, 1.0});
    while (next < steps.size() && birth.time() >= steps[next].time) {
      Injection changed = rates;
      changed.change(0, steps[next].time, steps[next].rate);
      birth.change(steps[next++].time, rates, changed);
      rates = changed;
    }
    ASSERT_EQ(birth.time(), all_known.next_birth(before, expected)) << id;
    before = birth.time();
  }
  EXPECT_EQ(next, steps.size());
}

// Silos with two outlets, of which the second opens and closes.

constexpr double window = 0.05, opens = 1.0, closes = 2.0, rate = 400.0;
const spot::DrainageLimits limits{-1.0};

std::shared_ptr<const spot::Container> silo() {
  return spot::box_silo(-11.0, 11.0, -4.0, 4.0,
                        spot::Outlets({Orifice{{-6.0, 0.0, 0.0}, 3.5}, Orifice{{6.0, 0.0, 0.0}, 3.5}}),
                        spot::SpotBuffers{1.0, 2.6});
}

SpotParameters spots(const RateSchedule& second, bool holds_outflow) {
  SpotParameters spots = scenes::paper_spots();
  spots.step_height = 0.4;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spots.fixed_volume = 77;
  spots.injection_rate = Injection({RateSchedule(300.0), second});
  spots.holds_outflow = holds_outflow;
  return spots;
}

const RateSchedule schedule({{0.0, 0.0}, {opens, rate}, {closes, 0.0}});

/// Of the second outlet, as somebody who looks at the clock before each window would have it.
double rate_at(double time) { return time > opens - 1e-9 && time < closes - 1e-9 ? rate : 0.0; }

void advance(Drainage& drainage, double from, double until, bool change) {
  const int last = static_cast<int>(until / window + 0.5);
  for (int k = static_cast<int>(from / window + 0.5); k < last; ++k) {
    if (change) drainage.change_rate(1, k * window, rate_at(k * window));
    drainage.advance_to((k + 1) * window);
  }
}

std::vector<Grain> filling() { return scenes::dense_grains({-10.5, -3.5, 0.5}, {10.5, 3.5, 8.0}, 0.01, 3); }

struct Outcome {
  std::map<std::int64_t, Grain> grains;
  std::map<std::int64_t, double> spots;  // next steps
  std::vector<Bytes> saved;

  bool operator==(const Outcome& other) const { return grains == other.grains && spots == other.spots; }
};

template <typename StartOfRank>
Outcome drain(const SpotParameters& spots, bool change, int ranks, double from, double until,
              const StartOfRank& start_of_rank) {
  Outcome outcome;
  outcome.saved.resize(static_cast<std::size_t>(ranks));
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    WindowedDrainage drainage(spots, {}, limits, window, 1, silo(), 1.0, 100.0, start_of_rank(communicator->rank()),
                              communicator);
    advance(drainage, from, until, change);
    const std::lock_guard<std::mutex> lock(mutex);
    drainage.visit_grains([&](const Grain& grain) { outcome.grains.emplace(grain.id, grain); });
    for (const spot::Spot& spot : drainage.spots()) outcome.spots.emplace(spot.id, spot.next_step);
    outcome.saved[static_cast<std::size_t>(communicator->rank())] = drainage.save();
  });
  return outcome;
}

Outcome drain(const SpotParameters& spots, bool change, int ranks = 1, double until = 3.0) {
  return drain(spots, change, ranks, 0.0, until, [](int rank) { return rank == 0 ? filling() : std::vector<Grain>{}; });
}

class ChangedRatesInvariance : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(HoldsOutflow, ChangedRatesInvariance, testing::Bool());

TEST_P(ChangedRatesInvariance, SilosDrainAsByASchedule) {
  const Outcome scheduled = drain(spots(schedule, GetParam()), false);
  const SpotParameters constant = spots(rate, GetParam());
  ASSERT_LT(scheduled.grains.size() + 50, filling().size());
  EXPECT_TRUE(drain(constant, true) == scheduled);
  EXPECT_TRUE(drain(constant, true, 3) == scheduled) << "on ranks";
  for (const double time : {0.5, opens, opens + window, 2.5}) {
    const Outcome first = drain(constant, true, 2, time);
    EXPECT_TRUE(drain(constant, true, 1, time, 3.0, [&](int) { return first.saved; }) == scheduled)
        << "saved at " << time;
  }
}

TEST_P(ChangedRatesInvariance, SilosDrainAsByAScheduleInTheOrderOfTime) {
  const auto start = [&](const RateSchedule& second) {
    return spot::TimeOrderedDrainage(spots(second, GetParam()), {}, limits, silo(),
                                     spot::Packing(1.0, 100.0, filling()));
  };
  spot::TimeOrderedDrainage scheduled = start(schedule), changed = start(rate);
  advance(scheduled, 0.0, 1.5, false);
  advance(changed, 0.0, 1.25, true);
  spot::TimeOrderedDrainage rest(spots(rate, GetParam()), {}, limits, silo(), 1.0, 100.0, changed.save());
  advance(rest, 1.25, 1.5, true);
  EXPECT_EQ(rest.grains(), scheduled.grains());
  ASSERT_EQ(rest.spots().size(), scheduled.spots().size());
  for (std::size_t k = 0; k < rest.spots().size(); ++k)
    EXPECT_EQ(rest.spots()[k].next_step, scheduled.spots()[k].next_step);
}

TEST_P(ChangedRatesInvariance, TheSameRateOnceMoreChangesNothing) {
  const SpotParameters constant = spots(rate, GetParam());
  WindowedDrainage left_alone(constant, {}, limits, window, 1, silo(), 1.0, 100.0, filling());
  WindowedDrainage told(constant, {}, limits, window, 1, silo(), 1.0, 100.0, filling());
  for (int k = 0; k < 20; ++k) {
    told.change_rate(0, k * window, 300.0);
    told.change_rate(1, k * window, rate);
    told.advance_to((k + 1) * window);
    left_alone.advance_to((k + 1) * window);
  }
  EXPECT_EQ(told.save(), left_alone.save());
}

TEST(ChangedRatesUnit, RatesThatNoRelaxationCouldFollowAreRefusedAndChangeNothing) {
  WindowedDrainage drainage(spots(rate, false), {}, limits, window, 1, silo(), 1.0, 100.0, filling());
  const Bytes before = drainage.save();
  const auto refusal = [&](double too_many) {
    return scenes::text_of<InvalidParameter>([&] { drainage.change_rate(1, 0.0, too_many); });
  };
  EXPECT_THAT(refusal(1e6), AllOf(HasSubstr("diameters pass the orifice"), HasSubstr("shorten the window")));
  EXPECT_THAT(refusal(1e9), HasSubstr("births while a spot climbs one diameter"));
  EXPECT_THAT(refusal(-1.0), HasSubstr("must be finite and not negative"));
  EXPECT_EQ(drainage.save(), before);
}

/// A rate that goes up and down all the time: what is asked for is still known R_s / v_s later, and no more.
TEST(ChangedRatesUnit, OutflowControlRemembersWhatItAsksForLater) {
  const SpotParameters parameters = spots(rate, true);
  const double end = 40.0, step = 0.1;
  std::vector<RateStep> steps;
  for (int k = 0; k * step < end; ++k) steps.push_back({k * step, k == 0 ? rate : (0.1 + 0.9 * (k % 7) / 6) * rate});
  SpotParameters all_known = parameters;
  all_known.injection_rate = Injection({RateSchedule(300.0), RateSchedule(steps)});
  spot::OutflowControl known(all_known, *silo(), 1.0), told(parameters, *silo(), 1.0);
  spot::Alone alone;
  for (const RateStep& now : steps) {
    Injection births = told.births();
    births.change(1, now.time, now.rate);
    told.change(now.time, births);
    for (spot::OutflowControl* control : {&known, &told}) {
      control->update(now.time, alone);
      control->count(1, 3 * 1024);
    }
    ASSERT_EQ(told.factors(), known.factors()) << now.time;
  }
  EXPECT_NE(told.factors()[1], 1.0);
  Bytes saved;
  told.births().save(saved);
  EXPECT_LT(saved.size(), 60 * sizeof(RateStep));
}

}  // namespace
