// SPDX-License-Identifier: GPL-2.0-only
#include "shaped_walls.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>

#include "spot/geometry/repeated_solid.hpp"
#include "spot/geometry/shapes.hpp"
#include "words.h"

using spot::InvalidParameter;
using spot::message;
using spot::Solid;
using spot::Vector3;

namespace {

struct BoundedSolid {
  Solid solid;
  Vector3 low, high;
  std::optional<ShapedWalls::Upright> upright = std::nullopt;
};

Vector3 read_vector(Words& words, const char* x, const char* y, const char* z) {
  const double at_x = words.number(x), at_y = words.number(y);
  return {at_x, at_y, words.number(z)};
}

/// The axis of a cylinder or cone: along x, y or z, and where it passes the other two.
struct Axis {
  int along, first, second;
  double c1, c2;

  explicit Axis(Words& words) {
    along = one_of<int>(words, "walls", {{"x", 0}, {"y", 1}, {"z", 2}});
    first = along == 0 ? 1 : 0;
    second = along == 2 ? 1 : 2;
    c1 = words.number("c1");
    c2 = words.number("c2");
  }

  Vector3 at(double height) const {
    Vector3 place;
    place[along] = height;
    place[first] = c1;
    place[second] = c2;
    return place;
  }

  /// From `low` to `high` along it, where it has these radii.
  BoundedSolid bounded(const Solid& solid, double low, double high, double radius_low, double radius_high) const {
    Vector3 around = Vector3::Constant(std::max(radius_low, radius_high));
    around[along] = 0.0;
    BoundedSolid all{solid, at(low) - around, at(high) + around};
    if (along == 2) all.upright = ShapedWalls::Upright{c1, c2, low, high, radius_low, radius_high};
    return all;
  }
};

void require_increasing(const char* shape, double low, double high) {
  if (!(low < high))
    throw InvalidParameter(message("'walls ... ", shape, "' needs lo < hi, but they are ", low, " and ", high));
}

BoundedSolid read_block(Words& words) {
  Vector3 low, high;
  const char* names[] = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = words.number(names[2 * axis]);
    high[axis] = words.number(names[2 * axis + 1]);
  }
  return {spot::block(low, high), low, high};
}

BoundedSolid read_cylinder(Words& words) {
  const Axis axis(words);
  const double radius = words.positive("the cylinder's radius"), low = words.number("lo"), high = words.number("hi");
  require_increasing("cylinder", low, high);
  return axis.bounded(spot::cylinder_between(axis.at(low), axis.at(high), radius), low, high, radius, radius);
}

BoundedSolid read_cone(Words& words) {
  const Axis axis(words);
  const double radius_low = words.not_negative("the cone's radius at lo"),
               radius_high = words.not_negative("the cone's radius at hi"), low = words.number("lo"),
               high = words.number("hi");
  require_increasing("cone", low, high);
  return axis.bounded(spot::cone_between(axis.at(low), radius_low, axis.at(high), radius_high), low, high, radius_low,
                      radius_high);
}

BoundedSolid read_sphere(Words& words) {
  const Vector3 centre = read_vector(words, "x", "y", "z");
  const double radius = words.positive("the sphere's radius");
  return {spot::sphere(centre, radius), centre.array() - radius, centre.array() + radius};
}

BoundedSolid read_plane(Words& words) {
  const Vector3 point = read_vector(words, "px", "py", "pz"), normal = read_vector(words, "nx", "ny", "nz");
  const Vector3 endless = Vector3::Constant(std::numeric_limits<double>::infinity());
  return {spot::half_space(point, normal), -endless, endless};
}

/// What others have walls of triangles for.
void refuse_mesh(const Words& words, bool add) {
  for (const char* mesh : {"mesh", "stl", "tet"})
    if (words.next_begins_with(mesh))
      throw InvalidParameter(message("'walls ", add ? "add " : "cut ", mesh, "': there are no walls of triangles; ",
                                     "write the inside as shapes: 'cylinder', 'cone' and 'sphere' where it is round, ",
                                     "'block' where it is flat, 'walls cut plane' for a wall that leans"));
}

}  // namespace

void ShapedWalls::read(Words& words) {
  using Reader = std::function<BoundedSolid(Words&)>;
  const std::size_t first = words.taken();
  const bool add = one_of<bool>(words, "walls", {{"add", true}, {"cut", false}});
  refuse_mesh(words, add);
  const BoundedSolid shape = one_of<Reader>(words, add ? "walls add" : "walls cut",
                                            {{"block", read_block},
                                             {"cone", read_cone},
                                             {"cylinder", read_cylinder},
                                             {"plane", read_plane},
                                             {"sphere", read_sphere}})(words);
  if (!add && shapes_.empty()) throw InvalidParameter("'walls cut' has nothing to cut from: 'walls add' comes first");
  if (add) {
    low_ = shapes_.empty() ? shape.low : low_.cwiseMin(shape.low);
    high_ = shapes_.empty() ? shape.high : high_.cwiseMax(shape.high);
  }
  shapes_.push_back({add, shape.solid, shape.low, shape.high, shape.upright, words.text_since(first)});
}

const ShapedWalls::Upright* ShapedWalls::cone_under_cylinder() const {
  if (shapes_.size() != 2) return nullptr;
  const Shape &below = shapes_[0], &above = shapes_[1];
  if (!above.add || !below.upright || !above.upright) return nullptr;
  const Upright &cone = *below.upright, &cylinder = *above.upright;
  const double slack = 1e-9 * cone.radius_high;
  const auto same = [slack](double a, double b) { return std::abs(a - b) <= slack; };
  const bool fits = cone.x == cylinder.x && cone.y == cylinder.y && same(cone.high, cylinder.low) &&
                    same(cone.radius_high, cylinder.radius_low) && same(cylinder.radius_low, cylinder.radius_high);
  return fits && cone.radius_low < cone.radius_high ? &cone : nullptr;
}

Solid ShapedWalls::solid(const spot::Periodic& periodic) const {
  std::optional<Solid> all;
  for (const Shape& shape : shapes_) {
    try {
      const Solid solid = spot::repeated(shape.solid, shape.low, shape.high, periodic);
      all = !all ? solid : shape.add ? *all | solid : *all & ~solid;
    } catch (const spot::InvalidContainer& e) {
      throw spot::InvalidContainer(message("'walls ", shape.text, "': ", e.what()));
    }
  }
  return *all;
}

std::string ShapedWalls::text() const {
  std::string text;
  for (const Shape& shape : shapes_) text += (text.empty() ? "" : " ") + shape.text;
  return text;
}
