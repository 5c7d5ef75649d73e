// SPDX-License-Identifier: GPL-2.0-or-later
#include "results.hpp"

#include <pybind11/numpy.h>

#include <algorithm>

#include "spot/drivers/counters.hpp"

namespace py = pybind11;

namespace spotcore {

namespace {

/// One column of a list.
template <typename Number, typename List, typename Get>
py::array_t<Number> column(const List& list, const Get& get) {
  py::array_t<Number> all(static_cast<py::ssize_t>(list.size()));
  std::transform(list.begin(), list.end(), all.mutable_data(), get);
  return all;
}

template <typename List>
py::array_t<double> positions_of(const List& list) {
  py::array_t<double> all({static_cast<py::ssize_t>(list.size()), py::ssize_t{3}});
  double* out = all.mutable_data();
  for (const auto& one : list) out = std::copy_n(one.position.data(), 3, out);
  return all;
}

template <typename Number>
py::array_t<Number> array_of(const std::vector<Number>& list) {
  return py::array_t<Number>(static_cast<py::ssize_t>(list.size()), list.data());
}

}  // namespace

void bind_results(py::module_& module) {
  py::class_<Progress>(module, "Progress", "What a callback is told.")
      .def_readonly("time", &Progress::time, "To which the packing has drained.")
      .def_readonly("until", &Progress::until, "Where this call ends.")
      .def_readonly("grains", &Progress::grains, "How many are left.")
      .def_readonly("drained", &Progress::drained, "How many have left.")
      .def_readonly("spots", &Progress::spots, "How many are in the packing.");
  py::class_<Spots>(module, "Spots", "The spots at one time, in the order of their birth; arrays of M.")
      .def("__len__", [](const Spots& spots) { return spots.all.size(); })
      .def_property_readonly(
          "positions", [](const Spots& spots) { return positions_of(spots.all); }, "(M, 3): middles (length).")
      .def_property_readonly(
          "ids", [](const Spots& spots) { return column<std::int64_t>(spots.all, [](const auto& s) { return s.id; }); },
          "(M,).")
      .def_property_readonly(
          "steps",
          [](const Spots& spots) { return column<std::int64_t>(spots.all, [](const auto& s) { return s.steps; }); },
          "(M,): taken since birth.")
      .def_property_readonly(
          "volumes",
          [](const Spots& spots) { return column<double>(spots.all, [](const auto& s) { return s.volume; }); },
          "(M,): that they carry, over that of a newborn one.");
  py::class_<Drained>(module, "Drained", "Grains that have left, in the order in which they did; arrays of K.")
      .def("__len__", [](const Drained& drained) { return drained.grains.size(); })
      .def_property_readonly(
          "positions", [](const Drained& drained) { return positions_of(drained.grains); },
          "(K, 3): where they left (length).")
      .def_property_readonly(
          "ids",
          [](const Drained& d) { return column<std::int64_t>(d.grains, [](const auto& grain) { return grain.id; }); },
          "(K,).")
      .def_property_readonly(
          "times", [](const Drained& drained) { return array_of(drained.times); },
          "(K,): ends of the windows in which they left (time).")
      .def_property_readonly(
          "outlets", [](const Drained& drained) { return array_of(drained.outlets); },
          "(K,): the place of their outlet in the list of outlets, from 0.");
  using spot::Counters;
  py::class_<Counters>(module, "Counters", "What has happened since the start.")
      .def_readonly("moves", &Counters::moves, "Steps of spots.")
      .def_readonly("sweeps", &Counters::sweeps, "Of the relaxation, over some cells.")
      .def_readonly("grains_swept", &Counters::grains_swept, "Grains in them, each counted every time.")
      .def_readonly("drained", &Counters::drained, "Grains that have left.")
      .def_property_readonly("grains_per_move", &Counters::grains_per_move,
                             "Grain volume that a spot encloses, on average (grains).");
}

}  // namespace spotcore
