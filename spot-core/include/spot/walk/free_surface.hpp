// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/walk/influence_profile.hpp"
#include "spot/walk/node_lattice.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// The height of the packing's free surface from place to place, and which way a spot below it goes.
///
/// 2010, section 3.3: of its candidate steps a spot takes step i with probability p_i^beta / sum_j p_j^beta, p_i being
/// the grains that the step would displace. Here p_i is the share of the spot's influence that lies below the surface,
/// so that no grains have to be counted: 1 for all steps deep in the packing, where the walk stays as it is. Near the
/// surface spots so go where it is higher, and it comes down there; beta is how strongly.
///
/// The surface over a column, 2 diameters wide, is the highest centre of a grain there; between the columns' axes it is
/// interpolated. Over a column without grains it is at the height of the outlets.
class FreeSurface {
 public:
  /// `diameter`: of grains. The container must outlive the surface, or be replaced.
  FreeSurface(const SpotParameters& parameters, const Container& container, double diameter);

  /// Do spots ask which steps are likely?
  bool steers() const { return beta_ > 0.0; }
  /// Does anybody ask anything?
  bool needed() const { return needed_; }
  /// Has any grain been found yet?
  bool known() const { return !heights_.empty(); }

  /// Calls visit(position) for every grain of this rank; those between two corners may be left out if they are covered,
  /// that is, no higher than others over them that were visited already.
  using VisitGrains = std::function<void(const std::function<void(const Vector3&)>& visit,
                                         const std::function<bool(const Vector3& low, const Vector3& high)>& covered)>;

  /// Forgets all grains.
  void clear();
  void add(const Vector3& grain);
  /// Are all grains between two corners no higher than others over the same columns? False where nobody knows.
  bool covers(const Vector3& low, const Vector3& high) const;
  /// Collective. After all ranks have added their grains.
  void gather(Communicator& communicator);

  double height(const Vector3& place) const;

  /// p^beta of a step with this middle, from 0 to 1: how likely it is, beside others, by 2010's rule.
  double weight(const Vector3& middle) const;

  /// May a step from here reach above the surface? If not, all steps are alike.
  bool is_near(const Vector3& place) const { return place.z() + margin_ > lowest_; }

  void replace_container(const Container& container);

  void save(Bytes& bytes) const;
  /// Throws InvalidState if what save() appended is damaged.
  void restore(ByteReader& saved);

  std::size_t memory() const;

 private:
  NodeLattice::Node column(const Vector3& place) const;
  void cover(const NodeLattice::Box& box);
  double height_over(NodeLattice::Node column) const;
  void find_lowest();

  bool needed_;
  const Container* container_;
  const InfluenceProfile* profile_;
  double radius_, beta_, margin_;
  NodeLattice lattice_;          // of columns: its nodes at height 0 are their axes
  NodeLattice::Box box_;         // of the columns that are known
  std::vector<double> heights_;  // over these
  double lowest_;
};

}  // namespace spot
