// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_REGION_PARTS_H
#define SPOT_REGION_PARTS_H

#include "spot/geometry/container.hpp"

#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class Domain;
class Region;

/// How to write a region that is open at an orifice.
std::string way_to_write_mouth(const spot::Orifice &orifice);

/// The shapes that a region is made of, and which of them a straight path passes.
///
/// The surface that LAMMPS reports of a union or intersection does not say how far one may go: where the nearest point
/// of a part's face lies inside another part, the rest of the face is left out, too. But every shape that is no union
/// or intersection is convex. So a straight path is inside each of them from one place to another, and it is inside the
/// region or not between any two such places.
class RegionParts {
 public:
  /// `region` must outlive this. Throws spot::InvalidContainer, naming the part, if LAMMPS cannot tell what is inside,
  /// since a part of a union or intersection has an open face, or a shape with 'side out'; or where a
  /// surface is, since a cone with a point is seen from outside, or has its ends along y; and if a style is unknown.
  RegionParts(Region *region, Domain &domain, const spot::Orifice &orifice);

  /// Where the path leaves the region, or where it begins if that is outside. There is no normal where it leaves
  /// through an open face.
  std::optional<spot::WallOnPath> first_wall(const spot::Vector3 &from, const spot::Vector3 &to) const;

 private:
  /// A union or intersection of others, or a shape.
  struct Part {
    Region *region;
    bool is_union;
    std::vector<Part> parts;
    std::size_t shape;  ///< index in shapes_, if there are no parts
  };
  /// The share of a path from which on, and up to which, it is inside a shape; nowhere if it enters after it leaves.
  struct Stay {
    double enters, leaves;
    bool covers(double share) const { return enters <= share && share <= leaves; }
  };

  Part part_of(Region *region, Domain &domain);
  void require_closed(const Part &part, const spot::Orifice &orifice) const;
  void require_known_surface(const Part &part, bool obstacle) const;
  Stay stay(Region &shape, const spot::Vector3 &from, const spot::Vector3 &to) const;
  double entrance(Region &shape, const spot::Vector3 &from, const spot::Vector3 &to) const;
  bool matches(const Part &part, double share, const std::vector<Stay> &stays) const;
  spot::Vector3 normal(const spot::Vector3 &from, const spot::Vector3 &to, double share,
                       const std::vector<Stay> &stays) const;

  std::vector<Region *> shapes_;
  double tolerance_;  ///< two places closer than that are the same (length)
  Part whole_;
};

}  // namespace LAMMPS_NS

#endif
