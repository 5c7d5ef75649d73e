// SPDX-License-Identifier: GPL-2.0-or-later
#include "packing.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "spot/base/errors.hpp"

namespace spotcore {

namespace {

Doubles radii_of(const py::object& radius, py::ssize_t n) {
  const py::array one = py::array::ensure(radius);
  if (!one || one.ndim() > 0 || std::string("fiu").find(one.dtype().kind()) == std::string::npos)
    return copy_of_numbers(radius, "radius", n);
  Doubles radii(n);
  std::fill_n(radii.mutable_data(), n, radius.cast<double>());
  return radii;
}

Integers ids_of(const py::object& ids, py::ssize_t n) {
  if (!ids.is_none()) return copy_of_integers(ids, "ids", n);
  Integers all(n);
  for (py::ssize_t i = 0; i < n; ++i) all.mutable_data()[i] = i + 1;
  return all;
}

Booleans held_of(const py::object& held, py::ssize_t n) {
  if (!held.is_none()) return copy_of_booleans(held, "held", n);
  Booleans all(n);
  std::fill_n(all.mutable_data(), n, false);
  return all;
}

/// Layers of a lattice along an axis, from wall to wall.
struct Layers {
  double first = 0.0, spacing = 0.0;
  int count = 0;

  Layers(double low, double high, double diameter, double least) {
    const double room = high - low - diameter;
    if (!(room / least < 1e4))
      throw spot::InvalidParameter(spot::message("the block, from ", low, " to ", high, ", is too long"));
    if (room < 0.0) return;
    const int gaps = static_cast<int>(room / least);
    count = gaps + 1;
    spacing = gaps > 0 ? room / gaps : 0.0;
    first = low + 0.5 * (diameter + (gaps > 0 ? 0.0 : room));
  }
};

/// Body-centred: the places of a cubic lattice whose three numbers are all even or all odd.
Doubles lattice(const std::array<double, 3>& low, const std::array<double, 3>& high, double diameter) {
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    throw spot::InvalidParameter(spot::message("diameter is ", diameter, " but must be positive and finite"));
  const double least = 0.58 * diameter;  // neighbours are sqrt(3) times as far apart: none in touch
  const Layers x(low[0], high[0], diameter, least), y(low[1], high[1], diameter, least),
      z(low[2], high[2], diameter, least);
  std::vector<double> all;
  for (int k = 0; k < z.count; ++k)
    for (int j = k % 2; j < y.count; j += 2)
      for (int i = k % 2; i < x.count; i += 2)
        all.insert(all.end(), {x.first + i * x.spacing, y.first + j * y.spacing, z.first + k * z.spacing});
  Doubles positions({static_cast<py::ssize_t>(all.size() / 3), py::ssize_t{3}});
  std::copy(all.begin(), all.end(), positions.mutable_data());
  return positions;
}

}  // namespace

Packing::Packing(const py::object& positions, const py::object& radius, const py::object& ids, const py::object& held)
    : positions_(copy_of_positions(positions, "positions")),
      radii_(radii_of(radius, positions_.shape(0))),
      ids_(ids_of(ids, positions_.shape(0))),
      held_(held_of(held, positions_.shape(0))) {
  find_sizes();
}

Packing::Packing(Doubles positions, Doubles radii, Integers ids, Booleans held)
    : positions_(std::move(positions)), radii_(std::move(radii)), ids_(std::move(ids)), held_(std::move(held)) {
  find_sizes();
}

void Packing::find_sizes() {
  const double* radii = radii_.data();
  for (std::size_t i = 0; i < size(); ++i)
    if (!(radii[i] > 0.0) || !std::isfinite(radii[i]))
      throw spot::InvalidPacking(
          spot::message("radius of grain ", ids_.data()[i], " is ", radii[i], " but must be positive and finite"));
  if (size() > 0) {
    const auto [least, most] = std::minmax_element(radii, radii + size());
    smallest_radius_ = *least;
    largest_radius_ = *most;
  }
  positions_ = read_only(positions_);
  radii_ = read_only(radii_);
  ids_ = read_only(ids_);
  held_ = read_only(held_);
}

std::vector<spot::Grain> Packing::grains() const {
  const bool equal = smallest_radius_ == largest_radius_;  // which is faster
  std::vector<spot::Grain> grains;
  grains.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const double* at = positions_.data() + 3 * i;
    grains.push_back({ids_.data()[i], {at[0], at[1], at[2]}, held_.data()[i], equal ? 0.0 : radii_.data()[i]});
  }
  return grains;
}

double Packing::extent() const {
  double extent = 0.0;
  for (py::ssize_t i = 0; i < positions_.size(); ++i)
    if (const double at = std::abs(positions_.data()[i]); std::isfinite(at)) extent = std::max(extent, at);
  return extent;
}

void bind_packing(py::module_& module) {
  py::class_<Packing>(module, "Packing", R"(Grains: spheres, at rest and dense.

Attributes are arrays that cannot be written.

>>> import numpy as np
>>> packing = Packing(np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 1.5]]), 0.5)
>>> len(packing), packing.diameter, packing.ids.tolist()
(2, 1.0, [1, 2])
)")
      .def(py::init<const py::object&, const py::object&, const py::object&, const py::object&>(), py::arg("positions"),
           py::arg("radius"), py::arg("ids") = py::none(), py::arg("held") = py::none(),
           R"(Copies arrays of N grains.

positions: (N, 3), centres (length).
radius: a number or (N,) (length). With radii that are not equal, the smallest is at least half of the largest.
ids: (N,), integers of 0 or more, each once; 1 to N by default.
held: (N,), booleans; grains that never move, obstacles. By default none.

ValueError for another shape, or another kind of numbers, and for radii that are not positive.)")
      .def("__len__", &Packing::size)
      .def("__repr__",
           [](const Packing& p) {
             return spot::message("<spotcore.Packing of ", p.size(), " grains, diameter ", p.diameter(), '>');
           })
      .def_property_readonly("positions", &Packing::positions, "(N, 3): centres (length).")
      .def_property_readonly("radii", &Packing::radii, "(N,) (length).")
      .def_property_readonly("ids", &Packing::ids, "(N,).")
      .def_property_readonly("held", &Packing::held, "(N,): those that never move.")
      .def_property_readonly("diameter", &Packing::diameter, "Of the largest grains (length); 0 if there are none.");
  module.def("lattice", &lattice, py::arg("low"), py::arg("high"), py::arg("diameter"),
             R"(Centres, (N, 3), of grains that fill a block as densely as a poured packing, with about 0.65.

low, high: corners of the block, within which the whole grains are (length).
diameter: of the grains (length).

They stand on a body-centred lattice, on which none are in touch. To try things out: a packing that was poured flows
otherwise.

>>> lattice((0, 0, 0), (2.3, 1, 1), 1.0)
array([[0.5, 0.5, 0.5],
       [1.8, 0.5, 0.5]])

ValueError unless the diameter is positive and finite.)");
}

}  // namespace spotcore
