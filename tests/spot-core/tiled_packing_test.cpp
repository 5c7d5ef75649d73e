// SPDX-License-Identifier: GPL-2.0-or-later
// The tiled packing against loops over all grains and all pairs.
#include "spot/packing/tiled_packing.hpp"
#include "spot/relaxation/cell_relaxation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "general_scene.hpp"
#include "named.hpp"
#include "plain_packing.hpp"
#include "scenes.hpp"
#include "spot/geometry/plane_wall.hpp"
#include "spot/walk/free_surface.hpp"

namespace {

using scenes::PlainPacking;
using spot::Grain;
using spot::grain_volume;
using spot::InvalidParameter;
using spot::Move;
using spot::Overlap;
using spot::PlaneWall;
using spot::RelaxationParameters;
using spot::RelaxationStrength;
using spot::SpotParameters;
using spot::TiledPacking;
using spot::Vector3;
using spot::WalledContainer;
using spot::Workers;
using testing::AllOf;
using testing::HasSubstr;

std::vector<Grain> sorted_grains(const TiledPacking& packing) {
  std::vector<Grain> all;
  packing.visit_grains([&](const Grain& grain) { all.push_back(grain); });
  std::sort(all.begin(), all.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return all;
}

/// The deepest overlap of all pairs and their images, as a share of the sum of their radii.
double deepest_of(const std::vector<Grain>& grains, const spot::Periodic& periodic = {}) {
  double least = 1.0;
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 apart = periodic.nearest(Vector3(grains[i].position - grains[j].position));
      least = std::min(least, apart.norm() / (grains[i].radius + grains[j].radius));
    }
  return 1.0 - least;
}

/// Carries out moves with the weights that they have; the shares that they enclosed.
std::vector<int> carry_out(TiledPacking& packing, std::vector<Move> moves, const SpotParameters& spots,
                           const spot::Container& container, Workers& workers) {
  std::vector<int> enclosed;
  packing.displace(
      moves, spots, [&](const std::vector<int>& shares, std::vector<Move>&) { enclosed = shares; }, container, workers);
  return enclosed;
}

bool none_is_closed(const Vector3&) { return false; }

/// What is done to a packing. Lengths in diameters; the numbers of the default are for a box of 11 x 7 x 8 centres.
struct Treatment {
  std::function<std::shared_ptr<const spot::Container>()> container = [] { return scenes::small_silo(6.0, 4.0); };
  std::vector<Grain> grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.01, 7);
  RelaxationParameters relaxation = {};
  const spot::InfluenceProfile* profile = spot::InfluenceProfile::uniform;
  Vector3 low{-4, -3, 0}, high{4, 3, 7};  // where moves are
  double largest_step = 0.05;             // of a grain along an axis
  bool one_way = false;                   // along x
  int calls = 100, moves_in_call = 12;
  int threads = 1;
  double diameter = 1.0, extent = 100.0, outlet = -1.0;
};

using NamedTreatment = scenes::Named<Treatment>;

RelaxationParameters relaxation_with(double alpha, double momentum,
                                     RelaxationStrength strength = RelaxationStrength::half_each) {
  RelaxationParameters relaxation;
  relaxation.alpha = alpha;
  relaxation.momentum = momentum;
  relaxation.strength = strength;
  return relaxation;
}

Treatment plain_box() { return {}; }

Treatment of_2006() {
  Treatment t;
  t.relaxation = relaxation_with(0.8, 0.0, RelaxationStrength::full_each);
  return t;
}

Treatment parabolic() {
  Treatment t;
  t.profile = spot::InfluenceProfile::parabolic;
  t.threads = 2;
  return t;
}

Treatment with_momentum() {
  Treatment t;
  t.relaxation = relaxation_with(1.2, 0.7);
  t.threads = 2;
  return t;
}

Treatment with_contacts() {
  Treatment t;
  t.relaxation = relaxation_with(0.8, 0.67);
  t.relaxation.contact_overlap = 1.5e-3;
  return t;
}

Treatment closing() {
  Treatment t = with_contacts();
  t.relaxation.closing_gap = 0.02;
  t.relaxation.closing_share = 0.3;
  t.threads = 2;
  return t;
}

Treatment with_held_grains() {
  Treatment t;
  t.relaxation = relaxation_with(1.2, 0.7);
  for (std::size_t i = 0; i < t.grains.size(); i += 5) t.grains[i].held = true;
  return t;
}

/// Pairs and a triple at the same places; some of them held.
Treatment coincident() {
  Treatment t;
  t.relaxation = relaxation_with(0.8, 0.5);
  for (const std::size_t i : {20, 100, 100, 300, 400, 401}) {
    Grain twin = t.grains[i];
    twin.id = 1000 + static_cast<std::int64_t>(t.grains.size());
    twin.held = i >= 400;
    t.grains.push_back(twin);
  }
  t.threads = 3;
  return t;
}

/// Grains jump by more than their diameter.
Treatment large_steps() {
  Treatment t;
  t.largest_step = 1.5;
  t.moves_in_call = 4;
  t.calls = 60;
  return t;
}

/// Many steps in one call, along which grains go much farther than lists allow.
Treatment many_moves() {
  Treatment t;
  t.largest_step = 0.05;
  t.one_way = true;
  t.moves_in_call = 300;
  t.calls = 8;
  t.threads = 2;
  return t;
}

/// Higher than 2^32 quanta.
Treatment tall() {
  Treatment t;
  t.grains = scenes::dense_grains({-1.3, -1.3, 0.0}, {1.3, 1.3, 330.0}, 0.01, 7);
  t.container = [] {
    auto column = scenes::empty_space();
    column->add(std::make_unique<PlaneWall>(Vector3(-1.8, 0, 0), Vector3(1, 0, 0)), 0.0);
    column->add(std::make_unique<PlaneWall>(Vector3(1.8, 0, 0), Vector3(-1, 0, 0)), 0.0);
    column->add(std::make_unique<PlaneWall>(Vector3(0, -1.8, 0), Vector3(0, 2, 0)), 0.0);
    column->add(std::make_unique<PlaneWall>(Vector3(0, 1.8, 0), Vector3(0, -2, 0)), 0.0);
    return std::shared_ptr<const spot::Container>(std::move(column));
  };
  t.extent = 400.0;
  t.outlet = -5.0;
  t.low = {-1, -1, 0};
  t.high = {1, 1, 330};
  t.largest_step = 0.3;
  t.calls = 12;
  t.moves_in_call = 200;
  t.relaxation = relaxation_with(1.2, 0.7);
  return t;
}

Treatment far_from_the_origin() {
  Treatment t;
  const Vector3 there(1e5, -9.9e4, 8e4);
  for (Grain& grain : t.grains) grain.position += there;
  t.low += there;
  t.high += there;
  t.container = [there] { return scenes::box_silo_at(there, 6.0, 4.0); };
  t.extent = 2e5;
  t.outlet += there.z();
  t.relaxation = relaxation_with(1.2, 0.7);
  return t;
}

/// A diameter that is no power of two.
Treatment in_metres() {
  Treatment t;
  const double d = 3e-3;
  for (Grain& grain : t.grains) grain.position *= d;
  t.container = [d] {
    return spot::box_silo(-6.0 * d, 6.0 * d, -4.0 * d, 4.0 * d, spot::Orifice{{0, 0, 0}, 4.0 * d},
                          spot::SpotBuffers{d, d});
  };
  t.diameter = d;
  t.extent = 1.0;
  t.outlet = -d;
  return t;
}

Treatment in_a_cylinder() {
  Treatment t;
  t.container = [] { return spot::cylinder_silo(0.5, 0.0, 4.5, spot::Orifice{{0, 0, 0}, 4.0}, {1.0, 1.0}); };
  t.grains.erase(
      std::remove_if(t.grains.begin(), t.grains.end(),
                     [](const Grain& grain) { return (grain.position - Vector3(0.5, 0, 0)).head<2>().norm() > 4.0; }),
      t.grains.end());
  t.threads = 2;
  return t;
}

/// Walls across axes and others in one container.
Treatment in_a_funnel() {
  Treatment t;
  t.container = [] {
    auto funnel = std::make_unique<WalledContainer>(spot::Orifice{{0, 0, -9}, 4.0});
    funnel->add(std::make_unique<PlaneWall>(Vector3(-5.6, 0, 0), Vector3(1, 0, 0.2)), 0.0);
    funnel->add(std::make_unique<PlaneWall>(Vector3(6, 0, 0), Vector3(-1, 0, 0)), 0.0);
    funnel->add(std::make_unique<PlaneWall>(Vector3(0, -4, 0), Vector3(0, 1, 0)), 0.0);
    funnel->add(std::make_unique<PlaneWall>(Vector3(0, 4, 0), Vector3(0, -1, 0)), 0.0);
    funnel->add(std::make_unique<PlaneWall>(Vector3(0, 0, 9), Vector3(0, 0, -1)), 0.0);
    funnel->add(std::make_unique<PlaneWall>(Vector3(0, 0, 0), Vector3(0, 0, 1)), 0.0);
    return std::shared_ptr<const spot::Container>(std::move(funnel));
  };
  return t;
}

TEST(TiledPackingUnit, MoreAxisPlanesThanBitsAreStillWalls) {
  WalledContainer steps(spot::Orifice{{0, 0, -99}, 4.0});
  for (int k = 0; k < 9; ++k) steps.add(std::make_unique<PlaneWall>(Vector3(-5.0 * k, 0, 0), Vector3(1, 0, 0)), 0.0);
  ASSERT_EQ(steps.axis_planes().size(), 9u);
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {0.25, 0, 0}}}, steps);
  Workers workers(1);
  spot::CellRelaxation(packing, {}).sweep(0, 1.0, steps, workers);
  EXPECT_NEAR(sorted_grains(packing)[0].position.x(), 0.25 + 0.8 * 0.25, 1e-6);
}

/// Radii from a quarter to half of the diameter.
Treatment unequal() {
  Treatment t;
  t.grains = scenes::unequal_grains(1200, {-6, -4, 0}, {6, 4, 9}, {}, 11);
  t.relaxation = relaxation_with(1.0, 0.6);
  t.relaxation.contact_overlap = 1.5e-3;
  for (std::size_t i = 0; i < t.grains.size(); i += 9) t.grains[i].held = true;
  t.threads = 2;
  return t;
}

Treatment unequal_closing() {
  Treatment t = unequal();
  t.relaxation.closing_gap = 0.05;
  t.relaxation.closing_share = 1.0;
  return t;
}

/// Moves reach across the ends of the period, and grains go through them.
Treatment repeating(bool x, bool y, bool equal) {
  Treatment t;
  const Vector3 low(-6, -5, 0), high(6, 5, 9);
  t.container = [=] { return scenes::repeated_silo(low, high, x, y, {{0, 0, 0}, 4.0}, {1.0, 1.0}); };
  t.grains = scenes::unequal_grains(equal ? 500 : 1200, low, high, t.container()->periodic(), 12, 1.0, equal);
  t.relaxation = relaxation_with(1.0, 0.6);
  t.low = low;
  t.high = high;
  t.largest_step = 0.2;
  t.one_way = true;
  t.threads = 3;
  return t;
}

class TiledPackingBruteForce : public testing::TestWithParam<NamedTreatment> {};

/// Covered cells left out, the free surface is that of all grains. Returns how many were visited.
std::size_t expect_same_surface(const TiledPacking& packing, const spot::Container& container, double diameter) {
  spot::FreeSurface of_all({2.6 * diameter}, container, diameter), surface = of_all;
  packing.visit_grains([&](const Grain& grain) { of_all.add(grain.position); });
  std::size_t visited = 0;
  const auto add = [&](const Vector3& position) {
    surface.add(position);
    ++visited;
  };
  packing.cells().visit_uncovered(add,
                                  [&](const Vector3& low, const Vector3& high) { return surface.covers(low, high); });
  spot::Bytes expected, found;
  of_all.save(expected);
  surface.save(found);
  EXPECT_EQ(found, expected);
  return visited;
}

/// Moves and sweeps over everything, many more than a list survives.
TEST_P(TiledPackingBruteForce, MovesAndSweepsEqualThePlainOnesToTheLastBit) {
  const Treatment t = GetParam().make();
  const auto container = t.container();
  TiledPacking tiled(t.diameter, t.extent, t.outlet, t.grains, *container);
  PlainPacking plain(t.diameter, t.extent, t.outlet, t.grains, *container);
  Workers workers(t.threads);
  SpotParameters spots{2.6 * t.diameter, 5e-3};
  spots.profile = t.profile;
  const double step = t.largest_step / spots.influence;
  scenes::Draws draws(3);
  std::vector<int> moved;
  int total = 0;
  for (int call = 0; call < t.calls; ++call) {
    std::vector<Move> moves(draws.below(static_cast<std::size_t>(t.moves_in_call) + 1));
    for (Move& move : moves) {
      move.middle = t.diameter * draws.in_box(t.low, t.high);
      move.step = t.diameter * draws.in_box({-step, -step, -0.5 * step}, {step, step, 0.5 * step});
      if (t.one_way) move.step.x() = (call % 2 == 0 ? 1.0 : -1.0) * std::abs(move.step.x());
      move.weight = draws.uniform(0.0, 1.0);
    }
    moved = carry_out(tiled, moves, spots, *container, workers);
    ASSERT_EQ(moved.size(), moves.size());
    for (std::size_t m = 0; m < moves.size(); ++m) {
      ASSERT_EQ(moved[m], plain.shares(moves[m], spots)) << "call " << call;
      total += moved[m] / grain_volume;
    }
    for (const Move& move : moves) plain.displace(move, spots);
    for (int sweep = call % 3; sweep > 0; --sweep) {
      std::size_t free = 0;
      for (const Grain& grain : t.grains) free += grain.held ? 0 : 1;
      ASSERT_EQ(spot::CellRelaxation(tiled, t.relaxation).sweep(0, 1.0, *container, workers), free);
      plain.sweep(t.relaxation);
    }
    if (call % 4 == 3 || call + 1 == t.calls) {
      scenes::expect_identical(sorted_grains(tiled), plain.grains());
      expect_same_surface(tiled, *container, t.diameter);
      if (HasFailure()) FAIL() << "call " << call;
    }
  }
  EXPECT_GT(total, 1000);
  // Lists are complete: they hold the deepest of all pairs.
  const double deepest = deepest_of(plain.grains(), container->periodic());
  EXPECT_GT(deepest, 0.0);
  EXPECT_NEAR(tiled.largest_overlap().depth, deepest, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    Treatments, TiledPackingBruteForce,
    testing::Values(NamedTreatment{"Box", plain_box}, NamedTreatment{"Of2006", of_2006},
                    NamedTreatment{"Parabolic", parabolic}, NamedTreatment{"Momentum", with_momentum},
                    NamedTreatment{"Contacts", with_contacts}, NamedTreatment{"Closing", closing},
                    NamedTreatment{"Held", with_held_grains}, NamedTreatment{"Coincident", coincident},
                    NamedTreatment{"LargeSteps", large_steps}, NamedTreatment{"ManyMoves", many_moves},
                    NamedTreatment{"Tall", tall}, NamedTreatment{"FarAway", far_from_the_origin},
                    NamedTreatment{"Metres", in_metres}, NamedTreatment{"Cylinder", in_a_cylinder},
                    NamedTreatment{"Funnel", in_a_funnel}, NamedTreatment{"Unequal", unequal},
                    NamedTreatment{"UnequalClosing", unequal_closing},
                    NamedTreatment{"AlongX", [] { return repeating(true, false, true); }},
                    NamedTreatment{"AlongY", [] { return repeating(false, true, false); }},
                    NamedTreatment{"AlongBoth", [] { return repeating(true, true, false); }}),
    [](const auto& treatment) { return treatment.param.name; });

TEST(TiledPackingBruteForce, LargestOverlapIsThatOfAllPairs) {
  const auto space = scenes::empty_space();
  const auto grains = scenes::random_grains(300, {0, 0, 0}, {7, 7, 7}, 0.8, 5);
  const TiledPacking packing(1.0, 100.0, 0.0, grains, *space);
  EXPECT_NEAR(packing.largest_overlap().depth, deepest_of(sorted_grains(packing)), 1e-15);
}

TEST(TiledPackingUnit, TheSurfaceIsFoundWithoutWhatIsDeepBelowIt) {
  const auto silo = scenes::small_silo(18.0, 15.0);
  auto grains = scenes::dense_grains({-17.5, -14.5, 0.5}, {17.5, 14.5, 20.0}, 0.01, 7);
  grains.erase(std::remove_if(grains.begin(), grains.end(),
                              [](const Grain& grain) { return grain.position.z() > 14.0 + 0.2 * grain.position.x(); }),
               grains.end());
  const TiledPacking packing(1.0, 100.0, -1.0, grains, *silo);
  EXPECT_LT(expect_same_surface(packing, *silo, 1.0), grains.size() / 8);
}

/// In a sweep over some cells, grains are pushed off those that stay with full strength.
TEST(TiledPackingBruteForce, ASweepOfSomeCellsEqualsThePlainOne) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TiledPacking tiled(1.0, 100.0, -1.0, scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 20.0}, 0.01, 7), *silo);
  Workers workers(2);
  scenes::Draws draws(4);
  std::vector<int> moved;
  const RelaxationParameters relaxation = relaxation_with(1.2, 0.0);
  std::size_t pushed_in_rounds = 0;
  for (int round = 0; round < 30; ++round) {
    std::vector<Move> moves(1 + draws.below(3));
    for (Move& move : moves) {
      move.middle = draws.in_box({-4, -3, 0}, {4, 3, 19});
      move.step = draws.in_box({-7, -7, -7}, {7, 7, 7});
    }
    moved = carry_out(tiled, moves, {2.6, 5e-3}, *silo, workers);
    const auto before = sorted_grains(tiled);
    PlainPacking plain(1.0, 100.0, -1.0, before, *silo), all = plain;
    all.sweep(relaxation);
    const auto pushed_in_all = all.grains();
    const std::size_t swept = spot::CellRelaxation(tiled, relaxation).sweep(1, 1.0, *silo, workers);
    const auto after = sorted_grains(tiled);
    // Grains that are swept and overlap nobody stay where they are, too, but then they push nobody either.
    std::set<std::int64_t> pushed;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const bool goes = after[i].position != before[i].position;
      if (goes) pushed.insert(after[i].id);
      for (const Move& move : moves)
        if ((before[i].position - move.middle).norm() < 2.6) {
          ASSERT_TRUE(goes || pushed_in_all[i].position == before[i].position)
              << "grain " << after[i].id << " is where a spot was";
        }
    }
    plain.sweep(relaxation, [&](std::int64_t id) { return pushed.count(id) > 0; });
    scenes::expect_identical(after, plain.grains());
    if (HasFailure()) FAIL() << "round " << round;
    pushed_in_rounds += pushed.size();
    EXPECT_LE(pushed.size(), swept);
    EXPECT_LT(swept, tiled.size());
    while (spot::CellRelaxation(tiled, relaxation).sweep(1, 1.0, *silo, workers) > 0) {
    }
  }
  EXPECT_GT(pushed_in_rounds, 100u);
}

TEST(TiledPackingInvariance, ThreadsChangeNothing) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  const auto start = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 20.0}, 0.01, 7);
  std::vector<std::vector<Grain>> left, out;
  std::vector<std::vector<std::size_t>> counts;
  for (const int threads : {1, 2, 3, 4}) {
    TiledPacking packing(1.0, 100.0, -1.0, start, *silo);
    Workers workers(threads);
    scenes::Draws draws(6);
    counts.emplace_back();
    out.emplace_back();
    std::vector<int> moved;
    for (int round = 0; round < 60; ++round) {
      std::vector<Move> moves(draws.below(30));
      for (Move& move : moves) {
        move.middle = draws.in_box({-4, -3, 0}, {4, 3, 19});
        move.step = draws.in_box({-7, -7, 0}, {7, 7, 7});
      }
      moved = carry_out(packing, moves, {2.6, 5e-3}, *silo, workers);
      for (const int n : moved) counts.back().push_back(static_cast<std::size_t>(n));
      counts.back().push_back(spot::CellRelaxation(packing, relaxation_with(1.2, 0.7)).sweep(2, 0.02, *silo, workers));
      packing.take_out_below(0.48, none_is_closed, out.back());
    }
    left.push_back(sorted_grains(packing));
    std::sort(out.back().begin(), out.back().end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  }
  EXPECT_LT(left[0].size(), start.size());
  for (std::size_t k = 1; k < left.size(); ++k) {
    EXPECT_EQ(counts[k], counts[0]) << k + 1 << " threads";
    scenes::expect_identical(left[k], left[0]);
    scenes::expect_identical(out[k], out[0]);
  }
}

TEST(TiledPackingUnit, ACellThatOverflowsIsMadeLarger) {
  const auto space = scenes::empty_space();
  const auto grains = scenes::random_grains(60, {0, 0, 0}, {1.4, 1.4, 1.4}, 0.2, 9);
  const TiledPacking packing(1.0, 100.0, 0.0, grains, *space);
  EXPECT_EQ(sorted_grains(packing).size(), grains.size());
}

std::vector<Move> one_move(const Vector3& middle, const Vector3& step) { return {{0.0, 0, middle, step}}; }

/// Moves that bring more and more grains into one cell, which is made larger while they have momentum.
TEST(TiledPackingBruteForce, ACellThatOverflowsInFlowIsMadeLarger) {
  const auto space = scenes::empty_space();
  auto grains = scenes::dense_grains({0, 0, 0}, {6, 6, 6}, 0.01, 3);
  TiledPacking tiled(1.0, 100.0, 0.0, grains, *space);
  PlainPacking plain(1.0, 100.0, 0.0, grains, *space);
  Workers workers(2);
  const RelaxationParameters relaxation = relaxation_with(0.2, 0.7);
  std::vector<int> moved;
  const std::size_t memory = tiled.memory();
  for (int k = 0; k < 60; ++k) {
    // Everything around a point of a sphere goes a little to its centre.
    const double turn = 2.4 * k;
    const Vector3 out(std::cos(turn) * std::cos(k), std::sin(turn) * std::cos(k), std::sin(k));
    const auto moves = one_move(Vector3(3, 3, 3) + 2.0 * out, 60.0 * out);
    moved = carry_out(tiled, moves, {2.0, 5e-3}, *space, workers);
    ASSERT_EQ(moved[0], plain.shares(moves[0], {2.0, 5e-3}));
    plain.displace(moves[0], {2.0, 5e-3});
    spot::CellRelaxation(tiled, relaxation).sweep(0, 1.0, *space, workers);
    plain.sweep(relaxation);
  }
  scenes::expect_identical(sorted_grains(tiled), plain.grains());
  EXPECT_GT(tiled.memory(), memory) << "no cell overflowed, so this tested nothing";
}

TEST(TiledPackingUnit, SweepsOnlyCellsWithEnoughUnrelaxedMoves) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TiledPacking packing(1.0, 100.0, -1.0, scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 20.0}, 0.01, 7), *silo);
  Workers workers(1);
  std::vector<int> moved;
  const RelaxationParameters relaxation;
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(1, 1.0, *silo, workers), 0u) << "nobody has moved";
  moved = carry_out(packing, one_move({0, 0, 5}, {0.7, 0, 0.1}), {2.6, 2.5e-3}, *silo, workers);
  EXPECT_GT(moved[0], 70 * grain_volume);
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(2, 1.0, *silo, workers), 0u);
  const std::size_t swept = spot::CellRelaxation(packing, relaxation).sweep(1, 1.0, *silo, workers);
  EXPECT_GT(swept, 80u);
  EXPECT_LT(swept, packing.size() / 2);
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(1, 1.0, *silo, workers), 0u) << "no move is left unrelaxed";
}

TEST(TiledPackingUnit, ASweepTakesOffAsManyMovesAsItIsMadeFor) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TiledPacking packing(1.0, 100.0, -1.0, scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 20.0}, 0.01, 7), *silo);
  Workers workers(1);
  std::vector<int> moved;
  for (const int moves : {1, 2, 3, 7}) {
    // Of 14 moves one after the other, some relaxed together.
    for (int k = 0; k < 14; ++k)
      moved = carry_out(packing, one_move({0, 0, 5}, {0.7, 0, 0.1}), {2.6, 1e-5}, *silo, workers);
    std::size_t swept = 0;
    for (int sweep = 0; sweep < 14 / moves; ++sweep) {
      const std::size_t now = spot::CellRelaxation(packing, {}).sweep(moves, 1.0, *silo, workers);
      EXPECT_GT(now, 0u) << moves << " moves are enough, sweep " << sweep;
      if (sweep > 0) {
        EXPECT_EQ(now, swept);
      }
      swept = now;
    }
    EXPECT_EQ(spot::CellRelaxation(packing, {}).sweep(moves, 1.0, *silo, workers), 0u);
    if (14 % moves > 0) {
      EXPECT_GT(spot::CellRelaxation(packing, {}).sweep(14 % moves, 1.0, *silo, workers), 0u) << "what is left over";
    }
    EXPECT_EQ(spot::CellRelaxation(packing, {}).sweep(1, 1.0, *silo, workers), 0u) << moves;
  }
}

TEST(TiledPackingUnit, ACellWithDeepOverlapsIsSweptAgain) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {1, 1, 1}}, {2, {1.9, 1, 1}}}, *space);
  Workers workers(1);
  std::vector<int> moved;
  moved = carry_out(packing, one_move({1, 1, 1}, {0, 0, 0}), {2.6, 2.5e-3}, *space, workers);
  const RelaxationParameters relaxation;
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(1, 0.02, *space, workers), 2u);
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(1, 0.02, *space, workers), 2u) << "0.02 d were left";
  EXPECT_EQ(spot::CellRelaxation(packing, relaxation).sweep(1, 0.02, *space, workers), 0u);
}

TEST(TiledPackingUnit, HeldGrainsStay) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {1, 1, 1}, true}, {2, {1.9, 1, 1}}}, *space);
  Workers workers(1);
  std::vector<int> moved;
  moved = carry_out(packing, one_move({1, 1, 1}, {1, 0, 0}), {2.6, 2.5e-3}, *space, workers);
  EXPECT_EQ(moved, std::vector<int>{grain_volume});
  EXPECT_EQ(spot::CellRelaxation(packing, {}).sweep(1, 0.02, *space, workers), 1u);
  const auto grains = sorted_grains(packing);
  EXPECT_EQ(grains[0].position, Vector3(1, 1, 1));
  EXPECT_GT(grains[1].position.x(), 1.9);
}

TEST(TiledPackingAnalytic, MomentumCarriesTheLastCorrectionOn) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {1, 1, 1}}, {2, {1.9, 1, 1}}}, *space);
  Workers workers(1);
  // The first sweep opens the pair by alpha = 1, the whole of the overlap of 0.1 d; then only momentum is left.
  double expected = 1.0 - 0.05;
  double step = 0.05;
  for (int sweep = 0; sweep < 10; ++sweep) {
    spot::CellRelaxation(packing, relaxation_with(1.001, 0.5)).sweep(0, 1.0, *space, workers);
    if (sweep > 0) expected -= step;
    step *= 0.5;
    EXPECT_NEAR(sorted_grains(packing)[0].position.x(), expected, 1e-3) << "sweep " << sweep;
  }
}

TEST(TiledPackingAnalytic, GrainsComeToRestInContact) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {1, 1, 1}}, {2, {1.96, 1, 1}}, {3, {5, 1, 1}}, {4, {5.995, 1, 1}}},
                       *space);
  Workers workers(1);
  RelaxationParameters relaxation;
  relaxation.contact_overlap = 0.01;
  spot::CellRelaxation sweeps(packing, relaxation);
  sweeps.sweep(0, 1.0, *space, workers);
  EXPECT_NEAR(sweeps.largest_overlap(), 0.04, 1e-6) << "before the sweep, in diameters";
  for (int sweep = 0; sweep < 20; ++sweep) spot::CellRelaxation(packing, relaxation).sweep(0, 1.0, *space, workers);
  const auto grains = sorted_grains(packing);
  EXPECT_NEAR(grains[1].position.x() - grains[0].position.x(), 0.99, 1e-6);
  EXPECT_NEAR(grains[3].position.x() - grains[2].position.x(), 0.995, 1e-6) << "nobody parts those who overlap by less";
}

/// Gaps of 0.003 beyond where they are left alone, of 0.005 and, of grains that are in contact, none.
TEST(TiledPackingAnalytic, SmallGapsAreClosedAndNoOthers) {
  const auto space = scenes::empty_space();
  RelaxationParameters relaxation;
  relaxation.contact_overlap = 0.01;
  relaxation.closing_gap = 0.004;
  relaxation.closing_share = 0.25;
  TiledPacking packing(
      1.0, 100.0, 0.0,
      {{1, {1, 1, 1}}, {2, {1.993, 1, 1}}, {3, {5, 1, 1}}, {4, {5.995, 1, 1}}, {5, {9, 1, 1}}, {6, {9.99, 1, 1}}},
      *space);
  Workers workers(1);
  spot::CellRelaxation sweeps(packing, relaxation);
  const auto distance = [&](std::size_t i) {
    const auto grains = sorted_grains(packing);
    return grains[i + 1].position.x() - grains[i].position.x();
  };
  double gap = 0.003;
  for (int sweep = 0; sweep < 5; ++sweep) {
    sweeps.sweep(0, 1.0, *space, workers);
    EXPECT_NEAR(sweeps.largest_overlap(), 0.01, 1e-6) << "gaps are no overlaps";
    gap *= 1.0 - 0.25 * 0.8;  // each grain by half of that
    EXPECT_NEAR(distance(0), 0.99 + gap, 1e-6) << "sweep " << sweep;
    EXPECT_NEAR(distance(2), 0.995, 1e-6);
    EXPECT_NEAR(distance(4), 0.99, 1e-6);
  }
}

/// Both grains go towards each other until they have a gap: almost as far as lists allow, or a little farther.
TEST(TiledPackingAnalytic, ListsHoldGapsAsLongAsPairsInContact) {
  const auto space = scenes::empty_space();
  RelaxationParameters relaxation;
  relaxation.closing_gap = 0.05;
  relaxation.closing_share = 0.5;
  Workers workers(1);
  for (double start = 1.3; start < 1.75; start += 0.005) {
    TiledPacking packing(1.0, 100.0, -5.0, {{1, {1, 1, 1}}, {2, {1 + start, 1, 1}}}, *space);
    spot::CellRelaxation sweeps(packing, relaxation);
    spot::Cells& cells = packing.cells();
    const auto by = static_cast<std::int32_t>(0.5 * (start - 1.04) / packing.quantum().length());
    cells.visit_own([&](std::uint32_t slot) {
      cells.points[slot].x += cells.ids[slot] == 1 ? by : -by;
      cells.drift.add(cells.cell_of(slot), by);
    });
    packing.update_lists(*space, workers);
    sweeps.sweep(0, 1.0, *space, workers);
    const auto grains = sorted_grains(packing);
    EXPECT_NEAR(grains[1].position.x() - grains[0].position.x(), 1.04 - 0.4 * 0.04, 1e-6) << start;
  }
}

TEST(TiledPackingUnit, CoincidentGrainsPartAlongX) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0, {{7, {1, 1, 1}}, {3, {1, 1, 1}}}, *space);
  Workers workers(1);
  spot::CellRelaxation(packing, {}).sweep(0, 1.0, *space, workers);
  const auto grains = sorted_grains(packing);
  EXPECT_NEAR(grains[0].position.x(), 0.6, 1e-6);
  EXPECT_NEAR(grains[1].position.x(), 1.4, 1e-6);
  for (const Grain& grain : grains) EXPECT_EQ(grain.position.tail<2>(), Eigen::Vector2d(1, 1));
}

/// Walls across axes, which have a short cut, push as all other walls do.
TEST(TiledPackingAnalytic, GrainsArePushedOffPlanesByAlphaDelta) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  for (const double overlap : {0.3, 0.01, 1e-4}) {
    const double x = 5.5 + overlap, y = -3.5 - 0.5 * overlap;
    TiledPacking packing(1.0, 100.0, -1.0, {{1, {x, y, 5}}, {2, {-x, -y, 5}}, {3, {0, 0, 5}}}, *silo);
    Workers workers(1);
    spot::CellRelaxation(packing, relaxation_with(0.8, 0.0)).sweep(0, 1.0, *silo, workers);
    const auto grains = sorted_grains(packing);
    for (const int sign : {1, -1}) {
      const Vector3& at = grains[sign > 0 ? 0 : 1].position;
      EXPECT_NEAR(sign * at.x(), 5.5 + 0.2 * overlap, 3e-7);
      EXPECT_NEAR(sign * at.y(), -3.5 - 0.1 * overlap, 3e-7);
      EXPECT_EQ(at.z(), 5.0);
    }
    EXPECT_EQ(grains[2].position, Vector3(0, 0, 5));
  }
}

/// Coordinates wrap around; walls that are farther from a grain than they reach must not seem near.
TEST(TiledPackingUnit, WideSilosHaveTheWallsWhereTheyAre) {
  for (const double width : {60.0, 100.0, 127.0, 129.0, 150.0, 250.0, 257.0, 300.0, 400.0, 600.0}) {
    for (const double d : {1.0, 1.99}) {
      const double half = 0.5 * width * d;
      const auto silo =
          spot::box_silo(-half, half, -4.0 * d, 4.0 * d, spot::Orifice{{0, 0, 0}, 4.0 * d}, spot::SpotBuffers{d, d});
      std::vector<Grain> start;
      for (double x = -half + 0.6 * d; x <= half - 0.6 * d; x += 0.05 * (half - 0.6 * d))
        start.push_back({static_cast<std::int64_t>(start.size()) + 1, {x, 0.0, 3.0 * d}});
      TiledPacking packing(d, 1000.0 * d, 0.0, start, *silo);
      Workers workers(1);
      const auto before = sorted_grains(packing);
      spot::CellRelaxation(packing, {}).sweep(0, 1.0, *silo, workers);
      scenes::expect_identical(sorted_grains(packing), before);
      ASSERT_FALSE(HasFailure()) << width << " diameters of " << d;
    }
  }
}

TEST(TiledPackingUnit, TakesOutWhatIsBelowTheOutlet) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, 0.0,
                       {{1, {1, 1, 0.001}}, {2, {2, 2, 0.001}, true}, {3, {1, 1, 0.9}}, {4, {1, 1, 1.9}}}, *space);
  Workers workers(1);
  std::vector<int> moved;
  std::vector<Grain> out;
  packing.take_out_below(0.0, none_is_closed, out);
  EXPECT_TRUE(out.empty());
  moved = carry_out(packing, one_move({1, 1, 0}, {0, 0, 0.1}), {2.6, 0.05}, *space, workers);
  packing.take_out_below(0.0, none_is_closed, out);
  ASSERT_EQ(out.size(), 1u) << "held grains stay";
  EXPECT_EQ(out[0].id, 1);
  EXPECT_NEAR(out[0].position.z(), -0.004, 1e-6);
  EXPECT_EQ(packing.size(), 3u);
  EXPECT_NEAR(packing.largest_overlap().depth, 0.0, 1e-6) << "who is out overlaps with nobody";
}

TEST(TiledPackingUnit, PutsUpWhatIsBelowWhereItIsClosed) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, 100.0, -0.3, {{1, {1, 1, -0.29}}, {2, {2.5, 1, -0.29}}}, *space);
  Workers workers(1);
  carry_out(packing, one_move({1.5, 1, 0}, {0, 0, 0.5}), {2.6, 0.05}, *space, workers);
  const auto below = sorted_grains(packing);
  std::vector<Grain> out;
  packing.take_out_below(
      -0.3, [](const Vector3& place) { return place.x() < 2.0; }, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].id, 2);
  const auto left = sorted_grains(packing);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_LT(below[0].position.z(), -0.3);
  EXPECT_GE(left[0].position.z(), -0.3);
  EXPECT_NEAR(left[0].position.z(), -0.3, 1e-6);
  EXPECT_EQ(left[0].position.x(), below[0].position.x());
}

TEST(TiledPackingUnit, SpotsThatAreTooWideAreNamed) {
  const auto space = scenes::empty_space();
  Workers workers(1);
  std::vector<int> moved;
  TiledPacking packing(1.0, 100.0, 0.0, {{1, {1, 1, 1}}}, *space);
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] {
                moved = carry_out(packing, one_move({1, 1, 1}, {1, 0, 0}), {8.0, 2.5e-3}, *space, workers);
              }),
              AllOf(HasSubstr("spot radius is 8 "), HasSubstr("below 8")));
  moved = carry_out(packing, one_move({8.9, 1, 1}, {1, 0, 0}), {7.99, 2.5e-3}, *space, workers);
  EXPECT_EQ(moved[0], grain_volume);
}

/// An empty place has id -1.
TEST(TiledPackingUnit, NegativeIdsAreNamedAndZeroIsAnId) {
  const auto space = scenes::empty_space();
  for (const std::int64_t bad : {std::int64_t{-1}, std::int64_t{-4711}, std::numeric_limits<std::int64_t>::min()})
    EXPECT_THAT(scenes::text_of<spot::InvalidPacking>([&] {
                  TiledPacking(1.0, 100.0, 0.0, {{1, {1, 1, 1}}, {bad, {3, 1, 1}}}, *space);
                }),
                HasSubstr("grain id " + std::to_string(bad) + " is negative"));
  const std::vector<Grain> grains = {{0, {1, 1, 1}, false, 0.5},
                                     {std::numeric_limits<std::int64_t>::max(), {3, 1, 1}, false, 0.5}};
  EXPECT_EQ(sorted_grains(TiledPacking(1.0, 100.0, 0.0, grains, *space)), grains);
}

TEST(TiledPackingUnit, NoMovesNoGrainsNoError) {
  const auto space = scenes::empty_space();
  Workers workers(2);
  std::vector<int> moved = {5};
  TiledPacking packing(1.0, 100.0, 0.0, {}, *space);
  moved = carry_out(packing, {}, {2.6, 2.5e-3}, *space, workers);
  EXPECT_TRUE(moved.empty());
  moved = carry_out(packing, one_move({8.9, 1, 1}, {1, 0, 0}), {2.6, 2.5e-3}, *space, workers);
  EXPECT_EQ(moved, std::vector<int>{0});
  EXPECT_EQ(spot::CellRelaxation(packing, {}).sweep(1, 0.02, *space, workers), 0u);
}

}  // namespace
