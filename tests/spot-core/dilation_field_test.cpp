// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/dilation_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes.hpp"
#include "spot/walk/calibration.hpp"

namespace {

using spot::Alone;
using spot::ByteReader;
using spot::Bytes;
using spot::DilationField;
using spot::SpotParameters;
using spot::Vector3;

SpotParameters dilating_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.radius = 3.0;
  spots.fixed_volume = 40.0;
  spots.dilation = 0.03;
  return spots;
}

/// The share of spots that are `spacing` apart along each axis.
double share(const SpotParameters& spots, double spacing) { return spots.missing_volume(1.0) / std::pow(spacing, 3); }

/// Spots on a lattice that fills the box, half a spacing from its faces.
std::vector<Vector3> lattice(const Vector3& low, const Vector3& high, double spacing) {
  std::vector<Vector3> spots;
  for (double x = low.x() + 0.5 * spacing; x < high.x(); x += spacing)
    for (double y = low.y() + 0.5 * spacing; y < high.y(); y += spacing)
      for (double z = low.z() + 0.5 * spacing; z < high.z(); z += spacing) spots.emplace_back(x, y, z);
  return spots;
}

TEST(DilationFieldUnit, ASpotTakesTheVolumeOfItsGrains) {
  SpotParameters spots = dilating_spots();
  EXPECT_DOUBLE_EQ(spots.missing_volume(1.0), 2.5e-3 * 40.0 * scenes::pi / 6.0);
  EXPECT_DOUBLE_EQ(spots.missing_volume(0.003), spots.missing_volume(1.0) * std::pow(0.003, 3));
  spots.fixed_volume = 0.0;
  EXPECT_DOUBLE_EQ(spots.missing_volume(1.0), spots.spot_volume(0.58));
}

/// Also where walls cut lattice cells: in a box, 10.3 d wide, and in a cylinder.
TEST(DilationFieldAnalytic, EvenSpotsDilateEvenlyUpToTheWalls) {
  const SpotParameters spots = dilating_spots();
  Alone alone;
  spot::Workers workers(1);
  const double spacing = 10.3 / 40;
  const auto box = scenes::small_silo(5.15, 5.15);
  const auto everywhere = lattice({-5.15, -5.15, 0.0}, {5.15, 5.15, 30.0}, spacing);
  DilationField field(spots, *box, 1.0);
  field.count(everywhere, alone, workers);
  for (const Vector3& place : {Vector3(0, 0, 10), Vector3(5.1, 0, 12.3), Vector3(-5.1, 5.1, 8.0), Vector3(1, -2, 0.5)})
    EXPECT_NEAR(field.at(place) / share(spots, spacing), 1.0, 0.03) << place.transpose();

  const auto pipe = spot::cylinder_silo(0.0, 0.0, 5.15, spot::Orifice{{0, 0, 0}, 4.0}, spot::SpotBuffers{1.0, 2.6});
  std::vector<Vector3> inside;
  for (const Vector3& place : everywhere)
    if (place.head<2>().norm() < 5.15) inside.push_back(place);
  DilationField round(spots, *pipe, 1.0);
  round.count(inside, alone, workers);
  for (const Vector3& place : {Vector3(0, 0, 10), Vector3(5.1, 0, 12.3), Vector3(-3.6, 3.6, 8.0)})
    EXPECT_NEAR(round.at(place) / share(spots, spacing), 1.0, 0.04) << place.transpose();
}

/// Spots at random, some outside the walls; each node's count is that of all spots by their nearness to it.
TEST(DilationFieldBruteForce, EqualsTheSumOverAllSpots) {
  const SpotParameters spots = dilating_spots();
  const auto space = scenes::empty_space();
  scenes::Draws draws(7);
  std::vector<Vector3> places;
  for (int k = 0; k < 300; ++k) places.push_back(draws.in_box({-9, -7, -4}, {8, 9, 11}));
  Alone alone;
  spot::Workers workers(3);
  DilationField field(spots, *space, 1.0);
  field.count(places, alone, workers);
  const auto hat = [](double a, double b) { return std::max(0.0, 1.0 - std::abs(a - b)); };
  const Vector3 origin = space->outlets()[0].centre;
  for (int k = 0; k < 100; ++k) {
    const Vector3 at = draws.in_box({-13, -10, -8}, {12, 12, 15}), u = (at - origin) / spots.radius;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 node = u.array().floor() + Eigen::Array3d(corner & 1, corner >> 1 & 1, corner >> 2);
      const double near = hat(u.x(), node.x()) * hat(u.y(), node.y()) * hat(u.z(), node.z());
      for (const Vector3& place : places) {
        const Vector3 v = (place - origin) / spots.radius;
        sum += near * hat(v.x(), node.x()) * hat(v.y(), node.y()) * hat(v.z(), node.z());
      }
    }
    const double expected = sum * spots.missing_volume(1.0) / std::pow(spots.radius, 3);
    EXPECT_NEAR(field.at(at), expected, 0.02 * expected + 1e-5)
        << at.transpose();  // whole 256ths of a spot, and of a place
  }
}

TEST(DilationFieldAnalytic, OneSpotDilatesByItsVolumeInAll) {
  const SpotParameters spots = dilating_spots();
  const auto space = scenes::empty_space();
  Alone alone;
  spot::Workers workers(1);
  for (const Vector3& place : {Vector3(0.0, 0.0, 0.0), Vector3(0.7, -1.1, 2.9), Vector3(1.5, 1.5, 1.5)}) {
    DilationField field(spots, *space, 1.0);
    field.count({place}, alone, workers);
    double sum = 0.0;
    const double step = 0.5;
    for (const Vector3& at : lattice(place - Vector3::Constant(10.0), place + Vector3::Constant(10.0), step))
      sum += field.at(at) * step * step * step;
    EXPECT_NEAR(sum / spots.missing_volume(1.0), 1.0, 0.01);
  }
}

TEST(DilationFieldUnit, RelativeSpeedIsTheSquareOfTheDilationWithinBounds) {
  SpotParameters spots = dilating_spots();
  const auto silo = scenes::small_silo(6.0, 6.0);
  const double spacing = 12.0 / 20;
  const auto places = lattice({-6, -6, 0}, {6, 6, 30}, spacing);
  Alone alone;
  spot::Workers workers(1);
  for (const double ratio : {0.1, 0.5, 1.0, 1.7, 3.0}) {
    spots.dilation = share(spots, spacing) / ratio;
    DilationField field(spots, *silo, 1.0);
    field.count(places, alone, workers);
    const double expected = ratio < 0.3   ? spot::calibration::slowest_relative_speed
                            : ratio > 2.0 ? spot::calibration::fastest_relative_speed
                                          : ratio * ratio;
    EXPECT_NEAR(field.relative_speed({0.0, 0.0, 15.0}) / expected, 1.0, 0.05) << ratio;
  }
}

TEST(DilationFieldUnit, NoSpotsAndNoRoom) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  Alone alone;
  spot::Workers workers(1);
  DilationField field(dilating_spots(), *silo, 1.0);
  EXPECT_EQ(field.relative_speed({0, 0, 15}), spot::calibration::slowest_relative_speed);
  field.count({}, alone, workers);
  EXPECT_EQ(field.at({0, 0, 15}), 0.0);
  EXPECT_EQ(field.relative_speed({0, 0, -20}), spot::calibration::fastest_relative_speed);  // where no grain can be
}

TEST(DilationFieldUnit, OtherWallsLeaveOtherVolumes) {
  const SpotParameters spots = dilating_spots();
  const auto wide = scenes::small_silo(20.0, 20.0), narrow = scenes::small_silo(5.0, 5.0);
  Alone alone;
  spot::Workers workers(1);
  DilationField field(spots, *wide, 1.0);
  field.count({{4.9, 0.0, 15.0}}, alone, workers);
  const double before = field.at({4.9, 0.0, 15.0});
  field.replace_container(*narrow);
  EXPECT_GT(field.at({4.9, 0.0, 15.0}), 1.3 * before);
}

TEST(DilationFieldInvariance, SavedCountsComeBack) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  Alone alone;
  spot::Workers workers(1);
  DilationField field(dilating_spots(), *silo, 1.0), other(dilating_spots(), *silo, 1.0);
  field.count(lattice({-5, -4, 1}, {3, 4, 20}, 0.9), alone, workers);
  Bytes bytes;
  field.save(bytes);
  ByteReader reader(bytes);
  other.restore(reader);
  EXPECT_TRUE(reader.at_end());
  for (const Vector3& place : lattice({-6, -6, 0}, {6, 6, 24}, 1.7)) EXPECT_EQ(field.at(place), other.at(place));
  bytes[0] = static_cast<char>(bytes[0] + 1);  // the first node counted
  ByteReader damaged(bytes);
  EXPECT_THAT(scenes::text_of<spot::InvalidState>([&] { other.restore(damaged); }), testing::HasSubstr("are damaged"));
}

}  // namespace
