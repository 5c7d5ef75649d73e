// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/relaxation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "scenes.hpp"

namespace {

using spot::Grain;
using spot::Packing;
using spot::Relaxation;
using spot::RelaxationParameters;
using spot::RelaxationStrength;
using spot::Vector3;

constexpr double close = 1e-11;  // a few quanta of grains of diameter 1

RelaxationParameters with_strength(RelaxationStrength strength, double alpha = 0.8) {
  RelaxationParameters parameters;
  parameters.strength = strength;
  parameters.alpha = alpha;
  return parameters;
}

/// One sweep over all grains that are not held; the grains afterwards, by id.
std::vector<Grain> swept(const std::vector<Grain>& grains, const RelaxationParameters& parameters,
                         const spot::Container& container = *scenes::empty_space()) {
  Packing packing(1.0, 100.0, grains);
  packing.refresh(container);
  Relaxation(parameters).sweep(packing, container, scenes::all_movable(packing));
  return packing.grains();
}

TEST(RelaxationUnit, TwoFreeGrainsMoveHalfTheShareEachWithTheStrengthOf2010) {
  const auto grains =
      swept({{1, {0.0, 0.0, 0.0}}, {2, {0.95, 0.0, 0.0}}}, with_strength(RelaxationStrength::half_each));
  EXPECT_NEAR(grains[0].position.x(), -0.4 * 0.05, close);
  EXPECT_NEAR(grains[1].position.x(), 0.95 + 0.4 * 0.05, close);
}

TEST(RelaxationUnit, TwoFreeGrainsMoveTheFullShareEachWithTheStrengthOf2006) {
  const auto grains =
      swept({{1, {0.0, 0.0, 0.0}}, {2, {0.95, 0.0, 0.0}}}, with_strength(RelaxationStrength::full_each));
  EXPECT_NEAR(grains[0].position.x(), -0.8 * 0.05, close);
  EXPECT_NEAR(grains[1].position.x(), 0.95 + 0.8 * 0.05, close);
}

TEST(RelaxationUnit, PushesAlongTheLineOfCentres) {
  const Vector3 direction = Vector3(1.0, -2.0, 2.0) / 3.0;
  const auto grains = swept({{1, {0.0, 0.0, 0.0}}, {2, 0.9 * direction}}, with_strength(RelaxationStrength::half_each));
  EXPECT_LT((grains[0].position + 0.04 * direction).norm(), close);
  EXPECT_LT((grains[1].position - 0.94 * direction).norm(), close);
}

TEST(RelaxationUnit, GrainsComeToRestInContact) {
  RelaxationParameters relaxation;
  relaxation.contact_overlap = 0.01;
  auto grains = swept({{1, {0.0, 0.0, 0.0}}, {2, {0.95, 0.0, 0.0}}}, relaxation);
  EXPECT_NEAR(grains[0].position.x(), -0.4 * 0.04, close);
  EXPECT_NEAR(grains[1].position.x(), 0.95 + 0.4 * 0.04, close);
  grains = swept({{1, {0.0, 0.0, 0.0}}, {2, {0.995, 0.0, 0.0}}}, relaxation);
  EXPECT_EQ(grains[0].position.x(), 0.0);
  EXPECT_NEAR(grains[1].position.x(), 0.995, close);
}

TEST(RelaxationUnit, SmallGapsAreClosedAndNoOthers) {
  RelaxationParameters relaxation;
  relaxation.contact_overlap = 0.01;
  relaxation.closing_gap = 0.004;
  relaxation.closing_share = 0.25;
  const auto apart = [&](double distance, bool held = false) {
    const auto grains = swept({{1, {0.0, 0.0, 0.0}, held}, {2, {distance, 0.0, 0.0}}}, relaxation);
    return grains[1].position.x() - grains[0].position.x();
  };
  for (const bool held : {false, true}) EXPECT_NEAR(apart(0.993, held), 0.993 - 0.25 * 0.8 * 0.003, close);
  EXPECT_NEAR(apart(0.9939), 0.9939 - 0.25 * 0.8 * 0.0039, close);
  for (const double alone : {0.99, 0.9941, 1.0, 1.003}) EXPECT_NEAR(apart(alone), alone, close);
  EXPECT_NEAR(apart(0.95), 0.95 + 0.8 * 0.04, close) << "overlaps are parted as without";
  relaxation.contact_overlap = 0.0;
  EXPECT_NEAR(apart(1.003), 1.003 - 0.25 * 0.8 * 0.003, close) << "beyond the diameter, too";
  EXPECT_NEAR(apart(1.0041), 1.0041, close);
}

/// Both grains go almost as far as lists allow, towards each other, until they have a gap.
TEST(RelaxationUnit, ListsHoldGapsAsLongAsPairsInContact) {
  const auto container = scenes::empty_space();
  RelaxationParameters relaxation;
  relaxation.closing_gap = 0.05;
  relaxation.closing_share = 0.5;
  for (double start = 1.1; start < 1.35; start += 0.005) {
    Packing packing(1.0, 100.0, {{1, {0.0, 0.0, 0.0}}, {2, {start, 0.0, 0.0}}});
    packing.hold_gaps(relaxation.closing_gap);
    packing.refresh(*container);
    const double by = packing.quantum().round(0.5 * (start - 1.04));
    packing.move(scenes::index_of(packing, 1), by, 0.0, 0.0);
    packing.move(scenes::index_of(packing, 2), -by, 0.0, 0.0);
    packing.update_lists(*container);
    Relaxation(relaxation).sweep(packing, *container, scenes::all_movable(packing));
    const auto grains = packing.grains();
    EXPECT_NEAR(grains[1].position.x() - grains[0].position.x(), 1.04 - 0.4 * 0.04, close) << start;
  }
}

TEST(RelaxationUnit, AMovableGrainTakesTheFullShareAgainstAFixedOne) {
  for (const auto strength : {RelaxationStrength::half_each, RelaxationStrength::full_each}) {
    const auto held = swept({{1, {0.0, 0.0, 0.0}, true}, {2, {0.95, 0.0, 0.0}}}, with_strength(strength));
    EXPECT_EQ(held[0].position, Vector3(0.0, 0.0, 0.0)) << "held grains do not move";
    EXPECT_NEAR(held[1].position.x(), 0.95 + 0.8 * 0.05, close);
  }
}

TEST(RelaxationUnit, GrainsThatAreNotListedAsMovableStay) {
  const auto container = scenes::empty_space();
  Packing packing(1.0, 100.0, {{1, {0.0, 0.0, 0.0}}, {2, {0.95, 0.0, 0.0}}});
  packing.refresh(*container);
  Relaxation relaxation{RelaxationParameters()};
  relaxation.sweep(packing, *container, {scenes::index_of(packing, 2)});
  EXPECT_EQ(packing.grains()[0].position, Vector3(0.0, 0.0, 0.0));
  EXPECT_NEAR(packing.grains()[1].position.x(), 0.95 + 0.8 * 0.05, close);
  // And the next sweep does not remember who was movable in the one before.
  relaxation.sweep(packing, *container, {scenes::index_of(packing, 1)});
  EXPECT_NEAR(packing.grains()[0].position.x(), -0.8 * 0.01, close);
  EXPECT_NEAR(packing.grains()[1].position.x(), 0.99, close);
}

TEST(RelaxationUnit, WallsPushByTheFullShare) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const std::vector<Grain> near_walls = {{1, {6.0, 0.0, 0.4}}, {2, {-7.6, 0.0, 5.0}}, {3, {0.0, 3.7, 5.0}}};
  for (const auto strength : {RelaxationStrength::half_each, RelaxationStrength::full_each}) {
    const auto grains = swept(near_walls, with_strength(strength), *silo);
    EXPECT_LT((grains[0].position - Vector3(6.0, 0.0, 0.48)).norm(), close) << "base";
    EXPECT_LT((grains[1].position - Vector3(-7.52, 0.0, 5.0)).norm(), close) << "side";
    EXPECT_LT((grains[2].position - Vector3(0.0, 3.54, 5.0)).norm(), close) << "front";
  }
}

TEST(RelaxationUnit, ACornerPushesOffAllItsWallsAtOnce) {
  const auto grains = swept({{1, {7.6, 3.6, 0.4}}}, RelaxationParameters(), *scenes::small_silo(8.0, 4.0));
  EXPECT_LT((grains[0].position - Vector3(7.52, 3.52, 0.48)).norm(), close);
}

TEST(RelaxationUnit, TheRimPushesAwayFromTheEdge) {
  // 0.4 from the edge at (4, 0, 0), along (-0.6, 0, 0.8).
  const auto grains = swept({{1, {4.0 - 0.24, 0.0, 0.32}}}, RelaxationParameters(), *scenes::small_silo(8.0, 4.0));
  EXPECT_LT((grains[0].position - Vector3(4.0 - 0.24 - 0.048, 0.0, 0.32 + 0.064)).norm(), close);
}

TEST(RelaxationUnit, InAChainThePushesOnTheMiddleAdd) {
  const std::vector<Grain> chain = {{1, {0.0, 0.0, 0.0}}, {2, {0.9, 0.0, 0.0}}, {3, {1.85, 0.0, 0.0}}};
  const auto grains = swept(chain, with_strength(RelaxationStrength::half_each));
  EXPECT_NEAR(grains[0].position.x(), -0.4 * 0.10, close);
  EXPECT_NEAR(grains[1].position.x(), 0.9 + 0.4 * 0.10 - 0.4 * 0.05, close);
  EXPECT_NEAR(grains[2].position.x(), 1.85 + 0.4 * 0.05, close);
}

TEST(RelaxationUnit, GrainsThatDoNotOverlapStay) {
  const std::vector<Grain> apart = {{1, {0.0, 0.0, 0.0}}, {2, {1.0, 0.0, 0.0}}, {3, {0.0, 1.125, 0.0}}};
  scenes::expect_identical(swept(apart, RelaxationParameters()), apart);
}

TEST(RelaxationUnit, CoincidentCentresArePartedWhicheverComesFirst) {
  const std::vector<Grain> coincident = {{1, {0.5, 0.5, 0.5}}, {2, {0.5, 0.5, 0.5}}};
  const auto grains = swept(coincident, RelaxationParameters());
  EXPECT_NEAR((grains[1].position - grains[0].position).norm(), 0.8, close);
  scenes::expect_identical(swept({coincident[1], coincident[0]}, RelaxationParameters()), grains);
  const auto held = swept({{1, {0.5, 0.5, 0.5}, true}, {2, {0.5, 0.5, 0.5}}}, RelaxationParameters());
  EXPECT_NEAR((held[1].position - held[0].position).norm(), 0.8, close);
}

TEST(RelaxationUnit, RefusesParametersOutOfRange) {
  EXPECT_THROW(Relaxation(with_strength(RelaxationStrength::half_each, 0.0)), spot::InvalidParameter);
}

/// B = (1/N) sum_i sum_j (delta_ij / d)^2, each pair counted from both ends.
double badness(const std::vector<Grain>& grains) {
  double sum = 0.0;
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double overlap = 1.0 - (grains[i].position - grains[j].position).norm();
      if (overlap > 0.0) sum += 2.0 * overlap * overlap;
    }
  return sum / static_cast<double>(grains.size());
}

/// Badness before and after each of the sweeps over a packing without walls.
std::vector<double> badness_of_sweeps(const std::vector<Grain>& grains, RelaxationStrength strength, int sweeps) {
  const auto container = scenes::empty_space();
  Packing packing(1.0, 100.0, grains);
  Relaxation relaxation(with_strength(strength));
  std::vector<double> series = {badness(packing.grains())};
  for (int k = 0; k < sweeps; ++k) {
    packing.refresh(*container);
    relaxation.sweep(packing, *container, scenes::all_movable(packing));
    series.push_back(badness(packing.grains()));
  }
  return series;
}

/// A random packing squeezed until its grains overlap.
std::vector<Grain> compressed(double squeeze, std::uint64_t seed) {
  std::vector<Grain> grains = scenes::random_grains(500, {-4.0, -4.0, -4.0}, {4.0, 4.0, 4.0}, 1.0, seed);
  for (Grain& grain : grains) grain.position *= squeeze;
  return grains;
}

TEST(RelaxationAnalytic, RepeatedSweepsOfACompressedPackingDoNotIncreaseB) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const double squeeze : {0.98, 0.95, 0.90, 0.85}) {
      const auto series = badness_of_sweeps(compressed(squeeze, seed), RelaxationStrength::half_each, 40);
      for (std::size_t k = 1; k < series.size(); ++k)
        EXPECT_LE(series[k], series[k - 1]) << "seed " << seed << ", squeezed to " << squeeze << ", sweep " << k;
      EXPECT_LT(series.back(), 1e-2 * series.front());
    }
}

TEST(RelaxationAnalytic, CentreOfMassIsConservedWithoutWallsToTheLastBit) {
  const auto container = scenes::empty_space();
  Packing packing(1.0, 100.0, compressed(0.9, 1));
  Relaxation relaxation{RelaxationParameters()};
  // Positions are multiples of the quantum, so that their sum is exact.
  const auto sum = [&] {
    Vector3 total = Vector3::Zero();
    for (const Grain& grain : packing.grains()) total += grain.position;
    return total;
  };
  const Vector3 before = sum();
  for (int k = 0; k < 20; ++k) {
    packing.refresh(*container);
    relaxation.sweep(packing, *container, scenes::all_movable(packing));
  }
  EXPECT_EQ(sum(), before);
}

TEST(RelaxationInvariance, OrderOfGrainsInMemoryAndInTheListChangesNothing) {
  const auto container = scenes::empty_space();
  std::vector<Grain> grains = compressed(0.85, 2);
  const auto expected = swept(grains, RelaxationParameters());
  scenes::Draws draws(1);
  for (int order = 0; order < 10; ++order) {
    draws.shuffle(grains);
    Packing packing(1.0, 100.0, grains);
    packing.refresh(*container);
    std::vector<std::uint32_t> movable = scenes::all_movable(packing);
    draws.shuffle(movable);
    Relaxation(RelaxationParameters()).sweep(packing, *container, movable);
    scenes::expect_identical(packing.grains(), expected);
  }
}

}  // namespace
