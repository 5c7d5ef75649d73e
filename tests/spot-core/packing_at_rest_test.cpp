// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/packing_at_rest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/walk/calibration.hpp"
#include "spot/walk/critical_state.hpp"
#include "spot/walk/grain_volume.hpp"

namespace {

using spot::EnclosedGrain;
using spot::SpotParameters;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;

SpotParameters critical_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.profile = spot::InfluenceProfile::parabolic;
  spots.radius = 3.5;
  spots.fixed_volume = 77.0;
  spots.critical_fraction = 0.55;
  spots.exchange_length = 1.0;
  return spots;
}

constexpr double half_width = 11.0, half_depth = 9.0, height = 25.0;

std::shared_ptr<const spot::Container> silo() { return scenes::small_silo(half_width, half_depth); }

/// Centres anywhere inside walls that are calibration::inset_of_walls farther in, up to a height: a gas of this packing
/// fraction.
std::vector<EnclosedGrain> gas(double fraction, double top, int volume = spot::grain_volume) {
  const Vector3 in = Vector3::Constant(spot::calibration::inset_of_walls);
  const Vector3 low(-half_width, -half_depth, 0.0), high(half_width, half_depth, top);
  const double size = (high - low - 2.0 * in).prod() / (scenes::pi / 6.0 * volume / spot::grain_volume);
  scenes::Draws draws(3);
  std::vector<EnclosedGrain> grains;
  for (int k = 0; k < static_cast<int>(fraction * size); ++k)
    grains.push_back({draws.in_box(low + in, high - in), volume});
  return grains;
}

std::optional<double> at_rest(const std::vector<EnclosedGrain>& grains, const SpotParameters& spots = critical_spots(),
                              const spot::Container& container = *silo()) {
  spot::Alone alone;
  const auto found = spot::packing_at_rest(spots, container, 1.0, grains, alone);
  return found ? std::optional<double>(found->fraction) : std::nullopt;
}

/// Of grains placed at random, so that the mean is uncertain by 1 % (one standard deviation; some 7,000 grains).
TEST(PackingAtRestStatistical, IsThatOfAGasOfGrains) {
  for (const auto* profile : spot::InfluenceProfile::all())
    for (const double fraction : {0.45, 0.6}) {
      SpotParameters spots = critical_spots();
      spots.profile = profile;
      EXPECT_NEAR(at_rest(gas(fraction, height), spots).value() / fraction, 1.0, 0.04) << profile->name();
      EXPECT_NEAR(at_rest(gas(fraction, height, 500), spots).value() / fraction, 1.0, 0.04) << "smaller grains";
    }
}

/// Nodes are R_s apart from the middle of the orifice; every grain is asked for each.
TEST(PackingAtRestBruteForce, IsTheSumOverPlacesInTheBulk) {
  const SpotParameters spots = critical_spots();
  const auto container = silo();
  const std::vector<EnclosedGrain> grains = gas(0.57, height);
  const spot::CriticalState state(spots, 1.0);
  double enclosed = 0.0, critical = 0.0;
  int places = 0;
  for (int x = -3; x <= 3; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = 2; z <= 5; ++z) {  // the surface is at 24 to 25: z + R_s + 2 goes up to 23 for z = 5 R_s
        const Vector3 place = spots.radius * Vector3(x, y, z);
        ++places;
        critical += state.enclosed(place, 0.0, *container);
        for (const EnclosedGrain& grain : grains) {
          const double squared = (grain.position - place).squaredNorm();
          if (squared <= spots.radius * spots.radius)
            enclosed += std::floor(spots.profile->share(squared, spots.radius) * grain.volume) / spot::grain_volume;
        }
      }
  ASSERT_EQ(places, 140);
  EXPECT_NEAR(at_rest(grains).value(), 0.55 * enclosed / critical, 1e-9);
}

/// A single grain on top does not lift the surface of what is beside it, nor do spots see a hole of what is above them.
TEST(PackingAtRestUnit, WhatLiesOnTopChangesNothing) {
  std::vector<EnclosedGrain> grains = gas(0.57, height);
  const double alone = at_rest(grains).value();
  grains.push_back({{0.0, 0.0, 90.0}, spot::grain_volume});
  EXPECT_EQ(at_rest(grains).value(), alone);
}

TEST(PackingAtRestUnit, ThereIsNoneOfASmallHeapNorOfRain) {
  EXPECT_FALSE(at_rest({}));
  EXPECT_FALSE(at_rest(gas(0.57, 12.0))) << "7 + 3.5 + 2 is above it";
  EXPECT_TRUE(at_rest(gas(0.57, 13.5)));
  std::vector<EnclosedGrain> rain = gas(0.57, 1.0);
  for (EnclosedGrain& grain : rain) grain.position.z() += 1e6;
  EXPECT_FALSE(at_rest(rain));
}

TEST(PackingAtRestInvariance, RanksAndOrderChangeNothing) {
  std::vector<EnclosedGrain> grains = gas(0.57, height);
  const double alone = at_rest(grains).value();
  scenes::Draws(1).shuffle(grains);
  for (const int ranks : {2, 5})
    scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
      std::vector<EnclosedGrain> own;
      for (std::size_t k = 0; k < grains.size(); ++k)
        if (static_cast<int>(k) % ranks == communicator->rank()) own.push_back(grains[k]);
      const double found = spot::packing_at_rest(critical_spots(), *silo(), 1.0, own, *communicator).value().fraction;
      if (found != alone) throw spot::Error(spot::message("another on ", ranks, " ranks: ", found));
    });
}

/// Walls of the box have one half-width everywhere; what they leave of phi_c can be below a bed that phi_c is above.
TEST(PackingAtRestAnalytic, WallsThatShearLowerWhatTheBedMustHave) {
  SpotParameters spots = critical_spots();
  spots.dilatancy = 0.15;
  const auto grains = gas(0.57, height);
  spot::Alone alone;
  const auto unsheared = spot::packing_at_rest(spots, *silo(), 1.0, grains, alone).value();
  EXPECT_NEAR(unsheared.critical, spots.critical_fraction, 1e-12);
  spots.wall_shear = 0.7;
  const auto sheared = spot::packing_at_rest(spots, *silo(), 1.0, grains, alone).value();
  const double shear = 0.7 * (1.0 / half_width + 1.0 / half_depth);
  EXPECT_NEAR(sheared.critical, spots.critical_fraction * (1.0 - 0.15 * shear), 1e-9);
  EXPECT_EQ(sheared.fraction, unsheared.fraction);
}

std::vector<spot::Grain> filling() {
  return scenes::dense_grains({0.5 - half_width, 0.5 - half_depth, 0.5}, {half_width - 0.5, half_depth - 0.5, 16.0},
                              0.01, 1);
}

void start_windowed(const SpotParameters& spots, const std::vector<spot::Grain>& grains,
                    std::shared_ptr<spot::Communicator> communicator = std::make_shared<spot::Alone>()) {
  spot::WindowedDrainage(spots, {}, {-1.0}, 0.01, 1, silo(), 1.0, 100.0, grains, communicator);
}

void start_time_ordered(const SpotParameters& spots, const std::vector<spot::Grain>& grains) {
  spot::TimeOrderedDrainage(spots, {}, {-1.0}, silo(), spot::Packing(1.0, 100.0, grains));
}

double fraction_of(const std::vector<spot::Grain>& grains) {
  std::vector<EnclosedGrain> enclosed;
  for (const spot::Grain& grain : grains) enclosed.push_back({grain.position, spot::grain_volume});
  return at_rest(enclosed).value();
}

/// Up to the uncertainty of the packing fraction at rest, in both drivers and on ranks.
TEST(PackingAtRestUnit, ASetPointAboveItIsRefused) {
  const auto grains = filling();
  const double highest = (1.0 + spot::calibration::most_above_rest) * fraction_of(grains);
  SpotParameters spots = critical_spots();
  spots.critical_fraction = highest - 1e-4;
  EXPECT_NO_THROW(start_windowed(spots, grains));
  EXPECT_NO_THROW(start_time_ordered(spots, grains));
  spots.critical_fraction = highest + 1e-4;
  const auto refused = AllOf(HasSubstr(spot::message("critical packing fraction is ", spots.critical_fraction)),
                             HasSubstr("must be at most 0.5"), HasSubstr("the packing at rest has 0.5"));
  EXPECT_THAT(scenes::text_of<spot::InvalidParameter>([&] { start_windowed(spots, grains); }), refused);
  EXPECT_THAT(scenes::text_of<spot::InvalidParameter>([&] { start_time_ordered(spots, grains); }), refused);
  std::mutex mutex;
  int refusals = 0;
  scenes::on_ranks(3, [&](std::shared_ptr<spot::Communicator> communicator) {
    try {
      start_windowed(spots, communicator->rank() == 0 ? grains : std::vector<spot::Grain>{}, communicator);
    } catch (const spot::InvalidParameter&) {
      const std::lock_guard<std::mutex> lock(mutex);
      ++refusals;
    }
  });
  EXPECT_EQ(refusals, 3);
}

/// A flow is looser than its bed was, and what is put on top may be.
TEST(PackingAtRestUnit, OnlyAStartIsRefused) {
  const auto grains = filling();
  SpotParameters spots = critical_spots();
  spots.critical_fraction = fraction_of(grains);
  spots.injection_rate = 30.0;
  spot::WindowedDrainage drainage(spots, {}, {-1.0}, 0.01, 1, silo(), 1.0, 100.0, grains);
  std::vector<spot::Grain> fewer;
  for (const spot::Grain& grain : grains)
    if (grain.id % 8 != 0) fewer.push_back(grain);
  ASSERT_LT(fraction_of(fewer), 0.9 * spots.critical_fraction);
  EXPECT_NO_THROW(drainage.replace_grains(fewer));
  EXPECT_NO_THROW(spot::WindowedDrainage(spots, {}, {-1.0}, 0.01, 1, silo(), 1.0, 100.0,
                                         std::vector<spot::Bytes>{drainage.save()}));
  spot::TimeOrderedDrainage ordered(spots, {}, {-1.0}, silo(), spot::Packing(1.0, 100.0, grains));
  EXPECT_NO_THROW(ordered.replace_grains(fewer));
  EXPECT_NO_THROW(spot::TimeOrderedDrainage(spots, {}, {-1.0}, silo(), 1.0, 100.0, ordered.save()));
}

}  // namespace
