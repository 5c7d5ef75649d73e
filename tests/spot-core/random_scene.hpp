// SPDX-License-Identifier: GPL-2.0-or-later
// Silos, packings, parameters and drivers drawn at random: one number says all of a scene.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace scenes {

/// One drainage, drawn from a seed. Lengths in the scene's own unit, in which grains have any diameter.
class RandomScene {
 public:
  explicit RandomScene(std::uint64_t seed) : seed_(seed), draws_(seed) {
    draw_units();
    draw_silo();
    draw_spots();
    draw_grains();
    draw_relaxation();
    draw_schedule();
    // Drawn last, so that all else in a scene is as it was before there were contact overlaps and closing.
    relaxation_.contact_overlap = chance(0.5) ? log_uniform(1e-4, 1e-2) : 0.0;
    relaxation_.closing_gap = chance(0.3) ? log_uniform(1e-4, 1e-2) : 0.0;
    relaxation_.closing_share = draws_.uniform(0.0, 0.5);
  }

  std::unique_ptr<spot::Drainage> start(int threads) const {
    if (time_ordered_)
      return std::make_unique<spot::TimeOrderedDrainage>(spots_, relaxation_, limits_, silo_,
                                                         spot::Packing(diameter_, extent_, grains_));
    return std::make_unique<spot::WindowedDrainage>(spots_, relaxation_, limits_, window_, threads, silo_, diameter_,
                                                    extent_, grains_);
  }

  double diameter() const { return diameter_; }
  double window() const { return window_; }
  int windows() const { return windows_; }
  const std::vector<spot::Grain>& grains() const { return grains_; }
  const spot::DrainageLimits& limits() const { return limits_; }
  const spot::Container& silo() const { return *silo_; }
  /// Is every grain that moves relaxed at once?
  bool relaxes() const {
    return !time_ordered_ || (relaxation_.every == 1 && relaxation_.schedule == spot::RelaxationSchedule::moves);
  }

  /// All that was drawn, lengths in diameters, for whoever has to find out what went wrong.
  std::string description() const {
    const double d = diameter_;
    return spot::message(
        "scene ", seed_, ": ", kind_, ", ", grains_.size(), " grains, d = ", d, ", orifice ",
        silo_->outlets()[0].hole->widest_radius() / d, ", R_s = ", spots_.radius / d, ", w = ", spots_.influence,
        ", dx = ", spots_.step_width / d, ", dz = ", spots_.step_height / d, ", nu_s = ", spots_.injection_rate.largest(),
        ", volume ", spots_.fixed_volume, ", dilation ", spots_.dilation, spots_.together ? ", together" : "",
        ", alpha ", relaxation_.alpha, ", momentum ", relaxation_.momentum, ", tolerance ", relaxation_.tolerance,
        ", contact ", relaxation_.contact_overlap, ", closing ", relaxation_.closing_gap, ' ',
        relaxation_.closing_share, ", ", windows_, " windows of ", window_,
        time_ordered_ ? ", time-ordered, every " : ", windowed, every ", relaxation_.every);
  }

 private:
  double log_uniform(double low, double high) { return low * std::exp(draws_.uniform(0.0, std::log(high / low))); }
  bool chance(double probability) { return draws_.uniform(0.0, 1.0) < probability; }

  void draw_units() {
    constexpr double diameters[] = {1.0, 0.003, 250.0};
    diameter_ = diameters[draws_.below(3)];
    const double far = chance(0.2) ? 1e5 : 10.0;
    place_ = diameter_ * draws_.in_box(spot::Vector3::Constant(-far), spot::Vector3::Constant(far));
    extent_ = diameter_ * (far + 60.0);
  }

  void draw_silo() {
    const double d = diameter_;
    half_x_ = draws_.uniform(1.0, 7.0);
    half_y_ = chance(0.3) ? draws_.uniform(0.6, 1.2) : draws_.uniform(1.0, 5.0);
    height_ = draws_.uniform(2.0, 14.0);
    const bool round = chance(0.4);
    if (round) half_y_ = half_x_;
    narrowest_ = std::min(half_x_, half_y_);
    spots_.radius = d * log_uniform(0.6, std::min(4.0, std::max(0.6, narrowest_)));
    // As wide as the base, as narrow as a spot, or between.
    const double widest = d * narrowest_, narrowest = spots_.radius;
    const double radius = chance(0.25) ? widest : chance(0.25) ? narrowest : draws_.uniform(narrowest, widest);
    const double side = d * (chance(0.2) ? 0.0 : draws_.uniform(0.0, std::min(1.5, narrowest_)));
    const spot::SpotBuffers buffers{side, d * draws_.uniform(0.0, 2.6)};
    const double room_x = d * half_x_ - radius, room_y = round ? 0.0 : d * half_y_ - radius;
    spot::Vector3 centre = place_;
    if (chance(0.5)) centre += spot::Vector3(draws_.uniform(-room_x, room_x), draws_.uniform(-room_y, room_y), 0.0);
    const spot::Orifice orifice{centre, radius};
    kind_ = spot::message(round ? "cylinder " : "box ", half_x_, " x ", half_y_, " x ", height_);
    if (round)
      silo_ = spot::cylinder_silo(place_.x(), place_.y(), d * half_x_, orifice, buffers);
    else
      silo_ = spot::box_silo(place_.x() - d * half_x_, place_.x() + d * half_x_, place_.y() - d * half_y_,
                             place_.y() + d * half_y_, orifice, buffers);
    round_ = round;
    limits_.outlet = place_.z() - (chance(0.3) ? draws_.uniform(0.0, spots_.radius) : 0.0);
  }

  void draw_spots() {
    const double d = diameter_;
    spots_.influence = log_uniform(1e-3, 0.03);
    spots_.step_height = d * log_uniform(0.05, 1.0);
    spots_.step_width = spot::step_width_for(d * draws_.uniform(0.3, 2.0), spots_.step_height);
    spots_.speed = d * draws_.uniform(1.0, 5.0);
    spots_.seed = 1 + draws_.below(1000);
    const double enclosed = 4.6 * std::pow(spots_.radius / d, 3);  // grains, at the packing fraction of flow
    if (chance(0.5)) spots_.fixed_volume = enclosed * draws_.uniform(0.7, 1.1);
    spots_.together = chance(0.2);
  }

  void draw_grains() {
    const spot::Vector3 low(0.5 - half_x_, 0.5 - half_y_, 0.5), high(half_x_ - 0.5, half_y_ - 0.5, height_);
    std::vector<spot::Grain> all;
    const std::size_t packing = draws_.below(3);
    const std::uint64_t seed = draws_.below(1u << 30);
    if (packing == 0)
      all = random_grains(static_cast<std::size_t>(3.0 * half_x_ * half_y_ * height_) + 1, low, high, 1.0, seed);
    else
      all = dense_grains(low, high, draws_.uniform(0.0, 0.01), seed);
    kind_ += packing == 0 ? ", random addition" : packing == 1 ? ", lattice" : ", fragments";
    if (packing == 2) take_out_balls(all);
    const double held = chance(0.3) ? draws_.uniform(0.0, 0.1) : 0.0;
    for (spot::Grain& grain : all) {
      if (round_ && grain.position.head<2>().norm() > half_x_ - 0.5) continue;
      if (overlaps(grain)) continue;
      grain.held = chance(held);
      grains_.push_back(grain);
    }
    for (spot::Grain& grain : grains_) grain.position = place_ + diameter_ * grain.position;
    draws_.shuffle(grains_);
  }

  /// Holes, so that there are cliffs, bridges and lone grains.
  void take_out_balls(std::vector<spot::Grain>& grains) {
    for (std::size_t ball = 1 + draws_.below(4); ball > 0; --ball) {
      const spot::Vector3 centre = draws_.in_box({-half_x_, -half_y_, 0.0}, {half_x_, half_y_, height_});
      const double radius = draws_.uniform(0.5, 4.0);
      grains.erase(std::remove_if(grains.begin(), grains.end(),
                                  [&](const spot::Grain& grain) { return (grain.position - centre).norm() < radius; }),
                   grains.end());
    }
  }

  bool overlaps(const spot::Grain& grain) const {
    return std::any_of(grains_.begin(), grains_.end(),
                       [&](const spot::Grain& other) { return (grain.position - other.position).norm() < 0.98; });
  }

  void draw_relaxation() {
    relaxation_.alpha = draws_.uniform(0.4, 1.4);
    relaxation_.momentum = chance(0.5) ? draws_.uniform(0.0, 0.7) : 0.0;
    relaxation_.tolerance = log_uniform(5e-4, 1e-2);
    relaxation_.shell = draws_.uniform(0.5, 2.0);
    time_ordered_ = chance(0.35);
    if (!time_ordered_) return;
    if (chance(0.2)) relaxation_.strength = spot::RelaxationStrength::full_each;
    relaxation_.alpha = draws_.uniform(0.4, 1.0);
    relaxation_.schedule = static_cast<spot::RelaxationSchedule>(draws_.below(4));
    relaxation_.every = static_cast<int>(draws_.below(4));
  }

  /// As many windows and spots as drain a share of the grains, within a budget of moves.
  void draw_schedule() {
    windows_ = static_cast<int>(10 + draws_.below(21));
    window_ = diameter_ * draws_.uniform(0.02, 0.3) / spots_.speed;
    const double time = windows_ * window_, volume = spots_.influence * 4.6 * std::pow(spots_.radius / diameter_, 3);
    const double births = draws_.uniform(0.05, 0.5) * static_cast<double>(grains_.size() + 1) / volume;
    const double steps = 1.0 + 0.5 * time * spots_.move_rate();  // a spot
    const double budget = time_ordered_ ? 1500.0 : 10000.0;
    spots_.injection_rate = std::min(births, budget / steps) / time;
    if (!spots_.together && chance(0.4)) spots_.dilation = log_uniform(1e-3, 0.5);
    if (time_ordered_) return;
    // Grains in the orifice go some way in a window, at most a diameter.
    const double clock = spots_.together ? std::max(window_, spots_.mean_waiting_time()) : window_;
    const double carried = spots_.fixed_volume > 0.0 ? spots_.fixed_volume * spots_.influence : volume;
    const double orifice = silo_->outlets()[0].hole->widest_radius() / diameter_;
    const double flow = clock * spots_.injection_rate.largest() * carried / (3.5 * orifice * orifice);
    spots_.injection_rate *= std::min(1.0, 0.9 / flow);
  }

  std::uint64_t seed_;
  Draws draws_;
  std::string kind_;
  double diameter_, extent_;
  spot::Vector3 place_;
  double half_x_ = 0.0, half_y_ = 0.0, height_ = 0.0, narrowest_ = 0.0;  // in diameters
  bool round_ = false, time_ordered_ = false;
  std::shared_ptr<const spot::Container> silo_;
  spot::SpotParameters spots_;
  spot::RelaxationParameters relaxation_;
  spot::DrainageLimits limits_{};
  std::vector<spot::Grain> grains_;
  double window_ = 0.0;
  int windows_ = 0;
};

}  // namespace scenes
