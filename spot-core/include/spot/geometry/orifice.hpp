// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/base/vector.hpp"

namespace spot {

/// The round, horizontal hole through which grains leave and spots enter.
struct Orifice {
  Vector3 centre;
  double radius;

  /// `position` with its distance from the axis reflected to stay within `limit`, its height kept.
  Vector3 keep_within(double limit, const Vector3& position) const;

  /// The share of a straight path that lies before it passes the height of the orifice, if it does.
  std::optional<double> passed_at(const Vector3& from, const Vector3& to) const;
};

}  // namespace spot
