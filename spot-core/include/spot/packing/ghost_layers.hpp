// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "spot/packing/cells.hpp"
#include "spot/packing/neighbour_lists.hpp"
#include "spot/parallel/communicator.hpp"

namespace spot {

/// What ranks with neighbouring layers tell each other: grains that go over to the other, what changes in the layers of
/// which the other has copies, how many moves their cells have received, and where their grains are. And what a rank
/// tells itself where space repeats: the same of the cells that it holds images of.
class GhostLayers {
 public:
  GhostLayers(Cells& cells, NeighbourLists& lists, std::shared_ptr<Communicator> communicator);

  /// Gives a grain, which is beyond its own layers, to the rank that owns the cell.
  void emigrate(std::uint32_t slot, const Cell& to);

  /// Collective. Sends those that emigrate to their new owners.
  void exchange_migrants(const Container& container);

  /// Collective. Brings the copies that neighbours hold up to date: lists, and positions as was chosen before.
  void exchange(const Container& container);

  /// Neighbours will be told where the grains are of all border cells; of none; or of those that so many sixteenths of
  /// a move have reached by now, on either side: they hold the same counts, and know which to expect.
  void send_positions() { choose(std::numeric_limits<std::int32_t>::min()); }
  void send_no_positions() { choose(std::numeric_limits<std::int32_t>::max()); }
  void send_positions_of_unrelaxed(std::int32_t parts) { choose(parts); }

 private:
  void exchange_layers(const Container& container);
  void clear(const Place& place);
  void update_images(const Container& container);
  void copy_to_image(std::uint32_t source, std::uint32_t image);
  void choose(std::int32_t parts);
  template <typename Visit>
  void visit_sent(std::uint32_t first_cell, const Visit& visit) const;
  Bytes changes(Side side);
  void take_changes(const Bytes& bytes, Side side, const Container& container);

  Cells& cells_;
  NeighbourLists& lists_;
  std::shared_ptr<Communicator> communicator_;
  std::array<Bytes, 2> migrants_;   // grains that go to the ranks below and above
  std::vector<std::uint8_t> sent_;  // of border cells, ours and theirs: will positions be sent?
};

}  // namespace spot
