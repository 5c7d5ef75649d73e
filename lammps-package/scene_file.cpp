// SPDX-License-Identifier: GPL-2.0-only
#include "scene_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "spot/geometry/round_hole.hpp"

using spot::Outlet;

namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;  // key, value

/// The shortest text that is read as the same number.
template <class Number>
std::string number(Number value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// Of places and widths that a deck may have got by different roundings.
bool same(double a, double b, double scale) { return std::abs(a - b) <= 1e-9 * scale; }

bool is_round(const Outlet& outlet) { return dynamic_cast<const spot::RoundHole*>(outlet.hole.get()) != nullptr; }

/// Along y: walls, or the cell that repeats.
spot::Interval depth_of(const BoxWalls& box, const spot::Periodic& periodic) {
  return box.y ? *box.y : spot::Interval{periodic.low(1), periodic.high(1)};
}

/// Whether they are alike, and each is round and in the middle of its part of the base, or a slot from side to side.
bool share_the_base(const std::vector<Outlet>& outlets, const spot::Interval& x, const spot::Interval& y,
                    bool periodic) {
  const double half = 0.5 * (x.high - x.low), part = (x.high - x.low) / static_cast<double>(outlets.size());
  const double depth = y.high - y.low, middle_y = 0.5 * (y.low + y.high);
  for (std::size_t k = 0; k < outlets.size(); ++k) {
    const Outlet& outlet = outlets[k];
    const bool alike = is_round(outlet) == is_round(outlets[0]) &&
                       same(outlet.hole->half_width(0), outlets[0].hole->half_width(0), half);
    const bool in_its_part = same(outlet.centre.x(), x.low + (static_cast<double>(k) + 0.5) * part, half);
    const double y_of_others = periodic ? outlets[0].centre.y() : middle_y;  // which is no place where space repeats
    const bool in_the_middle = is_round(outlet) ? same(outlet.centre.y(), y_of_others, depth)
                                                : outlet.hole->half_width(1) >= (0.5 - 1e-9) * depth;
    if (!alike || !in_its_part || !in_the_middle) return false;
  }
  return true;
}

std::optional<Entries> box_entries(const SpotCommand& command) {
  const auto* box = std::get_if<BoxWalls>(&command.walls);
  if (!box || !box->x) return std::nullopt;
  const spot::Outlets all = command.outlets.outlets();
  std::vector<Outlet> outlets(all.begin(), all.end());
  std::sort(outlets.begin(), outlets.end(),
            [](const Outlet& a, const Outlet& b) { return a.centre.x() < b.centre.x(); });
  const spot::Interval x = *box->x, y = depth_of(*box, command.periodic);
  const bool periodic = !box->y, slot = !is_round(outlets[0]);
  if (!share_the_base(outlets, x, y, periodic)) return std::nullopt;
  Entries entries = {{"half_width_x", number(0.5 * (x.high - x.low))},
                     {periodic ? "half_period_y" : "half_depth_y", number(0.5 * (y.high - y.low))},
                     {"orifice_radius", number(outlets[0].hole->half_width(0))},
                     {"axis_x", number(0.5 * (x.low + x.high))},
                     {"axis_y", number(periodic && !slot ? outlets[0].centre.y() : 0.5 * (y.low + y.high))}};
  if (outlets.size() > 1) entries.emplace_back("orifices", number(outlets.size()));
  if (slot) entries.emplace_back("slot", "true");
  return entries;
}

/// The outlet is where the axis of the analysis begins.
std::optional<Entries> hopper_entries(const SpotCommand& command) {
  const auto* walls = std::get_if<ShapedWalls>(&command.walls);
  const ShapedWalls::Upright* cone = walls ? walls->cone_under_cylinder() : nullptr;
  const std::optional<spot::Orifice> outlet = command.outlets.single_orifice();
  if (!cone || !outlet || command.periodic.any()) return std::nullopt;
  const bool at_origin = cone->x == 0.0 && cone->y == 0.0 && cone->low == 0.0 && outlet->centre.isZero(0.0);
  if (!at_origin || !same(outlet->radius, cone->radius_low, cone->radius_high)) return std::nullopt;
  return Entries{{"orifice_radius", number(cone->radius_low)},
                 {"cylinder_radius", number(cone->radius_high)},
                 {"cone_height", number(cone->high)}};
}

/// Units and origin.
Entries other_entries(const SpotCommand& command) {
  const spot::Vector3 origin = command.outlets.outlets()[0].centre;
  return {{"axis_x", number(origin.x())}, {"axis_y", number(origin.y())}};
}

}  // namespace

std::string describe(const SceneOfDumps& scene) {
  Entries entries = {{"format", "1"},  // of the file
                     {"program", "\"LAMMPS fix spot\""},
                     {"diameter", number(scene.diameter)},
                     {"gravity", number(scene.gravity)},
                     {"timestep", number(scene.timestep)},
                     {"grains", number(scene.grains)}};
  if (std::abs(scene.opening_time) > 1e-6 * scene.timestep)
    entries.emplace_back("opening_time", number(scene.opening_time));
  std::optional<Entries> walls = box_entries(scene.command);
  if (!walls) walls = hopper_entries(scene.command);
  if (!walls) walls = other_entries(scene.command);
  entries.insert(entries.end(), walls->begin(), walls->end());
  entries.emplace_back("base_z", number(scene.command.outlets.outlets().height()));

  std::string text;
  for (const auto& [key, value] : entries) text += (text.empty() ? "{\"" : ", \"") + key + "\": " + value;
  return text + "}\n";
}
