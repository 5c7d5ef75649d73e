// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "spot/geometry/spot_buffers.hpp"
#include "spot/walk/parameters.hpp"

namespace spotcore {

/// All numbers of the model but the rates of births.
struct Parameters {
  /// Those of glass beads with a friction of 0.5, fitted to DEM (examples/silo), of accuracy normal. `tau`:
  /// sqrt(diameter / gravity). Throws spot::InvalidParameter unless both are positive and finite.
  Parameters(double diameter, double tau);

  double diameter;             ///< of the grains that they are for (length)
  spot::SpotParameters spots;  ///< without step_width, which follows
  double diffusion_length;     ///< b_s (length)
  spot::RelaxationParameters relaxation;
  spot::SpotBuffers buffers;
  double largest_overlap;  ///< at the start, in diameters

  spot::SpotParameters complete() const;
};

void bind_parameters(pybind11::module_& module);

}  // namespace spotcore
