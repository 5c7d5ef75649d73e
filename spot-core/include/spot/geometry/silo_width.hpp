// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/container.hpp"

namespace spot {

/// How wide the silo is at an outlet: twice the distance of the nearest wall from the outlet's centre, as high above it
/// as it is half wide; of a slot on the two sides of its smaller width. None if there is no wall within 30 of its
/// radii.
std::optional<double> silo_width(const Container& container, const Outlet& outlet);

}  // namespace spot
