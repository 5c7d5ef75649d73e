// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/shared_moves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "ranks_of_threads.hpp"
#include "scenes.hpp"

namespace {

using spot::Move;
using spot::SharedMove;
using spot::SharedMoves;
using spot::Spot;

/// Rank k has the grains from z = k to k + 1; moves reach 0.4 up and down.
int rank_at(double z, int ranks) { return std::min(ranks - 1, std::max(0, static_cast<int>(std::floor(z)))); }
std::pair<int, int> reached(const Move& move, int ranks) {
  return {rank_at(move.middle.z() - 0.4, ranks), rank_at(move.middle.z() + 0.4, ranks)};
}

/// What the grains of a rank make of a move that they are told of.
int enclosed_by(int rank, const Move& move) { return static_cast<int>((7 * move.spot + 3 * move.number + rank) % 5); }

struct Track {
  Spot spot;
  std::vector<Move> moves;
  int before, after;  // ranks
};

/// Spots that make up to four moves each, most of which begin or end on another rank.
std::vector<Track> tracks(int ranks) {
  scenes::Draws draws(3);
  std::vector<Track> all;
  for (std::int64_t id = 0; id < 60; ++id) {
    double z = draws.uniform(-0.5, ranks + 0.5);
    Track track{{id, 0, {0.0, 0.0, z}, 0.0}, {}, rank_at(z, ranks), 0};
    for (std::int64_t number = 1 + id; number < 1 + id + id % 4; ++number) {
      Move move{0.0, id, {draws.uniform(0.0, 1.0), 0.0, z + 0.15}, {0.0, 0.0, 0.3}};
      move.number = number;
      track.moves.push_back(move);
      z += 0.3;
    }
    track.spot.position.z() = z;
    track.after = rank_at(z, ranks);
    all.push_back(track);
  }
  return all;
}

class SharedMovesBruteForce : public testing::TestWithParam<int> {};  // ranks

/// Against one who sees all moves and all ranks.
TEST_P(SharedMovesBruteForce, EveryRankKnowsWhatConcernsIt) {
  const int ranks = GetParam();
  const std::vector<Track> all = tracks(ranks);
  std::map<std::pair<std::int64_t, std::int64_t>, int> enclosed;
  for (const Track& track : all)
    for (const Move& move : track.moves)
      for (int rank = reached(move, ranks).first; rank <= reached(move, ranks).second; ++rank)
        enclosed[{move.spot, move.number}] += enclosed_by(rank, move);

  scenes::on_ranks(ranks, [&](const std::shared_ptr<spot::Communicator>& communicator) {
    const int own = communicator->rank();
    const auto reach = [ranks](const Move& move) { return reached(move, ranks); };
    SharedMoves shared(communicator);
    std::vector<Spot> leaving;
    for (const Track& track : all) {
      if (track.before != own) continue;
      shared.add(track.moves, track.after);
      if (track.after != own) leaving.push_back(track.spot);
    }
    const auto coming =
        shared.share(reach, leaving, [ranks](const Spot& spot) { return rank_at(spot.position.z(), ranks); });

    std::map<std::int64_t, spot::Vector3> expected_spots, spots;
    std::vector<std::pair<Move, int>> expected;
    for (const Track& track : all) {
      if (track.after == own && track.before != own) expected_spots[track.spot.id] = track.spot.position;
      for (const Move& move : track.moves)
        if (track.after == own || (reach(move).first <= own && own <= reach(move).second))
          expected.emplace_back(move, track.after);
    }
    for (const Spot& spot : coming) spots[spot.id] = spot.position;
    EXPECT_EQ(spots, expected_spots);
    ASSERT_EQ(shared.all().size(), expected.size());

    std::vector<int> here;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const auto& [move, owner] = expected[k];
      EXPECT_EQ(shared.all()[k].move.spot, move.spot);
      EXPECT_EQ(shared.all()[k].move.number, move.number);
      EXPECT_EQ(shared.all()[k].move.middle, move.middle);
      EXPECT_EQ(shared.all()[k].owner, owner);
      const auto [first, last] = reach(move);
      here.push_back(first <= own && own <= last ? enclosed_by(own, move) : 0);
    }
    shared.sum_enclosed(here);
    for (SharedMove& move : shared.all()) {
      if (!shared.own(move)) continue;
      EXPECT_EQ(move.enclosed, (enclosed[{move.move.spot, move.move.number}]));
      move.move.weight = 1.0 + 0.5 * move.enclosed;
    }
    shared.send_weights(reach);
    for (const SharedMove& move : shared.all())
      EXPECT_EQ(move.move.weight, 1.0 + 0.5 * enclosed[std::make_pair(move.move.spot, move.move.number)]);
    shared.clear();
    EXPECT_TRUE(shared.all().empty());
  });
}

INSTANTIATE_TEST_SUITE_P(Ranks, SharedMovesBruteForce, testing::Values(1, 2, 3, 5));

TEST(CommunicatorUnit, AllGetWhatAnyoneShares) {
  for (const int ranks : {1, 2, 5})
    scenes::on_ranks(ranks, [&](const std::shared_ptr<spot::Communicator>& communicator) {
      const auto own = static_cast<std::size_t>(communicator->rank());
      const auto all = communicator->share_with_all(spot::Bytes(own, static_cast<char>('a' + own)));
      ASSERT_EQ(all.size(), static_cast<std::size_t>(ranks));
      for (std::size_t rank = 0; rank < all.size(); ++rank)
        EXPECT_EQ(all[rank], spot::Bytes(rank, static_cast<char>('a' + rank)));
    });
}

}  // namespace
