// SPDX-License-Identifier: GPL-2.0-or-later
// However many ranks share a drainage, and however often it is saved and goes on: the same bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>

#include "ranks_of_threads.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/parallel/slabs.hpp"

namespace {

using spot::Bytes;
using spot::Counters;
using spot::Grain;
using spot::InvalidState;
using spot::Slabs;
using spot::Spot;
using spot::WindowedDrainage;
using testing::HasSubstr;

constexpr double window = 0.01;
constexpr double height = 16.0;

std::vector<Grain> filling() { return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, height}, 0.01, 2); }

/// With fixed volume, dilation, momentum, and many moves in a window.
struct Scene {
  spot::SpotParameters spots = scenes::paper_spots();
  spot::RelaxationParameters relaxation;
  double window = ::window;
  std::vector<Grain> grains = filling();

  Scene() {
    spots.step_height = 0.8;
    spots.step_width = spot::step_width_for(1.25, spots.step_height);
    spots.fixed_volume = 77;
    spots.dilation = 0.03;
    spots.injection_rate = 120.0;
    relaxation.tolerance = 3e-3;
    relaxation.momentum = 0.6;
    relaxation.contact_overlap = 2e-3;
  }

  template <typename Start>
  std::unique_ptr<WindowedDrainage> drainage(const Start& start, std::shared_ptr<spot::Communicator> ranks) const {
    return std::make_unique<WindowedDrainage>(spots, relaxation, spot::DrainageLimits{-1.0}, window, 1,
                                              scenes::small_silo(6.0, 4.0), 1.0, 100.0, start, std::move(ranks));
  }
};

/// All that there is to know at the end, in order of ids.
struct Outcome {
  std::map<std::int64_t, Grain> grains, drained;
  std::map<std::int64_t, Spot> spots;
  std::map<std::int64_t, std::int64_t> received;  // moves
  Counters counters;
  std::vector<Bytes> saved;
  std::vector<std::size_t> grains_of_rank;
};

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.grains, b.grains);
  EXPECT_EQ(a.drained, b.drained);
  EXPECT_EQ(a.received, b.received);
  ASSERT_EQ(a.spots.size(), b.spots.size());
  for (const auto& [id, spot] : a.spots) {
    ASSERT_TRUE(b.spots.count(id)) << id;
    const Spot& other = b.spots.at(id);
    EXPECT_EQ(spot.position, other.position) << id;
    EXPECT_EQ(spot.steps, other.steps) << id;
    EXPECT_EQ(spot.next_step, other.next_step) << id;
  }
  EXPECT_EQ(a.counters.moves, b.counters.moves);
  EXPECT_EQ(a.counters.volume_moved, b.counters.volume_moved);
  EXPECT_EQ(a.counters.sweeps, b.counters.sweeps);
  EXPECT_EQ(a.counters.grains_swept, b.counters.grains_swept);
  EXPECT_EQ(a.counters.drained, b.counters.drained);
}

/// Lets the scene drain until `time` on so many ranks, from grains or a saved state.
template <typename StartOfRank>
Outcome drain(const Scene& scene, int ranks, double time, const StartOfRank& start_of_rank) {
  Outcome outcome;
  outcome.saved.resize(static_cast<std::size_t>(ranks));
  outcome.grains_of_rank.resize(static_cast<std::size_t>(ranks));
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto rank = static_cast<std::size_t>(communicator->rank());
    const auto drainage = scene.drainage(start_of_rank(static_cast<int>(rank)), communicator);
    drainage->count_moves_received();
    drainage->advance_to(time);
    const Counters counters = drainage->total();
    const std::lock_guard<std::mutex> lock(mutex);
    drainage->visit_grains([&](const Grain& grain) {
      EXPECT_TRUE(outcome.grains.emplace(grain.id, grain).second) << "on two ranks: " << grain.id;
      ++outcome.grains_of_rank[rank];
    });
    for (const Grain& grain : drainage->take_drained()) outcome.drained.emplace(grain.id, grain);
    for (const Spot& spot : drainage->spots()) EXPECT_TRUE(outcome.spots.emplace(spot.id, spot).second);
    for (const auto& [id, moves] : drainage->take_moves_received()) outcome.received[id] += moves;
    outcome.counters = counters;
    outcome.saved[rank] = drainage->save();
  });
  return outcome;
}

/// The scene's grains, which the ranks bring in turn.
Outcome drain(const Scene& scene, int ranks, double time) {
  return drain(scene, ranks, time, [&](int rank) {
    std::vector<Grain> part;
    for (std::size_t i = 0; i < scene.grains.size(); ++i)
      if (static_cast<int>(i) % ranks == rank) part.push_back(scene.grains[i]);
    return part;
  });
}

class RanksInvariance : public testing::TestWithParam<int> {};

/// 11 layers: with 11 ranks every one has one of them, with 14 three have none.
TEST_P(RanksInvariance, ChangeNothing) {
  const Scene scene;
  static const Outcome alone = drain(scene, 1, 4.0);
  ASSERT_GT(alone.drained.size(), 20u);
  ASSERT_GT(alone.counters.sweeps, 100);
  const Outcome shared = drain(scene, GetParam(), 4.0);
  expect_same(shared, alone);
  for (int rank = 0; rank < std::min(GetParam(), 10); ++rank)
    EXPECT_GT(shared.grains_of_rank[static_cast<std::size_t>(rank)], 0u) << rank;
}

TEST_P(RanksInvariance, ChangeNothingInLongWindowsInWhichListsMustBeMadeAnew) {
  Scene scene;
  scene.window = 0.25;
  scene.spots.influence = 0.02;
  static const Outcome alone = drain(scene, 1, 2.0);
  expect_same(drain(scene, GetParam(), 2.0), alone);
}

TEST_P(RanksInvariance, GoOnFromAStateThatOthersHaveSaved) {
  const Scene scene;
  static const Outcome whole = drain(scene, 1, 4.0);
  for (const int before : {1, 3}) {
    const Outcome half = drain(scene, before, 2.0);
    Outcome rest = drain(scene, GetParam(), 4.0, [&](int) { return half.saved; });
    rest.drained.insert(half.drained.begin(), half.drained.end());
    for (const auto& [id, moves] : half.received) rest.received[id] += moves;
    expect_same(rest, whole);
  }
}

/// Of moves and sweeps low in the packing, in which the last of the ranks has no part until layers are shared out anew.
TEST(BalanceInvariance, LayersGoWhereTheWorkIsAndNothingElseChanges) {
  constexpr double low = 6.0;
  const auto silo = scenes::small_silo(6.0, 4.0);
  const auto start = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 40.0}, 0.01, 3);
  scenes::Draws draws(5);
  std::vector<std::vector<spot::Move>> rounds(40);
  for (std::size_t round = 0; round < rounds.size(); ++round)
    for (int k = 0; k < 20; ++k) {
      spot::Move move{};
      move.spot = static_cast<std::int64_t>(20 * round) + k;
      move.middle = draws.in_box({-4, -3, 2}, {4, 3, low});
      move.step = draws.in_box({-7, -7, 0}, {7, 7, 7});
      rounds[round].push_back(move);
    }
  // What each rank has in the end, and the highest of its grains.
  const auto work = [&](int ranks, bool balance, std::vector<double>& tops) {
    std::map<std::int64_t, Grain> grains;
    std::mutex mutex;
    int changes = 0;
    scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
      spot::TiledPacking packing(1.0, 100.0, -1.0, communicator->rank() == 0 ? start : std::vector<Grain>{}, *silo,
                                 communicator);
      spot::Workers workers(1);
      for (std::size_t round = 0; round < rounds.size(); ++round) {
        std::vector<spot::Move> moves = rounds[round];
        packing.displace(
            moves, {2.6, 5e-3}, [](const auto&, auto&) {}, *silo, workers);
        spot::CellRelaxation(packing, {}).sweep(2, 0.02, *silo, workers);
        if (balance && round % 10 == 9 && packing.balance(*silo) && communicator->rank() == 0) ++changes;
      }
      double top = 0.0;
      const std::lock_guard<std::mutex> lock(mutex);
      packing.visit_grains([&](const Grain& grain) {
        EXPECT_TRUE(grains.emplace(grain.id, grain).second) << "on two ranks: " << grain.id;
        top = std::max(top, grain.position.z());
      });
      tops[static_cast<std::size_t>(communicator->rank())] = top;
    });
    EXPECT_EQ(changes > 0, balance);
    return grains;
  };
  std::vector<double> alone(1), unbalanced(3), balanced(3);
  const auto expected = work(1, false, alone);
  ASSERT_EQ(expected.size(), start.size());
  EXPECT_EQ(work(3, false, unbalanced), expected);
  EXPECT_EQ(work(3, true, balanced), expected);
  EXPECT_GT(unbalanced[0], low + 3.0);
  EXPECT_LT(balanced[0], low);
  // The last rank takes grains off the others' hands, but no more than one and a half times what they have of the work.
  EXPECT_GT(balanced[1], 0.25 * 40.0);
}

/// A spot that goes on for ever: its moves keep their order on all ranks, of which each knows others of them. They are
/// so long that lists have to be brought up to date between them.
TEST(CountersInvariance, MovesKeepTheirOrderBeyondAnyNumberOfSteps) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  const auto start = filling();
  const auto moved = [&](int ranks, std::int64_t before) {
    scenes::Draws draws(11);
    std::vector<spot::Move> all(60);
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k].spot = 7;
      all[k].number = before + static_cast<std::int64_t>(k);
      all[k].middle = draws.in_box({-4, -3, 2}, {4, 3, height - 2.0});
      all[k].step = draws.in_box({-16, -16, -16}, {16, 16, 16});
    }
    std::map<std::int64_t, Grain> grains;
    std::mutex mutex;
    scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
      spot::TiledPacking packing(1.0, 100.0, -1.0, communicator->rank() == 0 ? start : std::vector<Grain>{}, *silo,
                                 communicator);
      spot::Workers workers(1);
      std::vector<spot::Move> moves;
      for (const spot::Move& move : all) {
        const auto [first, last] = packing.reached(move.middle.z(), 2.6);
        if (communicator->rank() >= first && communicator->rank() <= last) moves.push_back(move);
      }
      packing.displace(
          moves, {2.6, 2e-2}, [](const auto&, auto&) {}, *silo, workers);
      const std::lock_guard<std::mutex> lock(mutex);
      packing.visit_grains([&](const Grain& grain) { grains.emplace(grain.id, grain); });
    });
    return grains;
  };
  const auto expected = moved(1, 1);
  ASSERT_EQ(expected.size(), start.size());
  for (const int bits : {20, 31, 32, 52})
    for (const int ranks : {1, 3}) EXPECT_EQ(moved(ranks, (std::int64_t{1} << bits) - 30), expected) << bits;
}

/// A saved state of one rank as it would be so many steps of every spot, spots and windows later.
Bytes later(const Bytes& saved, std::int64_t steps, std::int64_t spots, std::int64_t windows) {
  spot::ByteReader reader = spot::unseal(saved);
  Bytes bytes;
  const auto shift = [&](auto by) {
    const auto value = reader.take<decltype(by)>() + by;
    spot::append(bytes, value);
    return value;
  };
  const double time = static_cast<double>(windows) * window;
  shift(windows);
  Counters counters = reader.take<Counters>();
  counters.moves += steps;
  spot::append(bytes, counters);
  shift(spots);
  for (int k = 0; k < 2; ++k) shift(time);         // of the next birth, and since when it is awaited
  shift(0.0);                                      // births that were expected then
  spot::append(bytes, reader.take_all<double>());  // factors on rates
  for (auto n = shift(std::uint64_t{0}); n > 0; --n) {
    shift(spots);
    shift(steps);
    spot::append(bytes, reader.take<spot::Vector3>());
    shift(time);
    for (int k = 0; k < 4; ++k) shift(0.0);  // direction, chance, relative speed, volume
    shift(std::int64_t{0});                  // outlet
  }
  shift(std::int64_t{0});  // times that relative speeds were set
  shift(std::int64_t{0});  // intervals until the surface is found next
  for (int k = 0; k < 2; ++k) spot::append(bytes, reader.take<std::array<int, 3>>());  // ends of the lattice of counts
  spot::append(bytes, reader.take_all<std::int64_t>());
  for (int k = 0; k < 2; ++k) spot::append(bytes, reader.take<std::array<int, 3>>());  // of that of the flow
  for (int k = 0; k < 2; ++k) spot::append(bytes, reader.take_all<double>());  // what was carried of late, and in all
  EXPECT_EQ(shift(std::uint64_t{0}), 0u) << "steps that the flow has not taken in";
  for (int k = 0; k < 2; ++k) spot::append(bytes, reader.take<std::array<int, 3>>());  // and of the surface
  spot::append(bytes, reader.take_all<double>());
  spot::append(bytes, reader.take_all<spot::RateStep>());  // of births, at the one outlet
  spot::append(bytes, reader.take_all<double>());          // the largest
  spot::append(bytes, reader.take_all<char>());            // the packing
  EXPECT_TRUE(reader.at_end());
  spot::seal(bytes);
  return bytes;
}

/// Steps, spots, moves and windows near the ends of 20, 31, 32 and more bits.
TEST(CountersInvariance, DrainagesGoOnBeyondAnyCount) {
  const Scene scene;
  const Outcome half = drain(scene, 1, 1.0);
  for (const int bits : {20, 31, 32, 40}) {
    const std::int64_t limit = std::int64_t{1} << bits, windows = limit - 110;
    // A whole number of windows, as the fix asks for.
    const double end = static_cast<double>(windows + 150) * window;
    const std::vector<Bytes> state = {later(half.saved[0], limit - 2, limit - 150, windows)};
    const Outcome one = drain(scene, 1, end, [&](int) { return state; });
    EXPECT_EQ(spot::ByteReader(one.saved[0]).take<std::int64_t>(), windows + 150);
    EXPECT_GT(one.counters.moves, limit + 100);
    std::int64_t most_steps = 0;
    for (const auto& [id, spot] : one.spots) most_steps = std::max(most_steps, spot.steps);
    EXPECT_GT(most_steps, limit);
    EXPECT_GT(one.spots.rbegin()->first, limit);
    expect_same(drain(scene, 3, end, [&](int) { return state; }), one);
  }
}

INSTANTIATE_TEST_SUITE_P(Numbers, RanksInvariance,
                         testing::ValuesIn(scenes::sanitized() ? std::vector<int>{2, 6}
                                                               : std::vector<int>{1, 2, 3, 4, 6, 11, 14}));

/// One bit: of the beginning first, then anywhere.
void flip(Bytes& bytes, scenes::Draws& draws, int k) {
  const std::size_t bit = k < 256 ? static_cast<std::size_t>(k) : draws.below(8 * bytes.size());
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
}

TEST(SavedStateUnit, DamageIsNamed) {
  const Scene scene;
  const Outcome outcome = drain(scene, 2, 0.5);
  const auto go_on_with = [&](const std::vector<Bytes>& saved) {
    return scenes::text_of<InvalidState>([&] { scene.drainage(saved, std::make_shared<spot::Alone>()); });
  };
  EXPECT_THAT(go_on_with({}), HasSubstr("no saved state"));
  EXPECT_THAT(go_on_with({outcome.saved[0]}), HasSubstr("has 1 parts, not 2"));
  for (std::size_t kept = 0; kept < outcome.saved[1].size(); kept += 1 + outcome.saved[1].size() / 97) {
    std::vector<Bytes> saved = outcome.saved;
    saved[1].resize(kept);
    EXPECT_THAT(go_on_with(saved), HasSubstr("saved state")) << kept << " bytes left";
  }
  scenes::Draws draws(1);
  for (int k = 0; k < 500; ++k) {
    std::vector<Bytes> saved = outcome.saved;
    flip(saved[draws.below(2)], draws, k);
    EXPECT_THAT(go_on_with(saved), HasSubstr("damaged")) << k;
  }
  Scene lower;
  lower.grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 10.0}, 0.01, 2);
  const Outcome other = drain(lower, 2, 0.5);
  EXPECT_THAT(go_on_with({outcome.saved[0], other.saved[1]}), HasSubstr("not of the same run"));
}

TEST(SavedStateInvariance, TheTimeOrderedDriverGoesOnWithTheSameBits) {
  const Scene scene;
  const auto silo = scenes::small_silo(6.0, 4.0);
  const spot::DrainageLimits limits{-1.0};
  spot::RelaxationParameters relaxation;
  relaxation.schedule = spot::RelaxationSchedule::global;
  spot::TimeOrderedDrainage whole(scene.spots, relaxation, limits, silo, spot::Packing(1.0, 100.0, scene.grains));
  whole.advance_to(0.7);
  const Bytes saved = whole.save();
  spot::TimeOrderedDrainage rest(scene.spots, relaxation, limits, silo, 1.0, 100.0, saved);
  whole.advance_to(1.5);
  rest.advance_to(1.5);
  scenes::expect_identical(rest.grains(), whole.grains());
  EXPECT_EQ(rest.counters().moves, whole.counters().moves);
  EXPECT_EQ(rest.counters().sweeps, whole.counters().sweeps);
  EXPECT_EQ(rest.save(), whole.save());
  scenes::Draws draws(2);
  for (int k = 0; k < 500; ++k) {
    Bytes damaged = saved;
    flip(damaged, draws, k);
    EXPECT_THROW(spot::TimeOrderedDrainage(scene.spots, relaxation, limits, silo, 1.0, 100.0, damaged), InvalidState);
  }
}

/// One bit, two of the same place in words, the length: the checksum is another one.
TEST(SavedStateUnit, TheChecksumSeesSmallDamage) {
  Bytes bytes;
  scenes::Draws draws(3);
  for (int k = 0; k < 43; ++k) bytes.push_back(static_cast<char>(draws.below(256)));
  const std::uint64_t whole = spot::checksum(bytes.data(), bytes.size());
  for (std::size_t a = 0; a < 8 * bytes.size(); ++a)
    for (std::size_t b = a; b < 8 * bytes.size(); ++b) {
      Bytes damaged = bytes;
      damaged[a / 8] = static_cast<char>(damaged[a / 8] ^ 1 << a % 8);
      if (b != a) damaged[b / 8] = static_cast<char>(damaged[b / 8] ^ 1 << b % 8);
      ASSERT_NE(spot::checksum(damaged.data(), damaged.size()), whole) << a << ' ' << b;
    }
  for (std::size_t kept = 0; kept < bytes.size(); ++kept) EXPECT_NE(spot::checksum(bytes.data(), kept), whole);
  const Bytes zeros(64, 0);
  EXPECT_NE(spot::checksum(zeros.data(), 56), spot::checksum(zeros.data(), 64));
}

TEST(SlabsUnit, ShareLayersOutByGrains) {
  const Slabs slabs({0, 10, 10, 10, 10, 0}, 2);
  EXPECT_EQ(slabs.first(0), 0);
  EXPECT_EQ(slabs.first(1), 3);
  EXPECT_EQ(slabs.first(2), 6);
  EXPECT_EQ(slabs.owner(-1), 0);
  EXPECT_EQ(slabs.owner(2), 0);
  EXPECT_EQ(slabs.owner(3), 1);
  EXPECT_EQ(slabs.owner(99), 1);
}

TEST(SlabsUnit, EveryRankHasALayerWhileThereAreEnough) {
  for (int layers = 1; layers < 12; ++layers)
    for (int ranks = 1; ranks < 15; ++ranks) {
      std::vector<std::int64_t> grains(static_cast<std::size_t>(layers), 0);
      grains[static_cast<std::size_t>(layers / 2)] = 1000;  // all in one layer
      const Slabs slabs(grains, ranks);
      ASSERT_EQ(slabs.ranks(), ranks);
      EXPECT_EQ(slabs.first(0), 0);
      EXPECT_EQ(slabs.first(ranks), layers);
      for (int rank = 0; rank < ranks; ++rank) {
        const int own = slabs.first(rank + 1) - slabs.first(rank);
        EXPECT_GE(own, rank < layers ? 1 : 0) << layers << " layers, rank " << rank << " of " << ranks;
        for (int layer = slabs.first(rank); layer < slabs.first(rank + 1); ++layer) EXPECT_EQ(slabs.owner(layer), rank);
      }
    }
}

/// Slabs of random layers against all ways to cut them.
TEST(SlabsBruteForce, TheLargestPartIsTheLeastPossible) {
  scenes::Draws draws(8);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t layers = 3 + draws.below(7);
    Slabs::Load work, grains;
    grains.slack = 1.5;
    for (std::size_t layer = 0; layer < layers; ++layer) {
      work.in_layer.push_back(static_cast<std::int64_t>(draws.below(100)));
      grains.in_layer.push_back(static_cast<std::int64_t>(draws.below(50)));
    }
    const auto part = [](const Slabs::Load& load, std::size_t first, std::size_t last) {
      double all = 0.0, sum = 0.0;
      for (std::size_t layer = 0; layer < load.in_layer.size(); ++layer) {
        all += static_cast<double>(load.in_layer[layer]);
        if (layer >= first && layer < last) sum += static_cast<double>(load.in_layer[layer]);
      }
      return all > 0.0 ? sum / (load.slack * all) : 0.0;
    };
    double least = 1.0;
    for (std::size_t a = 1; a + 1 < layers; ++a)
      for (std::size_t b = a + 1; b < layers; ++b) {
        double largest = 0.0;
        for (const auto& load : {work, grains})
          largest = std::max({largest, part(load, 0, a), part(load, a, b), part(load, b, layers)});
        least = std::min(least, largest);
      }
    const Slabs slabs(std::vector<Slabs::Load>{work, grains}, 3);
    EXPECT_NEAR(slabs.largest_part({work, grains}), least, 1e-8) << "trial " << trial;
  }
}

}  // namespace
