// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

enum Side { below, above };

/// A grain that goes to a cell of another rank.
struct Migrant {
  std::int64_t id;
  std::int32_t layer;
  std::uint32_t in_layer;  // number of the cell
  Point point, momentum;
};

/// What has become of a slot in a layer that another rank holds a copy of.
struct Change {
  std::uint32_t in_layer, in_cell;
  std::int64_t id;
  Point point, reference;
};

struct Moved {
  std::int32_t x, y, z;
};

}  // namespace

/// The first cell of the layer next to a neighbour's: of this rank's own, or of the copy of the neighbour's.
std::uint32_t TiledPacking::first_of_border(int side, bool own) const {
  if (side == below) return own ? first_owned() : 0;
  return own ? last_owned() - cells_in_layer() : last_owned();
}

void TiledPacking::note_change(std::uint32_t slot) {
  const Place place = {slot / capacity_, slot % capacity_};
  if (!owned(place.cell)) return;
  for (const int side : {below, above}) {
    const std::uint32_t first = first_of_border(side, true);
    if (border_[static_cast<std::size_t>(side)] != 0 && place.cell >= first && place.cell < first + cells_in_layer())
      changed_[static_cast<std::size_t>(side)].push_back(place);
  }
}

/// Gives a grain to the rank that owns the layer where it is now.
void TiledPacking::emigrate(std::uint32_t slot, int layer) {
  const Cell target = cell(slot / capacity_);
  const Vector3 at = from_low(points_[slot], slot / capacity_);
  const auto in_layer = static_cast<std::uint32_t>(cell_coordinate(at.y(), 1) * n_[0] + cell_coordinate(at.x(), 0));
  append(migrants_[layer < target.z ? below : above],
         Migrant{ids_[slot], layer, in_layer, points_[slot], momenta_[slot]});
  unlist(slot);
  vacate(slot);
}

void TiledPacking::exchange_migrants(const Container& container) {
  const auto arrived = communicator_->exchange_with_neighbours(std::move(migrants_));
  migrants_ = {};
  for (const Bytes& bytes : arrived)
    for (ByteReader reader(bytes); !reader.at_end();) {
      const auto migrant = reader.take<Migrant>();
      if (slabs_.owner(migrant.layer) != communicator_->rank())
        throw InvalidPacking(message("grain ", migrant.id, " has crossed all layers of a rank between two looks; the ",
                                     slabs_.layers(), " layers are too few for ", slabs_.ranks(), " ranks"));
      const auto layer = static_cast<std::uint32_t>(migrant.layer - first_layer_);
      const std::uint32_t at = slot(ensure_room(layer * cells_in_layer() + migrant.in_layer));
      occupy(at, migrant.id, migrant.point, migrant.point);
      momenta_[at] = migrant.momentum;
      list(at, container);
    }
}

/// Brings the copies that neighbours hold up to date: lists, and positions as choose_sent() said.
void TiledPacking::exchange_border(const Container& container) {
  if (communicator_->size() == 1) return;
  std::array<Bytes, 2> outgoing;
  for (const int side : {below, above})
    if (border_[static_cast<std::size_t>(side)] != 0) outgoing[static_cast<std::size_t>(side)] = changes(side);
  const auto incoming = communicator_->exchange_with_neighbours(std::move(outgoing));
  for (const int side : {below, above})
    if (border_[static_cast<std::size_t>(side)] != 0)
      take_changes(incoming[static_cast<std::size_t>(side)], side, container);
}

/// Neighbours are told where the grains of those border cells are that have been charged with so much, when this is
/// called; they have the same accounts, and know which to expect.
void TiledPacking::choose_sent(std::int32_t account) {
  sent_.resize(account_.size());
  for (const int side : {below, above})
    for (const bool own : {false, true}) {
      if (border_[static_cast<std::size_t>(side)] == 0) continue;
      const std::uint32_t first = first_of_border(side, own);
      for (std::uint32_t cell = first; cell < first + cells_in_layer(); ++cell) sent_[cell] = account_[cell] >= account;
    }
}

/// Calls visit(slot) for all occupied slots of the chosen cells of a layer, in order.
template <typename Visit>
void TiledPacking::visit_sent(std::uint32_t first_cell, const Visit& visit) const {
  for (std::uint32_t cell = first_cell; cell < first_cell + cells_in_layer(); ++cell) {
    if (sent_[cell] == 0) continue;
    for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot)
      if (ids_[slot] >= 0) visit(slot);
  }
}

/// What has changed in the layer next to a neighbour's since it was told last, the accounts of its cells, and where the
/// grains of the chosen cells are.
Bytes TiledPacking::changes(int side) {
  std::vector<Change> changed;
  const std::uint32_t first = first_of_border(side, true);
  for (const Place& place : changed_[static_cast<std::size_t>(side)])
    changed.push_back(
        {place.cell - first, place.in_cell, ids_[slot(place)], points_[slot(place)], references_[slot(place)]});
  changed_[static_cast<std::size_t>(side)].clear();
  Bytes bytes;
  append(bytes, changed);
  const auto account = account_.begin() + first;
  append(bytes, std::vector<std::int32_t>(account, account + cells_in_layer()));
  visit_sent(first, [&](std::uint32_t slot) {
    append(bytes, Moved{points_[slot].x, points_[slot].y, points_[slot].z});
  });
  return bytes;
}

void TiledPacking::take_changes(const Bytes& bytes, int side, const Container& container) {
  ByteReader reader(bytes);
  const std::uint32_t first = first_of_border(side, false);
  const auto changed = reader.take_all<Change>();
  // Slots may be named more than once: what they hold now is what all of these say.
  for (const Change& change : changed) {
    if (change.in_cell >= capacity_) set_capacity(change.in_cell / kernels::pack * kernels::pack + kernels::pack);
    const std::uint32_t at = slot({first + change.in_layer, change.in_cell});
    if (ids_[at] < 0) continue;
    unlist(at);
    vacate(at);
  }
  for (const Change& change : changed)
    if (change.id >= 0)
      occupy(slot({first + change.in_layer, change.in_cell}), change.id, change.point, change.reference);
  for (const Change& change : changed)
    if (change.id >= 0) list(slot({first + change.in_layer, change.in_cell}), container);
  const auto accounts = reader.take_all<std::int32_t>();
  std::copy(accounts.begin(), accounts.end(), account_.begin() + first);
  visit_sent(first, [&](std::uint32_t slot) {
    const auto moved = reader.take<Moved>();
    points_[slot].x = moved.x;
    points_[slot].y = moved.y;
    points_[slot].z = moved.z;
  });
}

}  // namespace spot
