// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/base/vector.hpp"

namespace spot {

/// The round outlet of most silos, by its numbers; Outlet has it as a shape, RoundHole.
struct Orifice {
  Vector3 centre;
  double radius;
};

}  // namespace spot
