// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/geometry/container.hpp"
#include "spot/walk/flow_field.hpp"
#include "spot/walk/free_surface.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// One diffusing spot of free volume.
struct Spot {
  std::int64_t id;
  std::int64_t steps;  ///< taken so far
  Vector3 position;
  double next_step;             ///< time of the step to come
  double direction = 0.0;       ///< a uniform random number, for its direction
  double chance = 0.0;          ///< another, for whoever draws lots
  double relative_speed = 1.0;  ///< its speed over v_s
  double volume = 1.0;          ///< that it carries, over that of a newborn one (CriticalState)
  std::int64_t outlet = 0;      ///< where it was born
};

/// How spots are born and walk. There is no state but the spot: all draws follow from (seed, spot id, step number). Of
/// grains, walks know the free surface at most; of other spots, how they have made the packing flow.
///
/// Free volume spreads sideways as b du/dx, with a b that in DEM's flow falls with the shear s. Spots walk with b_s,
/// and beside that drift, for each length that they climb, by
///
///     (b_s - B / (s + kappa / depth)) grad_h u / u
///
/// (FlowField), the depth being that below the free surface. So they spread as b = B / s would have them, without steps
/// that get longer the less is sheared: what nothing shears comes down as a plug, which walls and the surface limit
/// (docs/notes/2026-11-29-plug-flow.md). They drift towards what is
/// mobile, too (Mobility).
///
/// A spot is born uniformly on what is R_s inside the rim of an outlet, and R_s below it: it
/// enters the packing with its whole influence, so that as much leaves through the outlet as the spot
/// brings down through any height above (volume closes; see docs/notes).
class SpotWalk {
 public:
  /// Throws InvalidParameter, also if rates of injection are not for as many outlets as the container has, or
  /// InvalidContainer if the spots cannot enter.
  SpotWalk(const SpotParameters& parameters, const Container& container);

  /// Of spot `id`: births that are expected from the one before it, or time 0, up to its own: they are Poisson.
  double births_expected(std::int64_t id) const;

  Spot birth(std::int64_t id, double time, const Container& container) const;

  /// From `time` on, the spot goes at this speed over v_s: what is left of its waiting time gets shorter or longer.
  void set_relative_speed(Spot& spot, double time, double relative_speed) const;

  /// The next step comes a mean waiting time later.
  void wait(Spot& spot) const { spot.next_step += parameters_.mean_waiting_time(); }

  /// Carries out the next step of a spot and draws the time of the one after. Where space repeats, the spot is in its
  /// cell then; the middle of the step need not be.
  Move step(Spot& spot, const Container& container, const FreeSurface& surface, const FlowField& flow) const;

  /// From now on spots are born at these rates.
  void set_rates(const Injection& rates) { parameters_.injection_rate = rates; }

 private:
  void draw_next_step(Spot& spot) const;
  Vector3 drift(const Vector3& place, const FreeSurface& surface, const FlowField& flow) const;
  void steer(Spot& spot, const Container& container, const FreeSurface& surface, const FlowField& flow) const;

  SpotParameters parameters_;
};

}  // namespace spot
