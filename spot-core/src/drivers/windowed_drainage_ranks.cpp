// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include "spot/drivers/windowed_drainage.hpp"
#include "walk/packed_spot.hpp"

namespace spot {

namespace {

bool in_order(const Move& a, const Move& b) { return a.spot != b.spot ? a.spot < b.spot : a.number < b.number; }

/// What ranks tell each other about a move: shares of grains, or its weight.
template <typename Value>
struct Told {
  std::int64_t spot, number;
  Value value;
};

}  // namespace

/// Moves go to all ranks whose grains they may reach and to the rank that their spot then belongs to; so do spots.
void WindowedDrainage::share_turns() {
  const int own = communicator_->rank(), ranks = communicator_->size();
  if (ranks == 1) return;
  std::vector<Bytes> outgoing(static_cast<std::size_t>(ranks));
  hand_over(outgoing);
  std::vector<Turn> kept;
  for (const Turn& turn : turns_) {
    const auto [first, last] = packing_.reached(turn.move.middle.z(), parameters_.radius);
    for (int rank = 0; rank < ranks; ++rank) {
      if ((rank < first || rank > last) && rank != turn.owner) continue;
      if (rank == own) {
        kept.push_back(turn);
        continue;
      }
      append(outgoing[static_cast<std::size_t>(rank)], turn.owner);
      append(outgoing[static_cast<std::size_t>(rank)], turn.move);
    }
  }
  // Most ranks are far away and have nothing to hear but that there are no spots for them.
  for (Bytes& bytes : outgoing)
    if (bytes.size() == sizeof(std::uint64_t)) bytes.clear();
  turns_.swap(kept);
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing))) {
    ByteReader reader(bytes);
    for (auto spots = reader.at_end() ? 0 : reader.take<std::uint64_t>(); spots > 0; --spots) {
      walkers_.push_back({take_spot(reader), false});
    }
    while (!reader.at_end()) {
      const auto owner = reader.take<int>();
      turns_.push_back({take_move(reader), owner, 0});
    }
  }
  std::sort(walkers_.begin(), walkers_.end(), [](const Walker& a, const Walker& b) { return a.spot.id < b.spot.id; });
  std::sort(turns_.begin(), turns_.end(), [](const Turn& a, const Turn& b) { return in_order(a.move, b.move); });
}

/// Spots that are no longer in the layers of this rank go to the one that they are with.
void WindowedDrainage::hand_over(std::vector<Bytes>& outgoing) {
  std::vector<Bytes> spots(outgoing.size());
  std::vector<std::uint64_t> number(outgoing.size(), 0);
  const auto leaves = [&](const Walker& walker) {
    if (walker.removed || here(walker.spot.position)) return false;
    const auto to = static_cast<std::size_t>(packing_.owner(walker.spot.position.z()));
    append(spots[to], walker.spot);
    ++number[to];
    return true;
  };
  std::vector<Walker> staying;
  for (const Walker& walker : walkers_)
    if (!leaves(walker)) staying.push_back(walker);
  walkers_.swap(staying);
  for (std::size_t rank = 0; rank < outgoing.size(); ++rank) {
    append(outgoing[rank], number[rank]);
    outgoing[rank].insert(outgoing[rank].end(), spots[rank].begin(), spots[rank].end());
  }
}

WindowedDrainage::Turn& WindowedDrainage::turn_of(std::int64_t spot, std::int64_t number) {
  Move wanted;
  wanted.spot = spot;
  wanted.number = number;
  return *std::lower_bound(turns_.begin(), turns_.end(), wanted,
                           [](const Turn& turn, const Move& move) { return in_order(turn.move, move); });
}

/// The shares of all ranks' grains in a move, for the rank that its spot belongs to.
void WindowedDrainage::gather_shares() {
  if (communicator_->size() == 1) return;
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  for (const Turn& turn : turns_)
    if (turn.owner != communicator_->rank() && turn.shares > 0)
      append(outgoing[static_cast<std::size_t>(turn.owner)],
             Told<std::int64_t>{turn.move.spot, turn.move.number, turn.shares});
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto told = reader.take<Told<std::int64_t>>();
      turn_of(told.spot, told.number).shares += static_cast<int>(told.value);
    }
}

/// From the rank that a spot belongs to, to all others whose grains its moves may reach.
void WindowedDrainage::send_weights() {
  if (communicator_->size() == 1) return;
  const int own = communicator_->rank();
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  for (const Turn& turn : turns_) {
    if (turn.owner != own) continue;
    const auto [first, last] = packing_.reached(turn.move.middle.z(), parameters_.radius);
    for (int rank = first; rank <= last; ++rank)
      if (rank != own)
        append(outgoing[static_cast<std::size_t>(rank)],
               Told<double>{turn.move.spot, turn.move.number, turn.move.weight});
  }
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto told = reader.take<Told<double>>();
      turn_of(told.spot, told.number).move.weight = told.value;
    }
}

Counters WindowedDrainage::total() {
  const Counters& own = counters_;
  const auto sums = communicator_->sum({own.moves, own.shares_moved, own.drained});
  return {sums[0], sums[1], own.sweeps, own.grains_swept, sums[2]};
}

}  // namespace spot
