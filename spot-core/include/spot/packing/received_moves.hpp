// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/base/aligned_vector.hpp"
#include "spot/packing/cells.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/packing/slot_data.hpp"

namespace spot {

/// Counts how many moves the grain in each slot receives, if that is wanted.
class ReceivedMoves : public SlotData {
 public:
  explicit ReceivedMoves(Cells& cells) : cells_(cells) { cells.attach(*this); }

  /// Nothing is counted before.
  void start();
  bool counts() const { return counts_; }
  /// Of each slot, since it was handed over.
  std::uint32_t* counters() { return of_slot_.data(); }

  /// What has been counted goes to the grains that are in the slots now, before other grains may be in them.
  void hand_over();
  /// What has been counted since the last call.
  MovesReceived take();

  void renumber(const std::vector<std::uint32_t>& now, std::size_t slots) override;
  void follow(std::uint32_t slot, std::uint32_t from) override;
  void vacate(std::uint32_t slot) override;

  std::size_t memory() const;

 private:
  const Cells& cells_;
  bool counts_ = false;
  AlignedVector<std::uint32_t> of_slot_;
  MovesReceived handed_over_;
};

}  // namespace spot
