// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/shaped_container.hpp"

#include "geometry/directions.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

namespace {

const Orifice& valid(const Orifice& orifice, const SpotBuffers& buffers) {
  require_finite(orifice.centre, "the centre of the orifice");
  require_positive(orifice.radius, "the radius of the orifice");
  for (const double buffer : {buffers.side, buffers.base})
    if (!(buffer >= 0.0) || !std::isfinite(buffer))
      throw InvalidContainer(message("spot buffer is ", buffer, " but must be zero or positive"));
  return orifice;
}

/// What is above the orifice, and a pipe that leads on below it.
Solid open_at(const Orifice& orifice, const Solid& solid) {
  const Vector3 up = Vector3::UnitZ();
  return (solid & half_space(orifice.centre, up)) |
         (cylinder(orifice.centre, up, orifice.radius) & half_space(orifice.centre, -up));
}

}  // namespace

ShapedContainer::ShapedContainer(const Solid& solid, const Orifice& orifice, const SpotBuffers& buffers)
    : BodyContainer(valid(orifice, buffers), buffers), boundary_(open_at(orifice, solid), orifice.radius) {
  require_mouth();
}

void ShapedContainer::require_mouth() const {
  const Vector3& c = orifice().centre;
  const double radius = orifice().radius;
  constexpr int turns = 64;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0 - 1e-6})
    for (int turn = 0; turn < turns; ++turn) {
      const Vector3 out = around(static_cast<double>(turn) / turns, Vector3::UnitX(), Vector3::UnitY());
      const Vector3 at = c + share * radius * out + Vector3(0.0, 0.0, 1e-6 * radius);
      if (!contains(at))
        throw InvalidContainer(message("the orifice of radius ", radius, " at (", c.x(), ", ", c.y(), ", ", c.z(),
                                       ") does not open into the container: at (", at.x(), ", ", at.y(), ", ", at.z(),
                                       ") there is none"));
    }
}

bool ShapedContainer::contains(const Vector3& centre) const {
  return centre.z() >= orifice().centre.z() && boundary_.contains(centre);
}

void ShapedContainer::contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
  contacts.clear();
  if (centre.z() >= orifice().centre.z()) boundary_.add_contacts(centre, reach, contacts);
}

bool ShapedContainer::may_have_left_to(const Vector3& centre) const {
  return BasePlate(orifice()).may_have_left_to(centre);
}

std::optional<WallContact> ShapedContainer::nearest_wall(const Vector3& place, double reach) const {
  return boundary_.nearest(place, reach);
}

std::optional<WallOnPath> ShapedContainer::first_wall_above(const Vector3& from, const Vector3& to) const {
  return boundary_.first_wall(from, to);
}

}  // namespace spot
