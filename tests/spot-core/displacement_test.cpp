// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/displacement.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "scenes.hpp"

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
  EXPECT_EQ(spot::displace(packing, scenes::all_movable(packing), move, 2.6, 2.5e-3), 2);
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
  EXPECT_EQ(spot::displace(packing, scenes::all_movable(packing), move, 2.6, 2.5e-3), 1);
  EXPECT_LT(packing.grains()[0].position.x(), 2.4999);
  EXPECT_EQ(packing.grains()[1].position.x(), -2.5);
}

TEST(DisplacementUnit, TouchesOnlyTheGrainsItIsGiven) {
  Packing packing = listed(row);
  const Move move{0.0, 0, {0.0, 0.0, 0.0}, {0.68, 0.0, 0.1}};
  EXPECT_EQ(spot::displace(packing, {scenes::index_of(packing, 1)}, move, 2.6, 2.5e-3), 1);
  EXPECT_EQ(packing.grains()[1].position.x(), 2.5);
  EXPECT_EQ(spot::displace(packing, {}, move, 2.6, 2.5e-3), 0);
}

TEST(DisplacementUnit, OppositeStepsCancelToTheLastBit) {
  Packing packing = listed(row);
  const auto before = packing.grains();
  const Move there{0.0, 0, {0.1, 0.2, 0.3}, {0.68, 0.0, 0.1}};
  Move back = there;
  back.step = -there.step;
  for (int k = 0; k < 100; ++k) {
    spot::displace(packing, scenes::all_movable(packing), there, 4.0, 2.5e-3);
    spot::displace(packing, scenes::all_movable(packing), back, 4.0, 2.5e-3);
  }
  scenes::expect_identical(packing.grains(), before);
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
    for (const Move& move : moves) spot::displace(packing, scenes::all_movable(packing), move, 3.0, 2.5e-3);
    return packing.grains();
  };
  const auto expected = after();
  draws.shuffle(moves);
  scenes::expect_identical(after(), expected);
}

}  // namespace
