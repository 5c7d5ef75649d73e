// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/influence_profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "scenes.hpp"
#include "spot/walk/parameters.hpp"

namespace {

using spot::InfluenceProfile;

/// What every profile says about itself, against sums over places within R_s.
class InfluenceProfileAnalytic : public testing::TestWithParam<const InfluenceProfile*> {
 protected:
  static constexpr double radius = 3.5, h = 0.0625;
  const InfluenceProfile& profile = *GetParam();

  double share(double squared) const { return squared > radius * radius ? 0.0 : profile.share(squared, radius); }

  template <typename Visit>
  static void visit_places_within(const Visit& visit) {
    for (double x = -radius + 0.5 * h; x < radius; x += h)
      for (double y = -radius + 0.5 * h; y < radius; y += h)
        for (double z = -radius + 0.5 * h; z < radius; z += h)
          if (x * x + y * y + z * z <= radius * radius) visit(spot::Vector3(x, y, z));
  }
};

TEST_P(InfluenceProfileAnalytic, MeanShareAndEquivalentRadius) {
  double sum = 0.0, places = 0.0;
  visit_places_within([&](const spot::Vector3& place) {
    sum += share(place.squaredNorm());
    ++places;
  });
  EXPECT_NEAR(profile.mean_share() / (sum / places), 1.0, 2e-3);
  const double volume = sum * h * h * h, equivalent = profile.equivalent_radius(radius);
  EXPECT_NEAR(4.0 / 3.0 * scenes::pi * std::pow(equivalent, 3) / volume, 1.0, 5e-3);
}

TEST_P(InfluenceProfileAnalytic, PartAboveAPlane) {
  for (double plane = -1.25; plane <= 1.25; plane += 0.125) {
    double above = 0.0, whole = 0.0;
    visit_places_within([&](const spot::Vector3& place) {
      const double part = share(place.squaredNorm());
      whole += part;
      // Places are the middles of cubes, which the plane may cut.
      above += part * std::clamp((place.z() + plane * radius) / h + 0.5, 0.0, 1.0);
    });
    EXPECT_NEAR(profile.part_above(plane), above / whole, 2e-3) << plane;
  }
  EXPECT_EQ(profile.part_above(-2.0), profile.part_above(-1.0));
  EXPECT_NEAR(profile.part_above(-1.0), 0.0, 1e-15);
  EXPECT_NEAR(profile.part_above(1.0), 1.0, 1e-15);
}

TEST_P(InfluenceProfileAnalytic, GradientIsTheSlopeOfTheShare) {
  const double step = 1e-5;
  for (double r = 0.1; r < radius - 0.1; r += 0.1) {
    const double slope = (share((r + step) * (r + step)) - share((r - step) * (r - step))) / (2.0 * step);
    EXPECT_NEAR(profile.gradient(r, radius), slope, 1e-8) << r;
  }
}

/// Kernels measure lengths in quanta, of which a radius has millions.
TEST_P(InfluenceProfileAnalytic, KernelsEvaluateTheSameShare) {
  const double quanta = radius * (1 << 24);
  const auto parabola = profile.clipped_parabola(quanta);
  for (double part = 0.0; part < 1.2; part += 0.01) {
    if (std::abs(part - 1.0) < 1e-6) continue;
    const double squared = part * part * quanta * quanta;
    const double evaluated = std::clamp((parabola.radius_squared - squared) * parabola.per_square, 0.0, 1.0);
    EXPECT_NEAR(evaluated, part > 1.0 ? 0.0 : profile.share(squared, quanta), 1e-12) << part;
  }
}

TEST_P(InfluenceProfileAnalytic, SharesGoFromNoneToAll) {
  for (double r = 0.0; r <= radius; r += 0.05) {
    EXPECT_GE(share(r * r), 0.0);
    EXPECT_LE(share(r * r), 1.0);
  }
  EXPECT_EQ(share(0.0), 1.0);
  EXPECT_GT(profile.mean_square_difference(1.0 / radius), 0.0);
  EXPECT_GT(profile.calibrated().radius_in_diameters, 1.0);
  EXPECT_GE(profile.calibrated().momentum, 0.0);
  EXPECT_LT(profile.calibrated().momentum, 1.0);
}

INSTANTIATE_TEST_SUITE_P(All, InfluenceProfileAnalytic, testing::ValuesIn(InfluenceProfile::all()),
                         [](const auto& profile) { return std::string(profile.param->name()); });

/// Pairs in touch of which one is at a place within the spot, along any direction: of smooth profiles, in the limit of
/// small grains; a uniform spot's edge passes through every pair that it is asked about (2006, 2010).
TEST(InfluenceProfilesAnalytic, MeanSquareDifferenceOfAParabolicSpot) {
  const InfluenceProfile& parabolic = *InfluenceProfile::parabolic;
  double sum = 0.0;
  int n = 0;
  const double r = 3.5, d = 0.01, h = 0.1;
  for (double x = -r; x < r; x += h)
    for (double y = -r; y < r; y += h)
      for (double z = -r; z < r; z += h) {
        const spot::Vector3 place(x, y, z);
        if (place.squaredNorm() > r * r) continue;
        for (const spot::Vector3& along : {spot::Vector3(d, 0, 0), spot::Vector3(0, d, 0), spot::Vector3(0, 0, d)}) {
          sum +=
              std::pow(parabolic.share((place + along).squaredNorm(), r) - parabolic.share(place.squaredNorm(), r), 2);
          ++n;
        }
      }
  EXPECT_NEAR(parabolic.mean_square_difference(d / r) / (sum / n), 1.0, 0.02);
  EXPECT_EQ(InfluenceProfile::uniform->mean_square_difference(d / r), 0.25) << "half of all pairs are cut";
}

TEST(InfluenceProfilesUnit, NamesTellThemApart) {
  std::set<std::string> names;
  for (const InfluenceProfile* profile : InfluenceProfile::all()) names.insert(profile->name());
  EXPECT_EQ(names.size(), InfluenceProfile::all().size());
  EXPECT_EQ(names, (std::set<std::string>{"uniform", "parabolic"}));
}

/// Its volume is that of a smaller uniform one.
TEST(InfluenceProfilesAnalytic, ParabolicAndUniformSpotsOfTheSameVolume) {
  spot::SpotParameters uniform{2.6, 2.5e-3}, parabolic{2.6 * std::cbrt(2.5), 2.5e-3};
  parabolic.profile = InfluenceProfile::parabolic;
  EXPECT_NEAR(parabolic.spot_volume(0.6), uniform.spot_volume(0.6), 1e-12);
  EXPECT_NEAR(parabolic.equivalent_radius(), 2.6, 1e-12);
  EXPECT_EQ(uniform.equivalent_radius(), 2.6);
}

}  // namespace
