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

/// Shares the rows of the own layers out among the workers, to each the same ones in all windows: most grains then stay
/// with the same processor, whose memory is near.
void BlockMoves::set_parts(int workers) {
  const int first = cells_.first_own_layer(), last = first + cells_.own_layers();
  parts_.resize(static_cast<std::size_t>(workers));
  for (int worker = 0; worker < workers; ++worker)
    parts_[static_cast<std::size_t>(worker)].asked = {first, last, false, worker, workers};
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
    find_rows(part, moves, spots.radius);
    take_places(part);
    count_enclosed(part);
    if (motion.on()) update_tilts(part, motion);
  });
  enclosed_.assign(moves.size(), 0);
  for (const Part& part : parts_) {
    for (std::size_t layer = 0; layer < work.size(); ++layer) work[layer] += part.work[layer];
    for (std::size_t m = 0; m < moves.size(); ++m) enclosed_[m] += part.enclosed[m];
  }
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
      if (reaches) lattice.find_rows(image, reach, part.asked, part.rows);
      part.shifts.resize(part.rows.size(), lattice.periods(x, y));
    }
}

/// Calls visit(block) for the blocks of slots that a row of cells is in. What else is in these is in nobody's reach.
template <typename Visit>
void BlockMoves::visit_blocks(const CellRow& row, const Visit& visit) const {
  if (row.first >= row.last) return;
  const std::uint32_t end = (cells_.first_slot(row.last) + kernels::lanes - 1) / kernels::lanes;
  for (std::uint32_t block = cells_.first_slot(row.first) / kernels::lanes; block < end; ++block) visit(block);
}

/// Calls visit(places, middle) for all images of a move, with the places that it may reach.
template <typename Visit>
void BlockMoves::visit_images(Part& part, std::size_t move, const Visit& visit) {
  Coordinates& of = cells_.coordinates;
  const auto same_image = [&](std::size_t a, std::size_t b) {
    return part.shifts.empty() || (part.shifts[a].x == part.shifts[b].x && part.shifts[a].y == part.shifts[b].y);
  };
  for (std::size_t row = part.first_row(move), end = part.end_of_rows[move]; row < end;) {
    const std::size_t first = row;
    part.blocks.clear();
    for (; row < end && same_image(first, row); ++row)
      visit_blocks(part.rows[row], [&](std::uint32_t block) { part.blocks.push_back(block); });
    Point middle = middles_[move];
    if (!part.shifts.empty()) add(middle, part.shifts[first]);
    visit({of.x.data(), of.y.data(), of.z.data(), of.state_squared.data(), part.blocks.data(), part.blocks.size()},
          middle);
  }
}

void BlockMoves::find_rows(Part& part, const std::vector<Move>& moves, double radius) {
  const CellLattice& lattice = cells_.lattice();
  const double reach = BlockMoves::reach(radius, lattice);
  part.rows.clear();
  part.shifts.clear();
  part.end_of_rows.clear();
  const auto layers = static_cast<std::size_t>(cells_.own_layers());
  part.work.assign(layers, 0);
  part.reached.assign(layers * (lattice.cells_in_layer() / lattice.cells_in_row()), {cells_.count(), 0});
  for (const Move& move : moves) {
    const std::size_t before = part.rows.size();
    const Vector3 from_low = move.middle - lattice.low();
    if (lattice.periodic().any())
      find_rows_of_images(part, from_low, reach);
    else
      lattice.find_rows(from_low, reach, part.asked, part.rows);
    part.end_of_rows.push_back(part.rows.size());
    for (std::size_t r = before; r < part.rows.size(); ++r) add_reached(part, part.rows[r]);
  }
}

void BlockMoves::add_reached(Part& part, const CellRow& row) const {
  part.work[cells_.layer_of(row.first)] += row.last - row.first;
  CellRow& reached = part.reached[(row.first - cells_.first_own()) / cells_.lattice().cells_in_row()];
  reached = {std::min(reached.first, row.first), std::max(reached.last, row.last)};
}

void BlockMoves::take_places(const Part& part) {
  for (const CellRow& row : part.reached)
    visit_blocks(row, [&](std::uint32_t block) {
      for (std::uint32_t slot = block * kernels::lanes; slot < (block + 1) * kernels::lanes; ++slot)
        cells_.coordinates.set(slot, cells_.is_image(cells_.cell_of(slot)) ? nobody : cells_.points[slot]);
    });
}

void BlockMoves::count_enclosed(Part& part) {
  part.enclosed.clear();
  for (std::size_t m = 0; m < middles_.size(); ++m) {
    int enclosed = 0;
    visit_images(part, m, [&](const kernels::Places& places, const Point& middle) {
      enclosed += cells_.unequal() ? kernels_.enclosed_volume_of_unequal(places, cells_.sizes.data(), middle, reach_)
                                   : kernels_.enclosed_volume(places, middle, reach_);
    });
    part.enclosed.push_back(enclosed);
  }
}

/// Of all grains that moves may reach.
void BlockMoves::update_tilts(const Part& part, const NonaffineMotion& motion) {
  for (const CellRow& row : part.reached)
    for (std::uint32_t cell = row.first; cell < row.last; ++cell) {
      const Cell listed_in = cells_.lattice().cell(cell);
      cells_.visit(cell, cell + 1, [&](std::uint32_t slot) {
        const Vector3 at = cells_.lattice().low() + cells_.lattice().from_low(cells_.points[slot], listed_in);
        NonaffineMotion::Tilt tilt = cells_.tilts[slot];
        if (motion.update(tilt, cells_.ids[slot], at.z())) cells_.tilts.set(slot, tilt);
      });
    }
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
      cells_.drift.add(cell, length);
      part.must_rebuild |= cells_.drift[cell] > limit;
    });
  }
}

// ---- displacements

void BlockMoves::apply(std::size_t first, std::size_t end, Workers& workers, std::uint32_t* received) {
  workers.run([&](int worker) { apply(parts_[static_cast<std::size_t>(worker)], first, end, received); });
}

/// The drift that was added for moves beyond the end is taken back.
void BlockMoves::apply(Part& part, std::size_t first, std::size_t end, std::uint32_t* received) {
  for (; part.counted > end; --part.counted)
    part.visit_cells(part.counted - 1, [&](std::uint32_t cell) {
      cells_.drift.set(cell, cells_.drift[cell] - lengths_[part.counted - 1]);
    });
  for (std::size_t m = first; m < end; ++m) {
    part.visit_cells(m, [&](std::uint32_t cell) {
      cells_.unrelaxed[cell] = std::min(cells_.unrelaxed[cell] + Cells::parts_of_move, most_unrelaxed);
    });
    visit_images(part, m, [&](const kernels::Places& places, const Point& middle) {
      if (received) kernels_.count_received(places, middle, reach_, received);
      displace(places, middle, m);
    });
  }
}

void BlockMoves::displace(const kernels::Places& places, const Point& middle, std::size_t move) const {
  const Point& step = steps_[move];
  if (cells_.tilted())
    kernels_.displace_tilted(places, {cells_.tilts.x.data(), cells_.tilts.y.data(), cells_.tilts.z.data()}, middle,
                             reach_, step, tilt_unit_ * static_cast<float>(std::abs(step.z)));
  else
    kernels_.displace(places, middle, reach_, step);
}

void BlockMoves::write_back(std::uint32_t cell) {
  for (std::uint32_t slot = cells_.first_slot(cell); slot < cells_.end_slot(cell); ++slot)
    cells_.points[slot] = cells_.coordinates.at(slot, cells_.points[slot].state);
}

void BlockMoves::write_back(Workers& workers) {
  workers.run([&](int worker) {
    for (const CellRow& row : parts_[static_cast<std::size_t>(worker)].reached)
      for (std::uint32_t cell = row.first; cell < row.last; ++cell) write_back(cell);
  });
}

std::size_t BlockMoves::memory() const {
  std::size_t bytes = bytes_in(lengths_, parts_, middles_, steps_, enclosed_);
  for (const Part& part : parts_)
    bytes += bytes_in(part.rows, part.shifts, part.end_of_rows, part.reached, part.blocks, part.enclosed, part.work);
  return bytes;
}

}  // namespace spot
