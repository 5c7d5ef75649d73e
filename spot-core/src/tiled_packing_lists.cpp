// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include "kernels.hpp"
#include "spot/errors.hpp"
#include "spot/tiled_packing.hpp"
#include "wrapped_integers.hpp"

namespace spot {

namespace {

/// Grains that are this part of half a skin or more away from their references are listed anew once one of their cell
/// may have gone all the way.
constexpr double part_of_half_skin = 0.7;

}  // namespace

/// After all places in this rank's layers have been occupied.
void TiledPacking::list_all(const Container& container) {
  find_planes(container);
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot)
    if (ids_[slot] >= 0) list(slot, container);
  exchange_border(container);
}

void TiledPacking::update_lists(const Container& container) {
  relist_wandered(container);
  if (communicator_->size() == 1) return;
  exchange_migrants(container);
  exchange_border(container);
}

void TiledPacking::relist_wandered(const Container& container) {
  const double quantum = quantum_.length();
  const auto allowed = static_cast<std::int32_t>(0.5 * skin_ / quantum);
  const double kept = part_of_half_skin * allowed;
  const std::uint32_t owned = last_owned() - first_owned();
  wandered_cells_.resize(owned);
  const std::size_t n = kernels_->find_reached(path_.data() + first_owned(), owned, allowed, wandered_cells_.data());
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t cell = first_owned() + wandered_cells_[k], first = cell * capacity_;
    const double squared = kernels_->farthest(points_.data() + first, references_.data() + first, capacity_);
    if (squared > kept * kept)
      for (std::uint32_t in_cell = 0; in_cell < capacity_; ++in_cell) {
        const Place place = {cell, in_cell};
        if (squared_distance(points_[slot(place)], references_[slot(place)]) > kept * kept) relist(place, container);
      }
    path_[cell] = static_cast<std::int32_t>(std::min(1.001 * std::sqrt(squared), kept)) + 1;
  }
}

/// Lists the grain where it is now.
void TiledPacking::relist(Place place, const Container& container) {
  const Vector3 at = from_low(points_[slot(place)], place.cell);
  const int layer = cell_coordinate(at.z(), 2);
  if (slabs_.owner(layer) != communicator_->rank()) {
    emigrate(slot(place), layer);
    return;
  }
  const std::uint32_t cell = cell_at(at);
  if (cell != place.cell) {
    const Place to = ensure_room(cell);
    const std::uint32_t from = slot(place);
    occupy(slot(to), ids_[from], points_[from], points_[from]);
    momenta_[slot(to)] = momenta_[from];
    rename(from, slot(to));
    vacate(from);
    place = to;
  } else {
    note_change(slot(place));
  }
  references_[slot(place)] = points_[slot(place)];
  list(slot(place), container);
}

void TiledPacking::unlist(std::uint32_t slot) {
  const std::uint32_t* own = list_of(slot);
  for (std::uint32_t k = 0; k < list_size_[slot]; ++k) remove_neighbour(own[k], slot);
  list_size_[slot] = 0;
}

/// Hands the list of one slot to another, whose own is empty.
void TiledPacking::rename(std::uint32_t from, std::uint32_t to) {
  const std::uint32_t n = list_size_[from];
  const std::uint32_t *old = list_of(from), *own = std::copy_n(old, n, list_of(to)) - n;
  for (std::uint32_t k = 0; k < n; ++k) *std::find(list_of(own[k]), list_of(own[k]) + list_size_[own[k]], from) = to;
  list_size_[to] = list_size_[from];
  list_size_[from] = 0;
}

/// Makes the list of a grain's neighbours, and brings theirs up to date. Most stay the same.
void TiledPacking::list(std::uint32_t slot, const Container& container) {
  const Point reference = references_[slot];
  references_[slot] = nobody;  // so that it does not find itself
  const std::size_t n = find_neighbours(reference, slot / capacity_);
  const std::uint32_t *old = list_of(slot), *end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) marks_[*j] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    if (marks_[found_[k]] == 0) add_neighbour(found_[k], slot);
    marks_[found_[k]] = 0;
  }
  old = list_of(slot);  // lists may have become longer
  end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) {
    if (marks_[*j] != 0) remove_neighbour(*j, slot);
    marks_[*j] = 0;
  }
  list_size_[slot] = 0;
  for (std::size_t k = 0; k < n; ++k) add_neighbour(slot, found_[k]);
  references_[slot] = reference;
  if (owned(slot / capacity_)) mark_near_wall(slot, container);
}

/// Puts the slots of all grains with references near this one, in this cell, into found_; returns how many.
std::size_t TiledPacking::find_neighbours(const Point& reference, std::uint32_t cell) {
  const double reach = diameter_ + skin_;
  const auto reach_squared = static_cast<float>(square(reach / quantum_.length()));
  near_rows_.clear();
  const int held = static_cast<int>(cells() / cells_in_layer());
  find_rows(from_low(reference, cell), reach, first_layer_, first_layer_ + held, near_rows_);
  Point centre = reference;
  centre.state = Point::free;
  std::size_t found = 0;
  for (const Row& row : near_rows_) {
    const std::uint32_t first = row.first * capacity_, n = (row.last - row.first) * capacity_;
    if (found_.size() < found + n) found_.resize(found + n);
    found += kernels_->find_within(references_.data() + first, n, centre, reach_squared, first, found_.data() + found);
  }
  return found;
}

void TiledPacking::remove_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  std::uint32_t* last = list_of(slot) + --list_size_[slot];
  *std::find(list_of(slot), last, neighbour) = *last;
}

void TiledPacking::add_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  if (list_size_[slot] == list_capacity_) {
    const std::uint32_t longer = 2 * list_capacity_;
    if (longer > 128)
      throw InvalidPacking(message("a grain has more than ", list_capacity_, " neighbours: the packing has collapsed"));
    AlignedVector<std::uint32_t> lists(points_.size() * longer, 0);
    for (std::size_t s = 0; s < points_.size(); ++s)
      std::copy_n(lists_.begin() + static_cast<std::ptrdiff_t>(s * list_capacity_), list_size_[s],
                  lists.begin() + static_cast<std::ptrdiff_t>(s * longer));
    lists_.swap(lists);
    list_capacity_ = longer;
  }
  list_of(slot)[list_size_[slot]++] = neighbour;
}

}  // namespace spot
