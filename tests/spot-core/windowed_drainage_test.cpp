// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/windowed_drainage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "scenes.hpp"
#include "spot/time_ordered_drainage.hpp"

namespace {

using spot::DrainageLimits;
using spot::Grain;
using spot::InvalidParameter;
using spot::RelaxationParameters;
using spot::SpotParameters;
using spot::WindowedDrainage;
using testing::HasSubstr;

constexpr double window = 5e-3;

std::vector<Grain> filling(double height) {
  return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, height}, 0.01, 2);
}

WindowedDrainage drainage_of(const std::vector<Grain>& grains, const SpotParameters& spots = scenes::paper_spots(),
                             const RelaxationParameters& relaxation = {}, double length = window) {
  return WindowedDrainage(spots, relaxation, DrainageLimits{-1.0}, length, scenes::small_silo(6.0, 4.0), 1.0, 100.0,
                          grains);
}

TEST(WindowedDrainageInvariance, ARerunIsIdentical) {
  WindowedDrainage one = drainage_of(filling(15.0)), other = drainage_of(filling(15.0));
  one.advance_to(4.0);
  other.advance_to(4.0);
  EXPECT_GT(one.counters().drained, 100);
  scenes::expect_identical(one.grains(), other.grains());
  scenes::expect_identical(one.take_drained(), other.take_drained());
}

TEST(WindowedDrainageInvariance, OrderOfTheInputChangesNothing) {
  std::vector<Grain> grains = filling(15.0);
  WindowedDrainage one = drainage_of(grains);
  scenes::Draws(1).shuffle(grains);
  WindowedDrainage other = drainage_of(grains);
  one.advance_to(4.0);
  other.advance_to(4.0);
  scenes::expect_identical(one.grains(), other.grains());
}

TEST(WindowedDrainageInvariance, AdvancingInPiecesChangesNothing) {
  WindowedDrainage one = drainage_of(filling(15.0)), other = drainage_of(filling(15.0));
  one.advance_to(4.0);
  for (int k = 1; k <= 400; ++k) {
    other.advance_to(0.01 * k);
    other.largest_overlap();
  }
  EXPECT_EQ(one.counters().moves, other.counters().moves);
  scenes::expect_identical(one.grains(), other.grains());
}

TEST(WindowedDrainageInvariance, AnotherSeedGivesAnotherRun) {
  SpotParameters spots = scenes::paper_spots();
  WindowedDrainage one = drainage_of(filling(15.0), spots);
  ++spots.seed;
  WindowedDrainage other = drainage_of(filling(15.0), spots);
  one.advance_to(1.0);
  other.advance_to(1.0);
  EXPECT_NE(one.counters().moves, other.counters().moves);
}

TEST(WindowedDrainageUnit, NobodyIsLostOrOutside) {
  const auto grains = filling(15.0);
  WindowedDrainage drainage = drainage_of(grains);
  std::set<std::int64_t> drained;
  for (int k = 1; k <= 10; ++k) {
    drainage.advance_to(k);
    drainage.require_inside();
    for (const Grain& grain : drainage.take_drained()) EXPECT_TRUE(drained.insert(grain.id).second);
    EXPECT_EQ(drained.size(), static_cast<std::size_t>(drainage.counters().drained));
    EXPECT_EQ(drainage.grains().size() + drained.size(), grains.size());
    EXPECT_LT(drainage.largest_overlap().depth, 0.1);
  }
}

TEST(WindowedDrainageUnit, SpotsComeOutAtTheTop) {
  WindowedDrainage drainage = drainage_of(filling(6.0));
  drainage.advance_to(5.0);
  for (const spot::Spot& spot : drainage.spots()) EXPECT_LT(spot.position.z(), 10.0);
}

TEST(WindowedDrainageUnit, AnEmptySiloIsNoError) {
  WindowedDrainage drainage = drainage_of({});
  drainage.advance_to(2.0);
  EXPECT_EQ(drainage.counters().drained, 0);
}

TEST(WindowedDrainageUnit, ASmallerToleranceSweepsMore) {
  RelaxationParameters fine, coarse;
  fine.tolerance = 1e-3;
  coarse.tolerance = 4e-3;
  WindowedDrainage often = drainage_of(filling(10.0), scenes::paper_spots(), fine);
  WindowedDrainage seldom = drainage_of(filling(10.0), scenes::paper_spots(), coarse);
  EXPECT_EQ(often.due(), 4) << "12 tolerance^2 / (w dx)^2";
  EXPECT_EQ(seldom.due(), 66);
  often.advance_to(3.0);
  seldom.advance_to(3.0);
  EXPECT_GT(often.counters().grains_swept, 2 * seldom.counters().grains_swept);
}

TEST(WindowedDrainageUnit, BadParametersAreNamed) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    RelaxationParameters relaxation;
    relaxation.tolerance = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), relaxation); }),
                HasSubstr("tolerance"));
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), {}, bad); }),
                HasSubstr("window"));
  }
}

/// Same spots, another algorithm: as many grains drain, up to noise. The walks are the same, so births are no noise;
/// the bound is four standard deviations of the difference over seeds 1-8 of the windowed driver.
TEST(WindowedDrainageStatistical, DrainsAsManyAsTheTimeOrderedDriver) {
  const auto grains = filling(15.0);
  spot::TimeOrderedDrainage reference(scenes::paper_spots(), {}, DrainageLimits{-1.0}, scenes::small_silo(6.0, 4.0),
                                      spot::Packing(1.0, 100.0, grains));
  WindowedDrainage windowed = drainage_of(grains);
  reference.advance_to(8.0);
  windowed.advance_to(8.0);
  EXPECT_NEAR(static_cast<double>(windowed.counters().drained) / static_cast<double>(reference.counters().drained), 1.0,
              0.08);
}

}  // namespace
