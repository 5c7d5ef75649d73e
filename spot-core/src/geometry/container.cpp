// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/container.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// The shares of a straight path at which it passes from cell to cell, in increasing order, and 1 for its end.
std::vector<double> ends_of_pieces(const Periodic& periodic, const Vector3& from, const Vector3& to) {
  std::vector<double> ends = {1.0};
  for (int axis = 0; axis < 2; ++axis) {
    if (!periodic.along(axis) || from[axis] == to[axis]) continue;
    const double least = std::min(from[axis], to[axis]), most = std::max(from[axis], to[axis]);
    double border =
        periodic.low(axis) + std::ceil((least - periodic.low(axis)) / periodic.length(axis)) * periodic.length(axis);
    for (; border < most; border += periodic.length(axis))
      if (border > least) ends.push_back((border - from[axis]) / (to[axis] - from[axis]));
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// std::hypot guards against overflow, which lengths here are far from, and costs ten times as much.
double length(double x, double y) { return std::sqrt(x * x + y * y); }

}  // namespace

void WallContacts::add(const WallContact& contact) {
  if (size_ == capacity) throw InvalidContainer(message("more than ", capacity, " walls are close to one grain"));
  contacts_[size_++] = contact;
}

Vector3 Orifice::keep_within(double limit, const Vector3& position) const {
  const double dx = position.x() - centre.x();
  const double dy = position.y() - centre.y();
  const double distance = length(dx, dy);
  if (distance <= limit) return position;
  const double scale = std::max(0.0, 2.0 * limit - distance) / distance;
  return {centre.x() + scale * dx, centre.y() + scale * dy, position.z()};
}

std::optional<double> Orifice::passed_at(const Vector3& from, const Vector3& to) const {
  const double before = from.z() - centre.z(), after = to.z() - centre.z();
  if ((before >= 0.0) == (after >= 0.0)) return std::nullopt;
  return before / (before - after);
}

Vector3 Container::keep_spot_inside(const Vector3& start, const Vector3& target) const {
  if (const auto end = reflect_spot(start, target)) return *end;
  const Vector3 upwards(start.x(), start.y(), target.z());
  return first_wall(start, upwards) ? start : upwards;
}

const Periodic& Container::periodic() const {
  static const Periodic none;
  return none;
}

const std::vector<AxisPlane>& Container::axis_planes() const {
  static const std::vector<AxisPlane> none;
  return none;
}

void Container::require_entrance(double spot_radius) const {
  if (orifice().radius < spot_radius)
    throw InvalidContainer(message("orifice radius is ", orifice().radius, " but must be at least the spot radius, ",
                                   spot_radius, ": narrower orifices clog, which is outside the spot model"));
}

Vector3 Wall::reflect_spot(double buffer, const Vector3& target) const {
  const WallContact contact = nearest(target);
  if (contact.distance >= buffer) return target;
  return target + 2.0 * (buffer - contact.distance) * contact.normal;
}

PlaneWall::PlaneWall(const Vector3& point, const Vector3& normal) {
  const double norm = normal.norm();
  if (!(norm > 0.0) || !std::isfinite(norm) || !point.allFinite())
    throw InvalidContainer("a plane wall needs a finite point and a finite normal that is not zero");
  normal_ = normal / norm;
  offset_ = normal_.dot(point);
}

WallContact PlaneWall::nearest(const Vector3& centre) const { return {normal_.dot(centre) - offset_, normal_}; }

std::optional<WallOnPath> PlaneWall::meet(const Vector3& from, const Vector3& to) const {
  const double before = normal_.dot(from) - offset_, after = normal_.dot(to) - offset_;
  if (after >= 0.0) return std::nullopt;
  return WallOnPath{before > 0.0 ? before / (before - after) : 0.0, normal_};
}

std::optional<AxisPlane> PlaneWall::axis_plane() const {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(normal_[axis]) == 1.0) return AxisPlane{axis, offset_ * normal_[axis], normal_[axis] < 0.0};
  return std::nullopt;
}

CylinderWall::CylinderWall(double x, double y, double radius) : x_(x), y_(y), radius_(radius) {
  if (!(radius > 0.0) || !std::isfinite(radius))
    throw InvalidContainer(message("cylinder radius is ", radius, " but must be positive and finite"));
}

WallContact CylinderWall::nearest(const Vector3& centre) const {
  const double dx = centre.x() - x_;
  const double dy = centre.y() - y_;
  const double distance = length(dx, dy);
  if (distance == 0.0) return {radius_, {-1.0, 0.0, 0.0}};  // on the axis every direction is as good
  return {radius_ - distance, {-dx / distance, -dy / distance, 0.0}};
}

std::optional<WallOnPath> CylinderWall::meet(const Vector3& from, const Vector3& to) const {
  if (nearest(to).distance >= 0.0) return std::nullopt;
  if (nearest(from).distance <= 0.0) return WallOnPath{0.0, nearest(from).normal};
  // The share s of the path at which |start + s along| is the radius: the larger root of a s^2 + 2 b s - c.
  const Eigen::Vector2d start(from.x() - x_, from.y() - y_), along = (to - from).head<2>();
  const double a = along.squaredNorm(), b = start.dot(along), c = radius_ * radius_ - start.squaredNorm();
  const double root = std::sqrt(b * b + a * c);
  const double share = std::min(1.0, b > 0.0 ? c / (b + root) : (root - b) / a);
  return WallOnPath{share, nearest(from + share * (to - from)).normal};
}

BasePlate::BasePlate(const Orifice& orifice) : orifice_(orifice) {}

WallContact BasePlate::nearest(const Vector3& centre) const {
  const double dx = centre.x() - orifice_.centre.x();
  const double dy = centre.y() - orifice_.centre.y();
  const double height = centre.z() - orifice_.centre.z();
  const double from_axis = length(dx, dy);
  if (from_axis >= orifice_.radius) return {std::abs(height), {0.0, 0.0, height < 0.0 ? -1.0 : 1.0}};
  if (from_axis == 0.0) return {length(orifice_.radius, height), {0.0, 0.0, 1.0}};
  const double to_rim = orifice_.radius - from_axis;
  const double distance = length(to_rim, height);
  return {distance, {-dx / from_axis * to_rim / distance, -dy / from_axis * to_rim / distance, height / distance}};
}

Vector3 BasePlate::reflect_spot(double buffer, const Vector3& target) const {
  const double above = target.z() - orifice_.centre.z(), height = std::max(0.0, above);
  if (above >= 0.0 && height >= buffer) return target;
  const double rim_clearance = std::sqrt(buffer * buffer - height * height);
  return orifice_.keep_within(std::max(0.0, orifice_.radius - rim_clearance), target);
}

std::optional<WallOnPath> BasePlate::meet(const Vector3& from, const Vector3& to) const {
  const auto share = orifice_.passed_at(from, to);
  if (!share) return std::nullopt;
  const Vector3 passed = from + *share * (to - from) - orifice_.centre;
  if (length(passed.x(), passed.y()) <= orifice_.radius) return std::nullopt;
  return WallOnPath{*share, {0.0, 0.0, from.z() < orifice_.centre.z() ? -1.0 : 1.0}};
}

bool BasePlate::may_have_left_to(const Vector3& centre) const {
  const double from_axis = length(centre.x() - orifice_.centre.x(), centre.y() - orifice_.centre.y());
  return from_axis <= orifice_.radius + std::max(0.0, orifice_.centre.z() - centre.z());
}

WalledContainer::WalledContainer(const Orifice& orifice) : orifice_(orifice) {
  if (!(orifice.radius > 0.0) || !std::isfinite(orifice.radius) || !orifice.centre.allFinite())
    throw InvalidContainer(message("orifice radius is ", orifice.radius, " but must be positive and finite"));
}

void WalledContainer::add(std::unique_ptr<Wall> wall, double spot_buffer) {
  if (!(spot_buffer >= 0.0) || !std::isfinite(spot_buffer))
    throw InvalidContainer(message("spot buffer is ", spot_buffer, " but must be zero or positive"));
  if (const auto plane = wall->axis_plane()) {
    require_no_period_across(*plane);
    axis_planes_.push_back(*plane);
  }
  walls_.push_back({std::move(wall), spot_buffer});
}

void WalledContainer::require_no_period_across(const AxisPlane& plane) const {
  if (periodic_.along(plane.axis))
    throw InvalidContainer(message("a wall across ", "xyz"[plane.axis], " at ", plane.at,
                                   " stands in the way of a container that repeats along that axis"));
}

void WalledContainer::repeat(const Periodic& periodic) {
  for (int axis = 0; axis < 2; ++axis)
    if (orifice_.centre[axis] - orifice_.radius < periodic.low(axis) ||
        orifice_.centre[axis] + orifice_.radius > periodic.high(axis))
      throw InvalidContainer(message("orifice of radius ", orifice_.radius, " at ", "xy"[axis], " = ",
                                     orifice_.centre[axis], " reaches out of the cell that repeats, from ",
                                     periodic.low(axis), " to ", periodic.high(axis)));
  periodic_ = periodic;
  for (const AxisPlane& plane : axis_planes_) require_no_period_across(plane);
}

bool WalledContainer::contains(const Vector3& place) const {
  const Vector3 centre = periodic_.wrap(place);
  return std::all_of(walls_.begin(), walls_.end(),
                     [&](const Bounded& b) { return b.wall->nearest(centre).distance >= 0.0; }) &&
         centre.z() >= orifice_.centre.z();
}

bool WalledContainer::may_have_left_to(const Vector3& place) const {
  // Below the orifice grains may have gone on into the next cell: to the image nearest to its axis.
  const Vector3 centre =
      periodic_.any() ? orifice_.centre + periodic_.nearest(Vector3(place - orifice_.centre)) : place;
  return std::all_of(walls_.begin(), walls_.end(), [&](const Bounded& b) { return b.wall->may_have_left_to(centre); });
}

void WalledContainer::contacts(const Vector3& place, double reach, WallContacts& contacts) const {
  const Vector3 centre = periodic_.wrap(place);
  contacts.clear();
  for (const Bounded& b : walls_) {
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

void WalledContainer::other_contacts(const Vector3& place, double reach, WallContacts& contacts) const {
  const Vector3 centre = periodic_.wrap(place);
  contacts.clear();
  for (const Bounded& b : walls_) {
    if (b.wall->axis_plane()) continue;
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

std::optional<WallOnPath> WalledContainer::first_wall(const Vector3& from, const Vector3& to) const {
  if (!periodic_.any()) return first_wall_in_cell(from, to);
  double begin = 0.0;
  for (const double end : ends_of_pieces(periodic_, from, to)) {
    const Vector3 first = from + begin * (to - from), last = end == 1.0 ? to : from + end * (to - from);
    const Vector3 middle = 0.5 * (first + last), into_cell = periodic_.wrap(middle) - middle;
    if (auto wall = first_wall_in_cell(first + into_cell, last + into_cell)) {
      wall->share = begin + wall->share * (end - begin);
      return wall;
    }
    begin = end;
  }
  return std::nullopt;
}

/// Of a path in the cell. Walls go on beyond it.
std::optional<WallOnPath> WalledContainer::first_wall_in_cell(const Vector3& from, const Vector3& to) const {
  const bool rises = from.z() < orifice_.centre.z();
  const auto passed = orifice_.passed_at(from, to);
  if (rises && !passed) return std::nullopt;
  const double begin = rises ? *passed : 0.0, end = passed && !rises ? *passed : 1.0;
  std::optional<WallOnPath> first;
  for (const Bounded& b : walls_) {
    auto wall = b.wall->meet(from, to);
    // Planes go on below the orifice, where they are no walls.
    if (wall && wall->share < begin && (wall = b.wall->meet(from + begin * (to - from), to)))
      wall->share = begin + wall->share * (1.0 - begin);
    if (wall && wall->share <= end && (!first || wall->share < first->share)) first = wall;
  }
  return first;
}

std::optional<Vector3> WalledContainer::reflect_spot(const Vector3& start, const Vector3& target) const {
  if (!periodic_.any()) return reflect_in_cell(start, target);
  const Vector3 into_cell = periodic_.wrap(target) - target;
  auto end = reflect_in_cell(start + into_cell, target + into_cell);
  if (end) *end -= into_cell;
  return end;
}

std::optional<Vector3> WalledContainer::reflect_in_cell(const Vector3& start, const Vector3& target) const {
  // A reflection can lead into the next wall's buffer; in a corner or a narrow gap a few rounds settle it.
  constexpr int rounds = 8;
  Vector3 position = target;
  for (int round = 0; round < rounds; ++round) {
    const Vector3 before = position;
    for (const Bounded& b : walls_) position = b.wall->reflect_spot(b.spot_buffer, position);
    if (position != before) continue;
    if (first_wall(start, position)) break;
    return position;
  }
  return std::nullopt;
}

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
                                          const Orifice& orifice, const SpotBuffers& buffers) {
  require_order("x", x_low, x_high);
  require_order("y", y_low, y_high);
  require_room("x", x_low, x_high, buffers.side);
  require_room("y", y_low, y_high, buffers.side);
  auto silo = std::make_unique<WalledContainer>(orifice);
  const Vector3& c = orifice.centre;
  const double r = orifice.radius;
  const double slack = 1e-9 * r;  // an orifice exactly as wide as the silo is allowed, whatever the rounding
  if (c.x() - r < x_low - slack || c.x() + r > x_high + slack || c.y() - r < y_low - slack ||
      c.y() + r > y_high + slack)
    throw InvalidContainer(message("orifice of radius ", r, " at (", c.x(), ", ", c.y(),
                                   ") is wider than the base, x from ", x_low, " to ", x_high, ", y from ", y_low,
                                   " to ", y_high));
  silo->add(std::make_unique<BasePlate>(orifice), buffers.base);
  silo->add(std::make_unique<PlaneWall>(Vector3(x_low, 0, 0), Vector3(1, 0, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(x_high, 0, 0), Vector3(-1, 0, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(0, y_low, 0), Vector3(0, 1, 0)), buffers.side);
  silo->add(std::make_unique<PlaneWall>(Vector3(0, y_high, 0), Vector3(0, -1, 0)), buffers.side);
  return silo;
}

std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Orifice& orifice,
                                               const SpotBuffers& buffers) {
  auto wall = std::make_unique<CylinderWall>(x, y, radius);
  if (radius < buffers.side)
    throw InvalidContainer(message("cylinder radius is ", radius, " but spots keep ", buffers.side, " from its wall"));
  auto silo = std::make_unique<WalledContainer>(orifice);
  const double reach = length(orifice.centre.x() - x, orifice.centre.y() - y) + orifice.radius;
  if (reach > radius * (1.0 + 1e-9))
    throw InvalidContainer(
        message("orifice reaches ", reach, " from the axis and is wider than the base of radius ", radius));
  silo->add(std::make_unique<BasePlate>(orifice), buffers.base);
  silo->add(std::move(wall), buffers.side);
  return silo;
}

}  // namespace spot
