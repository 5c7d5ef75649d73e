// SPDX-License-Identifier: GPL-2.0-or-later
// The scene that the stress tests stretch, and how a drainage of it is judged.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "invariants.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace stress {

/// A silo with a packing, and all numbers of the model; by default those of the deck (examples/silo), phi_c
/// apart, in d and tau.
struct Scene {
  Scene();

  double diameter = 1.0;
  spot::Vector3 place = spot::Vector3::Zero();  ///< of the middle of the base
  double half_width = 6.0, half_depth = 4.0;
  double orifice = 4.0;
  spot::SpotBuffers buffers{0.25, 2.0};
  spot::SpotParameters spots;
  spot::RelaxationParameters relaxation;
  double largest_overlap = 0.03;  ///< at the start
  double window = 0.1;
  double time = 4.0;  ///< of the drainage
  bool time_ordered = false;
  std::vector<spot::Grain> grains;  ///< around `place`, not shifted yet
  int threads = 1;
  bool placed_by_hand = false;  ///< grains may start in each other or in walls, and have half of the time to get apart

  /// Another drift or step height, with the same diffusion length.
  void set_step_height(double height);
  /// Spots that carry what they enclose, and so can leave nothing behind.
  void set_no_fixed_volume();
  /// Another size of spots, with the volume and, if need be, the orifice and the silo that belong to it.
  void set_radius(double radius);
  /// A dense packing of this height.
  void fill(double height);

  std::shared_ptr<const spot::Container> silo() const;
  spot::DrainageLimits limits() const { return {place.z(), largest_overlap}; }
  std::vector<spot::Grain> placed() const;
  std::unique_ptr<spot::Drainage> start() const;
};

/// What became of a scene.
struct Outcome {
  enum Kind {
    valid,   ///< a packing within the bounds
    error,   ///< a typed error
    neither  ///< what must not happen
  };
  Kind kind = valid;
  std::string text;  ///< of the error, or what was wrong
  spot::Counters counters;
  invariants::Overlaps largest;  ///< over time
  invariants::Overlaps last;     ///< at the end
};

/// No two grains of a valid packing overlap more deeply, in diameters.
constexpr double overlap_bound = 0.3;

/// Drains the scene, checks it 20 times and judges it.
Outcome drain(const Scene& scene);

/// A field of a CSV file.
std::string quoted(const std::string& text);

/// A line of the table, as CSV: what was tried, and what became of it.
std::string row(const std::string& what, const std::string& value, const Scene& scene, const Outcome& outcome);

}  // namespace stress
