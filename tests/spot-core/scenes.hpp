// SPDX-License-Identifier: GPL-2.0-or-later
// Packings, containers and small tools that several tests use. Lengths in grain diameters unless said otherwise.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "spot/base/errors.hpp"
#include "spot/geometry/silos.hpp"
#include "spot/packing/packing.hpp"
#include "spot/walk/parameters.hpp"

namespace scenes {

constexpr double pi = 3.14159265358979323846;

/// Random numbers for the tests themselves, the same on every platform.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  spot::Vector3 in_box(const spot::Vector3& low, const spot::Vector3& high) {
    const double x = uniform(low.x(), high.x()), y = uniform(low.y(), high.y()), z = uniform(low.z(), high.z());
    return {x, y, z};
  }
  template <typename T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937_64 engine_;
};

/// Grains by the cube that they are in, so that only those near a place are asked.
class GrainsByCube {
 public:
  /// Nobody farther than `reach` is of interest.
  explicit GrainsByCube(double reach) : reach_(reach > 0.0 ? reach : 1.0) {}

  void add(const spot::Grain& grain) { cubes_[cube(grain.position)].push_back(grain); }

  /// Is this so of any grain in the cubes around?
  template <typename Is>
  bool any_near(const spot::Vector3& place, const Is& is) const {
    const Cube middle = cube(place);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const auto there = cubes_.find({middle[0] + dx, middle[1] + dy, middle[2] + dz});
          if (there != cubes_.end() && std::any_of(there->second.begin(), there->second.end(), is)) return true;
        }
    return false;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  Cube cube(const spot::Vector3& place) const {
    Cube cube;
    for (std::size_t axis = 0; axis < 3; ++axis)
      cube[axis] = static_cast<std::int64_t>(std::floor(place[static_cast<int>(axis)] / reach_));
    return cube;
  }

  double reach_;
  std::map<Cube, std::vector<spot::Grain>> cubes_;
};

/// Random sequential addition: up to n grains, no two centres closer than `least_distance`. Ids are shuffled, so
/// that they say nothing about the order of the grains.
inline std::vector<spot::Grain> random_grains(std::size_t n, const spot::Vector3& low, const spot::Vector3& high,
                                              double least_distance, std::uint64_t seed) {
  Draws draws(seed);
  std::vector<spot::Grain> grains;
  GrainsByCube placed(least_distance);
  for (std::size_t attempt = 0; attempt < 200 * n && grains.size() < n; ++attempt) {
    const spot::Vector3 centre = draws.in_box(low, high);
    const auto too_close = [&](const spot::Grain& other) {
      return (other.position - centre).squaredNorm() < least_distance * least_distance;
    };
    if (placed.any_near(centre, too_close)) continue;
    grains.push_back({0, centre});
    placed.add(grains.back());
  }
  std::vector<std::int64_t> ids(grains.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<std::int64_t>(10 + 3 * i);
  draws.shuffle(ids);
  for (std::size_t i = 0; i < ids.size(); ++i) grains[i].id = ids[i];
  return grains;
}

/// A body-centred lattice with the packing fraction of dense flow, about 0.58, stretched to fill the box of centres
/// from wall to wall, every centre displaced at random by up to `jitter` along each axis. For jitters up to 0.01 no two
/// grains touch in the boxes of these tests.
inline std::vector<spot::Grain> dense_grains(const spot::Vector3& low, const spot::Vector3& high, double jitter,
                                             std::uint64_t seed) {
  Draws draws(seed);
  int layers[3];
  spot::Vector3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = high[axis] - low[axis];
    layers[axis] = static_cast<int>(std::lround(length / 0.609));
    spacing[axis] = layers[axis] > 0 ? length / layers[axis] : 0.0;
  }
  std::vector<spot::Grain> grains;
  for (int iz = 0; iz <= layers[2]; ++iz)
    for (int iy = iz % 2; iy <= layers[1]; iy += 2)
      for (int ix = iz % 2; ix <= layers[0]; ix += 2) {
        const spot::Vector3 site = low + spot::Vector3(ix * spacing.x(), iy * spacing.y(), iz * spacing.z());
        const spot::Vector3 shift = draws.in_box(spot::Vector3::Constant(-jitter), spot::Vector3::Constant(jitter));
        grains.push_back({static_cast<std::int64_t>(grains.size()) + 1, (site + shift).cwiseMax(low).cwiseMin(high)});
      }
  return grains;
}

/// Looser than any default, for tests in which relaxation is not what is tested.
inline spot::RelaxationParameters loose_relaxation() {
  spot::RelaxationParameters relaxation;
  relaxation.tolerance = 3e-3;
  relaxation.momentum = 0.6;
  relaxation.contact_overlap = 1.5e-3;
  return relaxation;
}

/// The parameters of 2006 with the drift speed and injection rate of the project's own DEM run, in d and tau.
inline spot::SpotParameters paper_spots() {
  spot::SpotParameters spots;
  spots.radius = 2.6;
  spots.influence = 2.5e-3;
  spots.step_width = 0.68;
  spots.step_height = 0.1;
  spots.speed = 3.2;
  spots.injection_rate = 363.0;
  spots.seed = 2006;
  return spots;
}

/// No walls at all; the orifice far below.
inline std::unique_ptr<spot::WalledContainer> empty_space() {
  return std::make_unique<spot::WalledContainer>(spot::Orifice{{0.0, 0.0, -1000.0}, 4.0});
}

/// A silo around the origin that spots of 2006 can drain: orifice of radius 4 in the base at z = 0.
inline std::shared_ptr<const spot::Container> small_silo(double half_width, double half_depth) {
  return spot::box_silo(-half_width, half_width, -half_depth, half_depth, spot::Orifice{{0.0, 0.0, 0.0}, 4.0},
                        spot::SpotBuffers{1.0, 2.6});
}

/// The same around another place.
inline std::shared_ptr<const spot::Container> box_silo_at(const spot::Vector3& place, double half_width,
                                                          double half_depth) {
  return spot::box_silo(place.x() - half_width, place.x() + half_width, place.y() - half_depth, place.y() + half_depth,
                        spot::Orifice{place, 4.0}, spot::SpotBuffers{1.0, 2.6});
}

/// The index of the grain with this id; indices change whenever the packing is refreshed.
inline std::uint32_t index_of(const spot::Packing& packing, std::int64_t id) {
  for (std::uint32_t i = 0; i < packing.slots(); ++i)
    if (packing.present(i) && packing.id(i) == id) return i;
  ADD_FAILURE() << "no grain has id " << id;
  return 0;
}

inline std::vector<std::uint32_t> all_movable(const spot::Packing& packing) {
  std::vector<std::uint32_t> movable;
  for (std::uint32_t i = 0; i < packing.slots(); ++i)
    if (packing.present(i) && !packing.held(i)) movable.push_back(i);
  return movable;
}

/// Expects the same ids at the same places, to the last bit.
inline void expect_identical(const std::vector<spot::Grain>& a, const std::vector<spot::Grain>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].id, b[i].id);
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(a[i].position[axis], b[i].position[axis]) << "grain " << a[i].id << ", axis " << axis;
  }
}

/// The text of the exception that `act` must throw.
template <typename Exception, typename Act>
std::string text_of(Act&& act) {
  try {
    act();
  } catch (const Exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

/// How far a chi-square sum lies above its mean, in standard deviations of a normal variable (Wilson and Hilferty).
inline double chi_square_deviation(double sum, double degrees) {
  const double variance = 2.0 / (9.0 * degrees);
  return (std::cbrt(sum / degrees) - (1.0 - variance)) / std::sqrt(variance);
}

/// The same for counts that should be equal.
inline double deviation_from_equal_counts(const std::vector<int>& counts) {
  double total = 0.0;
  for (const int count : counts) total += count;
  const double expected = total / static_cast<double>(counts.size());
  double sum = 0.0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return chi_square_deviation(sum, static_cast<double>(counts.size()) - 1.0);
}

/// Bound of the statistical tests, in standard deviations: a correct program passes with all but one seed in 15,000
/// (two-sided; one in 30,000 for chi-square sums). Seeds are fixed, so a test that has passed once goes on passing.
constexpr double bound = 4.0;

}  // namespace scenes
