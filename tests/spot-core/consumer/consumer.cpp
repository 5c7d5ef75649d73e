// SPDX-License-Identifier: GPL-2.0-or-later
// A project outside that uses the installed library.
#include <spot/drivers/time_ordered_drainage.hpp>
#include <spot/geometry/silos.hpp>

int main() {
  spot::SpotParameters spots;
  spots.radius = 2.6;
  spots.influence = 2.5e-3;
  spots.step_width = 0.68;
  spots.step_height = 0.1;
  spots.speed = 3.2;
  spots.injection_rate = 363.0;
  std::shared_ptr<const spot::Container> silo =
      spot::cylinder_silo(0.0, 0.0, 8.0, spot::Orifice{{0.0, 0.0, 0.0}, 4.0}, spot::SpotBuffers{1.0, 2.6});
  spot::TimeOrderedDrainage drainage(spots, spot::RelaxationParameters(), spot::DrainageLimits{-1.0}, silo,
                                     spot::Packing(1.0, 100.0, {{1, {0.0, 0.0, 0.5}}}));
  drainage.advance_to(2.0);
  return drainage.counters().moves > 0 ? 0 : 1;
}
