// SPDX-License-Identifier: GPL-2.0-or-later
// The tiled packing against loops over all grains and all pairs.
#include "spot/tiled_packing.hpp"

#include <gtest/gtest.h>

#include <map>

#include "scenes.hpp"

namespace {

using spot::Grain;
using spot::Move;
using spot::Quantum;
using spot::TiledPacking;
using spot::Vector3;

constexpr double extent = 100.0;

std::vector<Grain> sorted_grains(const TiledPacking& packing) {
  std::vector<Grain> all;
  packing.visit_grains([&](const Grain& grain) { all.push_back(grain); });
  std::sort(all.begin(), all.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return all;
}

/// The same algorithm, obvious and slow: no cells, no lists.
class PlainPacking {
 public:
  PlainPacking(std::vector<Grain> grains, const spot::Container& container)
      : quantum_(1.0, extent), container_(container), grains_(std::move(grains)) {
    std::sort(grains_.begin(), grains_.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
    for (Grain& grain : grains_)
      for (int axis = 0; axis < 3; ++axis) grain.position[axis] = quantum_.snap(grain.position[axis]);
  }

  int displace(const Move& move, double radius, double influence) {
    int moved = 0;
    for (Grain& grain : grains_) {
      if (grain.held || square(grain.position - move.middle) > radius * radius) continue;
      grain.position += rounded(-influence * move.step);
      ++moved;
    }
    return moved;
  }

  void sweep(const spot::RelaxationParameters& parameters) {
    std::vector<Vector3> pushes(grains_.size(), Vector3::Zero());
    for (std::size_t i = 0; i < grains_.size(); ++i) {
      if (grains_[i].held) continue;
      for (std::size_t j = 0; j < grains_.size(); ++j) {
        const Vector3 from = grains_[i].position - grains_[j].position;
        const double s = 1.0 - square(from);
        if (i == j || s <= 0.0) continue;
        const double scale = parameters.pair_share() * s * (0.5 + s * (0.375 + s * (0.3125 + s * 0.2734375)));
        pushes[i] += rounded(scale * from);
      }
      spot::WallContacts contacts;
      container_.contacts(grains_[i].position, 0.5, contacts);
      for (const spot::WallContact& wall : contacts)
        pushes[i] += rounded(parameters.fixed_share() * (0.5 - wall.distance) * wall.normal);
    }
    for (std::size_t i = 0; i < grains_.size(); ++i) grains_[i].position += pushes[i];
  }

  const std::vector<Grain>& grains() const { return grains_; }

 private:
  static double square(const Vector3& v) { return v.x() * v.x() + v.y() * v.y() + v.z() * v.z(); }
  Vector3 rounded(const Vector3& v) const {
    return {quantum_.round(v.x()), quantum_.round(v.y()), quantum_.round(v.z())};
  }

  Quantum quantum_;
  const spot::Container& container_;
  std::vector<Grain> grains_;
};

/// Moves and sweeps over everything, many more than a list survives.
TEST(TiledPackingBruteForce, MovesAndSweepsEqualThePlainOnesToTheLastBit) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  const auto grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.01, 7);
  TiledPacking tiled(1.0, extent, -1.0, grains, *silo);
  PlainPacking plain(grains, *silo);
  const spot::RelaxationParameters relaxation;
  scenes::Draws draws(3);
  for (int step = 0; step < 300; ++step) {
    const Move move{0.0, 0, draws.in_box({-4, -3, 0}, {4, 3, 7}), draws.in_box({-7, -7, 0}, {7, 7, 4})};
    ASSERT_EQ(tiled.displace(move, 2.6, 5e-3), plain.displace(move, 2.6, 5e-3));
    tiled.update_lists(*silo);
    if (step % 3 == 0) {
      EXPECT_EQ(tiled.sweep(relaxation, 0, 4, 1.0, *silo), grains.size());
      tiled.update_lists(*silo);
      plain.sweep(relaxation);
    }
  }
  scenes::expect_identical(sorted_grains(tiled), plain.grains());
}

TEST(TiledPackingBruteForce, LargestOverlapIsThatOfAllPairs) {
  const auto space = scenes::empty_space();
  const auto grains = scenes::random_grains(300, {0, 0, 0}, {7, 7, 7}, 0.8, 5);
  const TiledPacking packing(1.0, extent, 0.0, grains, *space);
  double largest = 0.0;
  const auto all = sorted_grains(packing);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) largest = std::max(largest, 1.0 - (all[i].position - all[j].position).norm());
  EXPECT_NEAR(packing.largest_overlap().depth, largest, 1e-15);
}

TEST(TiledPackingUnit, ACellThatOverflowsIsMadeLarger) {
  const auto space = scenes::empty_space();
  const auto grains = scenes::random_grains(60, {0, 0, 0}, {1.4, 1.4, 1.4}, 0.2, 9);
  const TiledPacking packing(1.0, extent, 0.0, grains, *space);
  EXPECT_EQ(sorted_grains(packing).size(), grains.size());
}

TEST(TiledPackingUnit, SweepsOnlyCellsThatAreDue) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TiledPacking packing(1.0, extent, -1.0, scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 20.0}, 0.01, 7), *silo);
  const spot::RelaxationParameters relaxation;
  EXPECT_EQ(packing.sweep(relaxation, 1, 4, 1.0, *silo), 0u) << "nobody has moved";
  packing.displace({0.0, 0, {0, 0, 5}, {0.7, 0, 0.1}}, 2.6, 2.5e-3);
  EXPECT_EQ(packing.sweep(relaxation, 2, 4, 1.0, *silo), 0u);
  const std::size_t swept = packing.sweep(relaxation, 1, 4, 1.0, *silo);
  EXPECT_GT(swept, 80u);
  EXPECT_LT(swept, packing.size() / 2);
  EXPECT_EQ(packing.sweep(relaxation, 1, 4, 1.0, *silo), 0u) << "the accounts are settled";
}

TEST(TiledPackingUnit, DeepOverlapsKeepACellDue) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, extent, 0.0, {{1, {1, 1, 1}}, {2, {1.9, 1, 1}}}, *space);
  packing.displace({0.0, 0, {1, 1, 1}, {0, 0, 0}}, 2.6, 2.5e-3);
  const spot::RelaxationParameters relaxation;
  EXPECT_EQ(packing.sweep(relaxation, 1, 4, 0.02, *space), 2u);
  EXPECT_EQ(packing.sweep(relaxation, 1, 4, 0.02, *space), 2u) << "0.02 d were left";
  EXPECT_EQ(packing.sweep(relaxation, 1, 4, 0.02, *space), 0u);
}

TEST(TiledPackingUnit, HeldGrainsStay) {
  const auto space = scenes::empty_space();
  TiledPacking packing(1.0, extent, 0.0, {{1, {1, 1, 1}, true}, {2, {1.9, 1, 1}}}, *space);
  EXPECT_EQ(packing.displace({0.0, 0, {1, 1, 1}, {1, 0, 0}}, 2.6, 2.5e-3), 1);
  packing.sweep({}, 1, 4, 0.02, *space);
  const auto grains = sorted_grains(packing);
  EXPECT_EQ(grains[0].position, Vector3(1, 1, 1));
  EXPECT_GT(grains[1].position.x(), 1.9);
}

}  // namespace
