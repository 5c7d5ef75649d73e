// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/block_moves.hpp"
#include "spot/packing/cells.hpp"
#include "spot/packing/ghost_layers.hpp"
#include "spot/packing/grain.hpp"
#include "spot/packing/neighbour_lists.hpp"
#include "spot/packing/received_moves.hpp"
#include "spot/packing/wall_marks.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/workers.hpp"

namespace spot {

/// The packing of the windowed driver: grains in cells, their neighbours, the walls near them, and the ghost layers of
/// other ranks, laid out for vector kernels, threads and ranks.
///
/// Positions are whole numbers of quanta of 2^-24 d, in 32 bits, from the lowest corner of the lattice of cells; they
/// wrap around, and the cell that a grain is listed in tells where it is. Integer sums are exact, and what a cell does
/// depends on itself and its neighbours only; so neither cells, lists, threads, ranks nor instruction sets can change a
/// bit of the result.
///
/// Lists are up to date after all functions; those that say so are collective.
class TiledPacking {
 public:
  /// Collective. Grains, of which each rank brings some, may go down to `outlet`. Throws InvalidPacking as Packing
  /// does, and InvalidParameter if the environment variable SPOT_INSTRUCTION_SET names kernels that cannot run here.
  TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
               const Container& container, std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  /// Collective. A packing that goes on from a saved state, of which each rank brings all: the parts that save() gave
  /// on every rank, of however many. Throws InvalidState if a part is damaged or missing.
  TiledPacking(double diameter, double extent, const std::vector<Bytes>& saved, const Container& container,
               std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  double diameter() const { return cells_.lattice().diameter(); }
  double extent() const { return cells_.lattice().extent(); }
  const Quantum& quantum() const { return cells_.lattice().quantum(); }

  std::size_t size() const { return cells_.size(); }  ///< grains of this rank

  /// The rank that owns the layer at this height.
  int owner(double height) const { return cells_.slabs().owner(cells_.lattice().layer(height)); }
  /// The ranks, from first to last, that hold grains a move with its middle at this height may reach.
  std::pair<int, int> reached(double height, double radius) const;

  /// What is needed to go on from here, apart from walls: the part of this rank.
  Bytes save() const;

  /// Collective. Shares the layers out anew, by what was done in each since the last time, if that takes more off the
  /// busiest rank than it costs. Returns whether it has.
  bool balance(const Container& container);

  /// Calls visit for these grains of this rank, in no particular order.
  void visit_grains(const VisitGrain& visit, Which which = Which::all) const;
  void visit_grains_at_once(const VisitGrainAtOnce& visit, Which which, Workers& workers) const;

  /// Gives moves their weights, when it is told the volume of this rank's grains that each of them encloses.
  using Weigh = std::function<void(const std::vector<int>& enclosed, std::vector<Move>& moves)>;

  /// Collective. Applies the moves, one after the other to every grain, as displace() does. They are weighed before the
  /// first one is applied. Each counts as an unrelaxed move of all cells that it may have reached.
  /// `moves`: those that may reach grains of this rank, in the order of (spot, number) if there are several ranks.
  /// Throws InvalidParameter unless the radius is below 8 diameters.
  void displace(std::vector<Move>& moves, const SpotParameters& spots, const Weigh& weigh, const Container& container,
                Workers& workers);

  /// Marks the grains near walls anew, as after the walls changed.
  void mark_near_walls(const Container& container) { walls_.mark_all(container); }

  /// Throws InvalidContainer if space repeats otherwise there than here.
  void require_same_periods(const Container& container) const;

  /// Collective. Takes out the grains with these ids, which are this rank's, and brings in others, of which each rank
  /// brings some; a grain that has moved is one that goes and one that comes. Those that come fall, as Settling finds
  /// them. All others keep what is remembered of them. Throws InvalidPacking, and is of no use any more, if a grain is
  /// not there, is there already, or beyond the extent. Returns the largest overlap of one that came, as it came.
  Overlap change(const std::vector<std::int64_t>& gone, const std::vector<Grain>& come, const Container& container);

  /// Moves this rank's grains with centres below the outlet to `drained`, or up to its height where it is closed.
  void take_out_below(double outlet, const std::function<bool(const Vector3& place)>& is_closed,
                      std::vector<Grain>& drained);

  /// Of a grain of this rank and any other.
  Overlap largest_overlap() const;
  /// Bytes on this rank.
  std::size_t memory() const;

  // For relaxation.
  Cells& cells() { return cells_; }
  const Cells& cells() const { return cells_; }
  ReceivedMoves& received() { return received_; }
  const NeighbourLists& lists() const { return lists_; }
  NeighbourLists& lists() { return lists_; }
  const WallMarks& walls() const { return walls_; }
  GhostLayers& ghosts() { return ghosts_; }
  Communicator& communicator() { return *communicator_; }
  const kernels::Kernels& kernels() const { return kernels_; }

  /// Collective. After grains moved: lists those anew that are too far from their references, and brings ghost layers
  /// up to date.
  void update_lists(const Container& container, Workers& workers);

  /// For balance(), in cells that moves reach.
  void add_work(std::uint32_t cell, std::int64_t work) { work_[cells_.layer_of(cell)] += work; }

  /// Grains above this one may have lost what bore them: they are among those that Settling asks about.
  void note_unsupported_above(std::uint32_t slot);
  std::vector<Place>& unsupported() { return unsupported_; }

 private:
  TiledPacking(double diameter, double extent, const Periodic& periodic, std::shared_ptr<Communicator> communicator);
  void set_slabs(const Slabs& slabs);
  bool some_are_smaller(const std::vector<Grain>& grains);
  Place put(const Grain& grain, std::int32_t state);
  std::vector<Grain> take_own(const std::vector<Grain>& grains) const;
  void list_all(const Container& container);
  void find_drifted(Workers& workers);
  void move_reference(Place place);
  void cover(const std::vector<Grain>& come, const Container& container);
  void grow(const std::array<int, 3>& below, const std::array<int, 3>& above, const Container& container);
  void find_larger_overlap(std::uint32_t slot, double& least, Overlap& largest) const;

  const kernels::Kernels& kernels_;
  std::shared_ptr<Communicator> communicator_;
  Cells cells_;
  ReceivedMoves received_;
  WallMarks walls_;
  NeighbourLists lists_;
  GhostLayers ghosts_;
  BlockMoves moves_;
  bool between_moves_ = false;           // of a window, when places are where these have them
  std::vector<std::int64_t> work_;       // in each own layer, since balance()
  std::vector<Place> unsupported_;       // grains that may have lost what bore them
  std::vector<Place> drifted_;           // too far from where they were listed
  std::vector<std::vector<Place>> far_;  // the same, as each worker finds them
  std::vector<std::uint32_t> found_;
};

}  // namespace spot
