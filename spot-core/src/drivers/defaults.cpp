// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/defaults.hpp"

#include <algorithm>
#include <cmath>

#include "spot/drivers/windowed_drainage.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

double volume_of_grain(double diameter) { return 3.14159265358979323846 / 6.0 * diameter * diameter * diameter; }

}  // namespace

double step_height_in_diameters(Accuracy accuracy) {
  return accuracy == Accuracy::exact ? 0.1 : accuracy == Accuracy::normal ? 1.2 : 2.4;
}

RelaxationParameters relaxation_of(Accuracy accuracy, const InfluenceProfile& profile) {
  // Chosen from the curves of benchmarks/time_vs_error.py. More momentum and a larger alpha are cheaper for the same
  // overlaps, but take g(r) away from DEM's, from less on if spots are uniform.
  RelaxationParameters relaxation;
  if (accuracy == Accuracy::exact) return relaxation;
  const bool fast = accuracy == Accuracy::fast;
  relaxation.tolerance = fast ? 4e-3 : 1.7e-3;
  relaxation.alpha = fast ? 1.0 : 0.8;
  relaxation.momentum = fast ? profile.calibrated().fast_momentum : profile.calibrated().momentum;
  relaxation.contact_overlap = fast ? 0.0 : 1.5e-3;
  return relaxation;
}

double longest_window(const SpotParameters& spots, double diameter, double largest, const Outlets& outlets) {
  const double flow = WindowedDrainage::flow_through_orifice(spots, 1.0, largest, outlets) * (largest / diameter);
  return std::min(calibration::climb_in_a_window * diameter / spots.speed, calibration::flow_in_a_window / flow);
}

double predicted_outflow(const Hole& hole, const BeverlooLaw& law, double gravity, double diameter) {
  const double per_volume = calibration::packing_fraction_of_flow / volume_of_grain(diameter);
  return per_volume * std::sqrt(gravity) * hole.discharge(law, diameter);
}

double births_for(double outflow, const SpotParameters& spots, double diameter) {
  return outflow * volume_of_grain(diameter) / spots.missing_volume(diameter);
}

double births_that_empty(double area, const SpotParameters& spots, double diameter) {
  return calibration::packing_fraction_of_flow * area * spots.fastest() / spots.missing_volume(diameter);
}

}  // namespace spot
