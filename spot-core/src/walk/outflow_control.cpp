// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/outflow_control.hpp"

#include <algorithm>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double parts_of_grain = 1024.0;  // grain_volume, in a room above this one

}  // namespace

OutflowControl::OutflowControl(const SpotParameters& parameters, const Container& container, double diameter)
    : on_(parameters.holds_outflow),
      fade_(parameters.fade),
      radius_of_grain_(0.5 * parameters.mean_diameter(diameter)),
      outlets_(container.outlets()),
      births_(parameters.injection_rate),
      volume_of_birth_(parts_of_grain * parameters.missing_volume(diameter) /
                       (pi / 6.0 * diameter * diameter * diameter)),
      delay_(parameters.radius / parameters.speed),
      memory_time_(calibration::climb_of_flow_memory * delay_),
      updates_(calibration::climb_between_surfaces * delay_),
      counted_(container.outlets().size(), 0),
      missing_(container.outlets().size(), 0.0),
      shares_(container.outlets().size(), 1.0) {
  for (std::size_t k = 0; k < births_.outlets(); ++k) largest_.push_back(births_.largest(k));
}

/// Volume (1024 = grain_volume).
double OutflowControl::asked(std::size_t outlet, double from, double until) const {
  return shares_[outlet] * volume_of_birth_ *
         births_.expected_births(outlet, std::max(0.0, from - delay_), std::max(0.0, until - delay_));
}

bool OutflowControl::update(double now, Communicator& communicator) {
  if (!on_ || !updates_.due(now)) return false;
  const std::vector<std::int64_t> found = communicator.sum(counted_);
  for (std::size_t k = 0; k < missing_.size(); ++k) {
    missing_[k] += asked(k, updated_, now) - static_cast<double>(found[k]);
    // No more than factors have room for: what an outlet lacked while no grains were above it is not made good.
    const double most = calibration::largest_outflow_correction * largest_[k] * volume_of_birth_ * memory_time_;
    missing_[k] = std::clamp(missing_[k], 0.0, most);
    counted_[k] = 0;
  }
  updated_ = now;
  return true;
}

/// Of the bed over an outlet, on average over places that are as likely.
double OutflowControl::depth(const Outlet& outlet, const FreeSurface& surface) const {
  constexpr int places = 4;
  double sum = 0.0;
  for (int i = 0; i < places; ++i)
    for (int j = 0; j < places; ++j) {
      const Vector3 place = outlet.centre + outlet.hole->point(0.0, (i + 0.5) / places, (j + 0.5) / places);
      sum += std::max(0.0, surface.height(place) - outlet.centre.z());
    }
  return std::max(0.0, sum / (places * places) - radius_of_grain_);
}

void OutflowControl::fade(const FreeSurface& surface) {
  if (fade_ == 0.0 || !surface.known()) return;
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    const double width = 2.0 * outlets_[k].hole->widest_radius();
    shares_[k] = std::max(calibration::least_outflow_share, 1.0 - exp(-depth(outlets_[k], surface) / (fade_ * width)));
  }
}

void OutflowControl::change(double now, const Injection& births) {
  births_ = births;
  // asked() is for what was up to R_s / v_s before the last update.
  births_.forget_before(on_ ? std::max(0.0, updated_ - delay_) : now);
  for (std::size_t k = 0; k < largest_.size(); ++k) largest_[k] = std::max(largest_[k], births_.largest(k));
}

std::vector<double> OutflowControl::factors() const {
  std::vector<double> factors = shares_;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const double rate = births_.at(k, updated_) * volume_of_birth_;
    if (rate > 0.0)
      factors[k] += std::min(missing_[k] / (rate * memory_time_), calibration::largest_outflow_correction);
  }
  return factors;
}

void OutflowControl::save(Bytes& bytes) const {
  births_.save(bytes);
  append(bytes, largest_);
  if (!on_) return;
  updates_.save(bytes);
  append(bytes, updated_);
  append(bytes, counted_);
  append(bytes, missing_);
  append(bytes, shares_);
}

void OutflowControl::restore(ByteReader& saved, bool counts) {
  births_.restore(saved);
  largest_ = saved.take_all<double>();
  if (largest_.size() != births_.outlets()) throw InvalidState("the saved rates of births are damaged");
  if (!on_) return;
  updates_.restore(saved);
  updated_ = saved.take<double>();
  const auto counted = saved.take_all<std::int64_t>();
  missing_ = saved.take_all<double>();
  shares_ = saved.take_all<double>();
  if (counted.size() != counted_.size() || missing_.size() != counted_.size() || shares_.size() != counted_.size())
    throw InvalidState("the saved outflow is damaged");
  if (!counts) return;
  for (std::size_t k = 0; k < counted.size(); ++k) counted_[k] += counted[k];
}

}  // namespace spot
