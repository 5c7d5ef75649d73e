// SPDX-License-Identifier: GPL-2.0-or-later
// Grains of unequal size, and silos that repeat along x, y or both.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "scenes.hpp"
#include "spot/drivers/drainage.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/plane_wall.hpp"

namespace scenes {

/// Is this so of a place, or of its image beyond either end of a period?
template <typename Is>
bool near_any_image(const spot::Vector3& place, const spot::Periodic& periodic, const Is& is) {
  const auto shifts = [&](int axis) {
    const double length = periodic.along(axis) ? periodic.high(axis) - periodic.low(axis) : 0.0;
    return length > 0.0 ? std::vector<double>{-length, 0.0, length} : std::vector<double>{0.0};
  };
  for (const double x : shifts(0))
    for (const double y : shifts(1))
      if (is(spot::Vector3(place + spot::Vector3(x, y, 0.0)))) return true;
  return false;
}

/// Random sequential addition of up to n grains between walls, radii drawn uniformly from d/4 to d/2 (or all d/2), the
/// largest first; no two overlap, nor any a wall or, along the axes on which space repeats, an image. Ids are shuffled.
inline std::vector<spot::Grain> unequal_grains(std::size_t n, const spot::Vector3& low, const spot::Vector3& high,
                                               const spot::Periodic& periodic, std::uint64_t seed,
                                               double diameter = 1.0, bool equal = false) {
  Draws draws(seed);
  std::vector<double> radii;
  for (std::size_t k = 0; k < n; ++k) radii.push_back(equal ? 0.5 * diameter : diameter * draws.uniform(0.25, 0.5));
  std::sort(radii.rbegin(), radii.rend());
  std::vector<spot::Grain> grains;
  GrainsByCube placed(diameter);
  for (const double radius : radii)
    for (int attempt = 0; attempt < 200; ++attempt) {
      spot::Vector3 margin = spot::Vector3::Constant(radius);
      for (int axis = 0; axis < 2; ++axis)
        if (periodic.along(axis)) margin[axis] = 0.0;
      const spot::Vector3 centre = draws.in_box(low + margin, high - margin);
      const auto overlaps = [&](const spot::Grain& other) {
        return periodic.nearest(spot::Vector3(other.position - centre)).norm() < radius + other.radius;
      };
      if (near_any_image(centre, periodic, [&](const auto& image) { return placed.any_near(image, overlaps); }))
        continue;
      grains.push_back({0, centre, false, radius});
      placed.add(grains.back());
      break;
    }
  std::vector<std::int64_t> ids;
  for (std::size_t k = 0; k < grains.size(); ++k) ids.push_back(static_cast<std::int64_t>(3 + 7 * k));
  draws.shuffle(ids);
  for (std::size_t k = 0; k < grains.size(); ++k) grains[k].id = ids[k];
  return grains;
}

/// A base with an orifice, walls along the axes on which nothing repeats, no walls along the others.
inline std::shared_ptr<const spot::Container> repeated_silo(const spot::Vector3& low, const spot::Vector3& high,
                                                            bool repeats_x, bool repeats_y,
                                                            const spot::Orifice& orifice,
                                                            const spot::SpotBuffers& buffers) {
  const bool repeats[] = {repeats_x, repeats_y};
  auto silo = std::make_shared<spot::WalledContainer>(orifice);
  silo->add(std::make_unique<spot::BasePlate>(orifice), buffers.base);
  std::optional<spot::Interval> intervals[2];
  for (int axis = 0; axis < 2; ++axis) {
    if (repeats[axis]) {
      intervals[axis] = {low[axis], high[axis]};
      continue;
    }
    silo->add(std::make_unique<spot::PlaneWall>(low, spot::Vector3::Unit(axis)), buffers.side);
    silo->add(std::make_unique<spot::PlaneWall>(high, -spot::Vector3::Unit(axis)), buffers.side);
  }
  silo->repeat({intervals[0], intervals[1]});
  return silo;
}

/// A drainage drawn from a seed: grains of equal or unequal size, a silo that repeats along none, one or both of x and
/// y.
class GeneralScene {
 public:
  explicit GeneralScene(std::uint64_t seed) : seed_(seed) {
    Draws draws(seed);
    constexpr double diameters[] = {1.0, 0.003, 250.0};
    diameter_ = diameters[draws.below(3)];
    const double d = diameter_;
    repeats_x_ = draws.below(2) == 0;
    repeats_y_ = draws.below(2) == 0;
    equal_ = draws.below(4) == 0;
    spots_.radius = d * draws.uniform(1.0, 2.5);
    // At least 2 (R_s + 2 d) wide.
    const spot::Vector3 place = d * draws.in_box(spot::Vector3::Constant(-9.0), spot::Vector3::Constant(9.0));
    const double width = 2.0 * spots_.radius + 4.01 * d;
    const spot::Vector3 size(width + d * draws.uniform(0.0, 6.0), width + d * draws.uniform(0.0, 3.0),
                             d * draws.uniform(4.0, 12.0));
    low_ = place;
    high_ = place + size;
    const double radius = spots_.radius * draws.uniform(1.0, 1.0 + d / spots_.radius);
    const spot::Vector3 centre(draws.uniform(low_.x() + radius, high_.x() - radius),
                               draws.uniform(low_.y() + radius, high_.y() - radius), low_.z());
    silo_ = repeated_silo(low_, high_, repeats_x_, repeats_y_, {centre, radius},
                          {d * draws.uniform(0.0, 1.0), d * draws.uniform(0.0, 2.0)});
    limits_.outlet = low_.z() - (draws.below(3) == 0 ? 0.5 * spots_.radius : 0.0);
    const double volume = size.prod() / (d * d * d);
    grains_ = unequal_grains(static_cast<std::size_t>((equal_ ? 0.7 : 1.4) * volume), low_, high_, silo_->periodic(),
                             draws.below(1u << 30), d, equal_);
    const double held = draws.below(3) == 0 ? 0.05 : 0.0;
    for (spot::Grain& grain : grains_) grain.held = draws.uniform(0.0, 1.0) < held;
    spots_.influence = draws.uniform(0.005, 0.03);
    spots_.step_height = d * draws.uniform(0.1, 0.6);
    spots_.step_width = d * draws.uniform(0.2, 1.2);
    spots_.speed = 3.0 * d;
    spots_.injection_rate = draws.uniform(100.0, 400.0);
    spots_.seed = seed;
    if (draws.below(2) == 0) spots_.profile = spot::InfluenceProfile::parabolic;
    if (draws.below(2) == 0) spots_.fixed_volume = 2.5 * std::pow(spots_.radius / d, 3);
    if (draws.below(2) == 0) spots_.persistence = 0.5;
    if (draws.below(2) == 0) spots_.dilation = draws.uniform(0.01, 0.2);
    relaxation_.alpha = draws.uniform(0.5, 1.0);
    if (draws.below(2) == 0) relaxation_.contact_overlap = 1e-3;
    if (draws.below(2) == 0) spots_.surface_exponent = draws.uniform(0.5, 6.0);
    if (draws.below(2) == 0 && spots_.fixed_volume > 0.0) {
      spots_.critical_fraction = draws.uniform(0.5, 0.7);
      spots_.exchange_length = spots_.step_height * draws.uniform(0.2, 5.0);
      if (draws.below(2) == 0) spots_.dilatancy = spots_.radius * draws.uniform(0.02, 0.33);
    }
    // Drawn last, so that all else in a scene is as it was before.
    if (draws.below(2) == 0) {
      spots_.nonaffine = draws.uniform(0.05, 0.5);
      spots_.nonaffine_length = d * draws.uniform(0.05, 2.0);
    }
    if (!equal_ && draws.below(2) == 0) count_in_mean_grains();
    if (draws.below(2) == 0 && spots_.fixed_volume > 0.0 && spots_.persistence == 0.0) {
      spots_.spread = draws.uniform(0.05, 2.0);
      spots_.wall_shear = draws.uniform(0.0, 2.0);
      if (draws.below(2) == 0)
        spots_.mobility = {draws.uniform(0.01, 1.0), d * draws.uniform(0.1, 10.0), d * draws.uniform(0.1, 10.0)};
    }
    if (spots_.critical_fraction > 0.0 && draws.below(2) == 0)
      spots_.full_strain = draws.uniform(0.01, 3.0) / spots_.radius;
  }

  std::unique_ptr<spot::TimeOrderedDrainage> start_time_ordered() const {
    return std::make_unique<spot::TimeOrderedDrainage>(spots_, relaxation_, limits_, silo_,
                                                       spot::Packing(diameter_, extent(), grains_, silo_->periodic()));
  }

  spot::RelaxationParameters windowed_relaxation() const {
    spot::RelaxationParameters relaxation = relaxation_;
    relaxation.momentum = seed_ % 3 == 0 ? 0.0 : 0.6;
    relaxation.tolerance = 2e-3;
    return relaxation;
  }

  /// Each rank brings some of the grains.
  std::unique_ptr<spot::WindowedDrainage> start_windowed(
      int threads, std::shared_ptr<spot::Communicator> communicator = std::make_shared<spot::Alone>()) const {
    std::vector<spot::Grain> own;
    for (std::size_t i = 0; i < grains_.size(); ++i)
      if (static_cast<int>(i) % communicator->size() == communicator->rank()) own.push_back(grains_[i]);
    return std::make_unique<spot::WindowedDrainage>(spots_, windowed_relaxation(), limits_, window(), threads, silo_,
                                                    diameter_, extent(), own, communicator);
  }
  std::unique_ptr<spot::WindowedDrainage> go_on(
      const std::vector<spot::Bytes>& saved, int threads,
      std::shared_ptr<spot::Communicator> communicator = std::make_shared<spot::Alone>()) const {
    return std::make_unique<spot::WindowedDrainage>(spots_, windowed_relaxation(), limits_, window(), threads, silo_,
                                                    diameter_, extent(), saved, communicator);
  }
  static constexpr double window() { return 0.01; }

  double diameter() const { return diameter_; }
  const spot::Vector3& low() const { return low_; }
  const spot::Vector3& high() const { return high_; }
  double extent() const { return 100.0 * diameter_; }
  bool equal() const { return equal_; }
  const std::vector<spot::Grain>& grains() const { return grains_; }
  const spot::SpotParameters& spots() const { return spots_; }
  const spot::RelaxationParameters& relaxation() const { return relaxation_; }
  const spot::DrainageLimits& limits() const { return limits_; }
  const std::shared_ptr<const spot::Container>& silo() const { return silo_; }

  /// For whoever has to find out what went wrong.
  std::string description() const {
    return spot::message(
        "scene ", seed_, ": ", grains_.size(), equal_ ? " equal" : " unequal", " grains, d = ", diameter_,
        repeats_x_ ? ", repeats along x" : "", repeats_y_ ? ", repeats along y" : "",
        ", R_s = ", spots_.radius / diameter_, ", w = ", spots_.influence, ", volume ", spots_.fixed_volume,
        ", dilation ", spots_.dilation, ", phi_c = ", spots_.critical_fraction, ", l = ", spots_.exchange_length,
        ", a = ", spots_.dilatancy, ", s_1 = ", spots_.full_strain, ", beta = ", spots_.surface_exponent,
        ", S = ", spots_.nonaffine, ", B = ", spots_.spread, ", m_0 = ", spots_.mobility.at_rest);
  }

 private:
  /// Spots carry the same volume, told in grains of mean volume.
  void count_in_mean_grains() {
    double volume = 0.0;
    for (const spot::Grain& grain : grains_) volume += std::pow(2.0 * spot::radius_in(diameter_, grain) / diameter_, 3);
    spots_.mean_grain_volume = volume / static_cast<double>(grains_.size());
    spots_.fixed_volume /= spots_.mean_grain_volume;
  }

  std::uint64_t seed_;
  double diameter_;
  bool repeats_x_, repeats_y_, equal_;
  spot::Vector3 low_, high_;
  std::shared_ptr<const spot::Container> silo_;
  spot::SpotParameters spots_;
  spot::RelaxationParameters relaxation_;
  spot::DrainageLimits limits_{};
  std::vector<spot::Grain> grains_;
};

}  // namespace scenes
