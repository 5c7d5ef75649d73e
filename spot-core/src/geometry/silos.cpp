// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/silos.hpp"

#include <cmath>
#include <string>

#include "spot/base/errors.hpp"
#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/cylinder_wall.hpp"
#include "spot/geometry/plane_wall.hpp"

namespace spot {

namespace {

void require_order(const char* axis, double low, double high) {
  if (!(low < high) || !std::isfinite(low) || !std::isfinite(high))
    throw InvalidContainer(
        message("walls along ", axis, " are at ", low, " and ", high, " but must be finite and in increasing order"));
}

void require_room(const char* axis, double low, double high, double buffer) {
  if (high - low < 2.0 * buffer)
    throw InvalidContainer(message("walls along ", axis, " are ", high - low, " apart but spots that keep ", buffer,
                                   " from each need at least ", 2.0 * buffer));
}

/// One exactly as wide as the silo is allowed, whatever the rounding.
void require_base_around(const Outlet& outlet, const std::optional<Interval> (&walls)[2]) {
  const double slack = 1e-9 * outlet.hole->widest_radius();
  std::string base;
  bool inside = true;
  for (int axis = 0; axis < 2; ++axis) {
    if (!walls[axis]) continue;
    const auto [low, high] = *walls[axis];
    const double half = outlet.hole->half_width(axis);
    inside = inside && outlet.centre[axis] - half >= low - slack && outlet.centre[axis] + half <= high + slack;
    base += message(", ", axis == 0 ? "x" : "y", " from ", low, " to ", high);
  }
  if (!inside) throw InvalidContainer(message(outlet.name(), " is wider than the base", base));
}

void require_cell_around(double x, double y, double radius, const Periodic& periodic) {
  const double centre[] = {x, y};
  for (int axis = 0; axis < 2; ++axis)
    if (centre[axis] - radius < periodic.low(axis) || centre[axis] + radius > periodic.high(axis))
      throw InvalidContainer(message("a cylinder from ", centre[axis] - radius, " to ", centre[axis] + radius,
                                     " reaches out of the cell that repeats, along ", "xy"[axis], " from ",
                                     periodic.low(axis), " to ", periodic.high(axis)));
}

}  // namespace

std::unique_ptr<WalledContainer> box_silo(double x_low, double x_high, double y_low, double y_high,
                                          const Outlets& outlets, const SpotBuffers& buffers) {
  return box_silo(Interval{x_low, x_high}, Interval{y_low, y_high}, {}, outlets, buffers);
}

std::unique_ptr<WalledContainer> box_silo(const std::optional<Interval>& x, const std::optional<Interval>& y,
                                          const Periodic& periodic, const Outlets& given, const SpotBuffers& buffers) {
  const std::optional<Interval> walls[] = {x, y};
  const Outlets outlets = given.repeated(periodic);
  for (int axis = 0; axis < 2; ++axis) {
    const char* name = axis == 0 ? "x" : "y";
    if (walls[axis]) {
      require_order(name, walls[axis]->low, walls[axis]->high);
      require_room(name, walls[axis]->low, walls[axis]->high, buffers.side);
    } else if (!periodic.along(axis)) {
      throw InvalidContainer(message("there are no walls along ", name, ", where space does not repeat"));
    }
  }
  for (const Outlet& outlet : outlets) require_base_around(outlet, walls);
  auto silo = std::make_unique<WalledContainer>(outlets);
  silo->add(std::make_unique<BasePlate>(outlets), buffers.base);
  for (int axis = 0; axis < 2; ++axis) {
    if (!walls[axis]) continue;
    const auto along = [axis](double length) {
      Vector3 vector = Vector3::Zero();
      vector[axis] = length;
      return vector;
    };
    silo->add(std::make_unique<PlaneWall>(along(walls[axis]->low), along(1.0)), buffers.side);
    silo->add(std::make_unique<PlaneWall>(along(walls[axis]->high), along(-1.0)), buffers.side);
  }
  silo->repeat(periodic);
  return silo;
}

std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Outlets& outlets,
                                               const SpotBuffers& buffers, const Periodic& periodic) {
  auto wall = std::make_unique<CylinderWall>(x, y, radius);
  if (radius < buffers.side)
    throw InvalidContainer(message("cylinder radius is ", radius, " but spots keep ", buffers.side, " from its wall"));
  for (const Outlet& outlet : outlets) {
    const double reach = outlet.hole->farthest(outlet.centre - Vector3(x, y, 0.0));
    if (reach > radius * (1.0 + 1e-9))
      throw InvalidContainer(
          message(outlet.name(), " reaches ", reach, " from the axis and is wider than the base of radius ", radius));
  }
  auto silo = std::make_unique<WalledContainer>(outlets);
  silo->add(std::make_unique<BasePlate>(outlets), buffers.base);
  silo->add(std::move(wall), buffers.side);
  require_cell_around(x, y, radius, periodic);
  silo->repeat(periodic);
  return silo;
}

}  // namespace spot
