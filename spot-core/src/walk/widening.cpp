// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/widening.hpp"

#include <cmath>
#include <utility>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

double Widening::factor(double fallen) const { return later + (at_first - later) * exp(-fallen / length); }

void Widening::validate() const {
  for (const auto& [when, factor] : {std::pair("at first", at_first), std::pair("later", later)})
    if (!(factor >= 0.0 && factor <= calibration::largest_widening))
      throw InvalidParameter(message("the widening counts shear ", factor, " times ", when, " but must do so 0 to ",
                                     calibration::largest_widening, " times (1: off)"));
  if (on() && !(length > 0.0 && std::isfinite(length)))
    throw InvalidParameter(message("the fall with which the flow widens is ", length, " but must be positive"));
}

}  // namespace spot
