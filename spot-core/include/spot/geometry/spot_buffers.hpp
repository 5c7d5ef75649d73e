// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// How far spot centres stay from the walls.
struct SpotBuffers {
  double side;  ///< d_w, from the side walls (2006: one diameter)
  double base;  ///< the same, from the base plate and the rim of its orifice
};

}  // namespace spot
