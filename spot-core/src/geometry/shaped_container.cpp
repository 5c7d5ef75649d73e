// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/shaped_container.hpp"

#include <algorithm>
#include <limits>

#include "geometry/cells_on_path.hpp"
#include "geometry/directions.hpp"
#include "spot/geometry/repeated_solid.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

namespace {

const Outlets& valid(const Outlets& outlets, const SpotBuffers& buffers) {
  for (const double buffer : {buffers.side, buffers.base})
    if (!(buffer >= 0.0) || !std::isfinite(buffer))
      throw InvalidContainer(message("spot buffer is ", buffer, " but must be zero or positive"));
  return outlets;
}

/// What is above the outlets, and pipes that lead on below them.
Solid open_at(const Outlets& outlets, const Solid& solid, const Periodic& periodic) {
  const Vector3 up = Vector3::UnitZ();
  Solid open = solid & half_space(outlets[0].centre, up);
  for (const Outlet& outlet : outlets) {
    const Vector3 half(outlet.hole->half_width(0), outlet.hole->half_width(1), 0.0);
    const Solid column =
        repeated(outlet.hole->column(outlet.centre), outlet.centre - half, outlet.centre + half, periodic);
    open = open | (column & half_space(outlet.centre, -up));
  }
  return open;
}

double narrowest(const Outlets& outlets) {
  double radius = std::numeric_limits<double>::infinity();
  for (const Outlet& outlet : outlets) radius = std::min(radius, outlet.hole->widest_radius());
  return radius;
}

}  // namespace

ShapedContainer::ShapedContainer(const Solid& solid, const Outlets& outlets, const SpotBuffers& buffers,
                                 const Periodic& periodic)
    : BodyContainer(valid(outlets, buffers), buffers, periodic),
      boundary_(open_at(outlets, solid, periodic), narrowest(outlets)) {
  for (const Outlet& outlet : outlets) require_mouth(outlet);
}

/// At places all over the hole: of a round one on circles around its centre, of a slot on lines across it, with its
/// corners.
void ShapedContainer::require_mouth(const Outlet& outlet) const {
  const double radius = outlet.hole->widest_radius();
  constexpr int lines = 64;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0})
    for (int line = 0; line <= lines; ++line) {
      const Vector3 place = outlet.hole->point(1e-6 * radius, share * share, static_cast<double>(line) / lines);
      const Vector3 at = outlet.centre + place + Vector3(0.0, 0.0, 1e-6 * radius);
      if (!contains(at))
        throw InvalidContainer(message("the ", outlet.name(), " does not open into the container: right above it, at (",
                                       at.x(), ", ", at.y(), ", ", at.z(), "), the walls leave no inside"));
    }
}

bool ShapedContainer::contains(const Vector3& centre) const {
  return centre.z() >= outlets().height() && boundary_.contains(periodic().wrap(centre));
}

void ShapedContainer::contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
  contacts.clear();
  if (centre.z() >= outlets().height()) boundary_.add_contacts(periodic().wrap(centre), reach, contacts);
}

bool ShapedContainer::may_have_left_to(const Vector3& centre) const {
  const BasePlate base(outlets());
  return any_image_at_outlets(outlets(), periodic(), centre,
                              [&](const Vector3& place) { return base.may_have_left_to(place); });
}

std::optional<WallContact> ShapedContainer::nearest_wall(const Vector3& place, double reach) const {
  return boundary_.nearest(periodic().wrap(place), reach);
}

std::optional<WallOnPath> ShapedContainer::first_wall_above(const Vector3& from, const Vector3& to) const {
  return boundary_.first_wall(from, to);
}

}  // namespace spot
