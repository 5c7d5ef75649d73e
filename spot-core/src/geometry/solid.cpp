// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/solid.hpp"

#include <algorithm>

namespace spot {

Solid::Solid(std::shared_ptr<const Surface> surface, bool inner)
    : kind_(Kind::side), surface_(std::move(surface)), inner_(inner) {}

Solid Solid::operator~() const {
  if (kind_ == Kind::side) return Solid(surface_, !inner_);
  std::vector<Solid> parts;
  for (const Solid& part : parts_) parts.push_back(~part);
  return Solid(kind_ == Kind::union_of ? Kind::intersection : Kind::union_of, std::move(parts));
}

bool Solid::contains(const Vector3& place) const {
  if (kind_ == Kind::side) return inner_ ? surface_->depth(place) >= 0.0 : surface_->depth(place) <= 0.0;
  const auto contain = [&](const Solid& part) { return part.contains(place); };
  return kind_ == Kind::union_of ? std::any_of(parts_.begin(), parts_.end(), contain)
                                 : std::all_of(parts_.begin(), parts_.end(), contain);
}

}  // namespace spot
