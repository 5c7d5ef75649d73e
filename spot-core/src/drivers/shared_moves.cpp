// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/shared_moves.hpp"

#include <algorithm>

#include "walk/packed_spot.hpp"

namespace spot {

namespace {

/// What ranks tell each other about a move.
template <typename Value>
struct Told {
  std::int64_t spot, number;
  Value value;
};

bool before(const SharedMove& a, const Told<int>& b) {
  return a.move.spot != b.spot ? a.move.spot < b.spot : a.move.number < b.number;
}

}  // namespace

void SharedMoves::add(const std::vector<Move>& moves, int owner) {
  for (const Move& move : moves) moves_.push_back({move, owner, 0});
}

/// Messages to all ranks, which begin with the spots that leave for them.
std::vector<Bytes> SharedMoves::packed(const std::vector<Spot>& leaving,
                                       const std::function<int(const Spot&)>& owner) const {
  std::vector<std::vector<Spot>> to(static_cast<std::size_t>(communicator_->size()));
  for (const Spot& spot : leaving) to[static_cast<std::size_t>(owner(spot))].push_back(spot);
  std::vector<Bytes> messages = outgoing();
  for (std::size_t rank = 0; rank < to.size(); ++rank) append(messages[rank], to[rank]);
  return messages;
}

std::vector<Spot> SharedMoves::share(const Reached& reached, const std::vector<Spot>& leaving,
                                     const std::function<int(const Spot&)>& owner) {
  const int own = communicator_->rank(), ranks = communicator_->size();
  if (ranks == 1) return {};
  std::vector<Bytes> messages = packed(leaving, owner);
  std::vector<SharedMove> kept;
  for (const SharedMove& shared : moves_) {
    const auto [first, last] = reached(shared.move);
    for (int rank = 0; rank < ranks; ++rank) {
      if ((rank < first || rank > last) && rank != shared.owner) continue;
      if (rank == own) {
        kept.push_back(shared);
        continue;
      }
      append(messages[static_cast<std::size_t>(rank)], shared.owner);
      append(messages[static_cast<std::size_t>(rank)], shared.move);
    }
  }
  // Most ranks are far away and have nothing to hear but that there are no spots for them.
  for (Bytes& bytes : messages)
    if (bytes.size() == sizeof(std::uint64_t)) bytes.clear();
  moves_.swap(kept);
  std::vector<Spot> coming;
  for (const Bytes& bytes : communicator_->exchange(std::move(messages))) {
    ByteReader reader(bytes);
    if (reader.at_end()) continue;
    const std::vector<Spot> spots = take_spots(reader);
    coming.insert(coming.end(), spots.begin(), spots.end());
    while (!reader.at_end()) {
      const auto to = reader.take<int>();
      moves_.push_back({take_move(reader), to, 0});
    }
  }
  std::sort(moves_.begin(), moves_.end(), [](const SharedMove& a, const SharedMove& b) {
    return before(a, {b.move.spot, b.move.number, 0});
  });
  return coming;
}

SharedMove& SharedMoves::find(std::int64_t spot, std::int64_t number) {
  return *std::lower_bound(moves_.begin(), moves_.end(), Told<int>{spot, number, 0}, before);
}

void SharedMoves::sum_enclosed(const std::vector<int>& enclosed) {
  for (std::size_t k = 0; k < moves_.size(); ++k) moves_[k].enclosed = enclosed[k];
  if (communicator_->size() == 1) return;
  std::vector<Bytes> messages = outgoing();
  for (const SharedMove& shared : moves_)
    if (!own(shared) && shared.enclosed > 0)
      append(messages[static_cast<std::size_t>(shared.owner)],
             Told<std::int64_t>{shared.move.spot, shared.move.number, shared.enclosed});
  for (const Bytes& bytes : communicator_->exchange(std::move(messages)))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto told = reader.take<Told<std::int64_t>>();
      find(told.spot, told.number).enclosed += static_cast<int>(told.value);
    }
}

void SharedMoves::send_weights(const Reached& reached) {
  if (communicator_->size() == 1) return;
  std::vector<Bytes> messages = outgoing();
  for (const SharedMove& shared : moves_) {
    if (!own(shared)) continue;
    const auto [first, last] = reached(shared.move);
    for (int rank = first; rank <= last; ++rank)
      if (rank != communicator_->rank())
        append(messages[static_cast<std::size_t>(rank)],
               Told<double>{shared.move.spot, shared.move.number, shared.move.weight});
  }
  for (const Bytes& bytes : communicator_->exchange(std::move(messages)))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto told = reader.take<Told<double>>();
      find(told.spot, told.number).move.weight = told.value;
    }
}

}  // namespace spot
