// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/base/quantum.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/packing/packing.hpp"
#include "spot/walk/parameters.hpp"
#include "spot/walk/spot_walk.hpp"

namespace spot {

/// What has happened since the start.
struct Counters {
  std::int64_t moves = 0;         ///< spot steps
  std::int64_t shares_moved = 0;  ///< shares in them of the grains that they enclosed, in 1024ths of a grain
  std::int64_t sweeps = 0;        ///< relaxation sweeps, over one region (time-ordered) or all that was due (windowed)
  std::int64_t grains_swept = 0;  ///< grains in them, each counted every time
  std::int64_t drained = 0;       ///< grains that left below the outlet

  /// <N>: grains that a move of a spot influences, each counted by its share, on average.
  double grains_per_move() const {
    return moves == 0 ? 0.0 : static_cast<double>(shares_moved) / (static_cast<double>(moves) * whole_share);
  }
};

/// What somebody else has done to the grains. One that was moved, or is held now and was not, is among both.
/// Each is named by one rank, whichever.
struct GrainChanges {
  std::vector<std::int64_t> gone;  ///< ids
  std::vector<Grain> come;
};

/// How a drainage starts and ends.
struct DrainageLimits {
  double outlet;                  ///< grains with centres below this height are taken out (length)
  double largest_overlap = 0.03;  ///< allowed in the starting packing, in diameters
  /// What relaxation may leave behind in flow, in diameters, if no more was allowed at the start. DEM has 0.013, the
  /// spot model 0.03 with the fitted parameters; at 0.3 a packing collapses.
  double largest_overlap_in_flow = 0.3;
};

/// A packing that drains as spots climb through it: what all drivers have in common.
class Drainage {
 public:
  virtual ~Drainage() = default;

  /// Goes on until `time`, in the units of the rates; births and steps start at time 0. A windowed driver stops at the
  /// last whole window before it. Throws CollapsedPacking if relaxation does not keep up with the moves.
  virtual void advance_to(double time) = 0;

  /// Goes on after somebody else moved, added or took grains; the spots stay. Grains that come, and those that stood on
  /// some that are gone, are moved down until contacts hold them, at no time of the spots'. Throws InvalidPacking if a
  /// grain that comes is outside, which changes nothing, or if it overlaps another more deeply than is allowed at the
  /// start, after which the drainage is of no use.
  void change_grains(const GrainChanges& changes);

  /// The same, told what all grains are now. On one rank only.
  void replace_grains(const std::vector<Grain>& grains);

  /// Goes on with other walls; grains that are outside them are found by require_inside().
  virtual void replace_container(std::shared_ptr<const Container> container) = 0;

  /// Goes on with another number of threads, where the driver has any. Throws InvalidParameter as Workers does.
  virtual void set_threads(int) {}

  /// Calls visit(grain) for all grains, in no particular order.
  virtual void visit_grains(const std::function<void(const Grain&)>& visit) const = 0;

  /// All coordinates of grains are multiples of it.
  virtual const Quantum& quantum() const = 0;

  virtual std::vector<Spot> spots() const = 0;
  virtual Overlap largest_overlap() = 0;

  /// Bytes that packing and spots take on this rank, with all that is kept from one move or window to the next.
  virtual std::size_t memory() const = 0;

  /// All that is needed to go on from here with the same bits, walls and parameters apart: the part of this rank.
  virtual Bytes save() const = 0;

  /// Counters over all ranks.
  virtual Counters total() { return counters_; }

  /// All grains, in increasing order of ids.
  std::vector<Grain> grains() const;

  /// Throws InvalidPacking, naming the grain, if one has left the container other than through the orifice.
  void require_inside() const;

  /// Of this rank: its spots, its grains; of sweeps, those on all ranks.
  const Counters& counters() const { return counters_; }

  /// Grains that left since the last call, where they were then, in increasing order of ids.
  std::vector<Grain> take_drained();

  /// Counts from now on how many moves move each grain, which is not free.
  void count_moves_received() { received_.emplace(); }

  /// What was counted since the last call, on this rank. A grain that came from another rank has been counted there,
  /// too; grains that have drained meanwhile are among them.
  MovesReceived take_moves_received();

 protected:
  /// Throws InvalidParameter or InvalidContainer if spots, limits and container do not fit together.
  Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
           std::shared_ptr<const Container> container, double diameter);

  /// Throws InvalidPacking, naming the grains, if one is outside the container, or overlaps a wall or another too
  /// deeply.
  void require_valid_start();

  /// Carries out what change_grains() has checked; returns the largest overlap of a grain that came, as it came.
  virtual Overlap carry_out(const GrainChanges& changes) = 0;

  const Container& container() const { return *container_; }
  MovesReceived* received() { return received_ ? &*received_ : nullptr; }

  /// Largest overlap that may stand after a relaxation, in diameters.
  double overlap_allowed() const { return std::max(limits_.largest_overlap, limits_.largest_overlap_in_flow); }

  /// Throws CollapsedPacking, naming the grains, if they overlap more deeply than that.
  void require_no_collapse(const Overlap& largest) const;

  /// Throws CollapsedPacking if one of drained_, from this index on, left through a wall instead of the orifice.
  void require_left_through_orifice(std::size_t first) const;

  SpotParameters parameters_;
  RelaxationParameters relaxation_parameters_;
  DrainageLimits limits_;
  std::shared_ptr<const Container> container_;
  double diameter_;
  Counters counters_;
  std::vector<Grain> drained_;
  std::optional<MovesReceived> received_;  // if they are counted

 private:
  void require_inside(const Grain& grain, double lowest, double reach) const;
  double depth_in_walls(const Grain& grain) const;
  void require_off_walls(const Overlap& deepest, const char* when) const;
  void require_shallow(const Overlap& largest, const char* when) const;
};

}  // namespace spot
