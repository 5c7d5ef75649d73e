// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "spot/parallel/communicator.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/spot_walk.hpp"

namespace spot {

/// A move that this rank knows: one that may reach its grains, or of a spot that belongs to it.
struct SharedMove {
  Move move;
  int owner;         ///< rank to which the spot belongs after the window
  int enclosed = 0;  ///< grain volume that it encloses, as far as is known here, in 1024ths of a grain's (grain_volume)
};

/// The moves of one window, and what ranks tell each other about them: the moves themselves, the volume that each
/// encloses on all ranks together, and the weights that follow from it.
class SharedMoves {
 public:
  /// The ranks, from first to last, whose grains a move may reach.
  using Reached = std::function<std::pair<int, int>(const Move&)>;

  explicit SharedMoves(std::shared_ptr<Communicator> communicator) : communicator_(std::move(communicator)) {}

  void clear() { moves_.clear(); }

  /// Of one spot, which belongs to `owner` after them; spots in increasing order.
  void add(const std::vector<Move>& moves, int owner);

  /// Collective. Moves go to all ranks whose grains they may reach and to the rank that their spot then belongs to;
  /// only those that are for this rank stay. Spots that leave go along, each to the rank that `owner` gives; returns
  /// those that come.
  std::vector<Spot> share(const Reached& reached, const std::vector<Spot>& leaving,
                          const std::function<int(const Spot&)>& owner);

  /// Collective. `enclosed`: by each move, of this rank's grains. The rank that a spot belongs to then knows what its
  /// moves enclose on all.
  void sum_enclosed(const std::vector<int>& enclosed);

  /// Collective. Weights go from the rank that a spot belongs to, to all whose grains its moves may reach.
  void send_weights(const Reached& reached);

  /// In the order of (spot, number).
  const std::vector<SharedMove>& all() const { return moves_; }
  std::vector<SharedMove>& all() { return moves_; }

  /// Does the spot belong to this rank after the window?
  bool own(const SharedMove& move) const { return move.owner == communicator_->rank(); }

  std::size_t memory() const { return moves_.capacity() * sizeof(SharedMove); }

 private:
  std::vector<Bytes> outgoing() const { return std::vector<Bytes>(static_cast<std::size_t>(communicator_->size())); }
  std::vector<Bytes> packed(const std::vector<Spot>& leaving, const std::function<int(const Spot&)>& owner) const;
  SharedMove& find(std::int64_t spot, std::int64_t number);

  std::shared_ptr<Communicator> communicator_;
  std::vector<SharedMove> moves_;
};

}  // namespace spot
