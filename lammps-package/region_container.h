// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_REGION_CONTAINER_H
#define SPOT_REGION_CONTAINER_H

#include "spot/container.hpp"

namespace LAMMPS_NS {

class Region;

/// The general path: walls are the surface of a LAMMPS region. The region brings its own opening at the orifice
/// (an open face); below the orifice it is not asked. Region::surface is not thread-safe, so neither is this.
class RegionContainer : public spot::Container {
 public:
  /// The region must outlive this. Throws spot::InvalidContainer if a point just above the orifice is outside.
  RegionContainer(Region *region, const spot::Orifice &orifice, const spot::SpotBuffers &buffers);

  bool contains(const spot::Vector3 &centre) const override;
  void contacts(const spot::Vector3 &centre, double reach, spot::WallContacts &contacts) const override;
  bool concurrent() const override { return false; }
  const spot::Orifice &orifice() const override { return orifice_; }
  spot::Vector3 keep_spot_inside(const spot::Vector3 &start, const spot::Vector3 &target) const override;

 private:
  bool has_clearance(const spot::Vector3 &spot) const;

  Region *region_;
  spot::Orifice orifice_;
  spot::SpotBuffers buffers_;
};

}  // namespace LAMMPS_NS

#endif
