// SPDX-License-Identifier: GPL-2.0-only
#include "dry_run.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>

#include "spot/drivers/defaults.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/workers.hpp"
#include "spot/walk/calibration.hpp"
#include "spot/walk/free_surface.hpp"
#include "spot/walk/spots.hpp"

using spot::Vector3;

namespace {

constexpr double cell_of_slice = 0.25;  // diameters
constexpr int most_cells = 600;         // of a slice, along each axis
constexpr double beside = 1.0;  // of it on each side of the simulation box, so that walls there are seen (diameters)
constexpr std::int64_t ways_kept = 12;  // of the spots that are born first
constexpr std::size_t most_moves = 20'000'000;
constexpr double climbs = 4.0;  // so often spots could climb from outlet to surface at v_s, at most
/// Between two looks at how many there are, in such climbs; and a change that is none, as is one by less than sqrt(N)
/// of N spots, since a quarter of them are new, and come by chance.
constexpr double look = 0.25, steady_change = 0.02;

/// What spots do alone.
struct Walks {
  std::map<std::int64_t, std::vector<Vector3>> ways;  // by spot
  std::vector<spot::Spot> live;
  double time = 0.0, moves_per_time = 0.0;
  bool steady = false;
};

/// The first spots that leave are gone once nothing is in their reach.
Walks walk(const DryRun& run) {
  const spot::SpotParameters& parameters = run.command.spots;
  spot::Alone alone;
  spot::Workers worker(1);
  const spot::Spots::VisitGrains visit_grains = [&run](const auto& visit, const auto&) {
    for (const spot::Grain& grain : run.grains) visit(grain.position);
  };
  spot::FreeSurface surface(parameters, *run.container, run.largest);
  double top = run.container->outlets().height();
  for (const spot::Grain& grain : run.grains) {
    surface.add(grain.position);
    top = std::max(top, grain.position.z());
  }
  surface.gather(alone);

  spot::Spots spots(parameters, *run.container, run.largest);
  const double climb = (top - run.container->outlets().height() + 2.0 * parameters.radius) / parameters.speed;
  const double window = std::min(spot::calibration::climb_in_a_window * run.diameter / parameters.speed, look * climb);
  Walks walks;
  std::size_t moves = 0, moves_before = 0, live_before = 0;
  double next_look = look * climb, last_look = 0.0;
  while (walks.time < climbs * climb && moves < most_moves && !walks.steady) {
    walks.time += window;
    spots.give_birth(walks.time, *run.container, [](const spot::Spot&) { return true; });
    spots.update_surface(walks.time, visit_grains, alone);
    if (parameters.dilation > 0.0) spots.set_relative_speeds(walks.time - window, alone, worker);
    std::vector<std::int64_t> gone;
    spots.step_until(walks.time, *run.container, worker,
                     [&](const spot::Spot& spot, const std::vector<spot::Move>& made) {
                       moves += made.size();
                       for (const spot::Move& move : made) spots.add_to_flow(move, 1.0);
                       if (spot.id < ways_kept)
                         for (const spot::Move& move : made) walks.ways[spot.id].push_back(move.middle);
                       if (spot.position.z() > surface.height(spot.position) + parameters.radius)
                         gone.push_back(spot.id);
                     });
    spots.update_flow(window, alone);
    for (const std::int64_t spot : gone) spots.remove(spot);
    if (walks.time < next_look) continue;
    const std::size_t live = spots.live().size();
    walks.moves_per_time = static_cast<double>(moves - moves_before) / (walks.time - last_look);
    const double change = static_cast<double>(live) - static_cast<double>(live_before);
    const auto spots_alive = static_cast<double>(live);
    walks.steady =
        walks.time > climb && std::abs(change) < std::max(steady_change * spots_alive, std::sqrt(spots_alive));
    moves_before = moves;
    live_before = live;
    last_look = walks.time;
    next_look += look * climb;
  }
  walks.live = spots.live();
  return walks;
}

/// Values, separated by commas.
template <class Values, class Write>
void list(std::ostream& out, const Values& values, const Write& write) {
  out << '[';
  bool first = true;
  for (const auto& value : values) {
    if (!first) out << ", ";
    first = false;
    write(value);
  }
  out << ']';
}

/// An upright slice through a place, across x (0) or y (1): the inside on a grid, and the grains that it cuts.
void write_slice(std::ostream& out, const DryRun& run, int across, const Vector3& place) {
  const int along = 1 - across;
  const double margin = beside * run.diameter;
  const double low[] = {run.low[along] - margin, run.low[2]}, high[] = {run.high[along] + margin, run.high[2]};
  const auto cells = [&](int k) {
    return std::clamp(static_cast<int>((high[k] - low[k]) / (cell_of_slice * run.diameter)), 1, most_cells);
  };
  const int columns = cells(0), rows = cells(1);
  out << "{\"across\": \""
      << "xy"[across] << "\", \"at\": " << place[across] << ", \"low\": [" << low[0] << ", " << low[1]
      << "], \"high\": [" << high[0] << ", " << high[1] << "],\n\"inside\": [";
  Vector3 centre = place;
  for (int row = 0; row < rows; ++row) {
    centre.z() = low[1] + (row + 0.5) * (high[1] - low[1]) / rows;
    out << (row == 0 ? "\"" : ",\n\"");
    for (int column = 0; column < columns; ++column) {
      centre[along] = low[0] + (column + 0.5) * (high[0] - low[0]) / columns;
      out << (run.container->contains(centre) ? '1' : '0');
    }
    out << '"';
  }
  out << "],\n\"grains\": ";
  std::vector<Vector3> cut;
  for (const spot::Grain& grain : run.grains)
    if (std::abs(grain.position[across] - place[across]) < 0.5 * run.diameter) cut.push_back(grain.position);
  list(out, cut, [&](const Vector3& at) { out << '[' << at[along] << ", " << at.z() << ']'; });
  out << "}";
}

void write_outlets(std::ostream& out, const DryRun& run) {
  const spot::Outlets& outlets = run.container->outlets();
  const spot::SpotParameters& spots = run.command.spots;
  const double births_of_a_grain = spots.mean_grain_volume * spot::births_for(1.0, spots, run.largest);
  out << '[';
  for (std::size_t k = 0; k < outlets.size(); ++k) {
    const spot::Outlet& outlet = outlets[k];
    const double births = spots.injection_rate.largest(k);
    out << (k == 0 ? "" : ", ") << "{\"name\": \"" << outlet.name() << "\", \"centre\": [" << outlet.centre.x() << ", "
        << outlet.centre.y() << ", " << outlet.centre.z() << "], \"half_widths\": [" << outlet.hole->half_width(0)
        << ", " << outlet.hole->half_width(1) << "], \"births\": " << births
        << ", \"outflow\": " << births / births_of_a_grain << "}";
  }
  out << ']';
}

}  // namespace

std::string describe(const DryRun& run) {
  const spot::SpotParameters& p = run.command.spots;
  double smallest = run.largest;
  for (const spot::Grain& grain : run.grains) smallest = std::min(smallest, 2.0 * spot::radius_in(run.largest, grain));
  const Walks walks = walk(run);
  const auto point = [](std::ostream& out, const Vector3& at) {
    out << '[' << at.x() << ", " << at.y() << ", " << at.z() << ']';
  };
  std::ostringstream out;
  out << std::setprecision(9) << "{\"format\": 1, \"units\": \"" << run.units << "\", \"grains\": " << run.grains.size()
      << ", \"diameter\": " << run.diameter << ", \"smallest\": " << smallest << ", \"largest\": " << run.largest
      << ", \"recirculates\": " << (run.command.recirculation ? "true" : "false") << ", \"timestep\": " << run.timestep
      << ", \"window\": " << run.window << ", \"steps\": " << run.steps << ", \"memory\": " << run.memory
      << ", \"threads\": " << run.command.threads
      << ",\n\"time_ordered\": " << (*run.command.time_ordered ? "true" : "false") << ", \"profile\": \""
      << p.profile->name() << "\", \"radius\": " << p.radius << ", \"influence\": " << p.influence
      << ", \"fixed_volume\": " << p.fixed_volume << ", \"step_height\": " << p.step_height
      << ", \"speed\": " << p.speed << ", \"diffusion\": " << p.diffusion_length() << ", \"dilation\": " << p.dilation
      << ", \"critical\": " << p.critical_fraction << ", \"dilatancy\": " << p.dilatancy
      << ", \"full_strain\": " << p.full_strain << ", \"spread\": " << p.spread
      << ", \"surface\": " << p.surface_exponent << ", \"nonaffine\": " << p.nonaffine
      << ",\n\"spot_volume\": " << p.missing_volume(run.largest)
      << ", \"enclosed\": " << p.spot_volume(spot::calibration::packing_fraction_of_flow) / p.influence
      << ", \"spots\": " << walks.live.size() << ", \"moves_per_time\": " << walks.moves_per_time
      << ", \"walked\": " << walks.time << ", \"steady\": " << (walks.steady ? "true" : "false") << ",\n\"outlets\": ";
  write_outlets(out, run);
  out << ",\n\"slices\": [";
  const Vector3 place = run.container->outlets()[0].centre;
  write_slice(out, run, 1, place);
  out << ",\n";
  write_slice(out, run, 0, place);
  out << "],\n\"ways\": ";
  list(out, walks.ways, [&](const auto& way) { list(out, way.second, [&](const Vector3& at) { point(out, at); }); });
  out << ",\n\"live\": ";
  list(out, walks.live, [&](const spot::Spot& spot) { point(out, spot.position); });
  out << "}\n";
  return out.str();
}
