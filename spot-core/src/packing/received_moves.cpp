// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/received_moves.hpp"

#include <utility>

#include "spot/base/memory.hpp"

namespace spot {

void ReceivedMoves::start() {
  counts_ = true;
  of_slot_.assign(cells_.slots(), 0);
  handed_over_.clear();
}

void ReceivedMoves::hand_over() {
  for (std::uint32_t slot = 0; slot < of_slot_.size(); ++slot) vacate(slot);
}

MovesReceived ReceivedMoves::take() {
  hand_over();
  return std::exchange(handed_over_, {});
}

void ReceivedMoves::renumber(const std::vector<std::uint32_t>& now, std::size_t slots) {
  if (!counts_) return;
  const AlignedVector<std::uint32_t> old = std::exchange(of_slot_, AlignedVector<std::uint32_t>(slots, 0));
  for (std::size_t slot = 0; slot < now.size(); ++slot) of_slot_[now[slot]] = old[slot];
}

void ReceivedMoves::follow(std::uint32_t slot, std::uint32_t from) {
  if (counts_) of_slot_[slot] = std::exchange(of_slot_[from], 0);
}

void ReceivedMoves::vacate(std::uint32_t slot) {
  if (!counts_) return;
  if (const std::uint32_t moves = std::exchange(of_slot_[slot], 0)) handed_over_[cells_.ids[slot]] += moves;
}

std::size_t ReceivedMoves::memory() const { return bytes_in(of_slot_); }

}  // namespace spot
