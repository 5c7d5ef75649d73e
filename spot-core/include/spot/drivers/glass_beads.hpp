// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/walk/parameters.hpp"

/// Glass beads with a friction of 0.5, fitted to DEM (docs/model.md, Numbers): what lammps-package/glass-beads.lmp has.
namespace spot::glass_beads {

constexpr double diffusion_length = 1.47;  ///< b_s (diameters)

/// For grains of one diameter (length) and tau = sqrt(d/g) (time), with the steps of Accuracy::normal. Births are left.
SpotParameters spots(double diameter, double tau);

RelaxationParameters relaxation();

}  // namespace spot::glass_beads
