// SPDX-License-Identifier: GPL-2.0-only
#include "spot_command.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "spot/base/errors.hpp"
#include "words.h"

using spot::Accuracy;
using spot::InvalidParameter;
using spot::message;

namespace {

void set_walls(SpotCommand& command, decltype(SpotCommand::walls) walls) {
  if (!std::holds_alternative<std::monostate>(command.walls))
    throw InvalidParameter("only one of 'box', 'cylinder', 'region' and 'walls' can be given");
  command.walls = std::move(walls);
}

/// Of two walls, or `NULL NULL` for none.
std::optional<spot::Interval> read_places(Words& words, const char* low, const char* high) {
  if (!words.next_is("NULL")) {
    const double at = words.number(low);
    return spot::Interval{at, words.number(high)};
  }
  words.value(low);
  if (!words.next_is("NULL"))
    throw InvalidParameter(message("'box' has NULL for ", low, " but not for ", high,
                                   ": NULL NULL stands for no walls, where the simulation box is periodic"));
  words.value(high);
  return std::nullopt;
}

/// One shape more, or the first.
void read_shaped_walls(SpotCommand& command, Words& words) {
  if (!std::holds_alternative<ShapedWalls>(command.walls)) set_walls(command, ShapedWalls());
  std::get<ShapedWalls>(command.walls).read(words);
}

int to_int(long long value) { return static_cast<int>(std::min<long long>(value, 1 << 30)); }

void read_relax(SpotCommand& command, Words& words) {
  using spot::RelaxationSchedule;
  static const std::map<std::string, RelaxationSchedule> schedules = {{"every", RelaxationSchedule::moves},
                                                                      {"chance", RelaxationSchedule::chance},
                                                                      {"spot", RelaxationSchedule::spot},
                                                                      {"global", RelaxationSchedule::global}};
  const std::string how = words.value("'tol', 'every', 'chance', 'spot', 'global' or 'never'");
  command.time_ordered = how != "tol";
  const auto schedule = schedules.find(how);
  if (how == "tol") {
    command.tolerance = words.positive("the tolerance, in diameters,");
  } else if (how == "never") {
    command.relaxation.every = 0;
  } else if (schedule != schedules.end()) {
    command.relaxation.schedule = schedule->second;
    command.relaxation.every = to_int(words.integer("moves between relaxations", 1));
  } else {
    throw InvalidParameter(message("'relax ", how,
                                   "' is not known; allowed are 'relax tol delta', 'relax never', and "
                                   "'every', 'chance', 'spot' and 'global' with a number k"));
  }
}

void read_recirculation(SpotCommand& command, Words& words) {
  RecirculationCommand recirculation;
  if (words.next_is_number()) {
    recirculation.height = words.number("z");
  } else {
    const std::string how = words.value("'yes', 'no', a height or 'region'");
    if (how == "region")
      recirculation.region = words.value("region-ID");
    else if (how != "yes" && how != "no")
      throw InvalidParameter(message("'recirculate ", how,
                                     "' is not known; allowed are 'recirculate yes', 'recirculate no', a height, and "
                                     "'recirculate region' with the ID of one"));
    if (how == "no") return command.recirculation.reset();
  }
  command.recirculation = recirculation;
}

using Reader = std::function<void(SpotCommand&, Words&)>;

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all = {
      {"box",
       [](SpotCommand& c, Words& w) {
         const auto x = read_places(w, "xlo", "xhi"), y = read_places(w, "ylo", "yhi");
         set_walls(c, BoxWalls{x, y});
       }},
      {"cylinder",
       [](SpotCommand& c, Words& w) {
         CylinderWalls walls{};
         walls.x = w.number("x");
         walls.y = w.number("y");
         walls.radius = w.positive("the cylinder's radius");
         set_walls(c, walls);
       }},
      {"region", [](SpotCommand& c, Words& w) { set_walls(c, RegionWalls{w.value("region-ID")}); }},
      {"walls", read_shaped_walls},
      {"orifice", [](SpotCommand& c, Words& w) { c.outlets.read_orifice(w); }},
      {"slot", [](SpotCommand& c, Words& w) { c.outlets.read_slot(w); }},
      {"radius", [](SpotCommand& c, Words& w) { c.spots.radius = w.positive("the spot radius"); }},
      {"influence", [](SpotCommand& c, Words& w) { c.spots.influence = w.positive("the influence"); }},
      {"diffusion", [](SpotCommand& c, Words& w) { c.diffusion_length = w.positive("the diffusion length"); }},
      {"dz", [](SpotCommand& c, Words& w) { c.spots.step_height = w.positive("the step height"); }},
      {"speed", [](SpotCommand& c, Words& w) { c.spots.speed = w.positive("the drift speed"); }},
      {"outflow", [](SpotCommand& c, Words& w) { c.outlets.read_outflow(w); }},
      {"injection", [](SpotCommand& c, Words& w) { c.outlets.read_injection(w); }},
      {"beverloo", [](SpotCommand& c, Words& w) { c.outlets.read_beverloo(w); }},
      {"hopper", [](SpotCommand& c, Words& w) { c.outlets.read_hopper(w); }},
      {"schedule", [](SpotCommand& c, Words& w) { c.outlets.read_schedule(w); }},
      {"seed",
       [](SpotCommand& c, Words& w) {
         c.spots.seed = static_cast<std::uint64_t>(w.integer("the seed of the random numbers", 1));
       }},
      {"outlet", [](SpotCommand& c, Words& w) { c.outlet = w.number("z"); }},
      {"buffer",
       [](SpotCommand& c, Words& w) {
         c.side_buffer = w.not_negative("the distance of spots from side walls");
         c.base_buffer = w.not_negative("the distance of spots from the base");
       }},
      {"window", [](SpotCommand& c, Words& w) { c.window = w.positive("the window"); }},
      {"relax", read_relax},
      {"accuracy",
       [](SpotCommand& c, Words& w) {
         c.accuracy = one_of<Accuracy>(
             w, "accuracy", {{"fast", Accuracy::fast}, {"normal", Accuracy::normal}, {"exact", Accuracy::exact}});
       }},
      {"strength",
       [](SpotCommand& c, Words& w) {
         c.relaxation.strength = one_of<spot::RelaxationStrength>(
             w, "strength",
             {{"half", spot::RelaxationStrength::half_each}, {"full", spot::RelaxationStrength::full_each}});
       }},
      {"profile",
       [](SpotCommand& c, Words& w) {
         std::map<std::string, const spot::InfluenceProfile*> profiles;
         for (const spot::InfluenceProfile* profile : spot::InfluenceProfile::all())
           profiles[profile->name()] = profile;
         c.spots.profile = one_of<const spot::InfluenceProfile*>(w, "profile", profiles);
       }},
      {"alpha", [](SpotCommand& c, Words& w) { c.alpha = w.positive("alpha"); }},
      {"momentum", [](SpotCommand& c, Words& w) { c.momentum = w.not_negative("the momentum"); }},
      {"contact",
       [](SpotCommand& c, Words& w) { c.contact_overlap = w.not_negative("the overlap in contact, in diameters,"); }},
      {"closing",
       [](SpotCommand& c, Words& w) {
         c.relaxation.closing_gap = w.not_negative("the gap that is closed, in diameters,");
         c.relaxation.closing_share = w.not_negative("the share by which gaps are closed");
       }},
      {"volume", [](SpotCommand& c, Words& w) { c.spots.fixed_volume = w.not_negative("the number of grains"); }},
      {"steps",
       [](SpotCommand& c, Words& w) {
         c.spots.together = one_of<bool>(w, "steps", {{"poisson", false}, {"together", true}});
       }},
      {"persistence", [](SpotCommand& c, Words& w) { c.spots.persistence = w.not_negative("the persistence"); }},
      {"dilation", [](SpotCommand& c, Words& w) { c.spots.dilation = w.not_negative("the dilation"); }},
      {"critical",
       [](SpotCommand& c, Words& w) {
         c.spots.critical_fraction = w.not_negative("the critical packing fraction");
         c.spots.exchange_length = w.positive("the exchange length");
       }},
      {"dilatancy", [](SpotCommand& c, Words& w) { c.spots.dilatancy = w.not_negative("the dilatancy"); }},
      {"full_strain",
       [](SpotCommand& c, Words& w) { c.spots.full_strain = w.not_negative("the strain of full exchange"); }},
      {"spread",
       [](SpotCommand& c, Words& w) {
         c.spots.spread = w.not_negative("the spread");
         c.spots.wall_shear = w.not_negative("the shear by walls");
       }},
      {"mobility",
       [](SpotCommand& c, Words& w) {
         c.spots.mobility.at_rest = w.positive("the mobility of what has not fallen");
         c.spots.mobility.fall = w.positive("the fall that makes a packing mobile");
         c.spots.mobility.drift = w.positive("the drift towards what is mobile");
       }},
      {"surface",
       [](SpotCommand& c, Words& w) { c.spots.surface_exponent = w.not_negative("the exponent of the surface"); }},
      {"fade", [](SpotCommand& c, Words& w) { c.spots.fade = w.not_negative("the fade of the outflow"); }},
      {"nonaffine",
       [](SpotCommand& c, Words& w) {
         c.spots.nonaffine = w.not_negative("non-affine motion");
         c.spots.nonaffine_length = w.positive("the length of non-affine motion");
       }},
      {"recirculate", read_recirculation},
      {"scene",
       [](SpotCommand& c, Words& w) {
         const std::string file = w.value("the name of a file");
         c.scene = SceneCommand{file, w.positive("the acceleration of gravity")};
       }},
      {"threads", [](SpotCommand& c, Words& w) { c.threads = to_int(w.integer("the number of threads", 1)); }},
      {"shell", [](SpotCommand& c, Words& w) { c.relaxation.shell = w.not_negative("the shell, in diameters"); }},
      {"overlap", [](SpotCommand& c,
                     Words& w) { c.largest_overlap = w.positive("the largest overlap at the start, in diameters"); }},
      {"average", [](SpotCommand& c, Words& w) { c.average = to_int(w.integer("steps for the mean outflow", 1)); }},
      {"peratom", [](SpotCommand& c, Words& w) {
         c.per_atom = one_of<bool>(w, "peratom", {{"no", false}, {"yes", true}});
       }}};
  return all;
}

void require(bool given, const char* keyword, const char* what) {
  if (!given) throw InvalidParameter(message("keyword '", keyword, "' is missing: ", what));
}

}  // namespace

SpotCommand parse_spot_command(const std::vector<std::string>& list) {
  SpotCommand command;
  command.spots.influence = spot::calibration::influence;
  Words words(list);
  while (!words.empty()) {
    const std::string keyword = words.keyword();
    const auto reader = readers().find(keyword);
    if (reader == readers().end()) {
      std::string known;
      for (const auto& entry : readers()) known += ' ' + entry.first;
      throw InvalidParameter(message("unknown keyword '", keyword, "'; known are:", known));
    }
    reader->second(command, words);
  }
  require(!std::holds_alternative<std::monostate>(command.walls), "box",
          "walls are needed, by 'box xlo xhi ylo yhi', 'cylinder x y radius', 'region ID' or 'walls add shape ...'");
  command.outlets.validate();
  require(command.spots.speed > 0.0, "speed", "the drift speed of spots");
  if (command.uses_region() && !command.outlets.single_orifice())
    throw InvalidParameter(
        "'region' takes one round orifice; with slots or several outlets use 'box', 'cylinder' or 'walls'");
  return command;
}

std::size_t modify_spot_command(SpotCommand& command, const std::vector<std::string>& list) {
  Words words(list);
  const std::string keyword = words.keyword();
  if (keyword != "threads")
    throw InvalidParameter(message("unknown keyword '", keyword, "'; only 'threads' can be changed"));
  readers().at(keyword)(command, words);
  return words.taken();
}

std::string RecirculationCommand::text() const {
  return height ? precise(*height) : region.empty() ? "yes" : "region " + region;
}

void SpotCommand::resolve(double diameter, double mean_volume) {
  time_ordered = time_ordered.value_or(accuracy == Accuracy::exact);
  // What is relaxed in the order of time is relaxed as in 2006 and 2010.
  const spot::RelaxationParameters chosen =
      spot::relaxation_of(*time_ordered ? Accuracy::exact : accuracy, *spots.profile);
  relaxation.tolerance = tolerance.value_or(chosen.tolerance);
  relaxation.alpha = alpha.value_or(chosen.alpha);
  relaxation.momentum = *time_ordered ? 0.0 : momentum.value_or(chosen.momentum);
  relaxation.contact_overlap = contact_overlap.value_or(chosen.contact_overlap);
  if (spots.radius == 0.0) spots.radius = spots.profile->calibrated().radius_in_diameters * diameter;
  if (spots.step_height == 0.0) spots.step_height = spot::step_height_in_diameters(accuracy) * diameter;
  spots.step_width = spot::step_width_for(diffusion_length.value_or(spot::calibration::diffusion_length * diameter),
                                          spots.step_height, spots.persistence);
  side_buffer = side_buffer.value_or(spot::calibration::side_buffer * diameter);
  base_buffer = base_buffer.value_or(spot::calibration::base_buffer * diameter);
  outlet = outlet.value_or(outlets.outlets().height());
  resolve_rates(diameter, mean_volume);
}

namespace {

/// Where all grains have the diameter of the mean one.
spot::SpotParameters among_equal_grains(spot::SpotParameters spots) {
  spots.mean_grain_volume = 1.0;
  return spots;
}

}  // namespace

void SpotCommand::resolve_rates(double diameter, double mean_volume) {
  spots.injection_rate = outlets.injection(among_equal_grains(spots), diameter);
  spots.holds_outflow = outlets.holds_outflow();
  spots.mean_grain_volume = mean_volume;
}

std::vector<double> SpotCommand::births(double diameter) const {
  return outlets.births(among_equal_grains(spots), diameter);
}

double SpotCommand::most_births(double area, double diameter) const {
  return spot::births_that_empty(area, among_equal_grains(spots), diameter);
}

void SpotCommand::require_grains_between_spots(double area, double diameter) const {
  spots.validate();
  const double births = spots.injection_rate.largest(), most = most_births(area, diameter);
  if (births <= most) return;
  const double grains = 1.0 / spot::births_for(1.0, among_equal_grains(spots), diameter);  // a spot
  const bool counts_grains = outlets.holds_outflow();
  throw InvalidParameter(message("'", outlets.rate_keyword(), "' has ", counts_grains ? births * grains : births,
                                 counts_grains ? " grains" : " births of spots",
                                 " per time, of all outlets together, but at most ",
                                 counts_grains ? most * grains : most, " are allowed: with more, spots that climb at ",
                                 spots.fastest(), " carry away all grains that fit into the simulation box"));
}

namespace {

std::string text_of_places(const std::optional<spot::Interval>& walls) {
  return walls ? precise(walls->low, ' ', walls->high) : "NULL NULL";
}

std::string text_of_period(const spot::Periodic& periodic) {
  std::string text;
  for (int axis = 0; axis < 2; ++axis)
    if (periodic.along(axis))
      text += precise(" periodic ", "xy"[axis], ' ', periodic.low(axis), ' ', periodic.high(axis));
  return text;
}

std::string text_of_walls(const decltype(SpotCommand::walls)& walls) {
  if (const auto* box = std::get_if<BoxWalls>(&walls))
    return "box " + text_of_places(box->x) + ' ' + text_of_places(box->y);
  if (const auto* cylinder = std::get_if<CylinderWalls>(&walls))
    return precise("cylinder ", cylinder->x, ' ', cylinder->y, ' ', cylinder->radius);
  if (const auto* shaped = std::get_if<ShapedWalls>(&walls)) return shaped->text();
  return "region " + std::get<RegionWalls>(walls).id;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> SpotCommand::settings() const {
  return {{"walls", text_of_walls(walls) + text_of_period(periodic)},
          {"orifice", outlets.text_of_outlets()},
          {"radius", precise(spots.radius)},
          {"profile", spots.profile->name()},
          {"influence", precise(spots.influence)},
          {"dz", precise(spots.step_height)},
          {"diffusion", precise(spots.diffusion_length())},
          {"persistence", precise(spots.persistence)},
          {"speed", precise(spots.speed)},
          {"dilation", precise(spots.dilation)},
          {"critical", precise(spots.critical_fraction, ' ', spots.exchange_length)},
          {"dilatancy", precise(spots.dilatancy)},
          {"full_strain", precise(spots.full_strain)},
          {"spread", precise(spots.spread, ' ', spots.wall_shear)},
          {"mobility", precise(spots.mobility.at_rest, ' ', spots.mobility.fall, ' ', spots.mobility.drift)},
          {"surface", precise(spots.surface_exponent)},
          {"fade", precise(spots.fade)},
          {"nonaffine", precise(spots.nonaffine, ' ', spots.nonaffine_length)},
          {"injection", outlets.text_of_rates()},
          {"volume", precise(spots.fixed_volume)},
          {"steps", spots.together ? "together" : "poisson"},
          {"seed", precise(spots.seed)},
          {"outlet", precise(*outlet)},
          {"buffer", precise(*side_buffer, ' ', *base_buffer)},
          {"driver", *time_ordered ? "time-ordered" : "windowed"},
          {"relax tol", *time_ordered ? "none" : precise(relaxation.tolerance)},
          {"schedule of the relaxation", precise(static_cast<int>(relaxation.schedule), ' ', relaxation.every)},
          {"alpha", precise(relaxation.alpha)},
          {"strength", relaxation.strength == spot::RelaxationStrength::half_each ? "half" : "full"},
          {"momentum", precise(relaxation.momentum)},
          {"contact", precise(relaxation.contact_overlap)},
          {"closing", precise(relaxation.closing_gap, ' ', relaxation.closing_share)},
          {"shell", precise(relaxation.shell)},
          {"recirculate", recirculation ? recirculation->text() : "no"}};
}
