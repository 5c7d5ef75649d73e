// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

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
  choose_sent(every_cell);
  exchange_border(container);
}

void TiledPacking::update_lists(const Container& container, Workers& workers) {
  find_wandered();
  list_wandered(container, workers);
  if (communicator_->size() == 1) return;
  exchange_migrants(container);
  exchange_border(container);
}

/// Puts grains that are too far from their references into the cells where they are now, and into wandered_.
void TiledPacking::find_wandered() {
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
        if (squared_distance(points_[slot(place)], references_[slot(place)]) > kept * kept) move_reference(place);
      }
    path_[cell] = static_cast<std::int32_t>(std::min(1.001 * std::sqrt(squared), kept)) + 1;
  }
}

void TiledPacking::move_reference(Place place) {
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
  wandered_.push_back(place);
}

/// All references are in place, and each list is a function of them: workers find them, and one thread writes them
/// down.
void TiledPacking::list_wandered(const Container& container, Workers& workers) {
  if (wandered_.empty()) return;
  const std::size_t n = wandered_.size(), tasks = static_cast<std::size_t>(workers.size());
  findings_.resize(tasks);
  workers.run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    Finding& finding = findings_[w];
    finding.clear();
    for (std::size_t k = n * w / tasks; k < n * (w + 1) / tasks; ++k) find_neighbours(slot(wandered_[k]), finding);
  });
  std::size_t k = 0;
  for (const Finding& finding : findings_) {
    std::size_t first = 0;
    for (const std::size_t end : finding.ends) {
      list(slot(wandered_[k++]), finding.found.data() + first, end - first, container);
      first = end;
    }
  }
  wandered_.clear();
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

/// Lists a grain and its neighbours with each other.
void TiledPacking::list(std::uint32_t slot, const Container& container) {
  findings_.resize(std::max<std::size_t>(findings_.size(), 1));
  Finding& finding = findings_[0];
  finding.clear();
  find_neighbours(slot, finding);
  list(slot, finding.found.data(), finding.ends[0], container);
}

/// Makes `found` a grain's neighbours, and brings their lists up to date. Most stay the same.
void TiledPacking::list(std::uint32_t slot, const std::uint32_t* found, std::size_t n, const Container& container) {
  const std::uint32_t *old = list_of(slot), *end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) marks_[*j] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    if (marks_[found[k]] == 0) add_neighbour(found[k], slot);
    marks_[found[k]] = 0;
  }
  old = list_of(slot);  // lists may have become longer
  end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) {
    if (marks_[*j] != 0) remove_neighbour(*j, slot);
    marks_[*j] = 0;
  }
  list_size_[slot] = 0;
  for (std::size_t k = 0; k < n; ++k) add_neighbour(slot, found[k]);
  if (owned(slot / capacity_)) mark_near_wall(slot, container);
}

/// Adds the slots of all other grains with references near this one's.
void TiledPacking::find_neighbours(std::uint32_t slot, Finding& finding) const {
  const double reach = diameter_ + skin_;
  const auto reach_squared = static_cast<float>(square(reach / quantum_.length()));
  Point centre = references_[slot];
  const int held = static_cast<int>(cells() / cells_in_layer());
  finding.rows.clear();
  find_rows(from_low(centre, slot / capacity_), reach, first_layer_, first_layer_ + held, finding.rows);
  centre.state = Point::free;
  std::size_t end = finding.ends.empty() ? 0 : finding.ends.back();
  const auto before = static_cast<std::ptrdiff_t>(end);
  for (const Row& row : finding.rows) {
    const std::uint32_t first = row.first * capacity_, n = (row.last - row.first) * capacity_;
    if (finding.found.size() < end + n) finding.found.resize(end + n);
    end +=
        kernels_->find_within(references_.data() + first, n, centre, reach_squared, first, finding.found.data() + end);
  }
  const auto own = finding.found.begin() + before, last = finding.found.begin() + static_cast<std::ptrdiff_t>(end);
  finding.ends.push_back(static_cast<std::size_t>(std::remove(own, last, slot) - finding.found.begin()));
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
