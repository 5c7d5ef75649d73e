// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that somebody else brings, takes or moves.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_set>

#include "packing/packed_grain.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// Id of a grain that is about to be taken out.
constexpr std::int64_t going = std::numeric_limits<std::int64_t>::max();

/// Whole cells from the lowest corner of a grid down to a place, or 0.
int cells_before(double from_low, double per_edge) {
  return from_low < 0.0 ? static_cast<int>(std::ceil(-from_low * per_edge)) : 0;
}

}  // namespace

void TiledPacking::change(const std::vector<std::int64_t>& gone, const std::vector<Grain>& come,
                          const Container& container) {
  require_within_extent(come);
  const std::vector<std::int64_t> all_gone = of_all_ranks(gone);
  std::vector<Grain> incoming = come;
  if (!all_gone.empty()) {
    mark_going({all_gone.begin(), all_gone.end()});
    incoming = stay_under_other_ids(come);
  }
  cover(incoming, container);
  incoming = take_own(incoming);
  if (!all_gone.empty()) take_out_going(container);
  require_new_ids(incoming);
  std::vector<Place> places;
  for (const Grain& grain : incoming) {
    const Vector3 at = grain.position - low_;
    Point point = wrapped(at);
    point.state = grain.held ? Point::held : Point::falling;
    places.push_back(ensure_room(cell_at(at)));
    occupy(slot(places.back()), grain.id, point, point);
  }
  for (const Place& place : places) list(slot(place), container);
  choose_sent(no_cell);
  exchange_border(container);
  largest_overlap_of_new_ = Overlap();
  double least = square(diameter_ / quantum_.length());
  for (const Place& place : places) find_larger_overlap(slot(place), least, largest_overlap_of_new_);
}

std::vector<std::int64_t> TiledPacking::of_all_ranks(const std::vector<std::int64_t>& ids) const {
  Bytes own;
  append(own, ids);
  std::vector<std::int64_t> all;
  for (const Bytes& bytes :
       communicator_->exchange(std::vector<Bytes>(static_cast<std::size_t>(communicator_->size()), own)))
    for (const auto id : ByteReader(bytes).take_all<std::int64_t>()) all.push_back(id);
  return all;
}

void TiledPacking::mark_going(const std::unordered_set<std::int64_t>& gone) {
  std::int64_t found = 0;
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot) {
    if (!occupied(slot) || gone.count(ids_[slot]) == 0) continue;
    ids_[slot] = going;
    ++found;
  }
  const std::int64_t missing = static_cast<std::int64_t>(gone.size()) - communicator_->sum(found);
  if (missing != 0)
    throw InvalidPacking(message(missing, " of the ", gone.size(),
                                 " grains that are to be taken out are not there, or are there twice"));
}

/// A grain that stays where it is under another id, or as a held one or no longer as one, keeps what is remembered of
/// it. It may be on another rank than the one whose layers it has come to. Returns the others of those that come.
std::vector<Grain> TiledPacking::stay_under_other_ids(const std::vector<Grain>& come) {
  std::map<std::array<std::int64_t, 3>, std::uint32_t> slot_at;
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot)
    if (occupied(slot) && ids_[slot] == going) slot_at[quanta(position(slot) - low_)] = slot;
  Bytes own;
  for (const Grain& grain : come) append(own, grain);
  std::vector<std::int64_t> stay;
  for (const Bytes& bytes :
       communicator_->exchange(std::vector<Bytes>(static_cast<std::size_t>(communicator_->size()), own)))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const Grain grain = take_grain(reader);
      const auto found = slot_at.find(quanta(grain.position - low_));
      if (found == slot_at.end()) continue;
      ids_[found->second] = grain.id;
      points_[found->second].state = grain.held ? Point::held : Point::free;
      note_change(found->second);
      slot_at.erase(found);
      stay.push_back(grain.id);
    }
  stay = of_all_ranks(stay);
  const std::unordered_set<std::int64_t> ids(stay.begin(), stay.end());
  std::vector<Grain> others;
  for (const Grain& grain : come)
    if (ids.count(grain.id) == 0) others.push_back(grain);
  return others;
}

/// They fall out of the packing, so that the ranks below and above learn which of their grains have lost a neighbour.
void TiledPacking::take_out_going(const Container& container) {
  const auto goes = [this](std::uint32_t slot) { return occupied(slot) && ids_[slot] == going; };
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot) {
    if (!goes(slot)) continue;
    points_[slot].state = Point::falling;
    note_change(slot);
  }
  choose_sent(no_cell);
  exchange_border(container);
  note_above_falling_copies();
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot) {
    if (!goes(slot)) continue;
    note_neighbours_above(slot);
    unlist(slot);
    vacate(slot);
  }
}

void TiledPacking::require_new_ids(const std::vector<Grain>& incoming) const {
  std::unordered_set<std::int64_t> ids;
  for (const Grain& grain : incoming) {
    if (grain.id < 0) throw InvalidPacking(message("grain id ", grain.id, " is negative"));
    if (!ids.insert(grain.id).second) throw InvalidPacking(message("grain ", grain.id, " comes twice"));
  }
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_ && !ids.empty(); ++slot)
    if (occupied(slot) && ids.count(ids_[slot]) != 0)
      throw InvalidPacking(message("grain ", ids_[slot], " is there already"));
}

void TiledPacking::require_within_extent(const std::vector<Grain>& come) const {
  for (const Grain& grain : come)
    if (!grain.position.allFinite() || grain.position.cwiseAbs().maxCoeff() > extent_)
      throw InvalidPacking(message("grain ", grain.id, " at (", grain.position.x(), ", ", grain.position.y(), ", ",
                                   grain.position.z(), ") is beyond the largest coordinate, ", extent_));
}

/// Lets the grid grow by whole cells until it holds all these places. What is listed stays listed.
void TiledPacking::cover(const std::vector<Grain>& come, const Container& container) {
  std::vector<double> cells(6, 0.0);  // to be added below and above along each axis, with the other sign
  for (const Grain& grain : come)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double from_low = grain.position[static_cast<Eigen::Index>(axis)] - low_[static_cast<Eigen::Index>(axis)];
      const auto n = static_cast<int>(std::floor(from_low * per_edge_[axis])) + 1 - n_[axis];
      cells[axis] = std::min(cells[axis], -1.0 * cells_before(from_low, per_edge_[axis]));
      cells[axis + 3] = std::min(cells[axis + 3], -1.0 * n);
    }
  cells = communicator_->least(cells);
  if (cells == std::vector<double>(6, 0.0)) return;
  const auto added = [&](std::size_t k) { return static_cast<int>(-cells[k]); };
  grow({added(0), added(1), added(2)}, {added(3), added(4), added(5)}, container);
}

}  // namespace spot
