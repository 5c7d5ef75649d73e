// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/mobility.hpp"

#include <cmath>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

double Mobility::logarithm(double fallen) const { return log(1.0 - (1.0 - at_rest) * exp(-fallen / fall)); }

void Mobility::validate() const {
  if (!(at_rest >= calibration::least_mobility && at_rest <= 1.0))
    throw InvalidParameter(message("the mobility of what has not fallen is ", at_rest, " but must be from ",
                                   calibration::least_mobility, " to 1 (off)"));
  if (!on()) return;
  if (!(fall > 0.0 && std::isfinite(fall)))
    throw InvalidParameter(message("the fall that makes a packing mobile is ", fall, " but must be positive"));
  if (!(drift > 0.0 && std::isfinite(drift)))
    throw InvalidParameter(message("the drift towards what is mobile is ", drift, " but must be positive"));
}

}  // namespace spot
