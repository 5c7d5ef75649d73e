// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cells.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// Room in a cell at first; a dense packing has 3.7 grains in it.
constexpr std::uint32_t first_room = 2 * kernels::pack;

void require_countable(double slots, std::uint32_t cells) {
  if (slots > std::numeric_limits<std::uint32_t>::max() / kernels::lanes)
    throw InvalidPacking(message("grains are spread over ", cells, " cells with room for ", slots,
                                 ": the packing has collapsed, or is too large"));
}

/// Where the slots of a cell end that need to go so far.
std::uint32_t end_of(const CellLattice& lattice, std::uint32_t cell, std::uint32_t least) {
  const bool last_in_row = (cell + 1) % lattice.cells_in_row() == 0;
  return last_in_row ? (least + kernels::lanes - 1) / kernels::lanes * kernels::lanes : least;
}

/// Of each slot. `first_slot`: of each cell, and the end of the last.
AlignedVector<std::uint32_t> cells_of_slots(const AlignedVector<std::uint32_t>& first_slot) {
  AlignedVector<std::uint32_t> cells;
  cells.reserve(first_slot.back());
  for (std::uint32_t cell = 0; cell + 1 < first_slot.size(); ++cell) cells.resize(first_slot[cell + 1], cell);
  return cells;
}

/// Calls change(values, empty) for all arrays, with what empty slots have.
template <typename Change>
void change_all(Coordinates& coordinates, const Change& change) {
  change(coordinates.x, nobody.x);
  change(coordinates.y, nobody.y);
  change(coordinates.z, nobody.z);
  change(coordinates.state_squared, static_cast<float>(nobody.state) * static_cast<float>(nobody.state));
}

template <typename Change>
void change_all(Tilts& tilts, const Change& change) {
  for (auto* values : {&tilts.x, &tilts.y, &tilts.z, &tilts.level}) change(*values, std::int16_t{0});
}

}  // namespace

void Cells::hold(const Slabs& slabs, int rank) {
  hold_layers(slabs, rank, std::numeric_limits<std::uint32_t>::max() / (2 * first_room * kernels::lanes));
  const std::uint32_t n = count();
  first_slot_.resize(n + 1);
  for (std::uint32_t cell = 0; cell < n; ++cell)
    first_slot_[cell + 1] = end_of(lattice(), cell, first_slot_[cell] + first_room);
  const std::uint32_t slots = first_slot_.back();
  cell_of_ = cells_of_slots(first_slot_);
  points.assign(slots, nobody);
  references.assign(slots, nobody);
  corrections.assign(slots, {0, 0, 0, 0});
  const auto empty_all = [&](auto& values, auto empty) { values.assign(slots, empty); };
  change_all(coordinates, empty_all);
  if (tilted_) change_all(tilts, empty_all);
  ids.assign(slots, -1);
  if (unequal_) sizes.assign(slots, size_of(0.5 * lattice().diameter()));
  unrelaxed.assign(n, 0);
  drift.assign(n);
  changed_ = {};
  changed_in_images_.clear();
  size_ = 0;
  for (SlotData* data : attached_) data->renumber({}, slots);
}

// ---- sizes

GrainSize Cells::size_of(double radius) const {
  return {radius, static_cast<float>(radius / lattice().quantum().length()),
          static_cast<float>(volume_parts(lattice().diameter(), radius))};
}

void Cells::allow_unequal() {
  if (unequal_) return;
  unequal_ = true;
  sizes.assign(slots(), size_of(0.5 * lattice().diameter()));
}

void Cells::give_tilts() {
  if (tilted_) return;
  tilted_ = true;
  change_all(tilts, [&](auto& values, auto empty) { values.assign(slots(), empty); });
}

// ---- slots

Place Cells::ensure_room(std::uint32_t cell) {
  std::uint32_t slot = first_slot(cell);
  while (slot < end_slot(cell) && occupied(slot)) ++slot;
  const Place place = {cell, slot - first_slot(cell)};
  if (slot == end_slot(cell)) give_room(cell);
  return place;
}

void Cells::ensure_place(const Place& place) {
  while (place.in_cell >= end_slot(place.cell) - first_slot(place.cell)) give_room(place.cell);
}

/// More room for a cell, and for all others that have none left: soon they will need it, too.
void Cells::give_room(std::uint32_t cell) {
  AlignedVector<std::uint32_t> first(first_slot_.size());
  std::vector<std::uint32_t> now(slots());
  std::uint32_t end = 0;
  for (std::uint32_t c = 0; c < count(); ++c) {
    first[c] = end;
    bool full = true;
    for (std::uint32_t slot = first_slot(c); slot < end_slot(c); ++slot) {
      now[slot] = first[c] + slot - first_slot(c);
      full = full && occupied(slot);
    }
    end = end_of(lattice(), c, end + end_slot(c) - first_slot(c) + (full || c == cell ? kernels::pack : 0));
    require_countable(static_cast<double>(end), count());
  }
  const std::uint32_t slots = first.back() = end;
  const auto spread = [&](auto& values, const auto& empty) {
    auto old = std::move(values);
    values.assign(slots, empty);
    for (std::size_t slot = 0; slot < old.size(); ++slot) values[now[slot]] = old[slot];
  };
  spread(points, nobody);
  spread(references, nobody);
  spread(corrections, Point{0, 0, 0, 0});
  change_all(coordinates, spread);
  if (tilted_) change_all(tilts, spread);
  spread(ids, std::int64_t{-1});
  if (unequal_) spread(sizes, size_of(0.5 * lattice().diameter()));
  first_slot_ = std::move(first);
  cell_of_ = cells_of_slots(first_slot_);
  for (SlotData* data : attached_) data->renumber(now, slots);
}

void Cells::occupy(std::uint32_t slot, std::int64_t id, const Point& point, const Point& reference, double radius) {
  ids[slot] = id;
  points[slot] = point;
  coordinates.set(slot, is_image(cell_of(slot)) ? nobody : point);
  references[slot] = reference;
  lattice().note_listed(from_low(reference, cell_of(slot)));
  corrections[slot] = {0, 0, 0, 0};
  if (tilted_) tilts.set(slot, {0, 0, 0, 0});
  if (unequal_) sizes[slot] = size_of(radius);
  note_change(slot);
  drift.note_moved(cell_of(slot));
  if (!own(cell_of(slot))) return;
  ++size_;
  if (point.state != Point::free && point.state != Point::held) in_motion.push_back(place_of(slot));
}

void Cells::follow(std::uint32_t slot, std::uint32_t from) {
  corrections[slot] = corrections[from];
  if (tilted_) tilts.set(slot, tilts[from]);
  for (SlotData* data : attached_) data->follow(slot, from);
}

void Cells::vacate(std::uint32_t slot) {
  for (SlotData* data : attached_) data->vacate(slot);
  ids[slot] = -1;
  points[slot] = references[slot] = nobody;
  coordinates.set(slot, nobody);
  if (own(cell_of(slot))) --size_;
  note_change(slot);
}

void Cells::note_change(std::uint32_t slot) {
  const Place place = place_of(slot);
  if (is_image(place.cell)) return;
  if (repeat()) changed_in_images_.push_back(place);
  if (!own(place.cell)) return;
  for (const Side side : {below, above}) {
    const std::uint32_t first = first_of_border(side);
    if (has_ghosts(side) && place.cell >= first && place.cell < first + in_layer()) changed_[side].push_back(place);
  }
}

// ---- the rest

Grain Cells::grain(std::uint32_t slot, const Cell& listed_in) const {
  const Vector3 place = lattice().low() + lattice().from_low(points[slot], listed_in);
  return {ids[slot], repeat() ? lattice().periodic().wrap(place) : place, points[slot].state == Point::held,
          radius(slot)};
}

void Cells::visit_uncovered(const std::function<void(const Vector3&)>& visit,
                            const std::function<bool(const Vector3& low, const Vector3& high)>& is_covered) const {
  const double most = drift.largest() * lattice().quantum().length();
  std::vector<std::uint32_t> open(in_layer());  // cells of a layer over which nobody is known to cover them
  std::iota(open.begin(), open.end(), 0u);
  for (std::uint32_t layer = last_own(); layer > first_own() && !open.empty();) {
    layer -= in_layer();
    const auto is_done = [&](std::uint32_t place) {
      const std::uint32_t cell = layer + place;
      if (is_image(cell)) return true;
      const auto [low, high] = lattice().corners(lattice().cell(cell));
      if (is_covered(low.array() - most, high.array() + most)) return true;
      this->visit(cell, cell + 1, [&](std::uint32_t slot) { visit(position(slot)); });
      return false;
    };
    open.erase(std::remove_if(open.begin(), open.end(), is_done), open.end());
  }
}

std::vector<std::int64_t> Cells::grains_in_own_layers() const {
  std::vector<std::int64_t> grains(static_cast<std::size_t>(own_layers()), 0);
  visit_own([&](std::uint32_t slot) { ++grains[layer_of(cell_of(slot))]; });
  return grains;
}

std::size_t Cells::memory() const {
  return bytes_in(points, references, corrections, coordinates.x, coordinates.y, coordinates.z,
                  coordinates.state_squared, tilts.x, tilts.y, tilts.z, tilts.level, ids, sizes, unrelaxed, in_motion,
                  first_slot_, cell_of_, changed_[0], changed_[1], changed_in_images_) +
         drift.memory();
}

}  // namespace spot
