// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spot {

/// What else is kept for every slot of Cells, and has to follow when slots are numbered anew, and perhaps when grains
/// go to others.
class SlotData {
 public:
  virtual ~SlotData() = default;
  /// Slot `s` is slot `now[s]` from now on, of so many.
  virtual void renumber(const std::vector<std::uint32_t>& now, std::size_t slots) = 0;
  /// The grain in slot `from` is in this one now, too.
  virtual void follow(std::uint32_t /*slot*/, std::uint32_t /*from*/) {}
  /// This slot's grain is about to leave it.
  virtual void vacate(std::uint32_t /*slot*/) {}
};

}  // namespace spot
