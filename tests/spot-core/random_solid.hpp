// SPDX-License-Identifier: GPL-2.0-or-later
// Solids drawn at random, each once as spot-core has them and once as what a ray passes of them, found independently:
// a shape without overhangs is inside along one stretch of a ray, and a solid is a combination of stretches.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/shapes.hpp"

namespace scenes {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The part of a ray inside a convex shape; none if it begins behind its end.
struct Stretch {
  double begin = -infinity, end = infinity;
};

/// Of a s^2 + 2 b s + c, in increasing order, without cancellation.
inline std::pair<double, double> roots(double a, double b, double c) {
  const double q = -(b + std::copysign(std::sqrt(std::max(0.0, b * b - a * c)), b));
  return std::minmax({q / a, q == 0.0 ? 0.0 : c / q});
}

/// Where a s^2 + 2 b s + c is not positive, for a shape in which that is one stretch.
inline Stretch not_positive(double a, double b, double c) {
  if (a == 0.0) {
    if (b == 0.0) return c <= 0.0 ? Stretch{} : Stretch{1.0, 0.0};
    return b > 0.0 ? Stretch{-infinity, -0.5 * c / b} : Stretch{-0.5 * c / b, infinity};
  }
  if (b * b - a * c < 0.0) return a > 0.0 ? Stretch{1.0, 0.0} : Stretch{};
  const auto [low, high] = roots(a, b, c);
  return {low, high};
}

inline Stretch common(const Stretch& a, const Stretch& b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

using Ray = spot::Line;
using Convex = std::function<Stretch(const Ray&)>;

inline Convex convex_half_space(const spot::Vector3& point, const spot::Vector3& normal) {
  return [=](const Ray& ray) {
    return not_positive(0.0, -0.5 * normal.dot(ray.direction), -normal.dot(ray.origin - point));
  };
}

inline Convex convex_sphere(const spot::Vector3& centre, double radius) {
  return [=](const Ray& ray) {
    const spot::Vector3 out = ray.origin - centre;
    return not_positive(ray.direction.squaredNorm(), out.dot(ray.direction), out.squaredNorm() - radius * radius);
  };
}

inline Convex convex_cylinder(const spot::Vector3& point, const spot::Vector3& axis, double radius) {
  return [=](const Ray& ray) {
    const spot::Vector3 u = ray.direction.cross(axis), v = (ray.origin - point).cross(axis);
    return not_positive(u.squaredNorm(), u.dot(v), v.squaredNorm() - radius * radius * axis.squaredNorm());
  };
}

/// Only its nappe above the point.
inline Convex convex_cone(const spot::Vector3& point, const spot::Vector3& axis, double slope) {
  return [=](const Ray& ray) {
    const spot::Vector3 n = axis.normalized(), start = ray.origin - point;
    const spot::Vector3 u = ray.direction.cross(n), v = start.cross(n);
    const double rise = slope * n.dot(ray.direction), up = slope * n.dot(start);
    const Stretch above = convex_half_space(point, n)(ray);
    const double a = u.squaredNorm() - rise * rise, b = u.dot(v) - rise * up, c = v.squaredNorm() - up * up;
    if (a >= 0.0) return common(above, not_positive(a, b, c));
    // Steeper than the cone: inside from the later root on if it rises, up to the earlier one if it falls.
    const auto [low, high] = roots(a, b, c);
    return common(above, rise > 0.0 ? Stretch{high, infinity} : Stretch{-infinity, low});
  };
}

/// A solid and its double.
class RandomSolid {
 public:
  explicit RandomSolid(std::uint64_t seed) : draws_(seed) {
    whole_ = combination(2 + draws_.below(3));
    solid_ = std::make_unique<spot::Solid>(whole_->solid);
  }

  const spot::Solid& solid() const { return *solid_; }
  const std::string& description() const { return whole_->name; }
  Draws& draws() { return draws_; }

  bool contains(const spot::Vector3& place) const {
    return inside(*whole_, {place, spot::Vector3(0.36, 0.48, 0.8)}, 0.0);
  }

  /// How far it is along a ray of unit direction to where the ray goes in or out; infinity if it does not.
  double first_change(const Ray& ray) const {
    std::vector<double> changes;
    collect(*whole_, ray, changes);
    std::sort(changes.begin(), changes.end());
    double before = 0.0;
    const bool starts = inside(*whole_, ray, 0.0);
    for (const double change : changes) {
      // Shapes that touch have no gap between them.
      if (change - before > 1e-9 && inside(*whole_, ray, 0.5 * (before + change)) != starts) return before;
      before = change;
    }
    return inside(*whole_, ray, before + 1.0) != starts ? before : infinity;
  }

 private:
  struct Node {
    spot::Solid solid;
    std::string name;
    std::vector<Convex> convex;  // their common part
    char operation = ' ';        // or of these, or the complement of the first
    std::vector<std::shared_ptr<Node>> parts;
  };

  static bool inside(const Node& node, const Ray& ray, double at) {
    if (node.operation == '&') return inside(*node.parts[0], ray, at) && inside(*node.parts[1], ray, at);
    if (node.operation == '|') return inside(*node.parts[0], ray, at) || inside(*node.parts[1], ray, at);
    if (node.operation == '~') return !inside(*node.parts[0], ray, at);
    return std::all_of(node.convex.begin(), node.convex.end(), [&](const Convex& convex) {
      const Stretch stretch = convex(ray);
      return stretch.begin <= at && at <= stretch.end;
    });
  }

  static void collect(const Node& node, const Ray& ray, std::vector<double>& changes) {
    for (const auto& part : node.parts) collect(*part, ray, changes);
    for (const Convex& convex : node.convex) {
      const Stretch stretch = convex(ray);
      for (const double change : {stretch.begin, stretch.end})
        if (change > 0.0 && std::isfinite(change)) changes.push_back(change);
    }
  }

  std::shared_ptr<Node> combination(std::size_t shapes) {
    if (shapes == 1) {
      auto one = shape();
      if (draws_.below(4) != 0) return one;
      return std::make_shared<Node>(Node{~one->solid, "~" + one->name, {}, '~', {one}});
    }
    const std::size_t left = 1 + draws_.below(shapes - 1);
    const auto a = combination(left), b = combination(shapes - left);
    const std::string name_a = "(" + a->name, name_b = b->name + ")";
    if (draws_.below(2) == 0)
      return std::make_shared<Node>(Node{a->solid & b->solid, name_a + " & " + name_b, {}, '&', {a, b}});
    return std::make_shared<Node>(Node{a->solid | b->solid, name_a + " | " + name_b, {}, '|', {a, b}});
  }

  /// Half of them along the axes, at places that others have, too, so that shapes meet in each other's faces and rims.
  std::shared_ptr<Node> shape() {
    const bool neat = draws_.below(2) == 0;
    const auto length = [&](double low, double high) {
      const double drawn = draws_.uniform(low, high);
      return neat ? std::max(0.5, 0.5 * std::round(2.0 * drawn)) : drawn;
    };
    spot::Vector3 from = draws_.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5});
    spot::Vector3 axis = draws_.in_box({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0});
    if (neat) {
      for (double& at : from) at = std::round(at);
      if (draws_.below(2) == 0) from.x() = from.y() = 0.0;
      axis = spot::Vector3::Unit(draws_.below(3) == 0 ? static_cast<Eigen::Index>(draws_.below(2)) : 2);
      if (draws_.below(2) == 0) axis = -axis;
    }
    if (axis.norm() < 0.3) axis = spot::Vector3::UnitZ();
    axis = axis.normalized();
    const spot::Vector3 to = from + length(0.5, 2.0) * axis;
    const double radius = length(0.4, 1.5), wider = radius + length(0.3, 1.2), slope = length(0.3, 1.5);
    const Convex ends_from = convex_half_space(from, axis), ends_to = convex_half_space(to, -axis);
    const auto made = [&](const spot::Solid& solid, const char* name, std::vector<Convex> convex) {
      const spot::Vector3 &f = from, &t = to;
      return std::make_shared<Node>(Node{solid,
                                         spot::message(name, "[", f.x(), " ", f.y(), " ", f.z(), " -> ", t.x(), " ",
                                                       t.y(), " ", t.z(), ", r ", radius, " ", wider, " ", slope, "]"),
                                         std::move(convex),
                                         ' ',
                                         {}});
    };
    switch (draws_.below(7)) {
      case 0:
        return made(spot::half_space(from, axis), "half space", {ends_from});
      case 1:
        return made(spot::sphere(from, radius), "sphere", {convex_sphere(from, radius)});
      case 2:
        return made(spot::cylinder(from, axis, radius), "cylinder", {convex_cylinder(from, axis, radius)});
      case 3:
        return made(spot::cylinder_between(from, to, radius), "pipe",
                    {convex_cylinder(from, axis, radius), ends_from, ends_to});
      case 4:
        return made(spot::cone(from, axis, slope), "cone", {convex_cone(from, axis, slope)});
      case 5: {
        const bool pointed = draws_.below(3) == 0;
        const double narrow = pointed ? 0.0 : radius, rise = (wider - narrow) / (to - from).norm();
        return made(spot::cone_between(from, narrow, to, wider), pointed ? "pointed" : "frustum",
                    {convex_cone(from - narrow / rise * axis, axis, rise), ends_from, ends_to});
      }
      default: {
        const spot::Vector3 high = from + spot::Vector3(radius, wider, slope);
        std::vector<Convex> convex;
        for (int k = 0; k < 3; ++k) {
          convex.push_back(convex_half_space(from, spot::Vector3::Unit(k)));
          convex.push_back(convex_half_space(high, -spot::Vector3::Unit(k)));
        }
        return made(spot::block(from, high), "block", std::move(convex));
      }
    }
  }

  Draws draws_;
  std::shared_ptr<Node> whole_;
  std::unique_ptr<spot::Solid> solid_;
};

}  // namespace scenes
