// SPDX-License-Identifier: GPL-2.0-or-later
#include "walls.hpp"

#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "arrays.hpp"
#include "spot/base/errors.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/silos.hpp"

namespace spotcore {

namespace {

using Triple = std::array<double, 3>;
using Pair = std::array<double, 2>;
using spot::Vector3;

/// A set of places, none of which is beyond `low` and `high` (length).
struct Shape {
  spot::Solid solid;
  Vector3 low, high;

  static Vector3 endless() { return Vector3::Constant(std::numeric_limits<double>::infinity()); }

  Shape operator|(const Shape& o) const { return {solid | o.solid, low.cwiseMin(o.low), high.cwiseMax(o.high)}; }
  Shape operator&(const Shape& o) const { return {solid & o.solid, low.cwiseMax(o.low), high.cwiseMin(o.high)}; }
  Shape operator-(const Shape& o) const { return {solid & ~o.solid, low, high}; }
  Shape operator~() const { return {~solid, -endless(), endless()}; }
};

/// Around two places, by no more than a radius.
Shape around(const spot::Solid& solid, const Vector3& a, const Vector3& b, double radius) {
  return {solid, a.cwiseMin(b).array() - radius, a.cwiseMax(b).array() + radius};
}

double largest_finite(const Vector3& a, const Vector3& b) {
  double largest = 0.0;
  for (const Vector3& place : {a, b})
    for (const double at : place)
      if (std::isfinite(at)) largest = std::max(largest, std::abs(at));
  return largest;
}

Walls box(const Pair& x, const Pair& y, const std::string& periodic) {
  if (periodic != "" && periodic != "x" && periodic != "y")
    throw spot::InvalidContainer(spot::message("periodic is '", periodic, "' but must be 'x', 'y' or ''"));
  std::optional<spot::Interval> walls[] = {spot::Interval{x[0], x[1]}, spot::Interval{y[0], y[1]}}, period[2];
  const std::string text = spot::message("box from ", x[0], " to ", x[1], " and from ", y[0], " to ", y[1],
                                         periodic.empty() ? "" : ", periodic along ", periodic);
  if (!periodic.empty()) std::swap(walls[periodic == "y"], period[periodic == "y"]);
  const spot::Periodic cell(period[0], period[1]);
  const auto make = [=, wall_x = walls[0], wall_y = walls[1]](const spot::Outlets& outlets,
                                                              const spot::SpotBuffers& buffers) {
    return std::shared_ptr<const spot::Container>(
        spot::box_silo(wall_x, wall_y, cell, outlets.repeated(cell), buffers));
  };
  return {text, make, largest_finite({x[0], x[1], 0.0}, {y[0], y[1], 0.0})};
}

Walls cylinder(double x, double y, double radius) {
  const auto make = [=](const spot::Outlets& outlets, const spot::SpotBuffers& buffers) {
    return std::shared_ptr<const spot::Container>(spot::cylinder_silo(x, y, radius, outlets, buffers));
  };
  return {spot::message("cylinder of radius ", radius, " around (", x, ", ", y, ')'), make,
          largest_finite({x - radius, y - radius, 0.0}, {x + radius, y + radius, 0.0})};
}

Walls inside(const Shape& shape) {
  const auto make = [solid = shape.solid](const spot::Outlets& outlets, const spot::SpotBuffers& buffers) {
    return std::make_shared<const spot::ShapedContainer>(solid, outlets, buffers);
  };
  return {"inside of a shape", make, largest_finite(shape.low, shape.high)};
}

void bind_shape(pybind11::module_& module) {
  py::class_<Shape>(
      module, "Shape",
      R"(A set of places. `a | b` is both, `a & b` what they share, `a - b` what only a has, `~a` all else.

ValueError for numbers that make no shape. All places and radii are lengths.

>>> hopper = Shape.cone((0, 0, 0), 4.0, (0, 0, 15), 10.0) | Shape.cylinder((0, 0, 15), (0, 0, 70), 10.0)
>>> hopper.contains((0, 0, 20)), hopper.contains((9, 0, 1))
(True, False)
)")
      .def_static(
          "block",
          [](const Triple& low, const Triple& high) {
            return around(spot::block(vector_of(low), vector_of(high)), vector_of(low), vector_of(high), 0.0);
          },
          py::arg("low"), py::arg("high"), "Between two corners.")
      .def_static(
          "cylinder",
          [](const Triple& a, const Triple& b, double radius) {
            return around(spot::cylinder_between(vector_of(a), vector_of(b), radius), vector_of(a), vector_of(b),
                          radius);
          },
          py::arg("start"), py::arg("end"), py::arg("radius"), "With flat ends, between their centres.")
      .def_static(
          "cone",
          [](const Triple& a, double radius_a, const Triple& b, double radius_b) {
            return around(spot::cone_between(vector_of(a), radius_a, vector_of(b), radius_b), vector_of(a),
                          vector_of(b), std::max(radius_a, radius_b));
          },
          py::arg("start"), py::arg("radius_at_start"), py::arg("end"), py::arg("radius_at_end"),
          "With flat ends, between their centres; one radius may be 0, and they must differ.")
      .def_static(
          "sphere",
          [](const Triple& centre, double radius) {
            return around(spot::sphere(vector_of(centre), radius), vector_of(centre), vector_of(centre), radius);
          },
          py::arg("centre"), py::arg("radius"), "All around a centre.")
      .def_static(
          "half_space",
          [](const Triple& point, const Triple& normal) {
            return Shape{spot::half_space(vector_of(point), vector_of(normal)), -Shape::endless(), Shape::endless()};
          },
          py::arg("point"), py::arg("normal"), "All on the side of a plane to which `normal` points.")
      .def(py::self | py::self)
      .def(py::self & py::self)
      .def(py::self - py::self)
      .def(~py::self)
      .def(
          "contains", [](const Shape& shape, const Triple& place) { return shape.solid.contains(vector_of(place)); },
          py::arg("place"), "Is this place in it?");
}

}  // namespace

void bind_walls(pybind11::module_& module) {
  bind_shape(module);
  py::class_<Walls>(module, "Walls", R"(What holds the grains. Below the outlets there is nothing.

All numbers are lengths. Walls and outlets meet in Drainage, which refuses with a ValueError what does not fit together.

>>> Walls.box((-8, 8), (-5, 5))
<spotcore.Walls: box from -8 to 8 and from -5 to 5>
)")
      .def_static("box", &box, py::arg("x"), py::arg("y"), py::arg("periodic") = "",
                  R"(Four upright walls on a flat base at the height of the outlets.

x, y: from where to where.
periodic: 'x' or 'y': there are no walls along this axis; space repeats instead, with this interval as its cell.)")
      .def_static("cylinder", &cylinder, py::arg("x"), py::arg("y"), py::arg("radius"),
                  "An upright cylinder around (x, y), on a flat base at the height of the outlets.")
      .def_static("inside", &inside, py::arg("shape"), R"(The inside of a Shape, from the height of the outlets upwards.

>>> Walls.inside(Shape.cone((0, 0, 0), 4.0, (0, 0, 60), 20.0))
<spotcore.Walls: inside of a shape>
)")
      .def("__repr__", [](const Walls& walls) { return "<spotcore.Walls: " + walls.text + '>'; });
}

}  // namespace spotcore
