// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/beverloo.hpp"

#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

void BeverlooLaw::validate() const {
  const auto require = [](bool valid, const char* what, double is, const char* bound) {
    if (!valid) throw InvalidParameter(message(what, " of Beverloo's law is ", is, " but must be ", bound));
  };
  require(std::isfinite(round) && round > 0.0, "C of round holes", round, "positive and finite");
  require(std::isfinite(slot) && slot > 0.0, "C of slots", slot, "positive and finite");
  require(std::isfinite(margin) && margin >= 0.0, "k", margin, "zero or positive and finite");
}

}  // namespace spot
