// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/tiled_packing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "packing/kernel_builds.hpp"
#include "packing/packed_grain.hpp"
#include "packing/push_off_neighbours.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/packing/packing.hpp"

namespace spot {

namespace {

/// Grains that are this part of half a skin or more away from their references are listed anew once one of their cell
/// may have gone all the way.
constexpr double part_of_half_skin = 0.7;

/// The box of the grains of all ranks, down to the outlet: lowest coordinates, then the highest with the other sign.
std::vector<double> box_of(const std::vector<Grain>& grains, double outlet, Communicator& communicator) {
  constexpr double far = std::numeric_limits<double>::max();
  std::vector<double> box(6, far);
  box[2] = outlet;
  for (const Grain& grain : grains)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = grain.position[static_cast<Eigen::Index>(axis)];
      box[axis] = std::min(box[axis], at);
      box[axis + 3] = std::min(box[axis + 3], -at);
    }
  box = communicator.least(box);
  if (box[0] == far) box = {0.0, 0.0, outlet, 0.0, 0.0, -outlet};
  return box;
}

/// Puts a grain up to a height that it is below.
void put_up(Cells& cells, std::uint32_t slot, double height) {
  const double up = std::ceil((height - cells.position(slot).z()) / cells.lattice().quantum().length());
  const auto by = static_cast<std::int32_t>(up);
  cells.points[slot].z = add(cells.points[slot].z, by);
  cells.drift.add(cells.cell_of(slot), by);
}

}  // namespace

TiledPacking::TiledPacking(double diameter, double extent, const Periodic& periodic,
                           std::shared_ptr<Communicator> communicator)
    : kernels_(kernels::best()),
      communicator_(std::move(communicator)),
      cells_(CellLattice(diameter, extent, periodic)),
      received_(cells_),
      walls_(cells_),
      lists_(cells_, walls_, kernels_),
      ghosts_(cells_, lists_, communicator_),
      moves_(cells_, kernels_) {}

TiledPacking::TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
                           const Container& container, std::shared_ptr<Communicator> communicator)
    : TiledPacking(diameter, extent, container.periodic(), std::move(communicator)) {
  // Packing checks what can be wrong with grains.
  const std::vector<Grain> checked = Packing(diameter, extent, grains, container.periodic()).grains();
  const std::vector<double> box = box_of(checked, outlet, *communicator_);
  CellLattice& lattice = cells_.lattice();
  lattice.span(Vector3(box[0], box[1], box[2]), Vector3(-box[3], -box[4], -box[5]));
  std::vector<std::int64_t> in_layer(static_cast<std::size_t>(lattice.layers()), 0);
  for (const Grain& grain : checked) ++in_layer[static_cast<std::size_t>(lattice.layer(grain.position.z()))];
  set_slabs(Slabs(communicator_->sum(in_layer), communicator_->size()));
  if (some_are_smaller(checked)) cells_.allow_unequal();
  for (const Grain& grain : take_own(checked)) {
    put(grain, Point::free);
  }
  list_all(container);
}

/// One of the own layers' grains, in this state unless it is held.
Place TiledPacking::put(const Grain& grain, std::int32_t state) {
  const CellLattice& lattice = cells_.lattice();
  const Vector3 at = lattice.periodic().wrap(grain.position) - lattice.low();
  Point point = lattice.wrapped(at);
  point.state = grain.held ? Point::held : state;
  const Place place = cells_.ensure_room(lattice.number_of(lattice.cell_at(at)));
  cells_.occupy(cells_.slot(place), grain.id, point, point, radius_in(diameter(), grain));
  return place;
}

void TiledPacking::set_slabs(const Slabs& slabs) {
  received_.hand_over();
  cells_.hold(slabs, communicator_->rank());
  work_.assign(static_cast<std::size_t>(cells_.own_layers()), 0);
}

/// Of the grains that all ranks bring together, those in this rank's layers.
std::vector<Grain> TiledPacking::take_own(const std::vector<Grain>& grains) const {
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  for (const Grain& grain : grains) append(outgoing[static_cast<std::size_t>(owner(grain.position.z()))], grain);
  std::vector<Grain> own;
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) own.push_back(take_grain(reader));
  return own;
}

void TiledPacking::require_same_periods(const Container& container) const {
  container.periodic().require_same_as(cells_.lattice().periodic(), quantum());
}

/// Collective.
bool TiledPacking::some_are_smaller(const std::vector<Grain>& grains) {
  double least = 0.5 * diameter();
  for (const Grain& grain : grains) least = std::min(least, radius_in(diameter(), grain));
  return communicator_->least(std::vector<double>{least})[0] < 0.5 * diameter();
}

std::pair<int, int> TiledPacking::reached(double height, double radius) const {
  const double reach = BlockMoves::reach(radius, cells_.lattice());
  return {owner(height - reach), owner(height + reach)};
}

// ---- lists

/// After all places in the own layers have been occupied.
void TiledPacking::list_all(const Container& container) {
  walls_.find_planes(container);
  lists_.reserve(cells_.size());
  cells_.visit_own([&](std::uint32_t slot) { lists_.list(slot, container); });
  ghosts_.send_positions();
  ghosts_.exchange(container);
}

void TiledPacking::update_lists(const Container& container, Workers& workers) {
  find_drifted(workers);
  lists_.list(drifted_, container, workers);
  drifted_.clear();
  if (communicator_->size() > 1) ghosts_.exchange_migrants(container);
  ghosts_.exchange(container);
}

/// Puts grains that are too far from their references into the cells where they are now, and into drifted_. Workers
/// find them, and one of them moves their references.
void TiledPacking::find_drifted(Workers& workers) {
  const auto allowed = static_cast<std::int32_t>(lists_.largest_drift() / quantum().length());
  const double kept = part_of_half_skin * allowed;
  const std::uint32_t first_own = cells_.first_own(), owned = cells_.last_own() - first_own;
  found_.resize(owned);
  const std::size_t n = kernels_.find_reached(cells_.drift.data() + first_own, owned, allowed, found_.data());
  const auto find_in = [&](std::uint32_t cell, std::vector<Place>& far) {
    if (between_moves_) moves_.write_back(cell);
    const std::uint32_t first = cells_.first_slot(cell);
    const double squared = kernels_.farthest(cells_.points.data() + first, cells_.references.data() + first,
                                             cells_.end_slot(cell) - first);
    if (squared > kept * kept)
      for (Place place{cell, 0}; cells_.slot(place) < cells_.end_slot(cell); ++place.in_cell) {
        const std::uint32_t slot = cells_.slot(place);
        if (squared_distance(cells_.points[slot], cells_.references[slot]) > kept * kept) far.push_back(place);
      }
    cells_.drift.set(cell, static_cast<std::int32_t>(std::min(1.001 * std::sqrt(squared), kept)) + 1);
  };
  far_.resize(static_cast<std::size_t>(workers.size()));
  for (std::vector<Place>& far : far_) far.clear();
  workers.share_out(n, [&](int worker, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) find_in(first_own + found_[k], far_[static_cast<std::size_t>(worker)]);
  });
  for (const std::vector<Place>& far : far_)
    for (const Place& place : far) move_reference(place);
}

void TiledPacking::move_reference(Place place) {
  const CellLattice& lattice = cells_.lattice();
  const std::uint32_t from = cells_.slot(place);
  Vector3 at = cells_.from_low(cells_.points[from], place.cell);
  if (lattice.periodic().any()) {
    // It goes on where it has come in on the other side.
    const Vector3 inside = lattice.periodic().wrap(Vector3(lattice.low() + at)) - lattice.low();
    const auto periods = [&](int axis) { return inside[axis] > at[axis] ? 1 : inside[axis] < at[axis] ? -1 : 0; };
    add(cells_.points[from], lattice.periods(periods(0), periods(1)));
    cells_.coordinates.set(from, cells_.points[from]);
    at = inside;
  }
  const Cell cell = lattice.cell_at(at);
  if (cells_.slabs().owner(cell.z) != communicator_->rank()) {
    ghosts_.emigrate(from, cell);
    return;
  }
  const std::uint32_t number = lattice.number_of(cell);
  if (number != place.cell) {
    const Place to = cells_.ensure_room(number);
    const std::uint32_t old = cells_.slot(place), slot = cells_.slot(to);
    cells_.occupy(slot, cells_.ids[old], cells_.points[old], cells_.points[old], cells_.radius(old));
    cells_.follow(slot, old);
    lists_.rename(old, slot);
    cells_.vacate(old);
    place = to;
  } else {
    cells_.note_change(from);
    cells_.lattice().note_listed(at);
  }
  cells_.references[cells_.slot(place)] = cells_.points[cells_.slot(place)];
  drifted_.push_back(place);
}

void TiledPacking::note_unsupported_above(std::uint32_t slot) {
  for (const std::uint32_t other : lists_.of(slot))
    if (cells_.points[other].state == Point::free && minus(cells_.points[other].z, cells_.points[slot].z) > 0)
      unsupported_.push_back(cells_.place_of(other));
}

// ---- moves

void TiledPacking::displace(std::vector<Move>& moves, const SpotParameters& spots, const Weigh& weigh,
                            const Container& container, Workers& workers) {
  BlockMoves::require_radius(spots.radius, diameter());
  weigh(moves_.find(moves, spots, workers, work_), moves);
  moves_.weigh(moves, spots);
  for (std::size_t first = 0;;) {
    const std::size_t end = moves_.end_before_rebuild(moves, first, *communicator_, workers);
    moves_.apply(first, end, workers, received_.counts() ? received_.counters() : nullptr);
    between_moves_ = moves_.must_rebuild();
    if (!between_moves_) moves_.write_back(workers);
    // Sweeps are the next to ask where others' grains are.
    between_moves_ ? ghosts_.send_no_positions() : ghosts_.send_positions();
    update_lists(container, workers);
    first = end;
    if (!between_moves_) return;
  }
}

// ---- the rest

void TiledPacking::visit_grains(const VisitGrain& visit, Which which) const {
  Workers one_thread(1);
  visit_grains_at_once([&visit](const Grain& grain, std::size_t) { visit(grain); }, which, one_thread);
}

void TiledPacking::visit_grains_at_once(const VisitGrainAtOnce& visit, Which which, Workers& workers) const {
  const auto visit_cells = [&](int worker, std::size_t first, std::size_t last) {
    for (std::uint32_t k = static_cast<std::uint32_t>(first); k < last; ++k) {
      const std::uint32_t cell = cells_.first_own() + k;
      if (cells_.is_image(cell) || (which == Which::moved && !cells_.drift.moved(cell))) continue;
      const Cell listed_in = cells_.lattice().cell(cell);
      cells_.visit(cell, cell + 1,
                   [&](std::uint32_t slot) { visit(cells_.grain(slot, listed_in), static_cast<std::size_t>(worker)); });
    }
  };
  workers.share_out(cells_.last_own() - cells_.first_own(), visit_cells);
}

void TiledPacking::take_out_below(double outlet, const std::function<bool(const Vector3& place)>& is_closed,
                                  std::vector<Grain>& drained) {
  const CellLattice& lattice = cells_.lattice();
  const int layers =
      std::clamp(lattice.layer(outlet + lattice.skin()) + 1 - cells_.first_own_layer(), 0, cells_.own_layers());
  const std::uint32_t last = cells_.first_own() + static_cast<std::uint32_t>(layers) * cells_.in_layer();
  cells_.visit(cells_.first_own(), last, [&](std::uint32_t slot) {
    const bool stays = cells_.points[slot].state != Point::free || cells_.position(slot).z() >= outlet;
    if (stays || !cells_.own(cells_.cell_of(slot))) return;
    if (is_closed(cells_.position(slot))) return put_up(cells_, slot, outlet);
    drained.push_back(cells_.grain(slot));
    lists_.unlist(slot);
    cells_.vacate(slot);
  });
}

/// The kernel tells how deep each grain overlaps any other, in single precision; only those that may be the deepest so
/// far are measured in double precision.
Overlap TiledPacking::largest_overlap() const {
  constexpr std::uint32_t at_a_time = 1024;
  constexpr double precision = 1e-5;
  const double diameter = cells_.lattice().quanta_of_diameter(), per_square = 1.0 / square(diameter);
  std::array<std::uint32_t, at_a_time + kernels::ahead> grains{};
  std::array<Point, at_a_time> pushes;
  Overlap largest;
  double least = square(diameter);
  std::uint32_t n = 0;
  const auto measure = [&] {
    push_off_neighbours(kernels_, cells_, lists_, grains.data(), n, {0.0, 0.0, 0.0}, pushes.data());
    for (std::uint32_t k = 0; k < n; ++k)
      if (depth_of(pushes[k]) > 1.0 - least * per_square - precision) find_larger_overlap(grains[k], least, largest);
    n = 0;
  };
  cells_.visit_own([&](std::uint32_t slot) {
    grains[n++] = slot;
    if (n == at_a_time) measure();
  });
  measure();
  return largest;
}

/// `least`: the squared distance, in quanta, of the two grains with the largest overlap, as if they were of the largest
/// size.
void TiledPacking::find_larger_overlap(std::uint32_t slot, double& least, Overlap& largest) const {
  const std::int64_t id = cells_.ids[slot];
  for (const std::uint32_t other : lists_.of(slot)) {
    double squared = squared_distance(cells_.points[slot], cells_.points[other]);
    if (cells_.unequal())
      squared *= square(cells_.lattice().quanta_of_diameter() / cells_.touching_distance(slot, other));
    if (squared >= least) continue;
    least = squared;
    largest = {1.0 - std::sqrt(squared) * quantum().length() / diameter(), std::min(id, cells_.ids[other]),
               std::max(id, cells_.ids[other])};
  }
}

std::size_t TiledPacking::memory() const {
  return cells_.memory() + received_.memory() + walls_.memory() + lists_.memory() + moves_.memory() +
         bytes_in(work_, unsupported_, drifted_, far_, found_);
}

}  // namespace spot
