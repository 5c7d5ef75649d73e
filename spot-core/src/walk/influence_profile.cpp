// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/influence_profile.hpp"

#include <algorithm>

#include "spot/base/elementary.hpp"

namespace spot {

namespace {

class Uniform final : public InfluenceProfile {
 public:
  constexpr Uniform() = default;
  const char* name() const override { return "uniform"; }
  double share(double, double) const override { return 1.0; }
  double gradient(double, double) const override { return 0.0; }
  double mean_share() const override { return 1.0; }
  double mean_square_share() const override { return 1.0; }
  /// One of the two is as likely as not to be inside.
  double mean_square_difference(double) const override { return 0.25; }
  /// In quanta: whoever is inside by one or more moves all the way.
  ClippedParabola clipped_parabola(double radius) const override { return {radius * radius, 1.0}; }
  Calibrated calibrated() const override { return {2.6, 0.5, 0.5}; }

 private:
  /// 2010, section 3.3.
  double part_above_within(double z) const override { return 0.5 + 0.75 * z - 0.25 * z * z * z; }
};

class Parabolic final : public InfluenceProfile {
 public:
  constexpr Parabolic() = default;
  const char* name() const override { return "parabolic"; }
  double share(double distance_squared, double radius) const override {
    return 1.0 - distance_squared / (radius * radius);
  }
  double gradient(double distance, double radius) const override { return -2.0 * distance / (radius * radius); }
  double mean_share() const override { return 0.4; }
  double mean_square_share() const override { return 8.0 / 35.0; }
  /// 4 d^2 <r^2> <cos^2> / R_s^4 with <r^2> = 3 R_s^2 / 5 and <cos^2> = 1/3.
  double mean_square_difference(double diameter) const override { return 0.8 * diameter * diameter; }
  ClippedParabola clipped_parabola(double radius) const override { return {radius * radius, 1.0 / (radius * radius)}; }
  /// The radius is that of a uniform spot of 2.6 d with the same volume, rounded.
  Calibrated calibrated() const override { return {3.53, 0.67, 0.6}; }

 private:
  /// Discs of it have the volume pi (1 - z^2)^2 / 2.
  double part_above_within(double z) const override {
    return 0.5 + 0.9375 * (z - 2.0 / 3.0 * z * z * z + 0.2 * z * z * z * z * z);
  }
};

const Uniform the_uniform;
const Parabolic the_parabolic;

}  // namespace

const InfluenceProfile* const InfluenceProfile::uniform = &the_uniform;
const InfluenceProfile* const InfluenceProfile::parabolic = &the_parabolic;

const std::vector<const InfluenceProfile*>& InfluenceProfile::all() {
  static const std::vector<const InfluenceProfile*> profiles = {uniform, parabolic};
  return profiles;
}

double InfluenceProfile::part_above(double z) const { return part_above_within(std::clamp(z, -1.0, 1.0)); }

double InfluenceProfile::equivalent_radius(double radius) const { return radius * cbrt(mean_share()); }

}  // namespace spot
