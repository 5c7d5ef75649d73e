// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/critical_state.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/elementary.hpp"
#include "spot/walk/calibration.hpp"
#include "spot/walk/grain_volume.hpp"

namespace spot {

CriticalState::CriticalState(const SpotParameters& parameters, double diameter)
    : profile_(parameters.profile),
      radius_(parameters.radius),
      inset_(calibration::inset_of_walls * parameters.mean_diameter(diameter)),
      fraction_(parameters.critical_fraction),
      exchange_length_(parameters.exchange_length),
      dilatancy_(parameters.dilatancy),
      full_strain_(parameters.full_strain) {
  const double ratio = 2.0 * radius_ / diameter;
  enclosed_by_grains_alone_ = profile_->mean_share() * ratio * ratio * ratio;
}

double CriticalState::enclosed(const Vector3& middle, double shear, const Container& container) const {
  WallContacts walls;
  container.contacts(container.periodic().wrap(middle), radius_ + inset_, walls);
  double part = 1.0;
  for (const WallContact& wall : walls) part *= profile_->part_above((wall.distance - inset_) / radius_);
  return fraction_ * (1.0 - dilatancy_ * shear) * enclosed_by_grains_alone_ * part;
}

/// f: a packing comes to its critical state only as it is strained.
double CriticalState::share_exchanged(double strain) const {
  if (strain >= full_strain_) return 1.0;
  const double part = strain / full_strain_;
  return part * part;
}

double CriticalState::volume_after(double volume, const Move& move, int enclosed, const Strain& strain,
                                   const Container& container) const {
  if (move.middle.z() < container.outlets().height() + calibration::least_height_of_exchange * radius_) return volume;
  const double grains = static_cast<double>(enclosed) / grain_volume;
  const double critical = this->enclosed(move.middle, strain.shear, container);
  if (!(grains >= calibration::least_share_of_critical * critical) || critical <= 0.0) return volume;
  const double share = share_exchanged(strain.whole);
  const double left = volume * exp(-share * move.step.z() / exchange_length_ * (grains / critical - 1.0));
  return std::nearbyint(std::clamp(left, calibration::least_volume, calibration::most_volume) * volume_parts) /
         volume_parts;
}

}  // namespace spot
