// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
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
/// Spots are counted on the nodes of a cubic lattice, of which one is the centre of the first outlet, R_s apart, but no
/// closer than grains are; each is shared out between the eight nodes around it in proportion to its nearness to them
/// along each axis, in whole 2^-24ths: sums are the same on any ranks. Where space repeats, so does the lattice: its
/// spacing along that axis is the least from R_s on of which the period is a multiple.
class DilationField {
 public:
  /// `diameter`: of grains. The container must outlive the field, or be replaced.
  DilationField(const SpotParameters& parameters, const Container& container, double diameter);

  /// Collective. Counts spots anew, of which each rank brings some.
  void count(const std::vector<Vector3>& spots, Communicator& communicator);

  /// The share of the volume around a point that spots take (dimensionless). Infinite where walls leave no volume, as
  /// below the outlets.
  double at(const Vector3& point) const;

  /// The speed of a spot there, over v_s.
  double relative_speed(const Vector3& point) const;

  /// Works out the volume inside the walls anew, as after these changed.
  void replace_container(const Container& container);

  void save(Bytes& bytes) const;
  /// Throws InvalidState if what save() appended is damaged.
  void restore(ByteReader& saved);

  std::size_t memory() const;

 private:
  using Node = std::array<int, 3>;
  struct Corner {
    Node node;
    std::int64_t weight;  // in 2^-24ths
  };

  /// Where it is along an axis, in lattice spacings.
  double cell_of(const Vector3& point, std::size_t axis) const {
    const auto i = static_cast<int>(axis);
    return (point[i] - origin_[i]) / spacing_[i];
  }
  std::array<Corner, 8> corners(const Vector3& point) const;
  bool counted(const Node& node) const;
  std::size_t place(const Node& node) const;
  double volume_of(const Node& node) const;
  void find_volumes();
  /// Its image in the cell.
  Node wrapped(Node node) const;

  const Container* container_;
  Vector3 origin_, spacing_;
  Node period_ = {0, 0, 0};  // in nodes; 0 where nothing repeats
  double spot_volume_, reference_;
  Node low_ = {0, 0, 0}, high_ = {0, 0, 0};  // of the nodes counted: from low_ to high_, exclusive
  std::vector<std::int64_t> counts_;         // of spots, in 2^-24ths
  std::vector<double> counted_volumes_;      // around the same nodes
  mutable std::map<Node, double> volumes_;   // inside the walls, around the nodes asked for so far
};

}  // namespace spot
