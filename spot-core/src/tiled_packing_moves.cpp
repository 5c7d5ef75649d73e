// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels.hpp"
#include "spot/errors.hpp"
#include "spot/tiled_packing.hpp"
#include "wrapped_integers.hpp"

namespace spot {

namespace {

/// How far beyond half a skin moves may bring a grain before anybody looks, in diameters: moves search for grains this
/// much farther out.
constexpr double leeway_in_diameters = 0.1;

/// A point's state is the fourth of its coordinates, so this bounds how far a move can reach.
constexpr double largest_radius_in_diameters = 8.0;

/// No account goes beyond this, however little is relaxed.
constexpr std::int32_t deepest_in_debt = 1 << 28;

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// Moves in their order, the same on all ranks: by spot, then by step, of which no spot takes a million.
std::int64_t turn_of(const Move& move) { return move.spot << 20 | std::min<std::int64_t>(move.number, (1 << 20) - 1); }

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
  const auto limit = static_cast<std::int32_t>((0.5 * skin_ + leeway_in_diameters * diameter_) / quantum_.length());
  find_moves(moves, spots);
  find_shares(workers);
  weigh(shares_, moves);
  steps_.clear();
  for (const Move& move : moves) steps_.push_back(wrapped(-spots.influence * move.weight * move.step));
  for (std::size_t first = 0;;) {
    const std::size_t end = end_before_a_look(moves, first, limit);
    for (std::size_t m = first; m < end; ++m) charge(m);
    if (received) received_.assign(points_.size(), 0);
    apply_moves(first, end, workers, received != nullptr);
    if (received)
      for (std::size_t slot = 0; slot < received_.size(); ++slot)
        if (received_[slot] > 0) (*received)[ids_[slot]] += received_[slot];
    update_lists(container);
    first = end;
    if (!look_) return;
  }
}

/// Where the moves are, and the rows of this rank's cells that they may reach.
void TiledPacking::find_moves(const std::vector<Move>& moves, const SpotParameters& spots) {
  const int first_layer = first_layer_ + border_[0], last_layer = first_layer + rank_layers();
  const double radius_squared = square(spots.radius / quantum_.length());
  reach_.radius_squared = static_cast<float>(radius_squared);
  reach_.per_square = spots.profile == InfluenceProfile::uniform ? 1.0f : static_cast<float>(1.0 / radius_squared);
  middles_.clear();
  rows_.clear();
  end_of_rows_.clear();
  for (const Move& move : moves) {
    middles_.push_back(wrapped(move.middle - low_));
    find_rows(move.middle - low_, reach_of_move(spots.radius), first_layer, last_layer, rows_);
    end_of_rows_.push_back(rows_.size());
  }
}

void TiledPacking::find_shares(Workers& workers) {
  const std::size_t n = middles_.size(), tasks = static_cast<std::size_t>(workers.size());
  shares_.assign(n, 0);
  workers.run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    for (std::size_t m = n * w / tasks; m < n * (w + 1) / tasks; ++m)
      for (std::size_t r = first_row(m); r < end_of_rows_[m]; ++r)
        shares_[m] += kernels_->enclosed_shares(points_.data() + rows_[r].first * capacity_,
                                                (rows_[r].last - rows_[r].first) * capacity_, middles_[m], reach_);
  });
}

/// The end of the moves that can be applied before grains may be too far from their references for the next, on any
/// rank; look_ tells whether there is such a next. Their steps are added to the paths of the cells.
std::size_t TiledPacking::end_before_a_look(const std::vector<Move>& moves, std::size_t first, std::int32_t limit) {
  std::size_t lengthened = first;
  bool look = false;
  while (lengthened < moves.size() && !look) look = lengthen(lengthened++, limit);
  const std::int64_t own = look ? turn_of(moves[lengthened - 1]) : never, turn = communicator_->least(own);
  look_ = turn != never;
  if (turn == own) return lengthened;
  while (lengthened > first && turn_of(moves[lengthened - 1]) > turn) shorten(--lengthened);
  return lengthened;
}

/// Adds a move's length to the paths of the cells that it may reach; is one of them beyond the limit?
bool TiledPacking::lengthen(std::size_t move, std::int32_t limit) {
  const std::int32_t length = length_of(steps_[move]);
  bool reached = false;
  for (std::size_t r = first_row(move); r < end_of_rows_[move]; ++r)
    for (std::uint32_t cell = rows_[r].first; cell < rows_[r].last; ++cell) {
      path_[cell] += length;
      reached |= path_[cell] > limit;
    }
  return reached;
}

void TiledPacking::shorten(std::size_t move) {
  for (std::size_t r = first_row(move); r < end_of_rows_[move]; ++r)
    for (std::uint32_t cell = rows_[r].first; cell < rows_[r].last; ++cell) path_[cell] -= length_of(steps_[move]);
}

void TiledPacking::charge(std::size_t move) {
  for (std::size_t r = first_row(move); r < end_of_rows_[move]; ++r)
    for (std::uint32_t cell = rows_[r].first; cell < rows_[r].last; ++cell)
      account_[cell] = std::min(account_[cell] + parts_of_move, deepest_in_debt);
}

void TiledPacking::apply_moves(std::size_t first, std::size_t last, Workers& workers, bool count) {
  // A worker owns some layers of the grid, and applies all moves in them, in order.
  const auto n = static_cast<std::uint32_t>(workers.size());
  workers.run([&](int worker) {
    std::vector<std::uint32_t> found;
    for (std::size_t m = first; m < last; ++m)
      for (std::size_t r = first_row(m); r < end_of_rows_[m]; ++r) {
        const Row& row = rows_[r];
        if (n > 1 && row.first / cells_in_layer() % n != static_cast<std::uint32_t>(worker)) continue;
        if (count) count_received(row, middles_[m], found);
        kernels_->displace(points_.data() + row.first * capacity_, (row.last - row.first) * capacity_, middles_[m],
                           reach_, steps_[m]);
      }
  });
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
