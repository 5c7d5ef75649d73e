// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/ghost_layers.hpp"

#include <algorithm>
#include <utility>

#include "packing/wrapped_integers.hpp"

#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// A grain that goes to a cell of another rank.
struct Migrant {
  std::int64_t id;
  Cell cell;
  Point point, correction;
  double radius;
  NonaffineMotion::Tilt tilt;
};

/// What has become of a slot in a layer that another rank holds a copy of.
struct Change {
  std::uint32_t in_layer, in_cell;
  std::int64_t id;
  Point point, reference;
  double radius;
};

struct Position {
  std::int32_t x, y, z;
};

constexpr std::array<Side, 2> sides = {below, above};

}  // namespace

GhostLayers::GhostLayers(Cells& cells, NeighbourLists& lists, std::shared_ptr<Communicator> communicator)
    : cells_(cells), lists_(lists), communicator_(std::move(communicator)) {}

void GhostLayers::emigrate(std::uint32_t slot, const Cell& to) {
  append(migrants_[to.z < cells_.first_own_layer() ? below : above],
         Migrant{cells_.ids[slot], to, cells_.points[slot], cells_.corrections[slot], cells_.radius(slot),
                 cells_.tilted() ? cells_.tilts[slot] : NonaffineMotion::Tilt{0, 0, 0, 0}});
  lists_.unlist(slot);
  cells_.vacate(slot);
}

void GhostLayers::exchange_migrants(const Container& container) {
  const auto arrived = communicator_->exchange_with_neighbours(std::move(migrants_));
  migrants_ = {};
  for (const Bytes& bytes : arrived)
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto migrant = reader.take<Migrant>();
      const Slabs& slabs = cells_.slabs();
      if (slabs.owner(migrant.cell.z) != communicator_->rank())
        throw InvalidPacking(message("grain ", migrant.id,
                                     " has crossed all layers of a rank between two list updates; the ", slabs.layers(),
                                     " layers are too few for ", slabs.ranks(), " ranks"));
      const Place place = cells_.ensure_room(cells_.lattice().number_of(migrant.cell));
      const std::uint32_t at = cells_.slot(place);
      cells_.occupy(at, migrant.id, migrant.point, migrant.point, migrant.radius);
      cells_.corrections[at] = migrant.correction;
      if (cells_.tilted()) cells_.tilts.set(at, migrant.tilt);
      lists_.list(at, container);
    }
}

void GhostLayers::exchange(const Container& container) {
  if (communicator_->size() > 1) exchange_layers(container);
  if (cells_.repeat()) update_images(container);
}

void GhostLayers::exchange_layers(const Container& container) {
  std::array<Bytes, 2> outgoing;
  for (const Side side : sides)
    if (cells_.has_ghosts(side)) outgoing[side] = changes(side);
  const auto incoming = communicator_->exchange_with_neighbours(std::move(outgoing));
  for (const Side side : sides)
    if (cells_.has_ghosts(side)) take_changes(incoming[side], side, container);
}

/// Makes sure that there is such a place, and that no copy is in it.
void GhostLayers::clear(const Place& place) {
  cells_.ensure_place(place);
  const std::uint32_t at = cells_.slot(place);
  if (!cells_.occupied(at)) return;
  lists_.unlist(at);
  cells_.vacate(at);
}

/// An image has the grains of its source in the same places, a period away.
void GhostLayers::update_images(const Container& container) {
  const CellLattice& lattice = cells_.lattice();
  std::vector<std::pair<Place, Place>> changed;  // of a source, and of its image
  for (const Place& place : cells_.take_changes_seen_in_images())
    for (const std::uint32_t image : cells_.images_of(place.cell)) changed.push_back({place, {image, place.in_cell}});
  for (const auto& [source, image] : changed) clear(image);
  std::vector<Place> come;
  for (const auto& [source, image] : changed) {
    const std::uint32_t from = cells_.slot(source), to = cells_.slot(image);
    if (!cells_.occupied(from) || cells_.occupied(to)) continue;
    const Point by = lattice.shift_to(lattice.cell(image.cell));
    Point point = cells_.points[from], reference = cells_.references[from];
    add(point, by);
    add(reference, by);
    cells_.occupy(to, cells_.ids[from], point, reference, cells_.radius(from));
    come.push_back(image);
  }
  for (const Place& place : come) lists_.list(cells_.slot(place), container);
  for (std::uint32_t source = 0; source < cells_.count(); ++source)
    for (const std::uint32_t image : cells_.images_of(source)) copy_to_image(source, image);
}

void GhostLayers::copy_to_image(std::uint32_t source, std::uint32_t image) {
  cells_.unrelaxed[image] = cells_.unrelaxed[source];
  const Point by = cells_.lattice().shift_to(cells_.lattice().cell(image));
  const std::uint32_t first = cells_.first_slot(source);
  cells_.visit(image, image + 1, [&](std::uint32_t slot) {
    Point point = cells_.points[first + slot - cells_.first_slot(image)];
    add(point, by);
    point.state = cells_.points[slot].state;
    cells_.points[slot] = point;
  });
}

void GhostLayers::choose(std::int32_t parts) {
  sent_.resize(cells_.count());
  for (const Side side : sides) {
    if (!cells_.has_ghosts(side)) continue;
    for (const std::uint32_t first : {cells_.first_of_border(side), cells_.first_of_ghosts(side)})
      for (std::uint32_t cell = first; cell < first + cells_.in_layer(); ++cell)
        sent_[cell] = cells_.unrelaxed[cell] >= parts;
  }
}

/// Calls visit(point) for all grains of the chosen cells of a layer, in order.
template <typename Visit>
void GhostLayers::visit_sent(std::uint32_t first_cell, const Visit& visit) const {
  for (std::uint32_t cell = first_cell; cell < first_cell + cells_.in_layer(); ++cell)
    if (sent_[cell] != 0 && !cells_.is_image(cell))
      cells_.visit(cell, cell + 1, [&](std::uint32_t slot) { visit(cells_.points[slot]); });
}

/// What has changed in the layer next to a neighbour's since it was told last, the moves that its cells have received,
/// and where the grains of the chosen cells are.
Bytes GhostLayers::changes(Side side) {
  std::vector<Change> changed;
  const std::uint32_t first = cells_.first_of_border(side);
  for (const Place& place : cells_.take_changes(side)) {
    const std::uint32_t slot = cells_.slot(place);
    changed.push_back({place.cell - first, place.in_cell, cells_.ids[slot], cells_.points[slot],
                       cells_.references[slot], cells_.radius(slot)});
  }
  Bytes bytes;
  append(bytes, changed);
  const auto unrelaxed = cells_.unrelaxed.begin() + first;
  append(bytes, std::vector<std::int32_t>(unrelaxed, unrelaxed + cells_.in_layer()));
  visit_sent(first, [&](const Point& point) { append(bytes, Position{point.x, point.y, point.z}); });
  return bytes;
}

void GhostLayers::take_changes(const Bytes& bytes, Side side, const Container& container) {
  ByteReader reader(bytes);
  const std::uint32_t first = cells_.first_of_ghosts(side);
  const auto changed = reader.take_all<Change>();
  const auto place_of = [&](const Change& change) { return Place{first + change.in_layer, change.in_cell}; };
  // Slots may be named more than once: what they hold now is what all of these say.
  for (const Change& change : changed) clear(place_of(change));
  for (const Change& change : changed)
    if (change.id >= 0)
      cells_.occupy(cells_.slot(place_of(change)), change.id, change.point, change.reference, change.radius);
  for (const Change& change : changed)
    if (change.id >= 0) lists_.list(cells_.slot(place_of(change)), container);
  const auto unrelaxed = reader.take_all<std::int32_t>();
  std::copy(unrelaxed.begin(), unrelaxed.end(), cells_.unrelaxed.begin() + first);
  visit_sent(first, [&](Point& point) {
    const auto at = reader.take<Position>();
    point.x = at.x;
    point.y = at.y;
    point.z = at.z;
  });
}

}  // namespace spot
