// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/flow_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "general_scene.hpp"
#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/walk/calibration.hpp"

namespace {

using spot::Alone;
using spot::ByteReader;
using spot::Bytes;
using spot::Container;
using spot::FlowField;
using spot::Move;
using spot::SpotParameters;
using spot::Vector3;

/// The lattice has their radius as its spacing.
SpotParameters wide_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.radius = 3.0;
  return spots;
}
constexpr double spacing = 3.0;

Move step_at(const Vector3& middle, double climb = 0.1) { return {0.0, 0, middle, {0.0, 0.0, climb}}; }

struct Step {
  Move move;
  double volume;
};

/// On a cubic lattice that fills the box, half a spacing from its faces, as much carried as `flow` says there.
template <typename Flow>
std::vector<Step> planted(const Vector3& low, const Vector3& high, double apart, const Flow& flow) {
  std::vector<Step> steps;
  for (double x = low.x() + 0.5 * apart; x < high.x(); x += apart)
    for (double y = low.y() + 0.5 * apart; y < high.y(); y += apart)
      for (double z = low.z() + 0.5 * apart; z < high.z(); z += apart)
        steps.push_back({step_at({x, y, z}), flow(Vector3(x, y, z))});
  return steps;
}

void add(FlowField& field, const std::vector<Step>& steps) {
  for (const Step& step : steps) field.add(step.move, step.volume);
}

/// A field of these steps, taken in at once.
FlowField field_of(const std::vector<Step>& steps, const Container& container) {
  FlowField field(wide_spots(), container, 1.0);
  add(field, steps);
  Alone alone;
  field.update(0.1, alone);
  return field;
}

std::vector<Step> random_steps(int number, const Vector3& low, const Vector3& high, std::uint64_t seed) {
  scenes::Draws draws(seed);
  std::vector<Step> steps;
  for (int k = 0; k < number; ++k) {
    const Vector3 middle = draws.in_box(low, high);
    const double climb = draws.uniform(0.0, 0.2), volume = draws.uniform(0.1, 4.0);
    steps.push_back({step_at(middle, climb), volume});
  }
  return steps;
}

/// Equal to the last bit, inside and outside of what was counted.
void expect_same_shear(const FlowField& one, const FlowField& other) {
  for (double x = -17.0; x < 17.0; x += 1.3)
    for (double y = -17.0; y < 17.0; y += 2.9)
      for (double z = -8.0; z < 20.0; z += 3.7) {
        const Vector3 at(x, y, z);
        ASSERT_EQ(one.shear(at), other.shear(at)) << at.transpose();
        ASSERT_EQ(one.slope(at), other.slope(at)) << at.transpose();
      }
}

/// Of e^(kx), differences over two spacings h and the mean that they are divided by give (2 / h) tanh(k h / 2); sharing
/// steps between nodes changes no exponential but by a factor.
TEST(FlowFieldAnalytic, AnExponentialIsShearedEvenly) {
  const auto space = scenes::empty_space();
  for (const Vector3& k : {Vector3(0.1, 0.0, 0.0), Vector3(0.0, -0.2, 0.0), Vector3(0.15, 0.2, 0.0)}) {
    const FlowField field = field_of(
        planted({-15, -15, -6}, {15, 15, 6}, 0.75, [&](const Vector3& at) { return std::exp(k.dot(at)); }), *space);
    const auto along = [&](int axis) { return 2.0 / spacing * std::tanh(0.5 * spacing * k[axis]); };
    const double expected = std::hypot(along(0), along(1));
    for (const Vector3& at : {Vector3(0, 0, 0), Vector3(3, -3, 0), Vector3(1.1, 2.3, -0.7), Vector3(-4, 0.2, 1)})
      EXPECT_NEAR(field.shear(at) / expected, 1.0, 0.002) << k.transpose() << " at " << at.transpose();
    EXPECT_NEAR(expected / k.norm(), 1.0, 0.04) << "as fine as the lattice is";
  }
}

/// What falls faster higher up is not sheared by that.
TEST(FlowFieldAnalytic, NothingIsShearedByWhatChangesUpwards) {
  const auto space = scenes::empty_space();
  const FlowField field = field_of(
      planted({-12, -12, -12}, {12, 12, 12}, 0.75, [](const Vector3& at) { return std::exp(0.2 * at.z()); }), *space);
  EXPECT_NEAR(field.shear({0.3, 1.0, 2.0}), 0.0, 1e-3);
}

/// All that it is strained by has that, too; and what walls shear. A point lies between nodes of one exponential.
TEST(FlowFieldAnalytic, AnExponentialIsStrainedByItsWholeGradient) {
  SpotParameters spots = wide_spots();
  spots.full_strain = 0.2;
  spots.wall_shear = 0.7;
  const auto space = scenes::empty_space();
  const double walls = spot::shear_by_walls(spots.wall_shear, *space, {0, 0, 0}, spacing);
  for (const Vector3& k : {Vector3(0.1, 0.0, 0.2), Vector3(0.0, -0.15, -0.1), Vector3(0.0, 0.0, 0.2)}) {
    FlowField field(spots, *space, 1.0);
    add(field, planted({-12, -12, -12}, {12, 12, 12}, 0.75, [&](const Vector3& at) { return std::exp(k.dot(at)); }));
    Alone alone;
    field.update(0.1, alone);
    const auto along = [&](int axis) { return 2.0 / spacing * std::tanh(0.5 * spacing * k[axis]); };
    const double expected = std::hypot(std::hypot(along(0), along(1)), along(2)) + walls;
    for (const Vector3& at : {Vector3(0, 0, 0), Vector3(1.1, 2.3, -0.7), Vector3(-4, 0.2, 1)}) {
      EXPECT_NEAR(field.strain(at).whole / expected, 1.0, 0.002) << k.transpose() << " at " << at.transpose();
      EXPECT_EQ(field.strain(at).shear, field.shear(at));
    }
    EXPECT_EQ(field.strain({100, 0, 0}).whole, 0.0) << "where no spot has been";
  }
}

TEST(FlowFieldUnit, WithoutAStrainOfFullExchangeNobodyAsksForMoreThanShear) {
  const auto space = scenes::empty_space();
  const FlowField field = field_of(random_steps(200, {-9, -7, -4}, {8, 9, 11}, 1), *space);
  EXPECT_EQ(field.strain({1, 1, 1}).whole, 0.0);
  EXPECT_GT(field.strain({1, 1, 1}).shear, 0.0);
}

/// x / sigma^2, of a Gaussian that each node sees smoothed by its nearness to places around.
TEST(FlowFieldAnalytic, AGaussianIsShearedInProportionToTheDistanceFromItsMiddle) {
  const auto space = scenes::empty_space();
  const double sigma = 6.0;
  const auto gauss = [&](double x) { return std::exp(-0.5 * x * x / (sigma * sigma)); };
  const FlowField field =
      field_of(planted({-18, -9, -6}, {18, 9, 6}, 0.75, [&](const Vector3& at) { return gauss(at.x()); }), *space);
  const auto smoothed = [&](double node) {
    double sum = 0.0;
    for (double x = -spacing + 5e-3; x < spacing; x += 0.01) sum += (1.0 - std::abs(x) / spacing) * gauss(node + x);
    return sum;
  };
  for (const double x : {-9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0}) {
    const double low = smoothed(x - spacing), here = smoothed(x), high = smoothed(x + spacing);
    const double expected = std::abs(high - low) / (2.0 * spacing * (0.25 * (low + high) + 0.5 * here));
    EXPECT_NEAR(field.shear({x, 0.0, 0.0}), expected, 1e-3) << x;
    EXPECT_NEAR(field.shear({x, 0.0, 0.0}), std::abs(x) / (sigma * sigma), 0.02 * std::abs(x) / 9.0 * 3.0 + 1e-3) << x;
  }
}

double hat(double a, double b) { return std::max(0.0, 1.0 - std::abs(a - b)); }

/// With all steps since the start, each by its age.
class PlainFlow {
 public:
  explicit PlainFlow(const Container& container) : origin_(container.outlets()[0].centre) {}

  void add(const Step& step, double time) { steps_.push_back({step, time}); }

  /// In empty space, at a place with steps all around.
  double shear(const Vector3& at, double now) const {
    const Vector3 u = (at - origin_) / spacing;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 node = u.array().floor() + Eigen::Array3d(corner & 1, corner >> 1 & 1, corner >> 2);
      const double near = hat(u.x(), node.x()) * hat(u.y(), node.y()) * hat(u.z(), node.z());
      if (near > 0.0) sum += near * shear_of(node, now);
    }
    return sum;
  }

 private:
  double shear_of(const Vector3& node, double now) const {
    double squared = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double low = flow(node - Vector3::Unit(axis), now), high = flow(node + Vector3::Unit(axis), now);
      const double mean = 0.25 * (low + high) + 0.5 * flow(node, now);
      if (mean > 0.0) squared += std::pow((high - low) / (2.0 * spacing * mean), 2);
    }
    return std::sqrt(squared);
  }

  double flow(const Vector3& node, double now) const {
    const SpotParameters spots = wide_spots();
    const double memory = spot::calibration::climb_of_flow_memory * spots.radius / spots.speed;
    double sum = 0.0;
    for (const auto& [step, time] : steps_) {
      const Vector3 v = (step.move.middle - origin_) / spacing;
      sum += std::exp(-(now - time) / memory) * step.volume * step.move.step.z() * hat(v.x(), node.x()) *
             hat(v.y(), node.y()) * hat(v.z(), node.z());
    }
    return sum;
  }

  Vector3 origin_;
  std::vector<std::pair<Step, double>> steps_;
};

TEST(FlowFieldBruteForce, EqualsTheSumOverAllStepsSinceTheStart) {
  const auto space = scenes::empty_space();
  FlowField field(wide_spots(), *space, 1.0);
  PlainFlow plain(*space);
  Alone alone;
  double now = 0.0;
  for (const double elapsed : {0.5, 7.0, 0.0, 12.0}) {
    now += elapsed;
    for (const Step& step : random_steps(150, {-9, -7, -4}, {8, 9, 11}, static_cast<std::uint64_t>(now) + 5)) {
      field.add(step.move, step.volume);
      plain.add(step, now);
    }
    field.update(elapsed, alone);
    for (int k = 0; k < 40; ++k) {
      const Vector3 at = scenes::Draws(static_cast<std::uint64_t>(k)).in_box({-9, -7, -4}, {8, 9, 11});
      const double expected = plain.shear(at, now);
      // Whole 256ths of a step along each axis, and of a place.
      EXPECT_NEAR(field.shear(at), expected, 0.02 * expected + 5e-3) << at.transpose() << ", time " << now;
    }
  }
}

/// Up to the walls of a box and of a cylinder, which cut lattice cells, an even flow is sheared little; with no walls
/// there, its end is.
TEST(FlowFieldAnalytic, AcrossAWallNothingIsSheared) {
  const auto evenly = [](const Vector3&) { return 1.0; };
  const auto box = scenes::small_silo(5.15, 5.15);
  const auto pipe = spot::cylinder_silo(0.0, 0.0, 5.15, spot::Orifice{{0, 0, 0}, 4.0}, spot::SpotBuffers{1.0, 2.6});
  const auto space = std::make_unique<spot::WalledContainer>(spot::Orifice{{0.0, 0.0, 0.0}, 4.0});
  const auto steps = planted({-5.15, -5.15, 0.0}, {5.15, 5.15, 30.0}, 10.3 / 20, evenly);
  std::vector<Step> in_pipe;
  for (const Step& step : steps)
    if (step.move.middle.head<2>().norm() < 5.15) in_pipe.push_back(step);
  const FlowField in_box = field_of(steps, *box), round = field_of(in_pipe, *pipe), open = field_of(steps, *space);
  for (const Vector3& at : {Vector3(0, 0, 10), Vector3(5.1, 0, 12.3), Vector3(0, -5.1, 8.0), Vector3(3.6, -3.5, 8.0)}) {
    EXPECT_LT(in_box.shear(at), 0.02) << at.transpose();
    EXPECT_LT(round.shear(at), 0.03) << at.transpose();
  }
  EXPECT_GT(open.shear({5.1, 0.0, 12.3}), 0.15);
  EXPECT_GT(open.shear({0.0, -5.1, 8.0}), 0.15);
}

TEST(FlowFieldAnalytic, WhereSpaceRepeatsTheFieldDoes) {
  const double length = 24.0;
  const auto silo =
      scenes::repeated_silo({-12.0, -8.0, 0.0}, {12.0, 8.0, 0.0}, true, false, {{0.0, 0.0, 0.0}, 4.0}, {1.0, 2.6});
  const auto steps = planted({-12, -8, 0}, {12, 8, 12}, 0.75, [&](const Vector3& at) {
    return 2.0 + std::cos(2.0 * scenes::pi * (at.x() - 7.0) / length);
  });
  std::vector<Step> images = steps;
  for (std::size_t k = 0; k < images.size(); ++k)
    images[k].move.middle.x() += length * (static_cast<double>(k % 3) - 1.0);
  const FlowField field = field_of(steps, *silo), same = field_of(images, *silo);
  expect_same_shear(field, same);
  // At nodes, which see the cosine smoothed over both sides.
  const double k = 2.0 * scenes::pi / length, half = 0.5 * k * spacing;
  const double smoothed = std::pow(std::sin(half) / half, 2);
  const auto flow = [&](double x) { return 2.0 + smoothed * std::cos(k * (x - 7.0)); };
  for (double x = -12.0; x <= 12.0; x += spacing) {
    const double low = flow(x - spacing), high = flow(x + spacing);
    const double expected = std::abs(high - low) / (2.0 * spacing * (0.25 * (low + high) + 0.5 * flow(x)));
    EXPECT_NEAR(field.shear({x, 1.0, 6.0}), expected, 1e-3) << x;
    EXPECT_EQ(field.shear({x + 0.7, 1.0, 6.0}), field.shear({x + 0.7 + length, 1.0, 6.0})) << x;
  }
}

SpotParameters spreading_spots() {
  SpotParameters spots = wide_spots();
  spots.spread = 0.6;
  return spots;
}

TEST(FlowFieldAnalytic, AnExponentialSlopesEvenly) {
  const auto space = scenes::empty_space();
  for (const Vector3& k : {Vector3(0.1, 0.0, 0.0), Vector3(0.0, -0.2, 0.0), Vector3(0.15, 0.2, 0.0)}) {
    FlowField field(spreading_spots(), *space, 1.0);
    add(field, planted({-15, -15, -6}, {15, 15, 6}, 0.75, [&](const Vector3& at) { return std::exp(k.dot(at)); }));
    Alone alone;
    field.update(0.1, alone);
    const auto along = [&](int axis) { return 2.0 / spacing * std::tanh(0.5 * spacing * k[axis]); };
    const Vector3 expected(along(0), along(1), 0.0);
    for (const Vector3& at : {Vector3(0, 0, 0), Vector3(3, -3, 0), Vector3(1.1, 2.3, -0.7)})
      EXPECT_LT((field.slope(at) - expected).norm(), 0.002) << k.transpose();
  }
}

/// Spots that carry e^(kx) up past every place make grains fall by as much. On the nodes, h apart, an exponential is
/// larger by (2 sinh(k h / 2) / (k h))^2. What has fallen is not forgotten, however long ago it was; what tells the
/// shear is.
TEST(FlowFieldAnalytic, APackingIsMobileWhereItHasFallen) {
  const auto space = scenes::empty_space();
  SpotParameters spots = spreading_spots();
  spots.fixed_volume = 77.0;
  spots.mobility = {0.4, 1.0, 1.5};
  const double apart = 0.75, k = 0.2, half = 0.5 * k * spacing;
  const double fall = spots.influence * 77.0 * scenes::pi / 6.0 * spots.step_height /
                      (spot::calibration::packing_fraction_of_flow * std::pow(apart, 3)) *
                      std::pow(std::sinh(half) / half, 2);
  const auto steps =
      planted({-15, -15, -6}, {15, 15, 6}, apart, [&](const Vector3& at) { return 10.0 * std::exp(k * at.x()); });
  FlowField field(spots, *space, 1.0);
  Alone alone;
  for (int times = 1; times <= 3; ++times) {
    add(field, steps);
    field.update(1e3, alone);
    const auto logarithm = [&](double x) { return spots.mobility.logarithm(times * 10.0 * fall * std::exp(k * x)); };
    for (const double x : {-3.0, 0.0, 3.0}) {
      const double expected = (logarithm(x + spacing) - logarithm(x - spacing)) / (2.0 * spacing);
      EXPECT_GT(expected, 0.02);
      EXPECT_LT((field.slope_of_mobility({x, 0, 0}) - Vector3(expected, 0, 0)).norm(), 2e-3 * expected) << times;
    }
  }
  EXPECT_EQ(field.slope_of_mobility({100, 0, 0}), Vector3(Vector3::Zero()));
  Bytes bytes;
  field.save(bytes);
  FlowField again(spots, *space, 1.0);
  ByteReader saved(bytes);
  again.restore(saved);
  EXPECT_EQ(again.slope_of_mobility({1.1, 2.3, -0.7}), field.slope_of_mobility({1.1, 2.3, -0.7}));
  FlowField other(spreading_spots(), *space, 1.0);
  ByteReader once_more(bytes);
  EXPECT_THROW(other.restore(once_more), spot::InvalidState) << "saved by other parameters";
}

TEST(FlowFieldUnit, WhereAllIsMobileNobodyAsks) {
  const auto space = scenes::empty_space();
  const FlowField field = field_of(random_steps(200, {-9, -7, -4}, {8, 9, 11}, 1), *space);
  EXPECT_EQ(field.slope_of_mobility({1, 1, 1}), Vector3(Vector3::Zero()));
}

/// Between plates at +-4 they shear by kappa / 4 everywhere, besides what the flow itself does.
TEST(FlowFieldAnalytic, WallsShearWhatFallsBetweenThem) {
  SpotParameters spots = wide_spots();
  spots.wall_shear = 0.7;
  const auto narrow = scenes::small_silo(1e6, 4.0);
  const Vector3 k(0.1, 0.0, 0.0);
  FlowField field(spots, *narrow, 1.0);
  add(field, planted({-15, -4, 1}, {15, 4, 13}, 0.5, [&](const Vector3& at) { return std::exp(k.dot(at)); }));
  Alone alone;
  field.update(0.1, alone);
  const double far = spot::calibration::farthest_walls * spacing;
  const double slope = 2.0 / spacing * std::tanh(0.5 * spacing * k.x()), s = slope + 0.7 * (1.0 / 4.0 + 1.0 / far);
  for (const Vector3& at : {Vector3(0, 0, 6), Vector3(2.0, 1.0, 7.3)}) {
    EXPECT_NEAR(field.shear(at), s, 0.01) << at.transpose();
  }
  const auto wide = scenes::small_silo(1e6, 8.0);
  field.replace_container(*wide);
  EXPECT_NEAR(field.shear({0.0, 0.0, 6.0}) - slope, 0.7 * (1.0 / 8.0 + 1.0 / far), 0.02);
}

TEST(FlowFieldUnit, WithoutASpreadNobodyAsksForSlopes) {
  const auto space = scenes::empty_space();
  const FlowField field = field_of(random_steps(200, {-9, -7, -4}, {8, 9, 11}, 1), *space);
  EXPECT_GT(field.shear({1, 1, 1}), 0.0);
  EXPECT_EQ(field.slope({1, 1, 1}), Vector3(Vector3::Zero()));
}

TEST(FlowFieldUnit, WhereNoSpotHasBeenNothingIsSheared) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  Alone alone;
  FlowField field(wide_spots(), *silo, 1.0);
  EXPECT_EQ(field.shear({0, 0, 15}), 0.0);
  field.update(1.0, alone);
  EXPECT_EQ(field.shear({0, 0, 15}), 0.0);
  field.add(step_at({1.0, 0.0, 15.0}), 1.0);
  EXPECT_EQ(field.shear({1, 0, 15}), 0.0) << "before the update";
  field.update(1.0, alone);
  EXPECT_GT(field.shear({1, 0, 15}), 0.0);
  EXPECT_EQ(field.shear({1, 0, 40}), 0.0);
}

/// Shear is a share of the flow: neither how much of it there is nor how long ago it was counts.
TEST(FlowFieldUnit, ShearDoesNotDependOnHowMuchFlows) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  const auto steps = random_steps(500, {-6, -6, 1}, {6, 6, 14}, 3);
  std::vector<Step> twice = steps;
  twice.insert(twice.end(), steps.begin(), steps.end());
  FlowField once = field_of(steps, *silo);
  const FlowField both = field_of(twice, *silo);
  for (const Step& step : steps) EXPECT_NEAR(both.shear(step.move.middle), once.shear(step.move.middle), 1e-12);
  const double before = once.shear({2.0, 1.0, 7.0});
  Alone alone;
  once.update(50.0, alone);
  EXPECT_NEAR(once.shear({2.0, 1.0, 7.0}), before, 1e-12);
}

TEST(FlowFieldUnit, OtherWallsLeaveOtherVolumes) {
  const auto wide = scenes::small_silo(20.0, 20.0), narrow = scenes::small_silo(5.0, 5.0);
  FlowField field = field_of(planted({-5, -5, 0}, {5, 5, 20}, 0.5, [](const Vector3&) { return 1.0; }), *wide);
  EXPECT_GT(field.shear({4.9, 0.0, 10.0}), 0.15);
  field.replace_container(*narrow);
  EXPECT_LT(field.shear({4.9, 0.0, 10.0}), 0.02);
}

/// In one field steps that carry nothing have opened all of it from the start; in the other it grows.
TEST(FlowFieldInvariance, WhatIsCountedInAGrowingBoxIsKept) {
  const auto space = scenes::empty_space();
  FlowField large(wide_spots(), *space, 1.0), growing(wide_spots(), *space, 1.0);
  Alone alone;
  std::vector<Vector3> ends = {Vector3(-16, 2, -7), Vector3(14, -15, 18), Vector3(0, 16, 3)};
  for (const Vector3& end : ends) large.add(step_at(end), 0.0);
  for (int k = 0; k < 4; ++k) {
    const double reach = 2.0 + 3.0 * k;
    const auto steps = random_steps(200, {-reach, -1, -1}, {1, reach, reach}, 20 + static_cast<std::uint64_t>(k));
    add(large, steps);
    add(growing, steps);
    if (k == 3)
      for (const Vector3& end : ends) growing.add(step_at(end), 0.0);
    large.update(1.5, alone);
    growing.update(1.5, alone);
  }
  expect_same_shear(large, growing);
}

TEST(FlowFieldInvariance, ASavedFieldComesBackWithStepsThatWereNotTakenIn) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  Alone alone;
  FlowField field = field_of(random_steps(300, {-5, -4, 1}, {3, 4, 15}, 1), *silo);
  add(field, random_steps(100, {-5, -4, 1}, {5, 5, 19}, 2));
  Bytes bytes;
  field.save(bytes);
  FlowField other(wide_spots(), *silo, 1.0);
  ByteReader reader(bytes);
  other.restore(reader);
  EXPECT_TRUE(reader.at_end());
  expect_same_shear(field, other);
  const double before = field.shear({1.0, 1.0, 10.0});
  field.update(0.7, alone);
  other.update(0.7, alone);
  EXPECT_NE(field.shear({1.0, 1.0, 10.0}), before);
  expect_same_shear(field, other);
  bytes[0] = static_cast<char>(bytes[0] + 1);  // the first node counted
  ByteReader damaged(bytes);
  FlowField third(wide_spots(), *silo, 1.0);
  EXPECT_THAT(scenes::text_of<spot::InvalidState>([&] { third.restore(damaged); }), testing::HasSubstr("is damaged"));
}

TEST(FlowFieldInvariance, RanksChangeNothing) {
  const auto silo = scenes::small_silo(6.0, 6.0);
  const auto steps_of = [](int k) {
    return random_steps(200, {-5, -4, 1}, {3, 4, 6.0 + 5.0 * k}, 30 + static_cast<std::uint64_t>(k));
  };
  Alone alone;
  FlowField one(spreading_spots(), *silo, 1.0);
  for (int k = 0; k < 3; ++k) {
    add(one, steps_of(k));
    one.update(2.0, alone);
  }
  scenes::on_ranks(3, [&](std::shared_ptr<spot::Communicator> communicator) {
    FlowField field(spreading_spots(), *silo, 1.0);
    for (int k = 0; k < 3; ++k) {
      const auto steps = steps_of(k);
      // In the second update all steps are of the last rank.
      for (std::size_t i = 0; i < steps.size(); ++i)
        if (k == 1 ? communicator->rank() == 2 : static_cast<int>(i) % 3 == communicator->rank())
          field.add(steps[i].move, steps[i].volume);
      field.update(2.0, *communicator);
    }
    expect_same_shear(one, field);
  });
}

}  // namespace
