// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_COMMAND_H
#define SPOT_COMMAND_H

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "outlet_command.h"
#include "shaped_walls.h"
#include "spot/drivers/defaults.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/relaxation/calibration.hpp"
#include "spot/walk/parameters.hpp"

/// `box xlo xhi ylo yhi`: four vertical plane walls. Where there is no interval, `NULL NULL`, space repeats instead.
struct BoxWalls {
  std::optional<spot::Interval> x, y;
};

/// `cylinder x y radius`: an upright cylinder.
struct CylinderWalls {
  double x, y, radius;
};

/// `region ID`: the surface of a LAMMPS region.
struct RegionWalls {
  std::string id;
};

/// `recirculate yes`, `recirculate z` and `recirculate region ID`: drained grains come in again right above the bed, at
/// a height, or in a region.
struct RecirculationCommand {
  std::optional<double> height;
  std::string region;

  /// As it is written.
  std::string text() const;
};

/// `scene FILE g`: a file that tells the analysis what dumps do not say.
struct SceneCommand {
  std::string file;
  double gravity;
};

/// What a `fix ID group spot ...` command says, in the units of the deck. Where a length or a time was not
/// given, it is empty and follows from the grain diameter or the timestep, see resolve().
struct SpotCommand {
  std::variant<std::monostate, BoxWalls, CylinderWalls, RegionWalls, ShapedWalls> walls;
  spot::Periodic periodic;  // not of the command, but of the simulation box
  OutletCommand outlets;
  spot::SpotParameters spots;
  spot::RelaxationParameters relaxation;
  std::optional<bool> time_ordered;  // the driver of 2006, not the windowed one
  std::optional<double> tolerance, alpha, momentum, contact_overlap;
  spot::Accuracy accuracy = spot::Accuracy::normal;
  int threads = 1;
  std::optional<double> diffusion_length;
  std::optional<double> outlet;  // height below which grains are removed
  std::optional<double> side_buffer, base_buffer;
  std::optional<double> window;
  std::optional<RecirculationCommand> recirculation;  // none: grains that have drained are gone
  std::optional<SceneCommand> scene;
  double largest_overlap = spot::calibration::largest_overlap_at_start;  // in diameters
  int average = 100;                                                     // steps over which the outflow is averaged
  bool per_atom = false;                                                 // output of what has become of each grain

  SpotCommand() { spots.profile = spot::InfluenceProfile::parabolic; }

  /// Fills in what was left open: the radius that goes with the profile, diffusion length 1.25 d, buffers of 0.25 d
  /// from side walls and 2 d from the base, outlet at the orifice, and what `accuracy` decides. `diameter`: of a grain
  /// of mean volume, d; `mean_volume`: its volume, over that of the largest.
  void resolve(double diameter, double mean_volume = 1.0);

  /// The rates alone, once the outlets know more of the walls. Part of resolve().
  void resolve_rates(double diameter, double mean_volume);

  /// Births of spots per time at each outlet, where the factor of its schedule is 1; of what is resolved.
  std::vector<double> births(double diameter) const;

  /// The most births of spots per time, of all outlets together, in a simulation box with a base of this area
  /// (length^2). Beyond, no grains are left between spots.
  double most_births(double area, double diameter) const;

  /// Throws spot::InvalidParameter, naming the keyword, if there are more than that, and as the spots' validate().
  void require_grains_between_spots(double area, double diameter) const;

  /// All that decides where grains and spots go, as text, once it is resolved, but for the window. `threads`, `average`
  /// and `peratom` are not in it.
  std::vector<std::pair<std::string, std::string>> settings() const;

  bool uses_region() const { return std::holds_alternative<RegionWalls>(walls); }
};

/// Reads the words after `fix ID group spot`. Throws spot::InvalidParameter that names the offending word and
/// what is allowed. Knows no LAMMPS, so that it can be tested by itself.
SpotCommand parse_spot_command(const std::vector<std::string>& words);

/// Reads one keyword and its values from the words after `fix_modify ID`; returns how many words that were. Throws
/// spot::InvalidParameter unless it is one that may change between runs.
std::size_t modify_spot_command(SpotCommand& command, const std::vector<std::string>& words);

#endif
