// SPDX-License-Identifier: GPL-2.0-or-later
// Layers that go elsewhere: saved, shared out anew among ranks, or into a larger lattice; and grains that come and go.
#include <algorithm>

#include "packing/grain_change.hpp"
#include "packing/saved_layers.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// What all parts of a saved state have in common.
struct SavedLattice {
  double diameter, extent, low[3];
  std::int32_t cells[3];
  std::int32_t ranks;
};

/// A slab may hold this many times an even part of the grains, so that memory is shared out, too.
constexpr double grains_for_work = 1.5;

/// Slabs are changed if that makes the busiest rank's part of the work smaller than this times what it was.
constexpr double worth_a_change = 0.96;

}  // namespace

// ---- saved states

TiledPacking::TiledPacking(double diameter, double extent, const std::vector<Bytes>& saved, const Container& container,
                           std::shared_ptr<Communicator> communicator)
    : TiledPacking(diameter, extent, container.periodic(), std::move(communicator)) {
  CellLattice& lattice = cells_.lattice();
  SavedLayers layers;
  for (const Bytes& part : saved) {
    ByteReader reader = unseal(part);
    const auto of = reader.take<SavedLattice>();
    if (of.diameter != diameter || of.extent != extent)
      throw InvalidState(message("the saved state has grains of diameter ", of.diameter, " in a box that reaches to ",
                                 of.extent, ", not ", diameter, " and ", extent));
    if (static_cast<std::size_t>(of.ranks) != saved.size())
      throw InvalidState(message("the saved state has ", saved.size(), " parts, not ", of.ranks));
    const Vector3 low(of.low[0], of.low[1], of.low[2]);
    const std::array<int, 3> size = {of.cells[0], of.cells[1], of.cells[2]};
    if (&part != &saved.front() && (low != lattice.low() || size != lattice.size()))
      throw InvalidState("the parts of the saved state are not of the same run");
    lattice.span(low, size);
    layers.take(reader, lattice);
  }
  if (layers.unequal(diameter)) cells_.allow_unequal();
  set_slabs(Slabs(layers.grains_in_layers(lattice), communicator_->size()));
  layers.fill(cells_);
  list_all(container);
}

Bytes TiledPacking::save() const {
  const CellLattice& lattice = cells_.lattice();
  const Vector3& low = lattice.low();
  const std::array<int, 3>& size = lattice.size();
  Bytes bytes;
  append(bytes, SavedLattice{diameter(),
                             extent(),
                             {low.x(), low.y(), low.z()},
                             {size[0], size[1], size[2]},
                             static_cast<std::int32_t>(communicator_->size())});
  append_layers(bytes, cells_, cells_.first_own_layer(), cells_.first_own_layer() + cells_.own_layers());
  seal(bytes);
  return bytes;
}

// ---- other ranks, and larger lattices

bool TiledPacking::balance(const Container& container) {
  const int first = cells_.first_own_layer(), last = first + cells_.own_layers();
  const auto of_all_ranks = [&](const std::vector<std::int64_t>& own) {
    std::vector<std::int64_t> all(static_cast<std::size_t>(cells_.lattice().layers()), 0);
    std::copy(own.begin(), own.end(), all.begin() + first);
    return communicator_->sum(all);
  };
  const std::vector<Slabs::Load> loads = {{of_all_ranks(work_)},
                                          {of_all_ranks(cells_.grains_in_own_layers()), grains_for_work}};
  std::fill(work_.begin(), work_.end(), 0);
  const Slabs balanced(loads, communicator_->size());
  if (balanced.largest_part(loads) > worth_a_change * cells_.slabs().largest_part(loads)) return false;
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  for (int rank = 0; rank < communicator_->size(); ++rank) {
    const int from = std::max(first, balanced.first(rank)), to = std::min(last, balanced.first(rank + 1));
    if (from < to) append_layers(outgoing[static_cast<std::size_t>(rank)], cells_, from, to);
  }
  SavedLayers layers;
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) layers.take(reader, cells_.lattice());
  set_slabs(balanced);
  layers.fill(cells_);
  list_all(container);
  return true;
}

/// Lets the lattice grow by whole cells until it holds all these places. What is listed stays listed.
void TiledPacking::cover(const std::vector<Grain>& come, const Container& container) {
  std::vector<double> cells(6, 0.0);  // with the other sign
  for (const Grain& grain : come) {
    const std::array<int, 6> missing = cells_.lattice().cells_to(grain.position);
    for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = std::min(cells[k], -1.0 * missing[k]);
  }
  cells = communicator_->least(cells);
  if (cells == std::vector<double>(6, 0.0)) return;
  const auto added = [&](std::size_t k) { return static_cast<int>(-cells[k]); };
  grow({added(0), added(1), added(2)}, {added(3), added(4), added(5)}, container);
}

namespace {

/// Puts what was in a smaller lattice into the cells of the one that has grown. Cells keep their counts, and grains the
/// cells that their references are in; some, which had been beyond the lattice, enter others, of which it returns how
/// far they may be from their references.
std::vector<SavedCell> shift(SavedLayers& layers, const CellLattice& old, const CellLattice& now,
                             const std::array<int, 3>& below) {
  const auto shifted = [&](std::int64_t number) {
    const Cell cell = old.cell_in_all(number);
    return Cell{cell.x + below[0], cell.y + below[1], cell.z + below[2]};
  };
  const Point by = now.wrapped_cells(below);
  std::vector<SavedCell> entered;
  for (SavedGrain& grain : layers.grains) {
    add(grain.point, by);
    add(grain.reference, by);
    const Cell before = shifted(grain.cell);
    grain.cell = now.number_in_all(now.cell_at(now.from_low(grain.reference, before)));
    if (grain.cell != now.number_in_all(before))
      entered.push_back({grain.cell, 0, length_of(minus(grain.point, grain.reference))});
  }
  for (SavedCell& cell : layers.cells) cell.cell = now.number_in_all(shifted(cell.cell));
  return entered;
}

}  // namespace

/// Collective. Adds whole cells at the low and the high ends of the lattice.
void TiledPacking::grow(const std::array<int, 3>& below, const std::array<int, 3>& above, const Container& container) {
  CellLattice& lattice = cells_.lattice();
  Bytes own;
  append_layers(own, cells_, cells_.first_own_layer(), cells_.first_own_layer() + cells_.own_layers());
  SavedLayers layers;
  for (const Bytes& bytes : communicator_->share_with_all(own))
    for (ByteReader reader(bytes); !reader.at_end();) layers.take(reader, lattice);
  const CellLattice old = lattice;
  lattice.grow(below, above);
  const std::vector<SavedCell> entered = shift(layers, old, lattice, below);
  set_slabs(Slabs(layers.grains_in_layers(lattice), communicator_->size()));
  layers.fill(cells_);
  list_all(container);
  for (const SavedCell& cell : entered) {
    const Cell at = lattice.cell_in_all(cell.cell);
    if (cells_.slabs().owner(at.z) != communicator_->rank()) continue;
    const std::uint32_t number = lattice.number_of(at);
    cells_.drift.set(number, std::max(cells_.drift[number], cell.drift));
  }
}

// ---- grains that come and go

Overlap TiledPacking::change(const std::vector<std::int64_t>& gone, const std::vector<Grain>& come,
                             const Container& container) {
  GrainChange change(*this);
  change.require_within_extent(come);
  received_.hand_over();
  const bool some_go = change.mark_going(gone);
  std::vector<Grain> incoming = some_go ? change.stay_under_other_ids(come) : come;
  cover(incoming, container);
  incoming = take_own(incoming);
  if (some_go) change.take_out_going(container);
  change.require_new_ids(incoming);
  if (some_are_smaller(incoming)) cells_.allow_unequal();
  std::vector<Place> places;
  for (const Grain& grain : incoming) places.push_back(put(grain, Point::falling));
  for (const Place& place : places) lists_.list(cells_.slot(place), container);
  ghosts_.send_no_positions();
  ghosts_.exchange(container);
  Overlap largest;
  double least = square(cells_.lattice().quanta_of_diameter());
  for (const Place& place : places) find_larger_overlap(cells_.slot(place), least, largest);
  return largest;
}

}  // namespace spot
