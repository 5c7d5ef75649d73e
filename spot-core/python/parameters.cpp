// SPDX-License-Identifier: GPL-2.0-or-later
#include "parameters.hpp"

#include <pybind11/pybind11.h>

#include <cmath>
#include <string>

#include "spot/base/errors.hpp"
#include "spot/drivers/defaults.hpp"
#include "spot/drivers/glass_beads.hpp"
#include "spot/relaxation/calibration.hpp"

namespace py = pybind11;

namespace spotcore {

namespace {

void require_positive(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw spot::InvalidParameter(spot::message(name, " is ", value, " but must be positive and finite"));
}

/// Sets attributes by their names.
void change(py::object& parameters, const py::kwargs& changes) {
  for (const auto& [name, value] : changes) {
    if (!py::hasattr(parameters, name) || PyCallable_Check(parameters.attr(name).ptr()) != 0 ||
        name.cast<std::string>() == "diameter")
      throw spot::InvalidParameter("there is no parameter '" + name.cast<std::string>() + "' to change");
    try {
      parameters.attr(name) = value;
    } catch (py::error_already_set& error) {
      if (!error.matches(PyExc_TypeError)) throw;
      throw spot::InvalidParameter(std::string(py::str(name)) + " cannot be " + std::string(py::repr(value)));
    }
  }
}

const spot::InfluenceProfile* profile_named(const std::string& name) {
  std::string known;
  for (const spot::InfluenceProfile* profile : spot::InfluenceProfile::all()) {
    if (profile->name() == name) return profile;
    known += std::string(known.empty() ? "'" : ", '") + profile->name() + "'";
  }
  throw spot::InvalidParameter("profile is '" + name + "' but must be one of " + known);
}

using Class = py::class_<Parameters>;

/// A number; `of` gives the part of Parameters that has it.
template <typename Of, typename Part, typename Number>
void number_of(Class& bound, const char* name, Of of, Number Part::*member, const char* text) {
  bound.def_property(
      name, [=](Parameters& parameters) { return of(parameters).*member; },
      [=](Parameters& parameters, Number value) { of(parameters).*member = value; }, text);
}

/// A number of one of the parts of Parameters.
template <typename Part, typename Number>
void number(Class& bound, const char* name, Part Parameters::*part, Number Part::*member, const char* text) {
  number_of(
      bound, name, [=](Parameters& parameters) -> Part& { return parameters.*part; }, member, text);
}

void bind_mobility(Class& c) {
  using M = spot::Mobility;
  const auto of = [](Parameters& parameters) -> M& { return parameters.spots.mobility; };
  number_of(c, "mobility", of, &M::at_rest,
            "m_0: of what has not fallen, over that of what has fallen far. 1: all is mobile.");
  number_of(c, "mobility_fall", of, &M::fall, "H_1: of the fall that makes a packing mobile (length).");
  number_of(c, "mobility_drift", of, &M::drift,
            "k: of spots towards what is mobile, for each length that they climb (length).");
}

void bind_numbers(Class& c) {
  using S = spot::SpotParameters;
  using R = spot::RelaxationParameters;
  using B = spot::SpotBuffers;
  constexpr auto spots = &Parameters::spots;
  constexpr auto relaxation = &Parameters::relaxation;
  constexpr auto buffers = &Parameters::buffers;
  number(c, "radius", spots, &S::radius, "R_s: grains with centres this close to a spot's step move with it (length).");
  number(c, "influence", spots, &S::influence, "w: a step dr of the spot moves them by -w dr.");
  c.def_readwrite("diffusion_length", &Parameters::diffusion_length,
                  "b_s: of the spots' walk, the variance along x over twice the height (length).");
  number(c, "step_height", spots, &S::step_height, "dz: a step goes up by it (length).");
  number(c, "speed", spots, &S::speed, "v_s: mean speed at which spots climb (length / time).");
  number(c, "volume", spots, &S::fixed_volume, "N: a spot carries the free volume of w N grains. 0: of those in it.");
  number(c, "persistence", spots, &S::persistence, "p: the chance that a step goes the way of the last one.");
  number(c, "dilation", spots, &S::dilation,
         "c_0: the share of spots in the volume at which they climb at v_s. 0: v_s.");
  number(c, "critical_fraction", spots, &S::critical_fraction, "phi_c: packing fraction of what flows. 0: none.");
  number(c, "exchange_length", spots, &S::exchange_length, "Of climb, in which spots bring a packing to it (length).");
  number(c, "dilatancy", spots, &S::dilatancy, "a: shear s for each length of fall lowers phi_c by a s (length).");
  number(c, "full_strain", spots, &S::full_strain,
         "s_1: strain for each length of fall from which spots exchange volume in full. 0: everywhere (1 / length).");
  number(c, "spread", spots, &S::spread, "B: sheared by s, free volume spreads sideways by B / s; 0: by b_s.");
  number(c, "wall_shear", spots, &S::wall_shear, "kappa: walls shear by kappa over their half-width.");
  bind_mobility(c);
  number(c, "surface_exponent", spots, &S::surface_exponent,
         "beta: how much rather spots go where the surface is higher.");
  number(c, "fade", spots, &S::fade,
         "c: the outflow fades by 1 - exp(-H / (c D)), H being the bed's depth over it. 0: not.");
  number(c, "nonaffine", spots, &S::nonaffine, "S: how much grains go against their neighbours.");
  number(c, "nonaffine_length", spots, &S::nonaffine_length, "l: of fall in which a grain goes the same way (length).");
  number(c, "together", spots, &S::together, "All spots step at the same times.");
  number(c, "seed", spots, &S::seed, "Of all random numbers.");
  number(c, "tolerance", relaxation, &R::tolerance, "Rms overlap that moves may build up between sweeps (diameters).");
  number(c, "alpha", relaxation, &R::alpha, "Share of an overlap that is taken back in one sweep.");
  number(c, "momentum", relaxation, &R::momentum, "Share of a grain's last correction that is added to the next.");
  number(c, "contact_overlap", relaxation, &R::contact_overlap, "At which two grains are left alone (diameters).");
  number(c, "closing_gap", relaxation, &R::closing_gap, "Gaps below this are closed (diameters).");
  number(c, "closing_share", relaxation, &R::closing_share, "By this share of what an overlap is pushed apart by.");
  number(c, "side_buffer", buffers, &B::side, "How far spots stay from side walls (length).");
  number(c, "base_buffer", buffers, &B::base, "How far spots stay from the base (length).");
  c.def_readwrite("largest_overlap", &Parameters::largest_overlap, "Allowed in the packing at the start (diameters).");
}

}  // namespace

Parameters::Parameters(double d, double tau) : diameter(d) {
  require_positive("diameter", d);
  require_positive("tau", tau);
  spots = spot::glass_beads::spots(d, tau);
  diffusion_length = spot::glass_beads::diffusion_length * d;
  relaxation = spot::glass_beads::relaxation();
  buffers = {spot::calibration::side_buffer * d, spot::calibration::base_buffer * d};
  largest_overlap = spot::calibration::largest_overlap_at_start;
}

spot::SpotParameters Parameters::complete() const {
  spot::SpotParameters all = spots;
  all.step_width = spot::step_width_for(diffusion_length, all.step_height, all.persistence);
  return all;
}

void bind_parameters(pybind11::module_& module) {
  Class bound(module, "Parameters",
              R"(All numbers of the spot model, but how many spots enter: attributes that can be set.

Drainage copies them, and refuses by a ValueError what is outside its range. docs/model.md has the symbols.

>>> parameters = Parameters.glass_beads(1.0, 1.0, seed=7)
>>> parameters.seed, parameters.influence, parameters.speed
(7, 0.0015, 6.0)
>>> parameters.surface_exponent = 3.0
)");
  bound.def_static(
      "glass_beads",
      [](double diameter, double tau, const py::kwargs& changes) {
        py::object parameters = py::cast(Parameters(diameter, tau));
        change(parameters, changes);
        return parameters;
      },
      py::arg("diameter"), py::arg("tau"), R"(Those of glass beads with a friction of 0.5, fitted to DEM.

diameter: of the grains (length).
tau: sqrt(diameter / gravity) (time).
Keywords: attributes that are to have other values.

Other frictions and shapes of grains are other materials. ValueError unless both are positive, and for keywords that are
no parameters.)");
  bound.def_readonly("diameter", &Parameters::diameter, "Of the grains that they are for (length).");
  bind_numbers(bound);
  bound.def_property(
      "profile", [](const Parameters& parameters) { return parameters.spots.profile->name(); },
      [](Parameters& parameters, const std::string& name) { parameters.spots.profile = profile_named(name); },
      "How influence falls off within R_s: 'parabolic' or 'uniform'. radius and momentum go with it.");
  bound.def(
      "births_for",
      [](const Parameters& parameters, double outflow) {
        return spot::births_for(outflow, parameters.complete(), parameters.diameter);
      },
      py::arg("outflow"), R"(Spots that are to enter per time for so many grains to leave per time.

>>> round(Parameters.glass_beads(1.0, 1.0).births_for(11.55), 9)
100.0
)");
  bound.def("__repr__", [](const Parameters& parameters) {
    return spot::message("<spotcore.Parameters for grains of diameter ", parameters.diameter, '>');
  });
}

}  // namespace spotcore
