// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/neighbour_lists.hpp"

#include <algorithm>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// In the blocks that a slot has.
std::uint32_t entries(std::uint8_t room) { return room == 0 ? 0 : kernels::lanes << (room - 1); }

}  // namespace

NeighbourLists::NeighbourLists(Cells& cells, WallMarks& walls, const kernels::Kernels& kernels)
    : cells_(cells), walls_(walls), kernels_(kernels) {
  cells.attach(*this);
}

std::uint32_t* NeighbourLists::list_of(std::uint32_t slot) {
  return neighbours_.data() + static_cast<std::size_t>(block_[slot]) * kernels::lanes;
}

const std::uint32_t* NeighbourLists::list_of(std::uint32_t slot) const {
  return neighbours_.data() + static_cast<std::size_t>(block_[slot]) * kernels::lanes;
}

kernels::Lists NeighbourLists::view() const { return {neighbours_.data(), block_.data(), size_.data()}; }

// ---- who is whose neighbour

void NeighbourLists::list(std::uint32_t slot, const Container& container) {
  findings_.resize(std::max<std::size_t>(findings_.size(), 1));
  Finding& finding = findings_[0];
  finding.clear();
  find_neighbours(slot, finding);
  list(slot, finding.found.data(), finding.ends[0], container);
}

void NeighbourLists::list(const std::vector<Place>& places, const Container& container, Workers& workers) {
  if (places.empty()) return;
  const std::size_t n = places.size(), tasks = static_cast<std::size_t>(workers.size());
  findings_.resize(tasks);
  workers.run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    Finding& finding = findings_[w];
    finding.clear();
    for (std::size_t k = n * w / tasks; k < n * (w + 1) / tasks; ++k) find_neighbours(cells_.slot(places[k]), finding);
  });
  std::size_t k = 0;
  for (const Finding& finding : findings_) {
    std::size_t first = 0;
    for (const std::size_t end : finding.ends) {
      list(cells_.slot(places[k++]), finding.found.data() + first, end - first, container);
      first = end;
    }
  }
}

/// Adds the slots of all other grains with references near this one's.
void NeighbourLists::find_neighbours(std::uint32_t slot, Finding& finding) const {
  const CellLattice& lattice = cells_.lattice();
  const double reach = lattice.diameter() + lattice.skin();
  const auto reach_squared = static_cast<float>(square(reach / lattice.quantum().length()));
  Point centre = cells_.references[slot];
  finding.rows.clear();
  lattice.find_rows(cells_.from_low(centre, cells_.cell_of(slot)), reach, lattice.first_layer(), lattice.last_layer(),
                    true, finding.rows);
  centre.state = Point::free;
  std::size_t end = finding.ends.empty() ? 0 : finding.ends.back();
  const auto before = static_cast<std::ptrdiff_t>(end);
  for (const CellRow& row : finding.rows) {
    const std::uint32_t first = cells_.first_slot(row.first), n = cells_.first_slot(row.last) - first;
    if (finding.found.size() < end + n) finding.found.resize(end + n);
    end += kernels_.find_within(cells_.references.data() + first, n, centre, reach_squared, first,
                                finding.found.data() + end);
  }
  const auto own = finding.found.begin() + before, last = finding.found.begin() + static_cast<std::ptrdiff_t>(end);
  finding.ends.push_back(static_cast<std::size_t>(std::remove(own, last, slot) - finding.found.begin()));
}

/// Makes `found` a grain's neighbours, and brings their lists up to date. Most stay the same.
void NeighbourLists::list(std::uint32_t slot, const std::uint32_t* found, std::size_t n, const Container& container) {
  for (const std::uint32_t j : of(slot)) marks_[j] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    if (marks_[found[k]] == 0) add_neighbour(found[k], slot);
    marks_[found[k]] = 0;
  }
  for (const std::uint32_t j : of(slot)) {  // again, since lists may have moved
    if (marks_[j] != 0) remove_neighbour(j, slot);
    marks_[j] = 0;
  }
  size_[slot] = 0;
  for (std::size_t k = 0; k < n; ++k) add_neighbour(slot, found[k]);
  if (cells_.own(cells_.cell_of(slot))) walls_.mark(slot, container);
}

void NeighbourLists::unlist(std::uint32_t slot) {
  for (const std::uint32_t j : of(slot)) remove_neighbour(j, slot);
  size_[slot] = 0;
}

void NeighbourLists::rename(std::uint32_t from, std::uint32_t to) {
  for (const std::uint32_t j : of(from)) *std::find(list_of(j), list_of(j) + size_[j], from) = to;
  std::swap(block_[from], block_[to]);
  std::swap(room_[from], room_[to]);
  std::swap(size_[from], size_[to]);
}

void NeighbourLists::remove_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  std::uint32_t* last = list_of(slot) + --size_[slot];
  *std::find(list_of(slot), last, neighbour) = *last;
}

void NeighbourLists::add_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  if (size_[slot] == entries(room_[slot])) give_room(slot);
  list_of(slot)[size_[slot]++] = neighbour;
}

// ---- blocks

/// The first of 2^order blocks in a row.
std::uint32_t NeighbourLists::take_blocks(std::size_t order) {
  std::vector<std::uint32_t>& unused = unused_[order];
  if (unused.empty()) {
    const std::size_t first = neighbours_.size() / kernels::lanes;
    neighbours_.resize(neighbours_.size() + (std::size_t{kernels::lanes} << order), 0);
    return static_cast<std::uint32_t>(first);
  }
  const std::uint32_t first = unused.back();
  unused.pop_back();
  return first;
}

void NeighbourLists::give_room(std::uint32_t slot) {
  if (room_[slot] == unused_.size())
    throw InvalidPacking(message("a grain has more than ", int{size_[slot]}, " neighbours: the packing has collapsed"));
  const std::uint32_t first = take_blocks(room_[slot]);
  const std::uint32_t* old = list_of(slot);
  std::copy_n(old, size_[slot], neighbours_.data() + static_cast<std::size_t>(first) * kernels::lanes);
  if (room_[slot] > 0) unused_[room_[slot] - 1u].push_back(block_[slot]);
  block_[slot] = first;
  ++room_[slot];
}

/// Lists that are copied into place one slot after the other leave no unused blocks, and are again where their
/// neighbours' are.
void NeighbourLists::renumber(const std::vector<std::uint32_t>& now, std::size_t slots) {
  const auto neighbours = std::move(neighbours_);
  const auto block = std::move(block_);
  const auto room = std::move(room_), size = std::move(size_);
  neighbours_ = {};
  block_.assign(slots, 0);
  room_.assign(slots, 0);
  size_.assign(slots, 0);
  marks_.assign(slots, 0);
  for (auto& unused : unused_) unused.clear();
  for (std::size_t slot = 0; slot < now.size(); ++slot) {
    const std::uint32_t* old = neighbours.data() + static_cast<std::size_t>(block[slot]) * kernels::lanes;
    for (std::uint32_t k = 0; k < size[slot]; ++k) add_neighbour(now[slot], now[old[k]]);
  }
}

std::size_t NeighbourLists::memory() const {
  std::size_t bytes = bytes_in(neighbours_, block_, room_, size_, marks_, findings_);
  for (const auto& unused : unused_) bytes += bytes_in(unused);
  for (const Finding& finding : findings_) bytes += bytes_in(finding.found, finding.ends, finding.rows);
  return bytes;
}

}  // namespace spot
