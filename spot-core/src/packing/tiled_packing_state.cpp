// SPDX-License-Identifier: GPL-2.0-or-later
// What is needed to go on elsewhere: in another program, or on another rank.
#include <algorithm>
#include <limits>

#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// What all parts of a saved state have in common.
struct SavedGrid {
  double diameter, extent, low[3];
  std::int32_t cells[3];
  std::int32_t ranks;
};

/// A slab may hold this many times an even part of the grains, so that memory is shared out, too.
constexpr double grains_for_work = 1.5;

/// Slabs are changed if that makes the busiest rank's part of the work smaller than this times what it was.
constexpr double worth_a_change = 0.96;

}  // namespace

/// A grain; its cell, of the whole grid, tells which turn of the wrapped coordinates is meant.
struct TiledPacking::SavedGrain {
  std::int64_t id, cell;
  Point point, reference, momentum;
};

struct TiledPacking::SavedCell {
  std::int64_t cell;
  std::int32_t account, path;
};

TiledPacking::TiledPacking(double diameter, double extent, const std::vector<Bytes>& saved, const Container& container,
                           std::shared_ptr<Communicator> communicator)
    : TiledPacking(diameter, extent, std::move(communicator)) {
  std::vector<SavedGrain> grains;
  std::vector<SavedCell> cells;
  for (const Bytes& part : saved) {
    ByteReader reader = unseal(part);
    const auto grid = reader.take<SavedGrid>();
    if (grid.diameter != diameter || grid.extent != extent)
      throw InvalidState(message("the saved state has grains of diameter ", grid.diameter, " in a box that reaches to ",
                                 grid.extent, ", not ", diameter, " and ", extent));
    if (static_cast<std::size_t>(grid.ranks) != saved.size())
      throw InvalidState(message("the saved state has ", saved.size(), " parts, not ", grid.ranks));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& low = low_[static_cast<Eigen::Index>(axis)];
      if (&part != &saved.front() && (grid.low[axis] != low || grid.cells[axis] != n_[axis]))
        throw InvalidState("the parts of the saved state are not of the same run");
      low = grid.low[axis];
      n_[axis] = grid.cells[axis];
    }
    take_saved(reader, grains, cells);
  }
  std::vector<std::int64_t> in_layer(static_cast<std::size_t>(n_[2]), 0);
  for (const SavedGrain& grain : grains) ++in_layer[static_cast<std::size_t>(grain.cell / cells_in_layer())];
  set_slabs(Slabs(in_layer, communicator_->size()));
  fill(grains, cells, container);
}

Bytes TiledPacking::save() const {
  Bytes bytes;
  append(bytes, SavedGrid{diameter_,
                          extent_,
                          {low_.x(), low_.y(), low_.z()},
                          {n_[0], n_[1], n_[2]},
                          static_cast<std::int32_t>(communicator_->size())});
  save_layers(first_layer_ + border_[0], first_layer_ + border_[0] + rank_layers(), bytes);
  seal(bytes);
  return bytes;
}

/// Appends what is in some of this rank's layers.
void TiledPacking::save_layers(int first, int last, Bytes& bytes) const {
  const std::int64_t before = static_cast<std::int64_t>(first_layer_) * cells_in_layer();
  std::vector<SavedGrain> grains;
  std::vector<SavedCell> cells;
  for (std::uint32_t cell = first_cell_of(first); cell < first_cell_of(last); ++cell) {
    if (account_[cell] != 0 || path_[cell] != 0) cells.push_back({before + cell, account_[cell], path_[cell]});
    for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot)
      if (ids_[slot] >= 0)
        grains.push_back({ids_[slot], before + cell, points_[slot], references_[slot], momenta_[slot]});
  }
  append(bytes, grains);
  append(bytes, cells);
}

/// Adds what save_layers() has appended.
void TiledPacking::take_saved(ByteReader& reader, std::vector<SavedGrain>& grains,
                              std::vector<SavedCell>& cells) const {
  const std::int64_t all_cells = static_cast<std::int64_t>(cells_in_layer()) * n_[2];
  const auto take = [&](auto& all, const auto& part) {
    for (const auto& one : part) {
      if (one.cell < 0 || one.cell >= all_cells)
        throw InvalidState(message("the saved state has cell ", one.cell, " of ", all_cells));
      all.push_back(one);
    }
  };
  take(grains, reader.take_all<SavedGrain>());
  for (const SavedGrain& grain : grains)
    if (grain.id < 0) throw InvalidState(message("the saved state has grain id ", grain.id, ", which is negative"));
  take(cells, reader.take_all<SavedCell>());
}

/// Fills this rank's empty layers; what belongs to others is passed over.
void TiledPacking::fill(const std::vector<SavedGrain>& grains, const std::vector<SavedCell>& cells,
                        const Container& container) {
  const std::int64_t before = static_cast<std::int64_t>(first_layer_) * cells_in_layer();
  const auto is_own = [&](std::int64_t cell) {
    return slabs_.owner(static_cast<int>(cell / cells_in_layer())) == communicator_->rank();
  };
  for (const SavedGrain& grain : grains) {
    if (!is_own(grain.cell)) continue;
    const std::uint32_t at = slot(ensure_room(static_cast<std::uint32_t>(grain.cell - before)));
    occupy(at, grain.id, grain.point, grain.reference);
    momenta_[at] = grain.momentum;
  }
  for (const SavedCell& cell : cells) {
    if (!is_own(cell.cell)) continue;
    account_[static_cast<std::size_t>(cell.cell - before)] = cell.account;
    path_[static_cast<std::size_t>(cell.cell - before)] = cell.path;
  }
  list_all(container);
}

bool TiledPacking::balance(const Container& container) {
  const auto of_all_ranks = [this](const std::vector<std::int64_t>& own) {
    std::vector<std::int64_t> all(static_cast<std::size_t>(n_[2]), 0);
    std::copy(own.begin(), own.end(), all.begin() + first_layer_ + border_[0]);
    return communicator_->sum(all);
  };
  const std::vector<Slabs::Load> loads = {{of_all_ranks(work_)}, {of_all_ranks(grains_in_layers()), grains_for_work}};
  std::fill(work_.begin(), work_.end(), 0);
  const Slabs balanced(loads, communicator_->size());
  if (balanced.largest_part(loads) > worth_a_change * slabs_.largest_part(loads)) return false;
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  const int first = first_layer_ + border_[0], last = first + rank_layers();
  for (int rank = 0; rank < communicator_->size(); ++rank) {
    const int from = std::max(first, balanced.first(rank)), to = std::min(last, balanced.first(rank + 1));
    if (from < to) save_layers(from, to, outgoing[static_cast<std::size_t>(rank)]);
  }
  std::vector<SavedGrain> grains;
  std::vector<SavedCell> cells;
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) take_saved(reader, grains, cells);
  set_slabs(balanced);
  fill(grains, cells, container);
  return true;
}

/// Collective. Adds whole cells at the low and the high ends of the grid. Cells keep their accounts, and grains the
/// cells that their references are in, so that listing everything anew changes no list.
void TiledPacking::grow(const std::array<int, 3>& below, const std::array<int, 3>& above, const Container& container) {
  Bytes own;
  save_layers(first_layer_ + border_[0], first_layer_ + border_[0] + rank_layers(), own);
  std::vector<SavedGrain> grains;
  std::vector<SavedCell> cells;
  for (const Bytes& bytes :
       communicator_->exchange(std::vector<Bytes>(static_cast<std::size_t>(communicator_->size()), own)))
    for (ByteReader reader(bytes); !reader.at_end();) take_saved(reader, grains, cells);
  const std::array<int, 3> old = n_;
  const auto index = [this](const Cell& at) { return (static_cast<std::int64_t>(at.z) * n_[1] + at.y) * n_[0] + at.x; };
  const auto shifted = [&](std::int64_t cell) {
    const auto x = static_cast<int>(cell % old[0]), y = static_cast<int>(cell / old[0] % old[1]);
    return Cell{x + below[0], y + below[1], static_cast<int>(cell / old[0] / old[1]) + below[2]};
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<double>(n_[axis]) + below[axis] + above[axis];
    if (n > std::numeric_limits<std::int32_t>::max() / 2)
      throw InvalidPacking(message("grains are spread over ", n, " cells of ", edge_[axis], " along ", "xyz"[axis],
                                   ", which is too many"));
    low_[static_cast<Eigen::Index>(axis)] -= below[axis] * edge_[axis];
    n_[axis] += below[axis] + above[axis];
  }
  const Point shift = {wrap(below[0] * edge_quanta_[0]), wrap(below[1] * edge_quanta_[1]),
                       wrap(below[2] * edge_quanta_[2]), 0};
  std::vector<std::int64_t> in_layer(static_cast<std::size_t>(n_[2]), 0);
  std::vector<SavedCell> entered;  // by grains that had been beyond the grid, this far from their references
  for (SavedGrain& grain : grains) {
    for (Point* point : {&grain.point, &grain.reference}) {
      point->x = add(point->x, shift.x);
      point->y = add(point->y, shift.y);
      point->z = add(point->z, shift.z);
    }
    const Vector3 at = from_low(grain.reference, shifted(grain.cell));
    const Cell cell{cell_coordinate(at.x(), 0), cell_coordinate(at.y(), 1), cell_coordinate(at.z(), 2)};
    if (index(cell) != index(shifted(grain.cell)))
      entered.push_back({index(cell), 0, length_of(minus(grain.point, grain.reference))});
    grain.cell = index(cell);
    ++in_layer[static_cast<std::size_t>(cell.z)];
  }
  for (SavedCell& cell : cells) cell.cell = index(shifted(cell.cell));
  set_slabs(Slabs(in_layer, communicator_->size()));
  fill(grains, cells, container);
  for (const SavedCell& cell : entered) {
    const std::int64_t here = cell.cell - static_cast<std::int64_t>(first_layer_) * cells_in_layer();
    if (here < first_owned() || here >= last_owned()) continue;
    std::int32_t& path = path_[static_cast<std::size_t>(here)];
    path = std::max(path, cell.path);
  }
}

std::vector<std::int64_t> TiledPacking::grains_in_layers() const {
  std::vector<std::int64_t> grains(static_cast<std::size_t>(rank_layers()), 0);
  for (std::uint32_t cell = first_owned(); cell < last_owned(); ++cell)
    for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot)
      if (ids_[slot] >= 0) ++grains[(cell - first_owned()) / cells_in_layer()];
  return grains;
}

}  // namespace spot
