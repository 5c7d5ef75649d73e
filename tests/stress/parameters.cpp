// SPDX-License-Identifier: GPL-2.0-or-later
// Drains a silo with parameters and packings at and beyond the ends of their ranges, and says what became of each.
//
//   stress-parameters                         print the table
//   stress-parameters --short                 fewer values, a quarter of the time
//   stress-parameters --write FILE.csv        write it to a file, too: tests/stress/parameters.csv
//
// Ends with an error if one is neither a valid packing nor a typed error.
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <utility>

#include "stress.hpp"

namespace {

using stress::Scene;

struct Case {
  std::string what, value;
  Scene scene;
  bool odd = false;  ///< counted in the file, not listed
};

using Set = std::function<void(Scene&, double)>;

/// One parameter, all others as in the deck, or as in the time-ordered algorithm of 2006.
void add_values(std::vector<Case>& cases, const std::string& what, const std::vector<double>& values, const Set& set) {
  for (const bool time_ordered : {false, true})
    for (const double value : values) {
      Scene scene;
      if (time_ordered) {
        scene.time_ordered = true;
        scene.relaxation = {};
        scene.set_step_height(0.2);
        scene.time = 1.0;
      }
      set(scene, value);
      cases.push_back({what, spot::message(value), scene});
    }
}

void add_parameters(std::vector<Case>& cases) {
  add_values(cases, "alpha", {0.1, 0.4, 0.8, 1.2, 1.5, 1.7, 1.9}, [](Scene& s, double v) { s.relaxation.alpha = v; });
  add_values(cases, "w / 2.5e-3", {0.01, 1, 2, 5, 10, 20, 50, 100}, [](Scene& s, double v) { s.spots.influence *= v; });
  add_values(cases, "w / 2.5e-3, births fewer by as much", {0.1, 2, 5, 10, 20, 50, 100}, [](Scene& s, double v) {
    s.spots.influence *= v;
    s.spots.injection_rate = s.spots.injection_rate.largest() / v;
  });
  add_values(cases, "R_s / d", {0.6, 1, 1.5, 2, 3, 4, 5, 6}, [](Scene& s, double v) { s.set_radius(v); });
  add_values(cases, "dz / d", {0.005, 0.02, 0.05, 0.1, 0.2, 0.5, 1.2, 2.4},
             [](Scene& s, double v) { s.set_step_height(v); });
  add_values(cases, "nu_s tau / 368", {0.01, 1, 2, 5, 10, 20, 50, 100},
             [](Scene& s, double v) { s.spots.injection_rate *= v; });
  add_values(cases, "dilation c_0", {0, 1e-6, 1e-3, 0.01, 0.03, 0.1, 0.9},
             [](Scene& s, double v) { s.spots.dilation = v; });
  add_values(cases, "critical phi_c", {0.49, 0.5, 0.54, 0.55, 0.602, 0.7, 0.71},
             [](Scene& s, double v) { s.spots.critical_fraction = v; });
  add_values(cases, "critical 0 0.5 dilatancy 0", {0}, [](Scene& s, double v) {
    s.spots.critical_fraction = v;
    s.spots.dilatancy = s.spots.full_strain = v;
  });
  add_values(cases, "exchange length l / d", {0.01, 0.119, 0.12, 0.5, 5, 1e300},
             [](Scene& s, double v) { s.spots.exchange_length = v; });
  add_values(cases, "dilatancy a / d", {0, 1e-6, 0.15, 0.5, 1.176, 1.177, 10},
             [](Scene& s, double v) { s.spots.dilatancy = v; });
  add_values(cases, "full strain s_1 d", {0, 1e-300, 1e-3, 0.2, 0.849, 0.85, 1e300},
             [](Scene& s, double v) { s.spots.full_strain = v; });
  add_values(cases, "spread B", {0, 1e-6, 0.1, 0.6, 2, 2.1}, [](Scene& s, double v) { s.spots.spread = v; });
  add_values(cases, "spread 0.6, walls' kappa", {0, 1e-6, 0.7, 4, 4.1}, [](Scene& s, double v) {
    s.spots.spread = 0.6;
    s.spots.wall_shear = v;
  });
  const auto add_mobility = [&](const std::string& what, const std::vector<double>& values,
                                double spot::Mobility::*part) {
    add_values(cases, what, values, [part](Scene& s, double v) {
      s.spots.spread = 0.6;
      s.spots.mobility = {0.4, 1.0, 1.5};
      s.spots.mobility.*part = v;
    });
  };
  add_mobility("spread 0.6, mobility m_0", {0, 0.01, 0.4, 1, 1.1}, &spot::Mobility::at_rest);
  add_mobility("spread 0.6, mobility H_1 / d", {0, 1e-300, 1e-3, 1, 1e300}, &spot::Mobility::fall);
  add_mobility("spread 0.6, mobility k / d", {0, 1e-6, 1.5, 100, 1e300}, &spot::Mobility::drift);
  add_values(cases, "surface beta", {0, 1e-6, 0.5, 3, 10, 32, 33},
             [](Scene& s, double v) { s.spots.surface_exponent = v; });
  add_values(cases, "outflow held, fade c", {0, 1e-6, 0.25, 2, 2.1}, [](Scene& s, double v) {
    s.spots.holds_outflow = true;
    s.spots.fade = v;
  });
}

/// What the time-ordered algorithm has not.
void add_windowed_parameters(std::vector<Case>& cases) {
  const auto add = [&](const std::string& what, const std::vector<double>& values, const Set& set) {
    for (const double value : values) {
      cases.push_back({what, spot::message(value), {}});
      set(cases.back().scene, value);
    }
  };
  add("momentum", {0, 0.3, 0.6, 0.8, 0.9, 0.95}, [](Scene& s, double v) { s.relaxation.momentum = v; });
  add("momentum, alpha 1.9", {0, 0.6, 0.95}, [](Scene& s, double v) {
    s.relaxation.alpha = 1.9;
    s.relaxation.momentum = v;
  });
  add("contact / d", {1e-6, 1e-4, 5e-3, 0.02, 0.05, 0.06},
      [](Scene& s, double v) { s.relaxation.contact_overlap = v; });
  add("closing g / d, k 0.1", {1e-4, 4e-3, 0.05, 0.06}, [](Scene& s, double v) {
    s.relaxation.closing_gap = v;
    s.relaxation.closing_share = 0.1;
  });
  add("tolerance / d", {1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1}, [](Scene& s, double v) { s.relaxation.tolerance = v; });
  add("window / tau", {1e-3, 0.01, 0.05, 0.1, 0.5, 1}, [](Scene& s, double v) { s.window = v; });
  add("fixed volume / grains", {1, 77, 300, 1e3, 1e5, 1e300}, [](Scene& s, double v) { s.spots.fixed_volume = v; });
  add("speed v_s tau / d", {1e-3, 0.1, 32, 320}, [](Scene& s, double v) { s.spots.speed = v; });
}

/// Grains at these places alone, in d; they may overlap as they like.
Scene scene_of(const std::vector<spot::Vector3>& places, double largest_overlap = 0.03) {
  Scene scene;
  scene.grains.clear();
  for (const spot::Vector3& place : places)
    scene.grains.push_back({static_cast<std::int64_t>(scene.grains.size()) + 1, place});
  scene.largest_overlap = largest_overlap;
  scene.placed_by_hand = true;
  return scene;
}

/// The dense packing with some grains put on top of others.
Scene scene_with_doubles(int every, double largest_overlap) {
  Scene scene;
  const std::vector<spot::Grain> grains = scene.grains;
  // Where spots pass all the time, and there is room, since some neighbours are taken away.
  scene.grains.clear();
  for (std::size_t i = 0; i < grains.size(); ++i)
    if (i % 8 != 0) scene.grains.push_back(grains[i]);
  const std::size_t n = scene.grains.size();
  for (std::size_t i = 0; i < n; i += static_cast<std::size_t>(every)) {
    const spot::Vector3& centre = scene.grains[i].position;
    if (centre.head<2>().norm() < 3.0 && centre.z() < 6.0)
      scene.grains.push_back({static_cast<std::int64_t>(10000 + i), centre});
  }
  scene.spots.critical_fraction = scene.spots.dilatancy = scene.spots.full_strain = 0.0;  // it is too loose for any
  scene.largest_overlap = largest_overlap;
  scene.placed_by_hand = true;
  return scene;
}

Scene gap(double width, double radius) {
  Scene scene;
  scene.half_depth = 0.5 * width;
  scene.orifice = std::min(scene.half_depth, 4.0);
  scene.spots.radius = radius;
  scene.set_no_fixed_volume();
  scene.buffers = {0.0, 0.0};
  scene.grains.clear();
  for (int k = 0; k < 12; ++k)
    for (int i = -5; i <= 5; ++i)
      scene.grains.push_back({static_cast<std::int64_t>(scene.grains.size()) + 1, {1.0 * i, 0.0, 0.5 + 1.001 * k}});
  return scene;
}

void add_packings(std::vector<Case>& cases) {
  cases.push_back({"grains", "none", scene_of({})});
  cases.push_back({"grains", "one, over the orifice", scene_of({{0.3, 0.2, 0.7}})});
  cases.push_back({"grains", "one, far up", scene_of({{0.0, 0.0, 90.0}})});
  cases.push_back({"two grains at one place", "overlap 0.03", scene_of({{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}})});
  cases.push_back({"two grains at one place", "overlap 1.5", scene_of({{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}}, 1.5)});
  cases.push_back({"dense, some grains twice", "overlap 0.03", scene_with_doubles(16, 0.03)});
  cases.push_back({"dense, some grains twice", "overlap 1.5", scene_with_doubles(16, 1.5)});
  cases.push_back(
      {"20 grains at one place", "overlap 1.5", scene_of(std::vector<spot::Vector3>(20, {0, 0, 2.0}), 1.5)});
  cases.push_back(
      {"300 grains at one place", "overlap 1.5", scene_of(std::vector<spot::Vector3>(300, {0, 0, 2.0}), 1.5)});
  cases.push_back({"centres on walls", "side", scene_of({{6, 0, 1}, {-6, 1, 2}, {0, 4, 1}, {1, -4, 1}}, 0.6)});
  cases.push_back({"centres on walls", "corners", scene_of({{6, 4, 0}, {-6, 4, 0}, {6, -4, 3}, {-6, -4, 0}}, 0.6)});
  cases.push_back({"centres on walls", "base and rim", scene_of({{5, 0, 0}, {4, 0, 0}, {0, 3.9, 0}, {0, -4, 0}}, 0.6)});
  cases.push_back({"centres behind walls", "by 1e-9", scene_of({{6.000000001, 0, 1}})});
  for (const double width : {0.9, 1.0, 1.001, 1.2, 1.9})
    cases.push_back({"gap / d, R_s its half", spot::message(width), gap(width, 0.45)});
  {
    Scene scene;
    scene.half_width = scene.half_depth = scene.orifice = 4.0;
    scene.fill(14.0);
    cases.push_back({"orifice", "as wide as the base", scene});
    scene.orifice = 2.59;
    cases.push_back({"orifice", "narrower than a spot", scene});
    scene.orifice = 4.1;
    cases.push_back({"orifice", "wider than the base", scene});
  }
  for (const double far : {1e3, 1e6, 1e8, 1e9, 1e12, 1e300}) {
    Scene scene;
    scene.place = spot::Vector3(far, -far, far);
    cases.push_back({"d from the origin", spot::message(far), scene});
  }
}

/// Numbers that are none, or hardly any, for every parameter.
void add_odd_numbers(std::vector<Case>& cases) {
  const std::vector<std::pair<std::string, std::function<void(Scene&, double)>>> parameters = {
      {"R_s", [](Scene& s, double v) { s.spots.radius = v; }},
      {"w", [](Scene& s, double v) { s.spots.influence = v; }},
      {"dx", [](Scene& s, double v) { s.spots.step_width = v; }},
      {"dz", [](Scene& s, double v) { s.spots.step_height = v; }},
      {"v_s", [](Scene& s, double v) { s.spots.speed = v; }},
      {"c_0", [](Scene& s, double v) { s.spots.dilation = v; }},
      {"nu_s", [](Scene& s, double v) { s.spots.injection_rate = v; }},
      {"volume", [](Scene& s, double v) { s.spots.fixed_volume = v; }},
      {"phi_c", [](Scene& s, double v) { s.spots.critical_fraction = v; }},
      {"l", [](Scene& s, double v) { s.spots.exchange_length = v; }},
      {"a", [](Scene& s, double v) { s.spots.dilatancy = v; }},
      {"s_1", [](Scene& s, double v) { s.spots.full_strain = v; }},
      {"B", [](Scene& s, double v) { s.spots.spread = v; }},
      {"kappa", [](Scene& s, double v) { s.spots.wall_shear = v; }},
      {"beta", [](Scene& s, double v) { s.spots.surface_exponent = v; }},
      {"alpha", [](Scene& s, double v) { s.relaxation.alpha = v; }},
      {"momentum", [](Scene& s, double v) { s.relaxation.momentum = v; }},
      {"contact", [](Scene& s, double v) { s.relaxation.contact_overlap = v; }},
      {"closing g", [](Scene& s, double v) { s.relaxation.closing_gap = v; }},
      {"closing k", [](Scene& s, double v) { s.relaxation.closing_share = v; }},
      {"tolerance", [](Scene& s, double v) { s.relaxation.tolerance = v; }},
      {"window", [](Scene& s, double v) { s.window = v; }},
      {"overlap", [](Scene& s, double v) { s.largest_overlap = v; }},
      {"d", [](Scene& s, double v) { s.diameter = v; }},
      {"orifice", [](Scene& s, double v) { s.orifice = v; }},
      {"buffer", [](Scene& s, double v) { s.buffers.side = v; }},
      {"z of a grain", [](Scene& s, double v) { s.grains[40].position.z() = v; }}};
  const double denormal = std::numeric_limits<double>::denorm_min(), infinite = std::numeric_limits<double>::infinity();
  for (const auto& [name, number] : parameters)
    for (const double value : {denormal, 1e-310, 1e308, infinite, -infinite, std::nan(""), -1.0, -0.0}) {
      Scene scene;
      scene.time = 0.5;
      number(scene, value);
      cases.push_back({name, spot::message(value), scene, true});
    }
}

/// All parameters at once, each from all of its range.
void add_combinations(std::vector<Case>& cases, int number) {
  scenes::Draws draws(2010);
  const auto log_uniform = [&](double low, double high) { return low * std::pow(high / low, draws.uniform(0.0, 1.0)); };
  for (int k = 0; k < number; ++k) {
    Scene scene;
    scene.time_ordered = k % 3 == 0;
    scene.set_radius(log_uniform(0.6, 6.0));
    scene.set_step_height(log_uniform(0.005, 0.5));
    scene.spots.critical_fraction = draws.uniform(0.5, 0.55);
    scene.spots.exchange_length = scene.spots.step_height * log_uniform(0.1, 100.0);
    scene.spots.dilatancy = draws.below(2) == 0 ? 0.0 : scene.spots.radius * log_uniform(1e-3, 0.34);
    scene.spots.full_strain = draws.below(2) == 0 ? 0.0 : log_uniform(1e-3, 3.0) / scene.spots.radius;
    scene.spots.spread = draws.below(2) == 0 ? 0.0 : log_uniform(0.01, 2.0);
    scene.spots.wall_shear = draws.below(2) == 0 ? 0.0 : log_uniform(0.01, 4.0);
    if (draws.below(2) == 0) scene.set_no_fixed_volume();
    scene.spots.surface_exponent = draws.below(2) == 0 ? 0.0 : log_uniform(0.01, 32.0);
    scene.spots.dilation = draws.below(2) == 0 ? 0.0 : log_uniform(1e-3, 0.5);
    scene.spots.influence = 2.5e-3 * log_uniform(0.1, 100.0);
    scene.spots.injection_rate = 368.0 * log_uniform(0.01, 100.0);
    scene.relaxation.alpha = draws.uniform(0.1, 1.9);
    scene.relaxation.momentum = scene.time_ordered ? 0.0 : draws.uniform(0.0, 0.95);
    scene.relaxation.tolerance = log_uniform(1e-4, 0.1);
    // Births and steps grow with time; no more moves than take a second.
    const double moves = scene.time_ordered ? 2e4 : 4e5;
    scene.time =
        std::min(4.0, std::sqrt(2.0 * moves / (scene.spots.injection_rate.largest() * scene.spots.move_rate())));
    cases.push_back(
        {"all at once",
         spot::message("alpha ", scene.relaxation.alpha, ", w ", scene.spots.influence, ", R_s ", scene.spots.radius,
                       ", dz ", scene.spots.step_height, ", nu_s ", scene.spots.injection_rate.largest(), ", c_0 ",
                       scene.spots.dilation, ", phi_c ", scene.spots.critical_fraction, ", l ",
                       scene.spots.exchange_length, ", a ", scene.spots.dilatancy, ", s_1 ", scene.spots.full_strain,
                       ", B ", scene.spots.spread, ", kappa ", scene.spots.wall_shear, ", beta ",
                       scene.spots.surface_exponent, ", momentum ", scene.relaxation.momentum, ", tolerance ",
                       scene.relaxation.tolerance),
         scene, true});
  }
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_parameters(cases);
  add_windowed_parameters(cases);
  add_packings(cases);
  add_odd_numbers(cases);
  add_combinations(cases, 300);
  return cases;
}

/// The table, and how many were neither valid nor an error.
std::pair<std::string, int> drain_all(bool is_short) {
  std::string table = "tried,value,driver,grains,moves,drained,largest overlap (d),largest B,outcome\n";
  std::map<std::string, std::array<int, 3>> odd;  // outcomes
  int number = 0, neither = 0;
  for (Case& c : all_cases()) {
    if (is_short && number++ % 3 != 0) continue;
    if (is_short) c.scene.time *= 0.25;
    const stress::Outcome outcome = stress::drain(c.scene);
    const std::string row = stress::row(c.what, c.value, c.scene, outcome);
    if (outcome.kind == stress::Outcome::neither) ++neither;
    std::cout << row << std::flush;
    if (c.odd)
      ++odd[c.what][outcome.kind];
    else
      table += row;
  }
  for (const auto& [what, counts] : odd)
    table += spot::message(stress::quoted(what),
                           what == "all at once" ? ",drawn from the ranges above,both"
                                                 : ",\"5e-324, 1e-310, 1e308, inf, -inf, nan, -1, -0\",windowed",
                           ",,,,,,\"", counts[stress::Outcome::valid], " valid, ", counts[stress::Outcome::error],
                           " errors\"\n");
  return {table, neither};
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string option = argc > 1 ? argv[1] : "";
    const auto [table, neither] = drain_all(option == "--short");
    const std::string path = option == "--write" && argc > 2 ? argv[2] : "";
    if (option == "--write" && !(std::ofstream(path) << table)) throw spot::Error("cannot write '" + path + "'");
    std::cout << neither << " neither valid nor an error\n";
    return neither == 0 ? 0 : 1;
  } catch (const spot::Error& error) {
    std::cout << "error: " << error.what() << '\n';
    return 1;
  }
}
