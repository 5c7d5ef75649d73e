// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// How far beyond half a skin moves may bring a grain before anybody looks, in diameters: moves search for grains this
/// much farther out.
constexpr double leeway_in_diameters = 0.1;

/// A point's state is the fourth of its coordinates, so this bounds how far a move can reach.
constexpr double largest_radius_in_diameters = 8.0;

/// No account goes beyond this, however little is relaxed.
constexpr std::int32_t deepest_in_debt = 1 << 28;

/// The place of a move in the order of moves, the same on all ranks: by spot, then by step.
using Turn = Communicator::Pair;

Turn turn_of(const Move& move) { return {move.spot, move.number}; }

constexpr Turn never = {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};

}  // namespace

void TiledPacking::require_radius(double radius, double diameter) {
  if (!(radius < largest_radius_in_diameters * diameter))
    throw InvalidParameter(message("spot radius is ", radius, " but must be below ", largest_radius_in_diameters,
                                   " grain diameters of ", diameter));
}

/// From the middle of a move to the references of the grains that it moves.
double TiledPacking::reach_of_move(double radius) const {
  return radius + 0.5 * skin_ + leeway_in_diameters * diameter_;
}

void TiledPacking::displace(std::vector<Move>& moves, const SpotParameters& spots, const Weigh& weigh,
                            const Container& container, Workers& workers, MovesReceived* received) {
  require_radius(spots.radius, diameter_);
  find_moves(moves, spots, workers);
  weigh(shares_, moves);
  steps_.clear();
  for (const Move& move : moves) steps_.push_back(wrapped(-spots.influence * move.weight * move.step));
  for (std::size_t first = 0;;) {
    const std::size_t end = end_before_a_look(moves, first, workers);
    if (received) received_.assign(points_.size(), 0);
    workers.run(
        [&](int worker) { apply_moves(parts_[static_cast<std::size_t>(worker)], first, end, received != nullptr); });
    if (received)
      for (std::size_t slot = 0; slot < received_.size(); ++slot)
        if (received_[slot] > 0) (*received)[ids_[slot]] += received_[slot];
    // Sweeps are the next to ask where others' grains are.
    choose_sent(look_ ? no_cell : every_cell);
    update_lists(container, workers);
    first = end;
    if (!look_) return;
  }
}

/// Shares this rank's layers out among the workers, by how many cells the moves of the last window reached in each:
/// most grains then stay with the same processor, whose memory is near.
void TiledPacking::set_parts(int workers) {
  const Slabs slabs(cells_reached_, workers);
  parts_.resize(static_cast<std::size_t>(workers));
  for (int worker = 0; worker < workers; ++worker) {
    parts_[static_cast<std::size_t>(worker)].first_layer = first_layer_ + border_[0] + slabs.first(worker);
    parts_[static_cast<std::size_t>(worker)].last_layer = first_layer_ + border_[0] + slabs.first(worker + 1);
  }
  std::fill(cells_reached_.begin(), cells_reached_.end(), 1);
}

/// Where the moves are, and what they reach.
void TiledPacking::find_moves(const std::vector<Move>& moves, const SpotParameters& spots, Workers& workers) {
  const auto parabola = spots.profile->clipped_parabola(spots.radius / quantum_.length());
  reach_ = {static_cast<float>(parabola.radius_squared), static_cast<float>(parabola.per_square)};
  middles_.clear();
  for (const Move& move : moves) middles_.push_back(wrapped(move.middle - low_));
  set_parts(workers.size());
  workers.run([&](int worker) { find_moves(parts_[static_cast<std::size_t>(worker)], moves, spots.radius); });
  for (std::size_t layer = 0; layer < work_.size(); ++layer) work_[layer] += cells_reached_[layer];
  shares_.assign(moves.size(), 0);
  for (const Part& part : parts_)
    for (std::size_t m = 0; m < moves.size(); ++m) shares_[m] += part.shares[m];
}

/// The rows of cells that the moves may reach, and the shares of the grains there.
void TiledPacking::find_moves(Part& part, const std::vector<Move>& moves, double radius) {
  part.rows.clear();
  part.end_of_rows.clear();
  part.shares.clear();
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const std::size_t before = part.rows.size();
    find_rows(moves[m].middle - low_, reach_of_move(radius), part.first_layer, part.last_layer, part.rows);
    int shares = 0;
    for (std::size_t r = before; r < part.rows.size(); ++r) {
      const Row& row = part.rows[r];
      shares += kernels_->enclosed_shares(points_.data() + row.first * capacity_, (row.last - row.first) * capacity_,
                                          middles_[m], reach_);
      cells_reached_[(row.first - first_owned()) / cells_in_layer()] += row.last - row.first;
    }
    part.end_of_rows.push_back(part.rows.size());
    part.shares.push_back(shares);
  }
}

/// The end of the moves that can be applied before grains may be too far from their references for the next, on any
/// rank; look_ tells whether there is such a next.
std::size_t TiledPacking::end_before_a_look(const std::vector<Move>& moves, std::size_t first, Workers& workers) {
  const auto limit = static_cast<std::int32_t>((0.5 * skin_ + leeway_in_diameters * diameter_) / quantum_.length());
  workers.run([&](int worker) { lengthen(parts_[static_cast<std::size_t>(worker)], first, limit); });
  std::size_t end = moves.size();
  bool look = false;
  for (const Part& part : parts_) {
    look |= part.look;
    if (part.look) end = std::min(end, part.lengthened);
  }
  const Turn own = look ? turn_of(moves[end - 1]) : never, turn = communicator_->first(own);
  look_ = turn != never;
  while (turn != own && end > first && turn_of(moves[end - 1]) > turn) --end;
  return end;
}

/// Adds the lengths of moves to the paths of the cells that they may reach, until one of these is beyond the limit.
void TiledPacking::lengthen(Part& part, std::size_t first, std::int32_t limit) {
  part.look = false;
  part.lengthened = first;
  while (part.lengthened < middles_.size() && !part.look) {
    const std::int32_t length = length_of(steps_[part.lengthened]);
    part.visit_cells(part.lengthened++, [&](std::uint32_t cell) {
      path_[cell] += length;
      part.look |= path_[cell] > limit;
    });
  }
}

/// Charges the cells of a worker's part for some moves, and applies these in their order. Paths are taken back to their
/// end.
void TiledPacking::apply_moves(Part& part, std::size_t first, std::size_t end, bool count) {
  for (; part.lengthened > end; --part.lengthened)
    part.visit_cells(part.lengthened - 1,
                     [&](std::uint32_t cell) { path_[cell] -= length_of(steps_[part.lengthened - 1]); });
  std::vector<std::uint32_t> found;
  for (std::size_t m = first; m < end; ++m) {
    part.visit_cells(
        m, [&](std::uint32_t cell) { account_[cell] = std::min(account_[cell] + parts_of_move, deepest_in_debt); });
    for (std::size_t r = part.first_row(m); r < part.end_of_rows[m]; ++r) {
      const Row& row = part.rows[r];
      if (count) count_received(row, middles_[m], found);
      kernels_->displace(points_.data() + row.first * capacity_, (row.last - row.first) * capacity_, middles_[m],
                         reach_, steps_[m]);
    }
  }
}

/// Counts a move for the grains that it is about to move.
void TiledPacking::count_received(const Row& row, const Point& middle, std::vector<std::uint32_t>& found) {
  const std::uint32_t first = row.first * capacity_, n = (row.last - row.first) * capacity_;
  if (found.size() < n) found.resize(n);
  const std::size_t within =
      kernels_->find_within(points_.data() + first, n, middle, reach_.radius_squared, first, found.data());
  for (std::size_t k = 0; k < within; ++k)
    if (points_[found[k]].state == Point::free) ++received_[found[k]];
}

}  // namespace spot
