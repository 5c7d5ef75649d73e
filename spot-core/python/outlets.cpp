// SPDX-License-Identifier: GPL-2.0-or-later
#include "outlets.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "arrays.hpp"
#include "spot/base/errors.hpp"
#include "spot/drivers/defaults.hpp"
#include "spot/geometry/slot.hpp"

namespace spotcore {

namespace {

using MaybeNumber = std::optional<double>;

Outlet outlet_with(const spot::Outlet& hole, MaybeNumber outflow, MaybeNumber births, MaybeNumber gravity,
                   const Outlet::Schedule& schedule) {
  if (outflow.has_value() + births.has_value() + gravity.has_value() != 1)
    throw spot::InvalidParameter("one of 'outflow', 'births' and 'gravity' is needed, and no more, for the " +
                                 hole.name());
  const Outlet::Rate kind = outflow ? Outlet::Rate::outflow : births ? Outlet::Rate::births : Outlet::Rate::gravity;
  const double rate = outflow ? *outflow : births ? *births : *gravity;
  const char* name = outflow ? "outflow" : births ? "births" : "gravity";
  if (!std::isfinite(rate) || rate < 0.0 || (gravity && rate == 0.0))
    throw spot::InvalidParameter(spot::message(name, " is ", rate, " but must be finite and ",
                                               gravity ? "positive" : "not negative", " (", hole.name(), ')'));
  double last = -1.0;
  for (const auto& [time, factor] : schedule) {
    if (!std::isfinite(time) || time < 0.0 || time <= last)
      throw spot::InvalidParameter(spot::message("schedule has time ", time, " but times must increase from 0 on"));
    if (!std::isfinite(factor) || factor < 0.0)
      throw spot::InvalidParameter(spot::message("schedule has factor ", factor, " but it must not be negative"));
    last = time;
  }
  return {hole, kind, rate, schedule};
}

constexpr const char* rates = R"(
centre: where its middle is (length); all outlets are at one height.
outflow: grains that leave per time, as measured; births follow what leaves, so that no less does; or
births: spots that enter per time (Parameters.births_for() of an outflow): of what they bring some is lost; or
gravity: length / time^2; the outflow follows from Beverloo's law, which is for flat bases, and is held.
schedule: pairs (time, factor): from a time on, so many times the rate; 0 closes it to spots.

ValueError unless just one of the three is given, and times increase.
)";

}  // namespace

double Outlet::full_births(const spot::SpotParameters& spots, double diameter) const {
  if (kind == Rate::births) return rate;
  if (kind == Rate::outflow) return spot::births_for(rate, spots, diameter);
  const double outflow = spot::predicted_outflow(*hole.hole, {}, rate, diameter);
  if (outflow == 0.0)
    throw spot::InvalidParameter("Beverloo's law predicts no outflow through the " + hole.name() +
                                 ", which is too narrow");
  return spot::births_for(outflow, spots, diameter);
}

spot::RateSchedule Outlet::births(const spot::SpotParameters& spots, double diameter) const {
  const double births = full_births(spots, diameter);
  std::vector<spot::RateStep> steps;
  if (schedule.empty() || schedule.front().first > 0.0) steps.push_back({0.0, births});
  for (const auto& [time, factor] : schedule) steps.push_back({time, factor * births});
  return spot::RateSchedule(steps);
}

spot::Outlets holes_of(const std::vector<Outlet>& outlets) {
  std::vector<spot::Outlet> holes;
  for (const Outlet& outlet : outlets) holes.push_back(outlet.hole);
  return spot::Outlets(holes);
}

spot::Injection injection_of(const std::vector<Outlet>& outlets, const spot::SpotParameters& spots, double diameter) {
  std::vector<spot::RateSchedule> births;
  for (const Outlet& outlet : outlets) {
    births.push_back(outlet.births(spots, diameter));
    const double width = 2.0 * outlet.hole.hole->widest_radius() / diameter;
    if (outlet.kind != Outlet::Rate::gravity || width >= spot::BeverlooLaw::least_width) continue;
    const std::string doubt = spot::message("the ", outlet.hole.name(), " is ", width, " diameters wide: below ",
                                            spot::BeverlooLaw::least_width,
                                            " grains may clog, which neither Beverloo's law nor the spot model knows");
    if (PyErr_WarnEx(PyExc_UserWarning, doubt.c_str(), 1) != 0) throw py::error_already_set();
  }
  return spot::Injection(births);
}

bool holds_outflow(const std::vector<Outlet>& outlets) {
  const auto by_births = [](const Outlet& outlet) { return outlet.kind == Outlet::Rate::births; };
  if (std::none_of(outlets.begin(), outlets.end(), by_births)) return true;
  if (std::all_of(outlets.begin(), outlets.end(), by_births)) return false;
  throw spot::InvalidParameter("give 'births' for all outlets or for none: where an outflow is held, births follow it");
}

void bind_outlets(pybind11::module_& module) {
  static const std::string round = std::string("A circular hole of this radius (length).\n") + rates;
  static const std::string slot =
      std::string("A rectangular hole with sides along x and y, of these two widths (length).\n") + rates;
  py::class_<Outlet>(module, "Outlet", R"(A horizontal hole: where grains leave and spots enter.

>>> Outlet.round((0, 0, 0), 4.0, outflow=40.0, schedule=[(100.0, 0.5)])
<spotcore.Outlet: orifice of radius 4 at (0, 0, 0)>
)")
      .def_static(
          "round",
          [](const std::array<double, 3>& centre, double radius, MaybeNumber outflow, MaybeNumber births,
             MaybeNumber gravity, const Outlet::Schedule& schedule) {
            return outlet_with(spot::Orifice{vector_of(centre), radius}, outflow, births, gravity, schedule);
          },
          py::arg("centre"), py::arg("radius"), py::kw_only(), py::arg("outflow") = py::none(),
          py::arg("births") = py::none(), py::arg("gravity") = py::none(), py::arg("schedule") = Outlet::Schedule(),
          round.c_str())
      .def_static(
          "slot",
          [](const std::array<double, 3>& centre, const std::array<double, 2>& widths, MaybeNumber outflow,
             MaybeNumber births, MaybeNumber gravity, const Outlet::Schedule& schedule) {
            return outlet_with({vector_of(centre), std::make_shared<spot::Slot>(widths[0], widths[1])}, outflow, births,
                               gravity, schedule);
          },
          py::arg("centre"), py::arg("widths"), py::kw_only(), py::arg("outflow") = py::none(),
          py::arg("births") = py::none(), py::arg("gravity") = py::none(), py::arg("schedule") = Outlet::Schedule(),
          slot.c_str())
      .def("__repr__", [](const Outlet& outlet) { return "<spotcore.Outlet: " + outlet.hole.name() + '>'; });
}

}  // namespace spotcore
