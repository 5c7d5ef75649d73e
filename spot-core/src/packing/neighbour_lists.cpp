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

/// Makes an array longer, by no more than an eighth beyond that: it is the longest one there is.
template <typename Values>
void lengthen(Values& values, std::size_t by) {
  const std::size_t length = values.size() + by;
  if (length > values.capacity()) values.reserve(length + length / 8);
  values.resize(length, 0);
}

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

/// One block for each, and a few more: 3 % of the grains in a dense packing have more neighbours than that holds.
void NeighbourLists::reserve(std::size_t grains) { neighbours_.reserve((grains + grains / 16) * kernels::lanes); }

// ---- who is whose neighbour

void NeighbourLists::list(std::uint32_t slot, const Container& container) {
  findings_.resize(std::max<std::size_t>(findings_.size(), 1));
  Finding& finding = findings_[0];
  finding.clear();
  anew_[slot] = 1;
  list(slot, finding);
  write_down(finding);
  anew_[slot] = 0;
  if (cells_.own(cells_.cell_of(slot))) walls_.mark(slot, walls_.mark_of(slot, container));
}

void NeighbourLists::list(const std::vector<Place>& places, const Container& container, Workers& workers) {
  findings_.resize(static_cast<std::size_t>(workers.size()));
  for (Finding& finding : findings_) finding.clear();
  for (const Place& place : places) anew_[cells_.slot(place)] = 1;
  const auto mark_of = [&](std::uint32_t slot) {
    return cells_.own(cells_.cell_of(slot)) ? walls_.mark_of(slot, container) : std::uint8_t{0};
  };
  workers.share_out(places.size(), [&](int worker, std::size_t first, std::size_t last) {
    Finding& finding = findings_[static_cast<std::size_t>(worker)];
    for (std::size_t k = first; k < last; ++k) {
      const std::uint32_t slot = cells_.slot(places[k]);
      list(slot, finding);
      if (container.concurrent()) finding.marks.push_back(mark_of(slot));
    }
  });
  auto place = places.begin();
  for (const Finding& finding : findings_) {
    write_down(finding);
    for (const std::uint8_t mark : finding.marks) walls_.mark(cells_.slot(*place++), mark);
  }
  for (; place != places.end(); ++place) walls_.mark(cells_.slot(*place), mark_of(cells_.slot(*place)));
  for (const Place& listed : places) anew_[cells_.slot(listed)] = 0;
}

/// Finds the slots of all other grains with references near this one's.
void NeighbourLists::find_neighbours(std::uint32_t slot, Finding& finding) const {
  // More than what single precision rounds: so who finds a neighbour is found by it.
  constexpr double rounded = 1.0 + 1e-6;
  const CellLattice& lattice = cells_.lattice();
  const double reach = lattice.diameter() + lattice.skin();
  const auto reach_squared = static_cast<float>(square(reach / lattice.quantum().length()));
  Point centre = cells_.references[slot];
  finding.rows.clear();
  lattice.find_rows(cells_.from_low(centre, cells_.cell_of(slot)), rounded * reach,
                    {lattice.first_layer(), lattice.last_layer(), true}, finding.rows);
  centre.state = Point::free;
  std::size_t end = 0;
  for (const CellRow& row : finding.rows) {
    const std::uint32_t first = cells_.first_slot(row.first), n = cells_.first_slot(row.last) - first;
    if (finding.found.size() < end + n) finding.found.resize(end + n);
    end += kernels_.find_within(cells_.references.data() + first, n, centre, reach_squared, first,
                                finding.found.data() + end);
  }
  finding.found.resize(end);
  finding.found.erase(std::remove(finding.found.begin(), finding.found.end(), slot), finding.found.end());
}

/// Adds in which lists of other grains this one is no more, and in which it has to be. Those listed anew see to theirs
/// themselves.
void NeighbourLists::find_changes(std::uint32_t slot, Finding& finding) const {
  const Neighbours before = of(slot);
  const auto& now = finding.found;
  for (const std::uint32_t j : before)
    if (anew_[j] == 0 && std::find(now.begin(), now.end(), j) == now.end()) finding.gone.push_back({j, slot});
  for (const std::uint32_t j : now)
    if (anew_[j] == 0 && std::find(before.begin(), before.end(), j) == before.end()) finding.come.push_back({j, slot});
}

/// Lists of different grains may be written at the same time, if there is room in them.
void NeighbourLists::list(std::uint32_t slot, Finding& finding) {
  find_neighbours(slot, finding);
  find_changes(slot, finding);
  if (finding.found.size() <= entries(room_[slot])) {
    std::copy(finding.found.begin(), finding.found.end(), list_of(slot));
    size_[slot] = static_cast<std::uint8_t>(finding.found.size());
  } else {
    finding.crowded.push_back(slot);
    finding.crowds.push_back(finding.found);
  }
}

void NeighbourLists::write_down(const Finding& finding) {
  for (const auto& [slot, neighbour] : finding.gone) remove_neighbour(slot, neighbour);
  for (const auto& [slot, neighbour] : finding.come) add_neighbour(slot, neighbour);
  for (std::size_t k = 0; k < finding.crowded.size(); ++k) {
    size_[finding.crowded[k]] = 0;
    for (const std::uint32_t neighbour : finding.crowds[k]) add_neighbour(finding.crowded[k], neighbour);
  }
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
    lengthen(neighbours_, std::size_t{kernels::lanes} << order);
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
  neighbours_.reserve(neighbours.size());
  block_.assign(slots, 0);
  room_.assign(slots, 0);
  size_.assign(slots, 0);
  anew_.assign(slots, 0);
  for (auto& unused : unused_) unused.clear();
  for (std::size_t slot = 0; slot < now.size(); ++slot) {
    const std::uint32_t* old = neighbours.data() + static_cast<std::size_t>(block[slot]) * kernels::lanes;
    for (std::uint32_t k = 0; k < size[slot]; ++k) add_neighbour(now[slot], now[old[k]]);
  }
}

std::size_t NeighbourLists::memory() const {
  std::size_t bytes = bytes_in(neighbours_, block_, room_, size_, anew_, findings_);
  for (const auto& unused : unused_) bytes += bytes_in(unused);
  for (const Finding& finding : findings_)
    bytes += bytes_in(finding.found, finding.rows, finding.marks, finding.gone, finding.come);
  return bytes;
}

}  // namespace spot
