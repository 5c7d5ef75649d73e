// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/displacement.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "scenes.hpp"
#include "spot/walk/nonaffine_motion.hpp"

namespace {

using spot::Grain;
using spot::Move;
using spot::Packing;
using spot::Vector3;

const std::vector<Grain> row = {{1, {0.0, 0.0, 0.0}}, {2, {2.5, 0.0, 0.0}}, {3, {2.7, 1.0, 0.0}}, {4, {5.0, 0.0, 0.0}}};

Packing listed(const std::vector<Grain>& grains) {
  Packing packing(1.0, 100.0, grains);
  packing.refresh(*scenes::empty_space());
  return packing;
}

TEST(DisplacementUnit, MovesGrainsWithinTheRadiusAgainstTheStep) {
  Packing packing = listed(row);
  const Move move{0.0, 0, {0.0, 0.0, 0.0}, {0.68, 0.0, 0.1}};
  EXPECT_EQ(spot::displace(packing, scenes::all_movable(packing), move, {2.6, 2.5e-3}), 2 * spot::grain_volume);
  const auto grains = packing.grains();
  const Vector3 shift(-2.5e-3 * 0.68, 0.0, -2.5e-3 * 0.1);
  for (const std::size_t i : {0, 1})
    EXPECT_LT((grains[i].position - row[i].position - shift).norm(), 2.0 * packing.quantum().length());
  for (const std::size_t i : {2, 3})
    EXPECT_LT((grains[i].position - row[i].position).norm(), 2.0 * packing.quantum().length());
}

/// Influence is centred on the middle of the step, not on its start or end (2006).
TEST(DisplacementUnit, InfluenceIsCentredOnTheMiddle) {
  Packing packing = listed({{1, {2.5, 0.0, 0.0}}, {2, {-2.5, 0.0, 0.0}}});
  const Move move{0.0, 0, {0.34, 0.0, 0.0}, {0.68, 0.0, 0.0}};
  EXPECT_EQ(spot::displace(packing, scenes::all_movable(packing), move, {2.6, 2.5e-3}), spot::grain_volume);
  EXPECT_LT(packing.grains()[0].position.x(), 2.4999);
  EXPECT_EQ(packing.grains()[1].position.x(), -2.5);
}

TEST(DisplacementUnit, TouchesOnlyTheGrainsItIsGiven) {
  Packing packing = listed(row);
  const Move move{0.0, 0, {0.0, 0.0, 0.0}, {0.68, 0.0, 0.1}};
  EXPECT_EQ(spot::displace(packing, {scenes::index_of(packing, 1)}, move, {2.6, 2.5e-3}), spot::grain_volume);
  EXPECT_EQ(packing.grains()[1].position.x(), 2.5);
  EXPECT_EQ(spot::displace(packing, {}, move, {2.6, 2.5e-3}), 0);
}

TEST(DisplacementUnit, OppositeStepsCancelToTheLastBit) {
  Packing packing = listed(row);
  const auto before = packing.grains();
  const Move there{0.0, 0, {0.1, 0.2, 0.3}, {0.68, 0.0, 0.1}};
  Move back = there;
  back.step = -there.step;
  for (int k = 0; k < 100; ++k) {
    spot::displace(packing, scenes::all_movable(packing), there, {4.0, 2.5e-3});
    spot::displace(packing, scenes::all_movable(packing), back, {4.0, 2.5e-3});
  }
  scenes::expect_identical(packing.grains(), before);
}

TEST(DisplacementUnit, WeightMultipliesTheInfluence) {
  Packing packing = listed(row);
  Move move{0.0, 0, {0.0, 0.0, 0.0}, {0.68, 0.0, 0.1}};
  EXPECT_EQ(move.weight, 1.0);
  move.weight = 1.5;
  spot::displace(packing, scenes::all_movable(packing), move, {2.6, 2.5e-3});
  EXPECT_NEAR(packing.grains()[0].position.x(), -1.5 * 2.5e-3 * 0.68, 2.0 * packing.quantum().length());
  move.weight = 0.0;
  EXPECT_EQ(spot::displace(packing, scenes::all_movable(packing), move, {2.6, 2.5e-3}), 2 * spot::grain_volume);
  EXPECT_NEAR(packing.grains()[0].position.x(), -1.5 * 2.5e-3 * 0.68, 2.0 * packing.quantum().length());
}

/// Both components of the move that grains have in common are as without, and each goes its own way beside.
TEST(DisplacementUnit, GrainsGoAgainstTheirNeighboursByWhatIsTheirOwn) {
  spot::SpotParameters spots{2.6, 2.5e-3};
  const Move move{0.0, 0, {0.0, 0.0, 0.0}, {0.68, 0.0, 0.8}};
  const auto moved = [&] {
    Packing packing = listed(row);
    spot::displace(packing, scenes::all_movable(packing), move, spots);
    return packing.grains();
  };
  const auto straight = moved();
  spots.nonaffine = 0.2;
  spots.nonaffine_length = 0.5;
  const auto tilted = moved();
  const spot::NonaffineMotion motion(spots);
  int inside = 0;
  for (std::size_t i = 0; i < straight.size(); ++i) {
    spot::NonaffineMotion::Tilt tilt{};
    motion.update(tilt, row[i].id, row[i].position.z());
    const bool reached = row[i].position.norm() <= 2.6;
    inside += reached ? 1 : 0;
    const spot::Vector3 own = 2.5e-3 * 0.8 * motion.unit() * spot::Vector3(tilt.x, tilt.y, tilt.z);
    const spot::Vector3 expected = straight[i].position + (reached ? own : spot::Vector3(0.0, 0.0, 0.0));
    EXPECT_LT((tilted[i].position - expected).norm(), 1e-6) << straight[i].id;
  }
  EXPECT_EQ(inside, 2);
}

TEST(FixedVolumeUnit, WeightIsOneWithoutAFixedVolume) {
  const spot::SpotParameters spots = scenes::paper_spots();
  ASSERT_EQ(spots.fixed_volume, 0.0);
  for (const double height : {-9.0, 0.0, 1.0, 99.0})
    for (const int grains : {0, 1, 80}) EXPECT_EQ(spot::fixed_volume_weight(spots, height, grains), 1.0);
}

/// Grains that a spot encloses share the same free volume, however many they are.
TEST(FixedVolumeAnalytic, WeightTimesGrainsIsTheVolume) {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.fixed_volume = 77.0;
  for (const int grains : {20, 40, 77, 100, 300})
    EXPECT_NEAR(spot::fixed_volume_weight(spots, 3.0, grains * spot::grain_volume) * grains, 77.0, 1e-6) << grains;
  // At the surface, where a spot has less to carry its volume, grains are not thrown about.
  for (const int grains : {0, 1, 5, 19})
    EXPECT_NEAR(spot::fixed_volume_weight(spots, 3.0, grains * spot::grain_volume), 3.85, 1e-6);
}

/// One that has taken volume up carries that, too, but no move throws grains farther than 2010's.
TEST(FixedVolumeAnalytic, WeightGoesWithWhatTheSpotCarriesUpToThatOfTwentyGrains) {
  spot::SpotParameters spots = scenes::paper_spots();
  for (const double volume : {0.25, 1.0, 2.0})
    EXPECT_EQ(spot::fixed_volume_weight(spots, 3.0, 80 * spot::grain_volume, volume), volume);
  spots.fixed_volume = 77.0;
  for (const double volume : {0.25, 1.0, 2.0}) {
    for (const int grains : {40, 77, 300})
      EXPECT_NEAR(spot::fixed_volume_weight(spots, 3.0, grains * spot::grain_volume, volume) * grains, 77.0 * volume,
                  1e-6);
    for (const int grains : {0, 1, 4})
      EXPECT_NEAR(spot::fixed_volume_weight(spots, 3.0, grains * spot::grain_volume, volume), 3.85, 1e-6);
  }
  EXPECT_EQ(spot::largest_weight(spots), 3.85);
}

TEST(FixedVolumeAnalytic, VolumeIsThatOfThePartAboveTheOutlet) {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.fixed_volume = 77.0;
  EXPECT_NEAR(spot::fixed_volume_weight(spots, -2.6, 0), 0.0, 1e-6) << "all below";
  EXPECT_NEAR(spot::fixed_volume_weight(spots, 0.0, 40 * spot::grain_volume), 77.0 * 0.5 / 40.0, 1e-6);
}

/// N, and the 20 grains below which weights stay, are of mean volume: of grains that are all half as wide as the
/// reference, a spot moves as with as many equal ones.
TEST(FixedVolumeAnalytic, CountsGrainsOfMeanVolume) {
  spot::SpotParameters equal = scenes::paper_spots(), small = equal;
  equal.fixed_volume = small.fixed_volume = 77.0;
  small.mean_grain_volume = 0.125;
  for (const int grains : {0, 8, 40, 80, 300})
    for (const double height : {0.5, 3.0})
      EXPECT_EQ(spot::fixed_volume_weight(small, height, grains * spot::grain_volume / 8),
                spot::fixed_volume_weight(equal, height, grains * spot::grain_volume))
          << grains;
  EXPECT_EQ(spot::largest_weight(small), spot::largest_weight(equal));
}

/// What a parabolic spot hands out falls with the square of the distance, to nothing at its radius.
TEST(DisplacementAnalytic, SharesOfAParabolicSpot) {
  const double radius = 3.5;
  spot::SpotParameters spots{radius, 2.5e-3};
  spots.profile = spot::InfluenceProfile::parabolic;
  const Move move{0.0, 1, {0, 0, 0}, {0.7, 0, 0.1}};
  for (const double part : {0.0, 0.25, 0.5, 0.99, 1.01, 2.0}) {
    const double share = std::max(0.0, 1.0 - part * part);
    Packing packing = listed({{1, {0, part * radius, 0}}});
    const auto all = scenes::all_movable(packing);
    EXPECT_NEAR(spot::enclosed_volume(packing, all, move, spots), share * spot::grain_volume, 1.0) << part;
    EXPECT_NEAR(spot::displace(packing, all, move, spots), share * spot::grain_volume, 1.0) << part;
    const Vector3 at = packing.grains()[0].position;
    EXPECT_NEAR(at.x(), -share * 2.5e-3 * 0.7, 1e-9) << part;
    EXPECT_NEAR(at.z(), -share * 2.5e-3 * 0.1, 1e-9) << part;
  }
}

/// Influence does not couple grains while it is constant, so grains inside all spheres may see moves in any order.
TEST(DisplacementInvariance, OrderOfMovesChangesNothingInsideAllSpheres) {
  scenes::Draws draws(1);
  std::vector<Move> moves;
  for (int k = 0; k < 200; ++k)
    moves.push_back({0.0, k, draws.in_box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}),
                     draws.in_box({-0.68, -0.68, 0.1}, {0.68, 0.68, 0.1})});
  const auto grains = scenes::random_grains(20, {-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}, 0.3, 1);
  const auto after = [&] {
    Packing packing = listed(grains);
    for (const Move& move : moves) spot::displace(packing, scenes::all_movable(packing), move, {3.0, 2.5e-3});
    return packing.grains();
  };
  const auto expected = after();
  draws.shuffle(moves);
  scenes::expect_identical(after(), expected);
}

}  // namespace
