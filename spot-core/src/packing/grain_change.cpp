// SPDX-License-Identifier: GPL-2.0-or-later
#include "packing/grain_change.hpp"

#include <array>
#include <limits>
#include <map>
#include <unordered_set>

#include "packing/packed_grain.hpp"
#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Id of a grain that is about to be taken out.
constexpr std::int64_t going = std::numeric_limits<std::int64_t>::max();

std::vector<std::int64_t> of_all_ranks(const std::vector<std::int64_t>& ids, Communicator& communicator) {
  Bytes own;
  append(own, ids);
  std::vector<std::int64_t> all;
  for (const Bytes& bytes : communicator.share_with_all(own))
    for (const auto id : ByteReader(bytes).take_all<std::int64_t>()) all.push_back(id);
  return all;
}

}  // namespace

bool GrainChange::mark_going(const std::vector<std::int64_t>& ids) {
  Cells& cells = packing_.cells();
  const auto all = of_all_ranks(ids, packing_.communicator());
  if (all.empty()) return false;
  const std::unordered_set<std::int64_t> gone(all.begin(), all.end());
  std::int64_t found = 0;
  cells.visit_own([&](std::uint32_t slot) {
    if (gone.count(cells.ids[slot]) == 0) return;
    cells.ids[slot] = going;
    ++found;
  });
  const std::int64_t missing = static_cast<std::int64_t>(gone.size()) - packing_.communicator().sum(found);
  if (missing != 0)
    throw InvalidPacking(message(missing, " of the ", gone.size(),
                                 " grains that are to be taken out are not there, or are there twice"));
  return true;
}

std::vector<Grain> GrainChange::stay_under_other_ids(const std::vector<Grain>& come) {
  Cells& cells = packing_.cells();
  const CellLattice& lattice = cells.lattice();
  std::map<std::array<std::int64_t, 3>, std::uint32_t> slot_at;
  cells.visit_own([&](std::uint32_t slot) {
    if (cells.ids[slot] == going) slot_at[lattice.quanta(cells.position(slot) - lattice.low())] = slot;
  });
  Bytes own;
  for (const Grain& grain : come) append(own, grain);
  std::vector<std::int64_t> stay;
  for (const Bytes& bytes : packing_.communicator().share_with_all(own))
    for (ByteReader reader(bytes); !reader.at_end();) {
      const Grain grain = take_grain(reader);
      const auto found = slot_at.find(lattice.quanta(grain.position - lattice.low()));
      if (found == slot_at.end()) continue;
      if (radius_in(packing_.diameter(), grain) != cells.radius(found->second)) continue;
      cells.ids[found->second] = grain.id;
      cells.points[found->second].state = grain.held ? Point::held : Point::free;
      cells.note_change(found->second);
      slot_at.erase(found);
      stay.push_back(grain.id);
    }
  stay = of_all_ranks(stay, packing_.communicator());
  const std::unordered_set<std::int64_t> ids(stay.begin(), stay.end());
  std::vector<Grain> others;
  for (const Grain& grain : come)
    if (ids.count(grain.id) == 0) others.push_back(grain);
  return others;
}

void GrainChange::take_out_going(const Container& container) {
  Cells& cells = packing_.cells();
  // They fall out of the packing, so that the ranks below and above learn which of their grains they may have borne.
  cells.visit_own([&](std::uint32_t slot) {
    if (cells.ids[slot] != going) return;
    cells.points[slot].state = Point::falling;
    cells.note_change(slot);
  });
  packing_.ghosts().send_no_positions();
  packing_.ghosts().exchange(container);
  cells.visit_ghosts([&](std::uint32_t slot) {
    if (cells.points[slot].state == Point::falling) packing_.note_unsupported_above(slot);
  });
  cells.visit_own([&](std::uint32_t slot) {
    if (cells.ids[slot] != going) return;
    packing_.note_unsupported_above(slot);
    packing_.lists().unlist(slot);
    cells.vacate(slot);
  });
}

void GrainChange::require_new_ids(const std::vector<Grain>& incoming) const {
  std::unordered_set<std::int64_t> ids;
  for (const Grain& grain : incoming) {
    if (grain.id < 0) throw InvalidPacking(message("grain id ", grain.id, " is negative"));
    if (!ids.insert(grain.id).second) throw InvalidPacking(message("grain ", grain.id, " comes twice"));
  }
  if (ids.empty()) return;
  packing_.cells().visit_own([&](std::uint32_t slot) {
    if (const std::int64_t id = packing_.cells().ids[slot]; ids.count(id) != 0)
      throw InvalidPacking(message("grain ", id, " is there already"));
  });
}

void GrainChange::require_within_extent(const std::vector<Grain>& come) const {
  for (const Grain& grain : come)
    if (!grain.position.allFinite() || grain.position.cwiseAbs().maxCoeff() > packing_.extent())
      throw InvalidPacking(message("grain ", grain.id, " at (", grain.position.x(), ", ", grain.position.y(), ", ",
                                   grain.position.z(), ") is beyond the largest coordinate, ", packing_.extent()));
}

}  // namespace spot
