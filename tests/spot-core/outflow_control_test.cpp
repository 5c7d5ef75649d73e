// SPDX-License-Identifier: GPL-2.0-or-later
// Births that follow what leaves: by themselves, held against what is asked for, and in silos that drain.
#include "spot/walk/outflow_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <type_traits>
#include <vector>

#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/walk/calibration.hpp"

namespace {

using spot::Alone;
using spot::Orifice;
using spot::OutflowControl;
using spot::Outlets;
using spot::RateSchedule;
using spot::SpotParameters;
using testing::Each;
using testing::ElementsAre;

constexpr double rate = 60.0, interval = 0.5;  // of births at an outlet, and between calls

SpotParameters spots_at(const spot::Injection& injection) {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = 1e-2;
  spots.fixed_volume = 77;
  spots.speed = 5.0;
  spots.injection_rate = injection;
  spots.holds_outflow = true;
  return spots;
}

spot::Injection two_outlets(std::vector<spot::RateStep> second) {
  return spot::Injection({RateSchedule(rate), RateSchedule(std::move(second))});
}

const spot::WalledContainer& space() {
  static const spot::WalledContainer space(Outlets({Orifice{{-6.0, 0.0, 0.0}, 4.0}, Orifice{{6.0, 0.0, 0.0}, 4.0}}));
  return space;
}

double memory_time(const SpotParameters& spots) {
  return spot::calibration::climb_of_flow_memory * spots.radius / spots.speed;
}

/// Through two outlets, of which each lets out this share of what births carry. Returns the grains that left in the
/// last `counted` of the time.
std::vector<double> deliver(OutflowControl& control, const SpotParameters& spots, const std::vector<double>& shares,
                            double from, double until, double counted) {
  const double volume_of_birth = spots.influence * spots.fixed_volume;  // grains
  std::vector<double> left(2, 0.0), grains(2, 0.0);
  Alone alone;
  for (double time = from; time < until; time += interval) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double births = control.factors()[k] * spots.injection_rate.expected_births(k, time, time + interval);
      left[k] += shares[k] * births * volume_of_birth;
      const double whole = std::floor(left[k]);
      left[k] -= whole;
      control.count(k, static_cast<std::int64_t>(whole) * 1024);
      if (time >= until - counted) grains[k] += whole;
    }
    control.update(time + interval, alone);
  }
  return grains;
}

TEST(OutflowControlUnit, NothingIsChangedWhereItIsOff) {
  SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  spots.holds_outflow = false;
  OutflowControl control(spots, space(), 1.0);
  EXPECT_FALSE(control.on());
  deliver(control, spots, {0.5, 0.5}, 0.0, 20.0, 1.0);
  EXPECT_THAT(control.factors(), ElementsAre(1.0, 1.0));
}

TEST(OutflowControlAnalytic, OutflowComesToWhatIsAskedForAndBirthsToThatOverTheShareThatLeaves) {
  const SpotParameters spots = spots_at(two_outlets({{0.0, 0.5 * rate}}));
  OutflowControl control(spots, space(), 1.0);
  const double end = 30.0 * memory_time(spots), counted = 10.0 * memory_time(spots);
  const auto grains = deliver(control, spots, {0.9, 0.75}, 0.0, end, counted);
  const double asked = rate * spots.influence * spots.fixed_volume * counted;
  EXPECT_NEAR(grains[0], asked, 2.0 + 1e-3 * asked);
  EXPECT_NEAR(grains[1], 0.5 * asked, 2.0 + 1e-3 * asked);
  EXPECT_NEAR(control.factors()[0], 1.0 / 0.9, 0.01);
  EXPECT_NEAR(control.factors()[1], 1.0 / 0.75, 0.01);
}

TEST(OutflowControlUnit, AnOutletThatIsClosedHasNoneAskedForAndLearnsNothing) {
  const double closed = 20.0;
  const SpotParameters spots = spots_at(two_outlets({{0.0, rate}, {closed, 0.0}}));
  OutflowControl control(spots, space(), 1.0);
  deliver(control, spots, {0.9, 0.9}, 0.0, closed + 10.0, 1.0);
  EXPECT_GT(control.factors()[0], 1.05);
  EXPECT_EQ(control.factors()[1], 1.0);
}

TEST(OutflowControlUnit, WhatAnEmptySiloLackedIsNotMadeGoodWithoutABound) {
  const SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  OutflowControl control(spots, space(), 1.0);
  const double empty = 20.0 * memory_time(spots);
  deliver(control, spots, {0.0, 0.0}, 0.0, empty, 1.0);
  EXPECT_THAT(control.factors(), Each(1.0 + spot::calibration::largest_outflow_correction));
  deliver(control, spots, {1.0, 1.0}, empty, empty + 8.0 * memory_time(spots), 1.0);
  EXPECT_THAT(control.factors(), Each(testing::DoubleNear(1.0, 0.01)));
}

TEST(OutflowControlUnit, CallsWithinAnIntervalChangeNothing) {
  const SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  Alone alone;
  OutflowControl often(spots, space(), 1.0), seldom(spots, space(), 1.0);
  const double least = spot::calibration::climb_between_surfaces * spots.radius / spots.speed;
  for (int k = 0; k <= 400; ++k) {
    often.update(k * least / 4.0, alone);
    if (k % 4 == 0) seldom.update(k / 4 * least, alone);
    often.count(0, 1024);
    seldom.count(0, 1024);
  }
  EXPECT_EQ(often.factors(), seldom.factors());
  EXPECT_NE(often.factors()[0], 1.0);
}

/// A bed with a flat surface at this height.
spot::FreeSurface surface_at(double height, const SpotParameters& spots) {
  spot::FreeSurface surface(spots, space(), 1.0);
  for (double x = -20.0; x <= 20.0; x += 0.5)
    for (double y = -10.0; y <= 10.0; y += 0.5) surface.add({x, y, height});
  Alone alone;
  surface.gather(alone);
  return surface;
}

TEST(OutflowControlAnalytic, WhatIsAskedForFadesWithTheDepthOfTheBed) {
  SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  spots.fade = 0.25;  // of a width of 8
  OutflowControl control(spots, space(), 1.0);
  control.fade(spot::FreeSurface(spots, space(), 1.0));
  EXPECT_THAT(control.factors(), Each(1.0));  // nobody knows yet
  for (const double height : {40.0, 8.0, 4.5, 2.5, 1.0}) {
    control.fade(surface_at(height, spots));
    EXPECT_THAT(control.factors(), Each(testing::DoubleNear(1.0 - std::exp(-(height - 0.5) / 2.0), 1e-9))) << height;
  }
  control.fade(surface_at(0.4, spots));
  EXPECT_THAT(control.factors(), Each(spot::calibration::least_outflow_share));
}

TEST(OutflowControlAnalytic, OutflowComesToItsShareOfWhatIsAskedFor) {
  SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  spots.fade = 0.25;
  OutflowControl control(spots, space(), 1.0);
  control.fade(surface_at(2.5, spots));
  const double end = 30.0 * memory_time(spots), counted = 10.0 * memory_time(spots);
  const auto grains = deliver(control, spots, {0.9, 0.9}, 0.0, end, counted);
  const double asked = (1.0 - std::exp(-1.0)) * rate * spots.influence * spots.fixed_volume * counted;
  EXPECT_NEAR(grains[0], asked, 2.0 + 1e-3 * asked);
}

TEST(OutflowControlUnit, SharesAreSaved) {
  SpotParameters spots = spots_at(two_outlets({{0.0, rate}}));
  spots.fade = 0.25;
  OutflowControl control(spots, space(), 1.0), other(spots, space(), 1.0);
  control.fade(surface_at(2.5, spots));
  spot::Bytes saved;
  control.save(saved);
  spot::ByteReader reader(saved);
  other.restore(reader, true);
  EXPECT_EQ(control.factors(), other.factors());
}

/// The outflow over some time, in grains, of a silo whose orifice, 5.4 d wide, loses a part of what spots bring.
template <typename Driver>
double outflow_over(const SpotParameters& spots, double from, double until) {
  const std::shared_ptr<const spot::Container> silo =
      spot::box_silo(-6.0, 6.0, -4.0, 4.0, Orifice{{0.0, 0.0, 0.0}, 2.7}, spot::SpotBuffers{1.0, 2.6});
  const std::vector<spot::Grain> grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 24.0}, 0.01, 2);
  const auto drained = [&](spot::Drainage& drainage) {
    drainage.advance_to(from);
    const auto before = drainage.counters().drained;
    drainage.advance_to(until);
    return static_cast<double>(drainage.counters().drained - before) / (until - from);
  };
  if constexpr (std::is_same_v<Driver, spot::WindowedDrainage>) {
    spot::WindowedDrainage drainage(spots, {}, spot::DrainageLimits{-1.0}, 0.05, 1, silo, 1.0, 100.0, grains);
    return drained(drainage);
  } else {
    spot::TimeOrderedDrainage drainage(spots, {}, spot::DrainageLimits{-1.0}, silo, spot::Packing(1.0, 100.0, grains));
    return drained(drainage);
  }
}

template <typename Driver>
class OutflowControlStatistical : public testing::Test {};
using Drivers = testing::Types<spot::WindowedDrainage, spot::TimeOrderedDrainage>;
TYPED_TEST_SUITE(OutflowControlStatistical, Drivers);

TYPED_TEST(OutflowControlStatistical, ANarrowOrificeLetsOutWhatIsAskedFor) {
  SpotParameters spots = spots_at(30.0);
  spots.step_height = 0.8;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  const double asked = 30.0 * spots.influence * spots.fixed_volume;
  const double held = outflow_over<TypeParam>(spots, 10.0, 40.0);
  spots.holds_outflow = false;
  const double left_alone = outflow_over<TypeParam>(spots, 10.0, 40.0);
  std::printf("asked for %.2f /tau, held %.2f, left alone %.2f\n", asked, held, left_alone);
  EXPECT_NEAR(held, asked, 0.02 * asked);
  EXPECT_LT(left_alone, 0.97 * asked);
}

}  // namespace
