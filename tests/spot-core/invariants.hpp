// SPDX-License-Identifier: GPL-2.0-or-later
// What has to hold of every packing that drains, found without the lists and counts of the drivers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "spot/base/errors.hpp"
#include "spot/drivers/drainage.hpp"
#include "spot/packing/cell_grid.hpp"

namespace invariants {

/// How deeply grains overlap.
struct Overlaps {
  double largest = 0.0;  ///< over the sum of two radii
  double badness = 0.0;  ///< B: sum over grains and partners of the square of the same, a grain (2010)
};

/// Overlaps of all pairs, over a grid of cells of its own.
inline Overlaps overlaps_of(const std::vector<spot::Grain>& grains, double diameter,
                            const spot::Periodic& periodic = {}) {
  Overlaps overlaps;
  if (grains.empty()) return overlaps;
  spot::Vector3 low = grains.front().position, high = low;
  for (const spot::Grain& grain : grains) {
    low = low.cwiseMin(grain.position);
    high = high.cwiseMax(grain.position);
  }
  spot::CellGrid grid(low, high, diameter, periodic);
  for (std::uint32_t i = 0; i < grains.size(); ++i) {
    const spot::Vector3& centre = grains[i].position;
    grid.visit_near(centre, diameter, [&](std::uint32_t j) {
      const double touching = spot::radius_in(diameter, grains[i]) + spot::radius_in(diameter, grains[j]);
      const double overlap = 1.0 - periodic.nearest(spot::Vector3(grains[j].position - centre)).norm() / touching;
      if (overlap <= 0.0) return;
      overlaps.largest = std::max(overlaps.largest, overlap);
      overlaps.badness += 2.0 * overlap * overlap;
    });
    grid.insert(grid.cell_of(centre.x(), centre.y(), centre.z()), i);
  }
  overlaps.badness /= static_cast<double>(grains.size());
  return overlaps;
}

/// Where grains are to somebody who is told only of those that may have moved since he asked last. Ranks may share it.
class Followed {
 public:
  /// The grain of this drainage, of one rank, that is elsewhere than he thinks, or -1.
  std::int64_t check(spot::Drainage& drainage) {
    const std::lock_guard<std::mutex> lock(mutex_);
    drainage.visit_grains(
        [&](const spot::Grain& grain) {
          ++told_;
          place_of_[grain.id] = grain.position;
        },
        spot::Which::moved);
    drainage.forget_moved();
    std::int64_t elsewhere = -1;
    drainage.visit_grains([&](const spot::Grain& grain) {
      ++all_;
      const auto known = place_of_.find(grain.id);
      if (known == place_of_.end() || known->second != grain.position) elsewhere = grain.id;
    });
    return elsewhere;
  }

  /// Of all grains at all times, the share that he was told of.
  double share() const { return told_ / all_; }

 private:
  std::mutex mutex_;
  std::map<std::int64_t, spot::Vector3> place_of_;
  double told_ = 0.0, all_ = 0.0;
};

/// Follows one drainage from its start.
class Ledger {
 public:
  Ledger(const std::vector<spot::Grain>& start, double diameter, const spot::DrainageLimits& limits,
         const spot::Container& container)
      : diameter_(diameter), limits_(limits), container_(container) {
    for (const spot::Grain& grain : start) start_.emplace(grain.id, grain);
  }

  /// What is wrong with it now, or nothing. Takes the drained grains.
  std::string check(spot::Drainage& drainage) {
    try {
      drainage.require_inside();
    } catch (const spot::Error& error) {
      return error.what();
    }
    std::string wrong = check_drained(drainage);
    if (wrong.empty()) wrong = check_left(drainage.grains());
    if (wrong.empty() && drained_.size() != static_cast<std::size_t>(drainage.counters().drained))
      wrong =
          spot::message("the counter says ", drainage.counters().drained, " drained, but there were ", drained_.size());
    const double stated = drainage.largest_overlap().depth;
    if (wrong.empty() && std::abs(stated - overlaps_.largest) > 1e-5)
      wrong = spot::message("the largest overlap is ", overlaps_.largest, ", but the driver says ", stated);
    return wrong;
  }

  /// Grains may go through the base, as they do when nobody relaxes them.
  void leave_base_open() { guards_base_ = false; }

  /// At the last check.
  const Overlaps& overlaps() const { return overlaps_; }
  std::size_t drained() const { return drained_.size(); }

 private:
  std::string check_drained(spot::Drainage& drainage) {
    for (const spot::Grain& grain : drainage.take_drained()) {
      const auto found = start_.find(grain.id);
      if (found == start_.end()) return spot::message("grain ", grain.id, " drained but was never there");
      if (found->second.held) return spot::message("grain ", grain.id, " drained although it is held");
      if (!drained_.insert(grain.id).second) return spot::message("grain ", grain.id, " drained twice");
      if (!grain.position.allFinite() || grain.position.z() >= limits_.outlet)
        return spot::message("grain ", grain.id, " drained at z = ", grain.position.z());
      // Below a hole grains spread no farther than they have come down.
      const spot::Outlets& outlets = container_.outlets();
      const bool left = std::any_of(outlets.begin(), outlets.end(), [&](const spot::Outlet& outlet) {
        const spot::Vector3 from_centre = container_.periodic().nearest(spot::Vector3(grain.position - outlet.centre));
        return outlet.distance(outlet.centre + from_centre) <= outlets.height() - grain.position.z();
      });
      if (guards_base_ && !left)
        return spot::message("grain ", grain.id, " went through the base at (", grain.position.x(), ", ",
                             grain.position.y(), ")");
    }
    return {};
  }

  std::string check_left(const std::vector<spot::Grain>& left) {
    std::set<std::int64_t> seen;
    for (const spot::Grain& grain : left) {
      const auto found = start_.find(grain.id);
      if (found == start_.end()) return spot::message("grain ", grain.id, " was never there");
      if (!seen.insert(grain.id).second) return spot::message("grain ", grain.id, " is there twice");
      if (drained_.count(grain.id) != 0) return spot::message("grain ", grain.id, " is there and drained");
      if (!grain.position.allFinite()) return spot::message("position of grain ", grain.id, " is not finite");
      if (grain.radius != spot::radius_in(diameter_, found->second))
        return spot::message("the radius of grain ", grain.id, " has changed");
      if (grain.held != found->second.held) return spot::message("grain ", grain.id, " was held or let go");
      if (grain.held && apart(grain, found->second) > 1e-6 * diameter_)
        return spot::message("grain ", grain.id, " moved although it is held");
    }
    if (seen.size() + drained_.size() != start_.size())
      return spot::message(start_.size(), " grains at the start, but ", seen.size(), " left and ", drained_.size(),
                           " drained");
    overlaps_ = overlaps_of(left, diameter_, container_.periodic());
    return {};
  }

  double apart(const spot::Grain& a, const spot::Grain& b) const {
    return container_.periodic().nearest(spot::Vector3(a.position - b.position)).norm();
  }

  double diameter_;
  spot::DrainageLimits limits_;
  const spot::Container& container_;
  std::map<std::int64_t, spot::Grain> start_;
  std::set<std::int64_t> drained_;
  bool guards_base_ = true;
  Overlaps overlaps_;
};

}  // namespace invariants
