// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_RECIRCULATION_H
#define SPOT_RECIRCULATION_H

#include "grain_delivery.h"
#include "spot/drivers/recirculation.hpp"
#include "spot_command.h"

#include <vector>

namespace LAMMPS_NS {

class Atom;
class Comm;
class Domain;

/// Where keyword `recirculate` puts grains back. Throws spot::InvalidContainer that names what is wrong with its region
/// or height.
spot::Inlet inlet_of(const SpotCommand &command, Domain &domain);

/// LAMMPS hands atoms to neighbours of a process only, and loses those that went farther: this brings grains to the
/// processes in whose sub-domains they are, from neighbour to neighbour. Collective; each grain is named to all, with
/// where it is. Only where LAMMPS may exchange atoms.
void bring_home(const std::vector<Delivery> &grains, Atom &atom, Comm &comm, const Domain &domain,
                spot::Communicator &ranks);

}  // namespace LAMMPS_NS

#endif
