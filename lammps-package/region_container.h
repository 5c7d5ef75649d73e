// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_REGION_CONTAINER_H
#define SPOT_REGION_CONTAINER_H

#include "region_parts.h"
#include "spot/geometry/body_container.hpp"

#include <optional>

namespace LAMMPS_NS {

class Domain;
class Region;

/// The general path: walls are the surface of a LAMMPS region. The region brings its own opening at the orifice
/// (an open face, or a part that leads out); below the orifice it is not asked. Region::surface is not thread-safe, so
/// neither is this.
class RegionContainer : public spot::BodyContainer {
 public:
  /// The region must outlive this. Throws spot::InvalidContainer, naming region and orifice, unless the orifice lies in
  /// an opening of the region, beyond which there is a base, half a radius farther out, in some direction at least; and
  /// as RegionParts does.
  RegionContainer(Region *region, Domain &domain, const spot::Orifice &orifice, const spot::SpotBuffers &buffers);

  bool contains(const spot::Vector3 &centre) const override;
  void contacts(const spot::Vector3 &centre, double reach, spot::WallContacts &contacts) const override;
  bool concurrent() const override { return false; }

 private:
  std::optional<spot::WallContact> nearest_wall(const spot::Vector3 &place, double reach) const override;
  std::optional<spot::WallOnPath> first_wall_above(const spot::Vector3 &from, const spot::Vector3 &to) const override;
  spot::Vector3 beside_walls(const spot::Vector3 &place, double reach) const;
  double entrance_height() const;
  bool opens_below(const spot::Vector3 &place) const;
  void require_mouth() const;

  Region *region_;
  spot::Orifice orifice_;
  RegionParts parts_;
};

}  // namespace LAMMPS_NS

#endif
