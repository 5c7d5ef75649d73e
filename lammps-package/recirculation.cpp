// SPDX-License-Identifier: GPL-2.0-only
#include "lammps_headers.h"

#include "recirculation.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "region.h"

#include "find_region.h"
#include "spot/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

using spot::InvalidContainer;
using spot::message;

namespace LAMMPS_NS {

namespace {

/// The simulation box above the outlets, or what the walls leave of it.
spot::Inlet inlet_above_outlets(const SpotCommand &command, const Domain &domain) {
  spot::Inlet inlet;
  inlet.low = spot::Vector3(domain.boxlo[0], domain.boxlo[1], command.outlets.outlets().height());
  inlet.high = spot::Vector3(domain.boxhi[0], domain.boxhi[1], domain.boxhi[2]);
  const auto narrow = [&](int axis, double low, double high) {
    inlet.low[axis] = std::max(inlet.low[axis], low);
    inlet.high[axis] = std::min(inlet.high[axis], high);
  };
  if (const auto *box = std::get_if<BoxWalls>(&command.walls)) {
    if (box->x) narrow(0, box->x->low, box->x->high);
    if (box->y) narrow(1, box->y->low, box->y->high);
  } else if (const auto *cylinder = std::get_if<CylinderWalls>(&command.walls)) {
    narrow(0, cylinder->x - cylinder->radius, cylinder->x + cylinder->radius);
    narrow(1, cylinder->y - cylinder->radius, cylinder->y + cylinder->radius);
  } else if (const auto *shaped = std::get_if<ShapedWalls>(&command.walls)) {
    for (int axis = 0; axis < 3; ++axis) narrow(axis, shaped->low()[axis], shaped->high()[axis]);
  }
  return inlet;
}

void set_height(spot::Inlet &inlet, double height, const Domain &domain) {
  if (!(height > inlet.low.z() && height <= domain.boxhi[2]))
    throw InvalidContainer(message("'recirculate' puts grains to z = ", height, ", which must be above the outlets, ",
                                   inlet.low.z(), ", and inside the simulation box, up to ", domain.boxhi[2]));
  inlet.low.z() = inlet.high.z() = height;
}

void set_region(spot::Inlet &inlet, const std::string &name, Domain &domain) {
  Region *region = find_region(domain, name, 0);
  if (!region) throw InvalidContainer(message("region '", name, "' of 'recirculate' does not exist"));
  if (region->varshape || region->dynamic_check())
    throw InvalidContainer(
        message("region '", name, "' of 'recirculate' moves or changes shape, which is not supported"));
  if (region->bboxflag) {
    inlet.low = inlet.low.cwiseMax(spot::Vector3(region->extent_xlo, region->extent_ylo, region->extent_zlo));
    inlet.high = inlet.high.cwiseMin(spot::Vector3(region->extent_xhi, region->extent_yhi, region->extent_zhi));
  }
  if (!(inlet.low.array() <= inlet.high.array()).all())
    throw InvalidContainer(message("region '", name,
                                   "' of 'recirculate' is outside the walls, below the outlets or "
                                   "outside the simulation box"));
  inlet.contains = [region](const spot::Vector3 &at) {
    return (region->inside(at.x(), at.y(), at.z()) != 0) == (region->interior != 0);
  };
}

}  // namespace

spot::Inlet inlet_of(const SpotCommand &command, Domain &domain) {
  spot::Inlet inlet = inlet_above_outlets(command, domain);
  inlet.name = "'recirculate " + command.recirculation->text() + "'";
  if (command.recirculation->height)
    set_height(inlet, *command.recirculation->height, domain);
  else if (!command.recirculation->region.empty())
    set_region(inlet, command.recirculation->region, domain);
  else
    inlet.on_surface = true;
  return inlet;
}

void bring_home(const std::vector<Delivery> &grains, Atom &atom, Comm &comm, const Domain &domain,
                spot::Communicator &ranks) {
  std::unordered_map<std::int64_t, const double *> places;
  for (const Delivery &grain : grains) places.emplace(grain.id, grain.position);
  for (;;) {
    std::int64_t away = 0;
    for (int i = 0; i < atom.nlocal; ++i) {
      const auto found = places.find(atom.tag[i]);
      if (found == places.end()) continue;
      const double *place = found->second;
      std::copy_n(place, 3, atom.x[i]);
      // One axis at a time: what has crossed one side is the neighbour's there, in every style of communication.
      bool crosses = false;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = domain.sublo[axis], high = domain.subhi[axis];
        const bool below = place[axis] < low, above = place[axis] >= high && high < domain.boxhi[axis];
        if (!below && !above) continue;
        const double inside = below ? low : std::nextafter(high, low);
        const double outside = below ? std::nextafter(low, -std::numeric_limits<double>::infinity()) : high;
        atom.x[i][axis] = crosses ? inside : outside;
        crosses = true;
      }
      away += crosses;
    }
    if (ranks.sum(away) == 0) return;
    comm.exchange();
  }
}

}  // namespace LAMMPS_NS
