// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/node_lattice.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// What walls shear at a place inside them (1 / length): kappa / h, h being the half_width() there. Walls farther than
/// calibration::farthest_walls of the `spacing` count as that far.
double shear_by_walls(double kappa, const Container& container, const Vector3& place, double spacing);

/// How a packing is strained at a place, for each length that grains fall (1 / length).
struct Strain {
  double shear = 0.0;  ///< s: across the vertical
  double whole = 0.0;  ///< e: along it, too
};

/// How fast grains fall from place to place, as told by what spots have carried up, and how that is sheared.
///
/// Grains fall past a place as fast as spots carry free volume up there, so u, the volume that spots have carried for
/// the volume inside the walls, is proportional to their speed. The shear for each length that they fall is
///
///     s = |grad_h u| / u + kappa / h    (1 / length)
///
/// with grad_h across the vertical. The second term is what walls shear, at a half_width() of h, which the lattice is
/// too coarse for. All that it is strained, e, has the whole gradient: what converges is strained along the vertical,
/// too. s says nothing of how fast the flow is: at a given place it stays as it is when more or fewer spots
/// come. In DEM both the packing fraction and the width of the flow follow it (docs/notes/2026-11-28-flow-law.md).
///
/// Steps are counted on the nodes of a NodeLattice, R_s apart, but no closer than grains are; those that were made
/// longer ago count for less, by a factor of e after calibration::climb_of_flow_memory. How far grains have fallen past
/// a place in all, which the Mobility there goes with, all steps tell alike, at calibration::packing_fraction_of_flow.
class FlowField {
 public:
  /// `diameter`: of grains. The container must outlive the field, or be replaced.
  FlowField(const SpotParameters& parameters, const Container& container, double diameter);

  /// Counts a step of a spot that carries `volume`, over that of a newborn one.
  void add(const Move& move, double volume);

  /// Collective. Takes in the steps that ranks have added since the last time, which is so long ago.
  void update(double elapsed, Communicator& communicator);

  /// s at a point (1 / length); 0 where no spot has been. As of the last update.
  double shear(const Vector3& point) const;

  /// s and, if a parameter needs it, e at a point; 0 where no spot has been. As of the last update.
  Strain strain(const Vector3& point) const;

  /// grad_h u / u at a point (1 / length); 0 where no spot has been. As of the last update.
  Vector3 slope(const Vector3& point) const;

  /// grad_h ln m at a point, m being the Mobility there (1 / length); 0 where no spot has been, and if all is mobile.
  /// As of the last update.
  Vector3 slope_of_mobility(const Vector3& point) const;

  /// Works out the volume inside the walls anew, as after these changed.
  void replace_container(const Container& container);

  /// On several ranks only after an update.
  void save(Bytes& bytes) const;
  /// Throws InvalidState if what save() appended is damaged.
  void restore(ByteReader& saved);

  std::size_t memory() const;

 private:
  struct Step {
    Vector3 middle;
    std::int64_t carried;  // 2^-16ths of a newborn spot's volume, times step heights
  };

  void grow_to(const NodeLattice::Box& box);
  void find_volumes();
  void find_walls();
  Vector3 place_inside(const NodeLattice::Node& node) const;
  void find_slopes();
  void find_shear();
  void find_slope_of_mobility();
  double at(const std::vector<double>& values, double elsewhere, const NodeLattice::Node& node, double otherwise) const;
  std::pair<double, double> beside(const std::vector<double>& values, double elsewhere, int axis,
                                   const NodeLattice::Node& node) const;
  template <typename Value>
  Value mean_of(const std::vector<Value>& values, const Vector3& point, Value none) const;

  const Container* container_;
  NodeLattice lattice_;
  bool spreads_, strains_along_z_;
  double wall_shear_;
  double memory_time_, step_height_;
  Mobility mobility_;
  double fall_of_carried_;  // how far grains fall, times the volume through which it is carried
  std::vector<Step> added_;
  NodeLattice::Box box_;                    // of the nodes where steps have been counted
  std::vector<double> carried_;             // at these nodes: sums of steps, each counted for less the older it is
  std::vector<double> total_;               // the same, each counted alike, if not all is mobile
  std::vector<double> volumes_;             // inside the walls, around the same nodes; 0 where there is next to none
  std::vector<double> walls_;               // what they shear, at the same nodes; below 0 where that is not known yet
  std::vector<Eigen::Array2d> strains_;     // at the same nodes: s and, if a parameter needs it, e
  std::vector<Vector3> slope_;              // at the same nodes, if there is a spread
  std::vector<Vector3> slope_of_mobility_;  // at the same nodes, if not all is mobile
};

}  // namespace spot
