// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/block_moves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// How far beyond half a skin moves may bring a grain before lists are made anew, in diameters: moves search for grains
/// this much farther out.
constexpr double leeway_in_diameters = 0.1;

/// A point's state is the fourth of its coordinates, so this bounds how far a move can reach.
constexpr double largest_radius_in_diameters = 8.0;

/// No cell's count of unrelaxed moves goes beyond this, however little is relaxed.
constexpr std::int32_t most_unrelaxed = 1 << 28;

/// The place of a move in the order of moves, the same on all ranks: by spot, then by step.
using Order = Communicator::Pair;

Order order_of(const Move& move) { return {move.spot, move.number}; }

constexpr Order never = {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};

}  // namespace

void BlockMoves::require_radius(double radius, double diameter) {
  if (!(radius < largest_radius_in_diameters * diameter))
    throw InvalidParameter(message("spot radius is ", radius, " but must be below ", largest_radius_in_diameters,
                                   " grain diameters of ", diameter));
}

double BlockMoves::reach(double radius, const CellLattice& lattice) {
  return radius + 0.5 * lattice.skin() + leeway_in_diameters * lattice.diameter();
}

// ---- where moves are, and what they reach

/// Shares the own layers out among the workers, by how many cells the moves of the last window reached in each: most
/// grains then stay with the same processor, whose memory is near.
void BlockMoves::set_parts(int workers) {
  const auto own = static_cast<std::size_t>(cells_.own_layers());
  if (cells_reached_.size() != own) cells_reached_.assign(own, 1);  // the layers have been shared out anew
  const Slabs slabs(cells_reached_, workers);
  parts_.resize(static_cast<std::size_t>(workers));
  for (int worker = 0; worker < workers; ++worker) {
    parts_[static_cast<std::size_t>(worker)].first_layer = cells_.first_own_layer() + slabs.first(worker);
    parts_[static_cast<std::size_t>(worker)].last_layer = cells_.first_own_layer() + slabs.first(worker + 1);
  }
  std::fill(cells_reached_.begin(), cells_reached_.end(), 1);
}

const std::vector<int>& BlockMoves::find(const std::vector<Move>& moves, const SpotParameters& spots, Workers& workers,
                                         std::vector<std::int64_t>& work) {
  const auto parabola = spots.profile->clipped_parabola(spots.radius / cells_.lattice().quantum().length());
  reach_ = {static_cast<float>(parabola.radius_squared), static_cast<float>(parabola.per_square)};
  middles_.clear();
  for (const Move& move : moves) middles_.push_back(cells_.lattice().wrapped(move.middle - cells_.lattice().low()));
  set_parts(workers.size());
  const NonaffineMotion motion(spots);
  if (motion.on()) cells_.give_tilts();
  workers.run([&](int worker) {
    Part& part = parts_[static_cast<std::size_t>(worker)];
    find(part, moves, spots.radius);
    if (motion.on()) update_tilts(part, motion);
  });
  for (std::size_t layer = 0; layer < work.size(); ++layer) work[layer] += cells_reached_[layer];
  enclosed_.assign(moves.size(), 0);
  for (const Part& part : parts_)
    for (std::size_t m = 0; m < moves.size(); ++m) enclosed_[m] += part.enclosed[m];
  return enclosed_;
}

/// Grains move by the image of a move that is nearest to them.
void BlockMoves::find_rows_of_images(Part& part, const Vector3& middle, double reach) const {
  const CellLattice& lattice = cells_.lattice();
  const Periodic& periodic = lattice.periodic();
  const auto range = [&](int axis) { return periodic.along(axis) ? 1 : 0; };
  for (int y = -range(1); y <= range(1); ++y)
    for (int x = -range(0); x <= range(0); ++x) {
      Vector3 image = middle;
      if (x != 0) image.x() += x * periodic.length(0);
      if (y != 0) image.y() += y * periodic.length(1);
      bool reaches = true;
      for (int axis = 0; axis < 2; ++axis)
        if (periodic.along(axis))
          reaches = reaches && image[axis] + reach >= 0.0 && image[axis] - reach <= periodic.length(axis);
      if (reaches) lattice.find_rows(image, reach, part.first_layer, part.last_layer, false, part.rows);
      part.shifts.resize(part.rows.size(), lattice.periods(x, y));
    }
}

/// Of the image of a move that reaches a row.
Point BlockMoves::middle(const Part& part, std::size_t move, std::size_t row) const {
  Point middle = middles_[move];
  add(middle, part.shifts[row]);
  return middle;
}

/// The rows of cells that the moves may reach, and the enclosed of the grains there.
void BlockMoves::find(Part& part, const std::vector<Move>& moves, double radius) {
  const CellLattice& lattice = cells_.lattice();
  const double reach = BlockMoves::reach(radius, lattice);
  part.rows.clear();
  part.shifts.clear();
  part.end_of_rows.clear();
  part.enclosed.clear();
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const std::size_t before = part.rows.size();
    const Vector3 from_low = moves[m].middle - lattice.low();
    if (lattice.periodic().any())
      find_rows_of_images(part, from_low, reach);
    else
      lattice.find_rows(from_low, reach, part.first_layer, part.last_layer, false, part.rows);
    int enclosed = 0;
    for (std::size_t r = before; r < part.rows.size(); ++r) {
      const CellRow& row = part.rows[r];
      const std::uint32_t first = cells_.first_slot(row.first), n = cells_.first_slot(row.last) - first;
      const Point middle = part.shifts.empty() ? middles_[m] : this->middle(part, m, r);
      const Point* points = cells_.points.data() + first;
      enclosed += cells_.unequal()
                      ? kernels_.enclosed_volume_of_unequal(points, cells_.sizes.data() + first, n, middle, reach_)
                      : kernels_.enclosed_volume(points, n, middle, reach_);
      cells_reached_[cells_.layer_of(row.first)] += row.last - row.first;
    }
    part.end_of_rows.push_back(part.rows.size());
    part.enclosed.push_back(enclosed);
  }
}

/// Of all grains between the first and the last cell that moves may reach: there are hardly any that they don't.
void BlockMoves::update_tilts(const Part& part, const NonaffineMotion& motion) {
  if (part.rows.empty()) return;
  std::uint32_t first = part.rows.front().first, last = part.rows.front().last;
  for (const CellRow& row : part.rows) {
    first = std::min(first, row.first);
    last = std::max(last, row.last);
  }
  for (std::uint32_t cell = first; cell < last; ++cell)
    cells_.visit(cell, cell + 1, [&](std::uint32_t slot) {
      motion.update(cells_.tilts[slot], cells_.ids[slot], cells_.position(slot).z());
    });
}

void BlockMoves::weigh(const std::vector<Move>& moves, const SpotParameters& spots) {
  const NonaffineMotion motion(spots);
  tilt_unit_ = static_cast<float>(motion.unit());
  steps_.clear();
  lengths_.clear();
  for (const Move& move : moves) {
    const Point step = cells_.lattice().wrapped(-spots.influence * move.weight * move.step);
    steps_.push_back(step);
    lengths_.push_back(length_of(step) + static_cast<std::int32_t>(std::ceil(motion.largest() * std::abs(step.z))));
  }
}

// ---- how far grains may be from their references

std::size_t BlockMoves::end_before_rebuild(const std::vector<Move>& moves, std::size_t first,
                                           Communicator& communicator, Workers& workers) {
  const CellLattice& lattice = cells_.lattice();
  const auto limit = static_cast<std::int32_t>((0.5 * lattice.skin() + leeway_in_diameters * lattice.diameter()) /
                                               lattice.quantum().length());
  workers.run([&](int worker) { add_drift(parts_[static_cast<std::size_t>(worker)], first, limit); });
  std::size_t end = moves.size();
  bool must = false;
  for (const Part& part : parts_) {
    must |= part.must_rebuild;
    if (part.must_rebuild) end = std::min(end, part.counted);
  }
  const Order own = must ? order_of(moves[end - 1]) : never, first_of_all = communicator.first(own);
  must_rebuild_ = first_of_all != never;
  while (first_of_all != own && end > first && order_of(moves[end - 1]) > first_of_all) --end;
  return end;
}

/// Adds the lengths of moves to the drift of the cells that they may reach, until one of these is beyond the limit.
void BlockMoves::add_drift(Part& part, std::size_t first, std::int32_t limit) {
  part.must_rebuild = false;
  part.counted = first;
  while (part.counted < middles_.size() && !part.must_rebuild) {
    const std::int32_t length = lengths_[part.counted];
    part.visit_cells(part.counted++, [&](std::uint32_t cell) {
      cells_.drift[cell] += length;
      part.must_rebuild |= cells_.drift[cell] > limit;
    });
  }
}

// ---- displacements

void BlockMoves::apply(std::size_t first, std::size_t end, Workers& workers, MovesReceived* received) {
  if (received) received_.assign(cells_.slots(), 0);
  workers.run([&](int worker) { apply(parts_[static_cast<std::size_t>(worker)], first, end, received != nullptr); });
  if (!received) return;
  for (std::size_t slot = 0; slot < received_.size(); ++slot)
    if (received_[slot] > 0) (*received)[cells_.ids[slot]] += received_[slot];
}

/// The drift that was added for moves beyond the end is taken back.
void BlockMoves::apply(Part& part, std::size_t first, std::size_t end, bool count) {
  for (; part.counted > end; --part.counted)
    part.visit_cells(part.counted - 1, [&](std::uint32_t cell) { cells_.drift[cell] -= lengths_[part.counted - 1]; });
  std::vector<std::uint32_t> found;
  for (std::size_t m = first; m < end; ++m) {
    part.visit_cells(m, [&](std::uint32_t cell) {
      cells_.unrelaxed[cell] = std::min(cells_.unrelaxed[cell] + Cells::parts_of_move, most_unrelaxed);
    });
    for (std::size_t r = part.first_row(m); r < part.end_of_rows[m]; ++r) {
      const std::uint32_t slot = cells_.first_slot(part.rows[r].first), n = cells_.first_slot(part.rows[r].last) - slot;
      const Point middle = part.shifts.empty() ? middles_[m] : this->middle(part, m, r);
      if (count) count_received(slot, n, middle, found);
      displace(slot, n, middle, m);
    }
  }
}

void BlockMoves::displace(std::uint32_t first, std::uint32_t n, const Point& middle, std::size_t move) {
  Point* points = cells_.points.data() + first;
  const Point& step = steps_[move];
  if (cells_.tilted())
    kernels_.displace_tilted(points, cells_.tilts.data() + first, n, middle, reach_, step,
                             tilt_unit_ * static_cast<float>(std::abs(step.z)));
  else
    kernels_.displace(points, n, middle, reach_, step);
}

/// Counts a move for the grains that it is about to move, of n slots.
void BlockMoves::count_received(std::uint32_t first, std::uint32_t n, const Point& middle,
                                std::vector<std::uint32_t>& found) {
  if (found.size() < n) found.resize(n);
  const std::size_t within =
      kernels_.find_within(cells_.points.data() + first, n, middle, reach_.radius_squared, first, found.data());
  for (std::size_t k = 0; k < within; ++k)
    if (cells_.points[found[k]].state == Point::free) ++received_[found[k]];
}

std::size_t BlockMoves::memory() const {
  std::size_t bytes = bytes_in(lengths_, parts_, cells_reached_, middles_, steps_, enclosed_, received_);
  for (const Part& part : parts_) bytes += bytes_in(part.rows, part.shifts, part.end_of_rows, part.enclosed);
  return bytes;
}

}  // namespace spot
