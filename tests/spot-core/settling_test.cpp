// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that nothing holds come down until contacts do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>

#include "ranks_of_threads.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"
#include "spot/relaxation/settling.hpp"

namespace {

using spot::Grain;
using spot::TiledPacking;
using spot::Vector3;
using spot::Workers;

constexpr double half_width = 10.0, half_depth = 4.0;
constexpr double in_contact = 0.0015;
constexpr std::uint64_t seed = 3;

std::shared_ptr<const spot::Container> silo() { return scenes::small_silo(half_width, half_depth); }

TiledPacking packing(const std::vector<Grain>& grains) { return {1.0, 200.0, 0.0, grains, *silo()}; }

std::map<std::int64_t, Vector3> places(const TiledPacking& packing) {
  std::map<std::int64_t, Vector3> all;
  packing.visit_grains([&](const Grain& grain) { all[grain.id] = grain.position; });
  return all;
}

std::size_t settle(TiledPacking& packing, bool everybody = true, int threads = 1) {
  Workers workers(threads);
  return spot::Settling(packing, seed, in_contact, *silo(), workers).run(everybody);
}

/// So many grains, no two of them in touch, from this height on.
std::vector<Grain> cloud(std::size_t n, double low, double high) {
  return scenes::random_grains(n, {0.5 - half_width, 0.5 - half_depth, low}, {half_width - 0.5, half_depth - 0.5, high},
                               1.05, 4);
}

/// On a simple cubic lattice, as `create_atoms` makes them.
std::vector<Grain> lattice(double spacing, double low, int layers) {
  std::vector<Grain> grains;
  for (int k = 0; k < layers; ++k)
    for (double y = 0.5 - half_depth; y <= half_depth - 0.5; y += spacing)
      for (double x = 0.5 - half_width; x <= half_width - 0.5; x += spacing)
        grains.push_back({static_cast<std::int64_t>(grains.size()) + 1, {x, y, low + k * spacing}});
  return grains;
}

/// From wall to wall between two heights; of a grain across one of them, the part inside.
double packing_fraction(const std::map<std::int64_t, Vector3>& places, double low, double high) {
  const auto below = [](double h) {  // of a sphere of diameter 1, from its centre
    h = std::clamp(h, -0.5, 0.5);
    return scenes::pi * (h / 4.0 - h * h * h / 3.0 + 1.0 / 12.0);
  };
  double volume = 0.0;
  for (const auto& [id, at] : places) volume += below(high - at.z()) - below(low - at.z());
  return volume / (4.0 * half_width * half_depth * (high - low));
}

/// The plain way: grains that touch nothing lower than themselves, of those that are not where they were before.
std::size_t unsupported(const std::map<std::int64_t, Vector3>& places,
                        const std::map<std::int64_t, Vector3>& before = {}) {
  std::size_t n = 0;
  for (const auto& [id, at] : places) {
    const auto old = before.find(id);
    bool held = at.z() < 0.52 || (old != before.end() && old->second == at);
    for (const auto& [other, place] : places)
      held |= other != id && place.z() < at.z() && (place - at).squaredNorm() < 1.02 * 1.02;
    n += held ? 0 : 1;
  }
  return n;
}

TEST(SettlingUnit, PackingsInWhichEverybodyHasSomebodyBelowStay) {
  const auto grains = scenes::dense_grains({-9.5, -3.5, 0.5}, {9.5, 3.5, 12.0}, 0.01, 5);
  TiledPacking settled = packing(grains);
  const auto before = places(settled);
  EXPECT_EQ(settle(settled), 0u);
  EXPECT_TRUE(places(settled) == before);
}

TEST(SettlingUnit, OneGrainFallsOntoTheFloor) {
  TiledPacking settled = packing({{1, {7.0, 1.0, 20.0}}});
  EXPECT_EQ(settle(settled), 1u);
  EXPECT_NEAR(places(settled)[1].z(), 0.5, 0.02);
}

TEST(SettlingUnit, OverTheOrificeItWaitsForSpots) {
  TiledPacking settled = packing({{1, {0.5, 0.0, 20.0}}});
  EXPECT_EQ(settle(settled), 1u);
  EXPECT_GT(places(settled)[1].z(), 0.0);
  EXPECT_LT(places(settled)[1].z(), 0.5);
}

TEST(SettlingUnit, ItRollsIntoAHollow) {
  // Four on the floor, in a square; the fifth comes down onto one of them.
  std::vector<Grain> grains = {{1, {6.0, 0.0, 0.5}}, {2, {7.0, 0.0, 0.5}}, {3, {6.0, 1.0, 0.5}}, {4, {7.0, 1.0, 0.5}}};
  grains.push_back({5, {6.1, 0.12, 5.0}});
  for (Grain& grain : grains) grain.held = grain.id < 5;
  TiledPacking settled = packing(grains);
  EXPECT_EQ(settle(settled), 1u);
  const Vector3 at = places(settled)[5];
  if (at.z() > 0.6) {
    EXPECT_NEAR((at - Vector3(6.5, 0.5, 0.5 + std::sqrt(0.5))).norm(), 0.0, 0.03);
  } else {
    EXPECT_NEAR(at.z(), 0.5, 0.02);  // off to the other side
  }
}

TEST(SettlingUnit, AHeldGrainHangsWhereItIs) {
  TiledPacking settled = packing({{1, {7.0, 1.0, 20.0}, true}});
  settled.change({}, {{2, {7.0, 1.0, 21.0}}}, *silo());
  settle(settled, false);
  EXPECT_EQ(places(settled)[1], Vector3(7.0, 1.0, 20.0));
  EXPECT_NEAR(places(settled)[2].z(), 0.5, 0.02);
}

/// All that stood on a layer comes down when that is taken out; what is below stays.
TEST(SettlingUnit, AGapCloses) {
  auto grains = scenes::dense_grains({-9.5, -3.5, 0.5}, {9.5, 3.5, 16.0}, 0.01, 5);
  std::vector<std::int64_t> band;
  for (const Grain& grain : grains)
    if (grain.position.z() > 6.0 && grain.position.z() < 9.0) band.push_back(grain.id);
  TiledPacking settled = packing(grains);
  const auto before = places(settled);
  settled.change(band, {}, *silo());
  EXPECT_GT(settle(settled, false), 500u);
  const auto after = places(settled);
  EXPECT_EQ(after.size(), before.size() - band.size());
  double highest = 0.0;
  for (const auto& [id, at] : after) {
    highest = std::max(highest, at.z());
    if (before.at(id).z() < 4.0) {
      EXPECT_EQ(at, before.at(id)) << id;
    }
  }
  EXPECT_LT(highest, 15.0);
  EXPECT_GT(packing_fraction(after, 5.0, 9.0), 0.5);
  EXPECT_LT(unsupported(after, before), 20u);
}

/// DEM pours (liggghts-inputs/silo, -var size small, these walls) a bed of 0.576 between 5 and 15 d.
constexpr double poured = 0.576;

void expect_bed(const TiledPacking& packing, double low, double high) {
  const auto bed = places(packing);
  EXPECT_NEAR(packing_fraction(bed, low, high), poured, 0.02);
  EXPECT_LE(packing.largest_overlap().depth, 0.015);
  EXPECT_LT(unsupported(bed), bed.size() / 50);
  for (const auto& [id, at] : bed) EXPECT_GE(at.z(), 0.0) << id;
}

TEST(SettlingStatistical, ACloudBecomesABed) {
  TiledPacking settled = packing(cloud(2500, 5.0, 60.0));
  EXPECT_EQ(settle(settled), settled.size());
  expect_bed(settled, 3.0, 12.0);
}

TEST(SettlingStatistical, ALatticeHighUpBecomesABedAndNoFoam) {
  TiledPacking settled = packing(lattice(1.08, 15.0, 20));
  settle(settled);
  expect_bed(settled, 3.0, 12.0);
}

TEST(SettlingStatistical, GrainsThatComeAFewAtATimeBecomeABed) {
  TiledPacking settled = packing({});
  scenes::Draws draws(8);
  for (std::int64_t k = 0; k < 150; ++k) {
    std::vector<Grain> few;
    for (std::int64_t i = 0; i < 15; ++i)
      few.push_back({15 * k + i + 1, {draws.uniform(-9.5, 9.5), draws.uniform(-3.5, 3.5), 25.0 + 1.1 * i}});
    settled.change({}, few, *silo());
    EXPECT_EQ(settle(settled, false), 15u);
  }
  expect_bed(settled, 3.0, 10.0);
}

class SettlingInvariance : public testing::TestWithParam<int> {};

/// On ranks, in another order of the grains, on threads.
TEST_P(SettlingInvariance, RanksAndOrderChangeNothing) {
  const auto first = scenes::dense_grains({-9.5, -3.5, 0.5}, {9.5, 3.5, 9.0}, 0.01, 5);
  std::vector<Grain> more = cloud(400, 12.0, 30.0);
  for (Grain& grain : more) grain.id += 100000;
  std::vector<std::int64_t> gone;
  for (const Grain& grain : first)
    if (grain.position.head<2>().norm() < 3.0 && grain.position.z() > 3.0) gone.push_back(grain.id);
  static const auto alone = [&] {
    TiledPacking packing = ::packing(first);
    packing.change(gone, more, *silo());
    EXPECT_GE(settle(packing, false), 400u);
    return places(packing);
  }();
  const int ranks = GetParam();
  scenes::Draws(9).shuffle(more);
  std::map<std::int64_t, Vector3> shared;
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto part = [&](const std::vector<Grain>& all) {
      std::vector<Grain> own;
      for (std::size_t i = 0; i < all.size(); ++i)
        if (static_cast<int>(i) % ranks == communicator->rank()) own.push_back(all[i]);
      return own;
    };
    TiledPacking packing(1.0, 200.0, 0.0, part(first), *silo(), communicator);
    packing.change(communicator->rank() == 0 ? gone : std::vector<std::int64_t>(), part(more), *silo());
    settle(packing, false, 2);
    const std::lock_guard<std::mutex> lock(mutex);
    packing.visit_grains([&](const Grain& grain) { shared[grain.id] = grain.position; });
  });
  EXPECT_TRUE(shared == alone);
}

INSTANTIATE_TEST_SUITE_P(Ranks, SettlingInvariance,
                         testing::ValuesIn(scenes::sanitized() ? std::vector<int>{3}
                                                               : std::vector<int>{1, 2, 3, 5, 8}));

}  // namespace
