// SPDX-License-Identifier: GPL-2.0-or-later
// Births of spots at rates that change with time, at one outlet or several.
#include "spot/walk/injection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "scenes.hpp"
#include "spot/base/random.hpp"
#include "spot/geometry/slot.hpp"
#include "spot/walk/spot_walk.hpp"

namespace {

using spot::Injection;
using spot::InvalidParameter;
using spot::Orifice;
using spot::Outlet;
using spot::Outlets;
using spot::RateSchedule;
using spot::RateStep;
using spot::SpotParameters;
using spot::SpotWalk;
using testing::AllOf;
using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

RateSchedule schedule(std::vector<RateStep> steps) { return RateSchedule(std::move(steps)); }

Outlets two() {
  return Outlets({Orifice{{-6.0, 0.0, 0.0}, 4.0}, Outlet({6.0, 0.0, 0.0}, std::make_shared<spot::Slot>(8.0, 6.0))});
}

/// Time and outlet of every birth until a time.
struct Birth {
  double time;
  std::size_t outlet;
};

std::vector<Birth> births(const Injection& injection, std::uint64_t seed, double end) {
  const Outlets outlets = injection.outlets() == 1 ? Outlets(Orifice{{-6.0, 0.0, 0.0}, 4.0}) : two();
  const spot::WalledContainer space(outlets);
  SpotParameters spots = scenes::paper_spots();
  spots.injection_rate = injection;
  spots.seed = seed;
  const SpotWalk walk(spots, space);
  std::vector<Birth> all;
  double time = 0.0;
  for (std::int64_t id = 0; (time = injection.next_birth(time, walk.births_expected(id))) <= end; ++id) {
    const spot::Vector3 place = walk.birth(id, time, space).position;
    std::size_t outlet = 0;
    while (outlet < outlets.size() && outlets[outlet].distance(place) > -spots.radius + 1e-12) ++outlet;
    EXPECT_LT(outlet, outlets.size()) << "born beside all of them at " << place.transpose();
    EXPECT_EQ(place.z(), -spots.radius);
    all.push_back({time, outlet});
  }
  return all;
}

TEST(InjectionAnalytic, BirthsAreWhereTheIntegralOfTheRateIs) {
  const Injection injection({schedule({{0.0, 2.0}, {1.0, 0.0}, {3.0, 4.0}, {4.0, 0.0}})});
  EXPECT_EQ(injection.next_birth(0.0, 0.0), 0.0);
  EXPECT_EQ(injection.next_birth(0.0, 1.0), 0.5);
  EXPECT_EQ(injection.next_birth(0.25, 1.0), 0.75);
  EXPECT_EQ(injection.next_birth(0.0, 2.0), 3.0) << "not while it is closed";
  EXPECT_EQ(injection.next_birth(0.5, 2.0), 3.25);
  EXPECT_EQ(injection.next_birth(0.5, 5.0), infinity) << "closed for good";
  EXPECT_EQ(injection.next_birth(17.0, 1e-9), infinity);
  EXPECT_EQ(injection.next_birth(infinity, 1.0), infinity);
  EXPECT_EQ(injection.largest(), 4.0);
}

TEST(InjectionAnalytic, RatesOfOutletsAddUp) {
  const Injection injection({schedule({{0.0, 1.0}, {2.0, 0.0}}), schedule({{0.0, 0.0}, {1.0, 3.0}})});
  EXPECT_EQ(injection.next_birth(0.0, 3.0), 1.5);
  EXPECT_EQ(injection.next_birth(0.0, 8.0), 3.0);
  EXPECT_EQ(injection.largest(), 4.0);
  EXPECT_EQ(injection.largest(0), 1.0);
  EXPECT_EQ(injection.largest(1), 3.0);
  for (const double uniform : {0.0, 0.5, 1.0 - 1e-16}) {
    EXPECT_EQ(injection.outlet_of_birth(0.5, uniform), 0u);
    EXPECT_EQ(injection.outlet_of_birth(2.0, uniform), 1u);
  }
  EXPECT_EQ(injection.outlet_of_birth(1.0, 0.24), 0u);
  EXPECT_EQ(injection.outlet_of_birth(1.0, 0.26), 1u);
}

/// And so they have the same bits as before rates could change.
TEST(InjectionInvariance, AConstantRateIsTheRateOverEachDraw) {
  const auto all = births(363.0, 7, 3.0);
  ASSERT_GT(all.size(), 900u);
  double time = 0.0;
  for (std::size_t id = 0; id < all.size(); ++id) {
    time += spot::exponential(spot::uniform(7, spot::RandomPurpose::birth, id, 0)[0], 363.0);
    ASSERT_EQ(all[id].time, time);
  }
}

/// Until the rate changes nobody knows that it will.
TEST(InjectionInvariance, AScheduleBeginsAsItsFirstRateAlone) {
  const auto constant = births(100.0, 8, 2.0);
  const auto changing = births(Injection({schedule({{0.0, 100.0}, {2.0, 7.0}, {3.0, 0.0}})}), 8, 2.0);
  ASSERT_EQ(changing.size(), constant.size());
  for (std::size_t k = 0; k < constant.size(); ++k) EXPECT_EQ(changing[k].time, constant[k].time);
}

/// The rates of the outlets in intervals of time, one of which begins within a step.
struct Expected {
  double from, to;
  double rates[2];
};
constexpr Expected expected[] = {{0.0, 0.5, {30.0, 0.0}},  {0.5, 1.0, {30.0, 0.0}}, {1.0, 1.5, {30.0, 90.0}},
                                 {1.5, 3.0, {10.0, 90.0}}, {3.0, 4.0, {0.0, 0.0}},  {4.0, 5.0, {50.0, 5.0}}};
Injection changing() {
  return Injection({schedule({{0.0, 30.0}, {1.5, 10.0}, {3.0, 0.0}, {4.0, 50.0}}),
                    schedule({{0.0, 0.0}, {1.0, 90.0}, {3.0, 0.0}, {4.0, 5.0}})});
}

TEST(InjectionStatistical, EachOutletHasItsOwnRateInEachInterval) {
  constexpr int runs = 200;
  double deviation = 0.0, degrees = 0.0;  // of counts of one run in one interval at one outlet: Poisson
  double counts[std::size(expected)][2] = {};
  for (int seed = 1; seed <= runs; ++seed) {
    double count[std::size(expected)][2] = {};
    for (const Birth& birth : births(changing(), static_cast<std::uint64_t>(seed), 5.0))
      for (std::size_t k = 0; k < std::size(expected); ++k)
        if (birth.time >= expected[k].from && birth.time < expected[k].to) ++count[k][birth.outlet];
    for (std::size_t k = 0; k < std::size(expected); ++k)
      for (std::size_t outlet = 0; outlet < 2; ++outlet) {
        const double mean = expected[k].rates[outlet] * (expected[k].to - expected[k].from);
        counts[k][outlet] += count[k][outlet];
        if (mean == 0.0) continue;
        deviation += (count[k][outlet] - mean) * (count[k][outlet] - mean) / mean;
        ++degrees;
      }
  }
  double of_means = 0.0, means = 0.0;
  for (std::size_t k = 0; k < std::size(expected); ++k)
    for (std::size_t outlet = 0; outlet < 2; ++outlet) {
      const double mean = runs * expected[k].rates[outlet] * (expected[k].to - expected[k].from);
      if (mean == 0.0) {
        EXPECT_EQ(counts[k][outlet], 0.0) << "closed";
        continue;
      }
      of_means += (counts[k][outlet] - mean) * (counts[k][outlet] - mean) / mean;
      ++means;
    }
  EXPECT_LT(std::abs(scenes::chi_square_deviation(of_means, means)), scenes::bound);
  // The variance of counts is their mean, and they are independent of each other.
  EXPECT_LT(std::abs(scenes::chi_square_deviation(deviation, degrees)), scenes::bound);
}

/// Between births the integral of the rates is exponential with mean 1, whatever the rates: as in constant runs one
/// after the other.
TEST(InjectionStatistical, TheIntegralBetweenBirthsIsExponential) {
  const auto integral = [](double time) {
    double sum = 0.0;
    for (const Expected& part : expected)
      sum += std::max(0.0, std::min(time, part.to) - part.from) * (part.rates[0] + part.rates[1]);
    return sum;
  };
  std::vector<int> counts(40);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    double before = 0.0;
    for (const Birth& birth : births(changing(), seed, 5.0)) {
      // The last few would be cut off by the end.
      if (integral(before) > integral(5.0) - 40.0) break;
      const double below = 1.0 - std::exp(integral(before) - integral(birth.time));
      ++counts[std::min<std::size_t>(39, static_cast<std::size_t>(40.0 * below))];
      before = birth.time;
    }
  }
  EXPECT_LT(std::abs(scenes::deviation_from_equal_counts(counts)), scenes::bound);
}

std::string refusal_of(const Injection& injection) {
  SpotParameters spots = scenes::paper_spots();
  spots.injection_rate = injection;
  return scenes::text_of<InvalidParameter>([&] { spots.validate(); });
}

TEST(InjectionUnit, BadSchedulesAreNamedWithTheirBound) {
  const RateSchedule good = 10.0;
  EXPECT_THAT(refusal_of(Injection(std::vector<RateSchedule>{})), HasSubstr("no outlet"));
  EXPECT_THAT(refusal_of(Injection({good, schedule({})})), AllOf(HasSubstr("outlet 2"), HasSubstr("has no")));
  EXPECT_THAT(refusal_of(Injection({good, schedule({{0.5, 1.0}})})),
              AllOf(HasSubstr("outlet 2"), HasSubstr("time 0.5"), HasSubstr("must begin at 0")));
  for (const double bad : {1.0, 0.5, -1.0, infinity, std::nan("")})
    EXPECT_THAT(refusal_of(Injection({good, schedule({{0.0, 1.0}, {1.0, 2.0}, {bad, 3.0}})})),
                AllOf(HasSubstr("outlet 2"), HasSubstr("after 1 "), HasSubstr("finite and increase")));
  EXPECT_THAT(refusal_of(Injection({good, schedule({{std::nan(""), 1.0}})})), HasSubstr("must begin at 0"));
  for (const double bad : {-1.0, infinity, std::nan("")})
    EXPECT_THAT(refusal_of(Injection({good, schedule({{0.0, 1.0}, {2.0, bad}})})),
                AllOf(HasSubstr("at outlet 2 from time 2 "), HasSubstr("finite and not negative")));
  EXPECT_THAT(refusal_of(Injection({schedule({{0.0, 0.0}, {1.0, 0.0}}), schedule({{0.0, 0.0}})})),
              HasSubstr("0 at all times"));
  EXPECT_NO_THROW(Injection({good, schedule({{0.0, 0.0}})}).validate()) << "one may be closed for good";
}

TEST(InjectionUnit, RatesAreForAsManyOutletsAsThereAre) {
  SpotParameters spots = scenes::paper_spots();
  const spot::WalledContainer one(Orifice{{0.0, 0.0, 0.0}, 4.0}), pair(two());
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { SpotWalk(spots, pair); }),
              AllOf(HasSubstr("for 1 outlets"), HasSubstr("container has 2")));
  spots.injection_rate = Injection({10.0, 20.0});
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { SpotWalk(spots, one); }),
              AllOf(HasSubstr("for 2 outlets"), HasSubstr("container has 1")));
  EXPECT_NO_THROW(SpotWalk(spots, pair));
}

TEST(InjectionUnit, AllRatesCanBeScaled) {
  Injection injection({schedule({{0.0, 1.0}, {2.0, 3.0}}), 5.0});
  injection *= 2.0;
  EXPECT_EQ(injection.largest(0), 6.0);
  EXPECT_EQ(injection.largest(1), 10.0);
  EXPECT_EQ(injection.largest(), 16.0);
}

}  // namespace
