// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/outlets.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

bool overlap(const Outlet& a, const Outlet& b) {
  const auto near = [&](int axis) {
    return std::abs(a.centre[axis] - b.centre[axis]) < a.hole->half_width(axis) + b.hole->half_width(axis);
  };
  return near(0) && near(1);
}

}  // namespace

Outlets::Outlets(std::vector<Outlet> all) : all_(std::move(all)) {
  if (all_.empty()) throw InvalidContainer("a container has no outlet but needs at least one");
  for (const Outlet& outlet : all_)
    if (outlet.centre.z() != height())
      throw InvalidContainer(message("outlets are at z = ", height(), " and z = ", outlet.centre.z(),
                                     " but must all be at one height, below which grains are taken out"));
  for (std::size_t a = 0; a < all_.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (overlap(all_[a], all_[b]))
        throw InvalidContainer(message(all_[b].name(), " and ", all_[a].name(),
                                       " overlap, or the rectangles around them do: move them apart along x or y"));
}

Outlets Outlets::repeated(const Periodic& periodic) const {
  Outlets repeated = *this;
  for (Outlet& outlet : repeated.all_)
    for (int axis = 0; axis < 2; ++axis) {
      const double period = periodic.length(axis);
      if (!periodic.along(axis) || std::abs(2.0 * outlet.hole->half_width(axis) - period) > 1e-9 * period) continue;
      if (const auto endless = outlet.hole->without_ends(axis)) {
        outlet.hole = endless;
        outlet.centre[axis] = 0.5 * (periodic.low(axis) + periodic.high(axis));
      }
    }
  return repeated;
}

void Outlets::require_within(const Periodic& periodic) const {
  for (const Outlet& outlet : all_)
    for (int axis = 0; axis < 2; ++axis) {
      const double half = outlet.hole->half_width(axis),
                   slack = periodic.along(axis) ? 1e-9 * periodic.length(axis) : 0.0;
      if (outlet.centre[axis] - half < periodic.low(axis) - slack ||
          outlet.centre[axis] + half > periodic.high(axis) + slack)
        throw InvalidContainer(message(outlet.name(), " reaches out of the cell that repeats, along ", "xy"[axis],
                                       " from ", periodic.low(axis), " to ", periodic.high(axis)));
    }
}

const Outlet& Outlets::nearest(const Vector3& place) const {
  if (all_.size() == 1) return all_.front();
  return *std::min_element(all_.begin(), all_.end(),
                           [&](const Outlet& a, const Outlet& b) { return a.distance(place) < b.distance(place); });
}

std::optional<double> Outlets::passed_at(const Vector3& from, const Vector3& to) const {
  const double before = from.z() - height(), after = to.z() - height();
  if ((before >= 0.0) == (after >= 0.0)) return std::nullopt;
  return before / (before - after);
}

}  // namespace spot
