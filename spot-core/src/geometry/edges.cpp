// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/directions.hpp"
#include "geometry/plane.hpp"
#include "geometry/search.hpp"
#include "geometry/sphere.hpp"

namespace spot {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using Curves = std::vector<std::unique_ptr<Curve>>;

Curves edges_of_planes(const Plane& a, const Plane& b) {
  const Vector3 na = a.normal(Vector3::Zero()), nb = b.normal(Vector3::Zero()), along = na.cross(nb);
  const double sine2 = along.squaredNorm();
  Curves curves;
  if (sine2 < 1e-24) return curves;
  const Vector3 point = (a.offset() * nb.cross(along) + b.offset() * along.cross(na)) / sine2;
  curves.push_back(std::make_unique<StraightCurve>(Line{point, along / std::sqrt(sine2)}));
  return curves;
}

/// Of a sphere and a plane at a distance from its centre, in the direction of a unit vector.
Curves edge_of_sphere(const Sphere& sphere, const Vector3& direction, double distance) {
  Curves curves;
  const double square = sphere.radius() * sphere.radius() - distance * distance;
  if (square > 0.0)
    curves.push_back(std::make_unique<Circle>(sphere.centre() + distance * direction, direction, std::sqrt(square)));
  return curves;
}

Curves edges_of_spheres(const Sphere& a, const Sphere& b) {
  const Vector3 apart = b.centre() - a.centre();
  const double distance = apart.norm();
  if (distance == 0.0) return {};
  const double from_a = 0.5 * (distance + (a.radius() - b.radius()) * (a.radius() + b.radius()) / distance);
  return edge_of_sphere(a, apart / distance, from_a);
}

/// Where one generator meets the other surface, all do, at the same height.
Curves edges_about_axis(const Surface& ruled, const Surface& other) {
  const Line axis = *ruled.axis(), generator = ruled.generator(0.0);
  Curves curves;
  for (const double s : Crossings(other.along(generator))) {
    const Vector3 point = generator.at(s), from_axis = point - axis.origin;
    const Vector3 centre = axis.origin + axis.direction.dot(from_axis) * axis.direction;
    const double radius = (point - centre).norm();
    if (radius > 0.0) curves.push_back(std::make_unique<Circle>(centre, axis.direction, radius));
  }
  return curves;
}

/// The generators of `ruled` that lie in the other surface: those that meet it at a distance along them.
Curves common_generators(const Surface& ruled, const Surface& other, double distance, double tolerance) {
  const Line axis = *ruled.axis();
  const Vector3 point = ruled.generator(0.0).at(distance);
  const Vector3 centre = axis.origin + axis.direction.dot(point - axis.origin) * axis.direction;
  Curves curves;
  const Circle cross_section(centre, axis.direction, (point - centre).norm());
  for (const Vector3& at : cross_section.meetings(other, tolerance)) {
    const Vector3 direction = ruled.apex() ? Vector3((at - *ruled.apex()).normalized()) : axis.direction;
    curves.push_back(std::make_unique<StraightCurve>(Line{at, direction}));
  }
  return curves;
}

/// Finds at which angles the generators of a surface meet another one.
class Pieces {
 public:
  Pieces(const Surface& ruled, const Surface& other, bool plus, double longest)
      : ruled_(ruled), other_(other), plus_(plus), longest_(longest) {
    take_angles();
  }

  Curves curves() const {
    Curves curves;
    if (std::all_of(meets_.begin(), meets_.end(), [](bool meets) { return meets; })) {
      curves.push_back(std::make_unique<CurveOverGenerators>(ruled_, other_, plus_, 0.0, 1.0, true));
      return curves;
    }
    const std::size_t n = angles_.size();
    for (std::size_t k = 0; k < n; ++k) {
      if (meets_[k] || !meets_[(k + 1) % n]) continue;
      std::size_t last = k + 1;
      while (meets_[(last + 1) % n]) ++last;
      const double first_angle = close_in(unrolled(k + 1), unrolled(k));
      const double last_angle = close_in(unrolled(last), unrolled(last + 1));
      curves.push_back(std::make_unique<CurveOverGenerators>(ruled_, other_, plus_, first_angle, last_angle, false));
    }
    return curves;
  }

 private:
  Quadratic equation(double turns) const { return other_.along(ruled_.generator(turns)); }

  bool meets(double turns) const {
    const double root = equation(turns).root(plus_);
    return std::isfinite(root) && std::abs(root) <= longest_;
  }

  /// Evenly spaced ones, and where between them the surfaces begin to touch or to part.
  void take_angles() {
    constexpr int samples = 256;
    const auto angle = [](int k) { return static_cast<double>(k) / samples; };
    std::vector<double> discriminants;
    for (int k = 0; k < samples; ++k) discriminants.push_back(equation(angle(k)).discriminant());
    for (int k = 0; k < samples; ++k) {
      const auto at = [&](int i) { return discriminants[static_cast<std::size_t>((i + samples) % samples)]; };
      angles_.push_back(angle(k));
      const double sign = at(k) < 0.0 ? -1.0 : 1.0;
      if (sign * at(k - 1) < sign * at(k) || sign * at(k + 1) < sign * at(k)) continue;
      const double change = std::max(std::abs(at(k) - at(k - 1)), std::abs(at(k) - at(k + 1)));
      if (std::abs(at(k)) > 2.0 * change) continue;
      const auto function = [&](double turns) { return sign * equation(turns).discriminant(); };
      const double extreme = place_of_minimum(function, angle(k - 1), angle(k + 1));
      if (function(extreme) < 0.0) angles_.push_back(extreme - std::floor(extreme));
    }
    std::sort(angles_.begin(), angles_.end());
    for (const double turns : angles_) meets_.push_back(meets(turns));
  }

  double unrolled(std::size_t k) const { return angles_[k % angles_.size()] + static_cast<double>(k / angles_.size()); }

  double close_in(double meeting, double not_meeting) const {
    return last_where([&](double turns) { return meets(turns); }, meeting, not_meeting);
  }

  const Surface& ruled_;
  const Surface& other_;
  bool plus_;
  double longest_;
  std::vector<double> angles_;
  std::vector<bool> meets_;
};

Curves edges_over_generators(const Surface& ruled, const Surface& other, double tolerance) {
  Curves curves;
  for (const bool plus : {false, true})
    for (auto& curve : Pieces(ruled, other, plus, 1e13 * tolerance).curves()) curves.push_back(std::move(curve));
  return curves;
}

/// How far a surface that may be swept from a point by lines misses that: 0 if it is.
double miss(const Surface& surface, const Vector3& point) {
  if (surface.apex()) return (*surface.apex() - point).norm();
  return dynamic_cast<const Plane*>(&surface) != nullptr ? std::abs(surface.depth(point)) : infinity;
}

/// Almost parallel surfaces meet along curves that no even spacing of generators finds.
bool is_exact(double difference, double tolerance, double clear, const char* what) {
  if (difference < tolerance) return true;
  if (difference < clear)
    throw InvalidContainer(message(what, ", but for ", difference, ": make it exact, or differ by ", clear));
  return false;
}

}  // namespace

std::vector<std::unique_ptr<Curve>> edges_between(const Surface& a, const Surface& b, double tolerance) {
  const auto *plane_a = dynamic_cast<const Plane*>(&a), *plane_b = dynamic_cast<const Plane*>(&b);
  const auto *sphere_a = dynamic_cast<const Sphere*>(&a), *sphere_b = dynamic_cast<const Sphere*>(&b);
  if (plane_a && plane_b) return edges_of_planes(*plane_a, *plane_b);
  if (sphere_a && sphere_b) return edges_of_spheres(*sphere_a, *sphere_b);
  if (sphere_a && plane_b)
    return edge_of_sphere(*sphere_a, plane_b->normal(Vector3::Zero()), -plane_b->depth(sphere_a->centre()));
  // A cylinder before a cone: its generators have one direction.
  if (!a.axis() || (a.apex() && b.axis() && !b.apex())) {
    if (!b.axis() && !(plane_a && sphere_b))
      throw InvalidContainer("there is no way to find the edges between two of the shapes of a container");
    return edges_between(b, a, tolerance);
  }
  if (b.revolves_about(*a.axis(), tolerance)) return edges_about_axis(a, b);
  if (!a.apex() && is_exact(b.slant(a.axis()->direction), 1e-12, 1e-3, "the axis of a cylinder is along a surface"))
    return common_generators(a, b, 0.0, tolerance);
  if (a.apex() && is_exact(miss(b, *a.apex()), tolerance, 1e6 * tolerance, "the point of a cone is on a surface"))
    return common_generators(a, b, 1e9 * tolerance, tolerance);
  return edges_over_generators(a, b, tolerance);
}

}  // namespace spot
