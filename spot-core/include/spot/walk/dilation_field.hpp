// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/workers.hpp"
#include "spot/walk/node_lattice.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// How far spots have dilated the packing, from place to place: the share of the volume inside the walls that is
/// theirs.
///
/// A packing at rest has to dilate before it can flow, and in DEM one that flows is dilated by about as much
/// everywhere, 0.03, however fast it flows. So a spot climbs the faster the more the packing is dilated where it is: at
/// v_s (c / c_0)^2, with c_0 = SpotParameters::dilation, within bounds (calibration.hpp). That is its *relative speed*.
/// A flow that brings more spots then has hardly more of them at a time, and starts narrow and fast, and widens as its
/// sides dilate.
///
/// Spots are counted on the nodes of a NodeLattice, R_s apart, but no closer than grains are.
class DilationField {
 public:
  /// `diameter`: of grains. The container must outlive the field, or be replaced.
  DilationField(const SpotParameters& parameters, const Container& container, double diameter);

  /// Collective. Counts spots anew, of which each rank brings some.
  void count(const std::vector<Vector3>& spots, Communicator& communicator, Workers& workers);

  /// The share of the volume around a point that spots take (dimensionless). Infinite where walls leave no volume, as
  /// below the outlets.
  double at(const Vector3& point) const;

  /// The speed of a spot there, over v_s. Several threads may ask for those of spots that have been counted.
  double relative_speed(const Vector3& point) const;

  /// Works out the volume inside the walls anew, as after these changed.
  void replace_container(const Container& container);

  void save(Bytes& bytes) const;
  /// Throws InvalidState if what save() appended is damaged.
  void restore(ByteReader& saved);

  std::size_t memory() const;

 private:
  void find_volumes();

  NodeLattice lattice_;
  double spot_volume_, reference_;
  NodeLattice::Box box_;                 // of the nodes counted
  std::vector<std::int64_t> counts_;     // of spots, in 2^-24ths
  std::vector<double> counted_volumes_;  // around the same nodes
};

}  // namespace spot
