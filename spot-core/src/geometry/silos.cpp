// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/silos.hpp"

#include <cmath>

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

}  // namespace

std::unique_ptr<WalledContainer> box_silo(double x_low, double x_high, double y_low, double y_high,
                                          const Outlets& outlets, const SpotBuffers& buffers) {
  require_order("x", x_low, x_high);
  require_order("y", y_low, y_high);
  require_room("x", x_low, x_high, buffers.side);
  require_room("y", y_low, y_high, buffers.side);
  for (const Outlet& outlet : outlets) {
    const Vector3 half(outlet.hole->half_width(0), outlet.hole->half_width(1), 0.0);
    const Vector3 low = outlet.centre - half, high = outlet.centre + half;
    // One exactly as wide as the silo is allowed, whatever the rounding.
    const double slack = 1e-9 * outlet.hole->widest_radius();
    if (low.x() < x_low - slack || high.x() > x_high + slack || low.y() < y_low - slack || high.y() > y_high + slack)
      throw InvalidContainer(message(outlet.name(), " is wider than the base, x from ", x_low, " to ", x_high,
                                     ", y from ", y_low, " to ", y_high));
  }
  auto silo = std::make_unique<WalledContainer>(outlets);
  silo->add(std::make_unique<BasePlate>(outlets), buffers.base);
  silo->add(std::make_unique<PlaneWall>(Vector3(x_low, 0, 0), Vector3(1, 0, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(x_high, 0, 0), Vector3(-1, 0, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(0, y_low, 0), Vector3(0, 1, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(0, y_high, 0), Vector3(0, -1, 0)), buffers.side);
  return silo;
}

std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Outlets& outlets,
                                               const SpotBuffers& buffers) {
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
  return silo;
}

}  // namespace spot
