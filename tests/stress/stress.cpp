// SPDX-License-Identifier: GPL-2.0-or-later
#include "stress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "spot/drivers/glass_beads.hpp"

namespace stress {

constexpr double deck_radius = 3.53;

Scene::Scene() {
  spots = spot::glass_beads::spots(1.0, 1.0);
  spots.injection_rate = 613.0;
  // The deck's 0.62 is for packings that were poured; this one has 0.54 at rest, to the smallest spots 0.503.
  spots.critical_fraction = 0.5;
  relaxation = spot::glass_beads::relaxation();
  fill(14.0);
}

void Scene::set_step_height(double height) {
  spots.step_height = height;
  spots.step_width = spot::step_width_for(1.47, height);
}

void Scene::set_no_fixed_volume() {
  spots.fixed_volume = spots.critical_fraction = spots.dilatancy = spots.full_strain = spots.spread = 0.0;
}

void Scene::set_radius(double radius) {
  spots.radius = radius;
  spots.fixed_volume = 77.0 * std::pow(radius / deck_radius, 3);
  orifice = std::max(orifice, radius);
  half_width = std::max(half_width, orifice);
  half_depth = std::max(half_depth, orifice);
  fill(14.0);
}

void Scene::fill(double height) {
  grains = scenes::dense_grains({0.5 - half_width, 0.5 - half_depth, 0.5}, {half_width - 0.5, half_depth - 0.5, height},
                                0.01, 2);
}

std::shared_ptr<const spot::Container> Scene::silo() const {
  return spot::box_silo(place.x() - half_width, place.x() + half_width, place.y() - half_depth, place.y() + half_depth,
                        spot::Orifice{place, orifice}, buffers);
}

std::vector<spot::Grain> Scene::placed() const {
  std::vector<spot::Grain> all = grains;
  for (spot::Grain& grain : all) grain.position += place;
  return all;
}

std::unique_ptr<spot::Drainage> Scene::start() const {
  const double extent = place.cwiseAbs().maxCoeff() + 100.0 * diameter;
  if (time_ordered)
    return std::make_unique<spot::TimeOrderedDrainage>(spots, relaxation, limits(), silo(),
                                                       spot::Packing(diameter, extent, placed()));
  return std::make_unique<spot::WindowedDrainage>(spots, relaxation, limits(), window, threads, silo(), diameter,
                                                  extent, placed());
}

namespace {

void follow(const Scene& scene, spot::Drainage& drainage, Outcome& outcome) {
  constexpr int checks = 20;
  const auto silo = scene.silo();
  invariants::Ledger ledger(scene.grains, scene.diameter, scene.limits(), *silo);
  for (int k = 1; k <= checks; ++k) {
    drainage.advance_to(scene.time * k / checks);
    drainage.require_inside();  // as the fix does
    const std::string wrong = ledger.check(drainage);
    if (!wrong.empty()) outcome.text = wrong;
    outcome.counters = drainage.counters();
    outcome.last = ledger.overlaps();
    if (scene.placed_by_hand && k <= checks / 2) continue;
    outcome.largest.largest = std::max(outcome.largest.largest, outcome.last.largest);
    outcome.largest.badness = std::max(outcome.largest.badness, outcome.last.badness);
  }
  // The windowed driver checks all grains every 64 windows: it has this time to find out by itself.
  if (outcome.largest.largest > overlap_bound) drainage.advance_to(scene.time + 65.0 * scene.window);
  if (outcome.text.empty() && outcome.largest.largest > overlap_bound)
    outcome.text = spot::message("overlap of ", outcome.largest.largest, " d");
  if (!outcome.text.empty()) outcome.kind = Outcome::neither;
}

}  // namespace

Outcome drain(const Scene& scene) {
  Outcome outcome;
  try {
    const auto drainage = scene.start();
    follow(scene, *drainage, outcome);
  } catch (const spot::Error& error) {
    outcome.kind = Outcome::error;
    outcome.text = error.what();
  } catch (const std::exception& error) {
    outcome.kind = Outcome::neither;
    outcome.text = spot::message("not a spot::Error: ", error.what());
  }
  return outcome;
}

std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string(2, c) : std::string(1, c);
  return field + '"';
}

std::string row(const std::string& what, const std::string& value, const Scene& scene, const Outcome& outcome) {
  char numbers[200];
  std::snprintf(numbers, sizeof numbers, "%zu,%lld,%lld,%.3f,%.1e", scene.grains.size(),
                static_cast<long long>(outcome.counters.moves), static_cast<long long>(outcome.counters.drained),
                outcome.largest.largest, outcome.largest.badness);
  const char* const kinds[] = {"valid", "error: ", "NEITHER: "};
  return quoted(what) + ',' + quoted(value) + (scene.time_ordered ? ",2006," : ",windowed,") + numbers + ',' +
         quoted(kinds[outcome.kind] + outcome.text) + '\n';
}

}  // namespace stress
