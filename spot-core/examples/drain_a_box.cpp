// SPDX-License-Identifier: GPL-2.0-or-later
// Drains a box of grains through a round orifice with spot-core alone. Lengths in grain diameters, times in
// sqrt(diameter / gravity). Prints, every two time units, how many grains are left and how deeply any two overlap.
#include <cstdio>
#include <memory>

#include "spot/base/errors.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/geometry/silos.hpp"

/// A body-centred lattice of the packing fraction that dense flow has, 0.58, filling the box up to a height.
std::vector<spot::Grain> lattice(double half_width, double half_depth, double height) {
  const double edge = 1.218;  // body-centred cubic: two grains of diameter 1 in each cube, none touch
  std::vector<spot::Grain> grains;
  for (int corner = 0; corner < 2; ++corner)
    for (double z = 0.5 + 0.5 * edge * corner; z < height; z += edge)
      for (double y = -half_depth + 0.5 + 0.5 * edge * corner; y <= half_depth - 0.5; y += edge)
        for (double x = -half_width + 0.5 + 0.5 * edge * corner; x <= half_width - 0.5; x += edge)
          grains.push_back({static_cast<std::int64_t>(grains.size()) + 1, {x, y, z}});
  return grains;
}

int main() try {
  spot::SpotParameters spots;
  spots.radius = 2.6;
  spots.influence = 2.5e-3;
  spots.step_height = 0.1;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  spots.speed = 3.2;
  spots.injection_rate = 363.0;

  const spot::Orifice orifice{{0.0, 0.0, 0.0}, 4.0};
  const spot::SpotBuffers buffers{1.0, spots.radius};
  const double half_width = 8.0, half_depth = 5.0, height = 15.0;
  std::shared_ptr<const spot::Container> silo =
      spot::box_silo(-half_width, half_width, -half_depth, half_depth, orifice, buffers);
  spot::Packing packing(1.0, 100.0, lattice(half_width, half_depth, height));
  spot::TimeOrderedDrainage drainage(spots, spot::RelaxationParameters(), spot::DrainageLimits{-1.0}, silo,
                                     std::move(packing));

  std::printf("%8s %8s %8s %8s %16s\n", "time", "spots", "left", "drained", "largest overlap");
  for (double time = 0.0; time <= 20.0; time += 2.0) {
    drainage.advance_to(time);
    std::printf("%8.1f %8zu %8zu %8lld %16.4f\n", time, drainage.spots().size(), drainage.packing().size(),
                static_cast<long long>(drainage.counters().drained), drainage.largest_overlap().depth);
  }
} catch (const spot::Error& error) {
  std::fprintf(stderr, "drain_a_box: %s\n", error.what());
  return 1;
}
