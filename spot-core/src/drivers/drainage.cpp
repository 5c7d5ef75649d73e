// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/drainage.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "spot/base/errors.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/walk/calibration.hpp"
#include "spot/walk/nonaffine_motion.hpp"
#include "spot/walk/packing_at_rest.hpp"

namespace spot {

namespace {

bool by_id(const Grain& a, const Grain& b) { return a.id < b.id; }

/// A grain at rest on the base has its centre this far from it, in diameters; no move may carry one through.
constexpr double longest_displacement = 0.5;

/// Steps of spots, in diameters: longer than any spot is wide, or too short to get anywhere.
constexpr double longest_step = 16.0, shortest_step = 1e-6;

/// Of the fall in which a grain keeps its way, in diameters: with less, ways of their own are noise of every move.
constexpr double least_own_way = 0.01;

/// Spots born while one climbs a diameter. The fitted parameters have 120.
constexpr double most_births = 1e7;

void require_births(const SpotParameters& spots, const Injection& rates, double diameter) {
  const double births = rates.largest() * (diameter / spots.speed);
  if (!(births <= most_births))
    throw InvalidParameter(message("spot injection rate is ", rates.largest(), ": ", births,
                                   " births while a spot climbs one diameter, but at most ", most_births,
                                   " are allowed"));
}

void require_steps(const SpotParameters& spots, double diameter) {
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    throw InvalidParameter(message("grain diameter is ", diameter, " but must be positive and finite"));
  const double longest = std::max(spots.step_width, spots.step_height) / diameter;
  if (!(longest <= longest_step))
    throw InvalidParameter(
        message("steps of spots are ", longest, " diameters long but must be at most ", longest_step));
  if (!(spots.step_height >= shortest_step * diameter))
    throw InvalidParameter(message("spot step height is ", spots.step_height / diameter,
                                   " diameters but must be at least ", shortest_step));
  if (spots.nonaffine > 0.0 && !(spots.nonaffine_length >= least_own_way * diameter))
    throw InvalidParameter(message("length of non-affine motion is ", spots.nonaffine_length / diameter,
                                   " diameters but must be at least ", least_own_way));
  require_births(spots, spots.injection_rate, diameter);
  const double step = std::sqrt(spots.step_width * spots.step_width + spots.step_height * spots.step_height);
  const double displacement =
      spots.influence * largest_weight(spots) * (1.0 + NonaffineMotion::largest(spots.nonaffine)) * (step / diameter);
  if (!(displacement <= longest_displacement))
    throw InvalidParameter(message("a step of a spot displaces grains by up to ", displacement,
                                   " diameters, but at most ", longest_displacement,
                                   " is allowed: less influence or volume, or shorter steps"));
}

}  // namespace

Drainage::Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   std::shared_ptr<const Container> container, double diameter)
    : spots_(spots),
      relaxation_(relaxation),
      container_(std::move(container)),
      diameter_(diameter),
      checks_(limits, container_, diameter) {
  spots_.validate();
  relaxation_.validate();
  require_steps(spots_, diameter);
  container_->require_entrance(spots.equivalent_radius());
  container_->periodic().require_length(
      2.0 * (spots.radius + 2.0 * diameter),
      "twice the sum of the spot radius and two diameters, so that no spot meets itself");
  const double base = container_->outlets().height();
  // A newborn spot is 2 R_s tall, and the middle of its first step is half a step higher.
  const double lowest_reached = base - 2.0 * spots.radius + 0.5 * spots.step_height;
  if (!(limits.outlet > lowest_reached && limits.outlet <= base))
    throw InvalidParameter(message("outlet is at z = ", limits.outlet, " but must be above ", lowest_reached,
                                   ", the reach of newborn spots, and not above the orifice, ", base));
}

double Drainage::weigh(const Move& move, int enclosed, const Spots::Carried& carried) {
  counters_.volume_left += carried.left;
  return fixed_volume_weight(spots_, move.middle.z() - limits().outlet, enclosed, carried.volume);
}

std::vector<Grain> Drainage::grains() const {
  std::vector<Grain> all;
  visit_grains([&](const Grain& grain) { all.push_back(grain); });
  std::sort(all.begin(), all.end(), by_id);
  return all;
}

std::vector<Grain> Drainage::take_drained() {
  std::vector<Grain> drained;
  drained.swap(drained_);
  std::sort(drained.begin(), drained.end(), by_id);
  return drained;
}

void Drainage::add_drained(const std::vector<Grain>& grains, Spots& spots) {
  for (const Grain& grain : grains)
    spots.count_drained(container().nearest_outlet_index(grain.position),
                        volume_parts(diameter_, radius_in(diameter_, grain)));
  drained_.insert(drained_.end(), grains.begin(), grains.end());
  counters_.drained += static_cast<std::int64_t>(grains.size());
}

void Drainage::require_inside(Which which) const {
  const auto require = [&](const Grain& grain) { checks_.require_inside(grain); };
  if (container().concurrent())
    visit_grains_at_once([&require](const Grain& grain, std::size_t) { require(grain); }, which);
  else
    visit_grains(require, which);
}

void Drainage::replace_container(std::shared_ptr<const Container> container) {
  if (container->outlets().size() != container_->outlets().size())
    throw InvalidContainer(message("a container with ", container->outlets().size(),
                                   " outlets cannot take the place of one with ", container_->outlets().size()));
  container_ = std::move(container);
  checks_.replace_container(container_);
  take_new_container();
}

void Drainage::change_rate(std::size_t outlet, double time, double rate) {
  Injection changed = rates();
  if (!changed.change(outlet, time, rate)) return;
  require_births(spots_, changed, diameter_);
  take_new_rates(time, changed);
}

void Drainage::change_grains(const GrainChanges& changes) {
  for (const Grain& grain : changes.come) {
    checks_.require_valid_place(grain);
    checks_.require_off_walls({checks_.depth_in_walls(grain), grain.id, grain.id}, "when it is put in");
  }
  checks_.require_shallow(carry_out(changes), "when they are put in");
}

void Drainage::replace_grains(const std::vector<Grain>& grains) {
  GrainChanges changes;
  std::map<std::int64_t, Grain> old;
  visit_grains([&](const Grain& grain) { old.emplace(grain.id, grain); });
  for (Grain grain : grains) {
    for (double& at : grain.position) at = quantum().snap(at);
    grain.radius = radius_in(diameter_, grain);
    const auto same = old.find(grain.id);
    if (same != old.end() && same->second == grain)
      old.erase(same);
    else
      changes.come.push_back(grain);
  }
  for (const auto& [id, grain] : old) changes.gone.push_back(id);
  change_grains(changes);
}

void Drainage::require_valid_start() {
  Overlap in_wall;  // of the grain with the lowest id among the deepest
  visit_grains([&](const Grain& grain) {
    checks_.require_valid_place(grain);
    const double depth = checks_.depth_in_walls(grain);
    if (depth > in_wall.depth || (depth == in_wall.depth && grain.id < in_wall.first))
      in_wall = {depth, grain.id, grain.id};
  });
  checks_.require_off_walls(in_wall, "at the start");
  checks_.require_shallow(largest_overlap(), "at the start");
}

void Drainage::require_dense_start(Communicator& communicator) const {
  if (spots_.critical_fraction == 0.0) return;
  std::vector<EnclosedGrain> grains;
  visit_grains([&](const Grain& grain) {
    grains.push_back({grain.position, volume_parts(diameter_, radius_in(diameter_, grain))});
  });
  const auto at_rest = packing_at_rest(spots_, container(), diameter_, grains, communicator);
  if (!at_rest || at_rest->critical <= (1.0 + calibration::most_above_rest) * at_rest->fraction) return;
  const double part_left = at_rest->critical / spots_.critical_fraction;  // of phi_c, by walls
  throw InvalidParameter(message("critical packing fraction is ", spots_.critical_fraction, " but must be at most ",
                                 (1.0 + calibration::most_above_rest) * at_rest->fraction / part_left,
                                 ": the packing at rest has ", at_rest->fraction));
}

}  // namespace spot
