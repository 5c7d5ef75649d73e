// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "spot/geometry/container.hpp"
#include "spot/packing/packing.hpp"
#include "spot/relaxation/calibration.hpp"

namespace spot {

/// How a drainage starts and ends.
struct DrainageLimits {
  double outlet;  ///< grains with centres below this height are taken out (length)
  double largest_overlap = calibration::largest_overlap_at_start;  ///< allowed in the starting packing, in diameters
  /// What relaxation may leave behind in flow, in diameters, if no more was allowed at the start.
  double largest_overlap_in_flow = calibration::largest_overlap_in_flow;

  /// Largest overlap that may stand after a relaxation, in diameters.
  double overlap_allowed() const { return std::max(largest_overlap, largest_overlap_in_flow); }

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

/// What grains must keep to in a container. All functions throw an error that names the grains.
class GrainChecks {
 public:
  /// Throws InvalidParameter as DrainageLimits does.
  GrainChecks(const DrainageLimits& limits, std::shared_ptr<const Container> container, double diameter);

  const DrainageLimits& limits() const { return limits_; }
  void replace_container(std::shared_ptr<const Container> container) { container_ = std::move(container); }

  /// InvalidPacking, if a grain of a running drainage has left the container other than through an outlet.
  void require_inside(const Grain& grain) const;

  /// InvalidPacking, if a grain that is put in is neither inside nor in an opening above the height at which they are
  /// taken out.
  void require_valid_place(const Grain& grain) const;

  /// How deep a grain overlaps a wall, in diameters, or 0. Held grains may be part of the walls, and there are none
  /// below the outlets.
  double depth_in_walls(const Grain& grain) const;

  /// InvalidPacking, if the grain (first) overlaps a wall more deeply than is allowed at the start.
  void require_off_walls(const Overlap& deepest, const char* when) const;

  /// InvalidPacking, if two grains overlap more deeply than is allowed at the start.
  void require_shallow(const Overlap& largest, const char* when) const;

  /// CollapsedPacking, if they overlap more deeply than is allowed in flow.
  void require_no_collapse(const Overlap& largest) const;

  /// CollapsedPacking, if one of them left through a wall instead of an outlet; of several outlets, more than a fourth
  /// of a grain beside it.
  void require_left_through_orifice(const std::vector<Grain>& drained) const;

 private:
  void require_inside(const Grain& grain, double lowest, double beside) const;

  DrainageLimits limits_;
  std::shared_ptr<const Container> container_;
  double diameter_;
};

}  // namespace spot
