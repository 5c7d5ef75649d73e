// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>

namespace spot {

using Vector3 = Eigen::Vector3d;

}  // namespace spot
