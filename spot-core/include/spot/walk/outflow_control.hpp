// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/base/recurrence.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/walk/free_surface.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// Keeps what leaves through each outlet at what is asked for, F(t) = nu_s(t) times the volume of a newborn spot.
///
/// Left alone, less leaves: grains on the base beside an outlet cannot go down where a spot would have them, so a part
/// of its volume is lost, some 2 % at an outlet 8 grains wide and 6 % at one of 6.5. What is missing, M, grows by
/// F - F_found, and spots are born at
///
///     nu_s (1 + M / (F T)),  but at 1 to 3 / 2 of nu_s.
///
/// So M goes to a constant within T, and the outflow to F, with no overshoot. M is never below 0: an outlet loses
/// volume and gains none. What is over it when it opens leaves at once, and would make births fewer for T. A spot
/// delivers its volume on its way through the outlet, so F is that of R_s / v_s before. T is
/// calibration::climb_of_flow_memory R_s / v_s.
///
/// As the bed over an outlet runs out, less than F is asked for, as in DEM (docs/notes/2026-11-30-fade.md): its share
///
///     1 - exp(-H / (c D)),
///
/// D being the width of the outlet and H the mean depth of the bed over it, that of the free surface less half a grain.
class OutflowControl {
 public:
  /// `diameter`: the reference diameter.
  OutflowControl(const SpotParameters& parameters, const Container& container, double diameter);

  bool on() const { return on_; }

  /// A grain of this volume (1024 = grain_volume), which this rank had, has left through an outlet.
  void count(std::size_t outlet, std::int64_t volume) { counted_[outlet] += volume; }

  /// Collective. Once in each interval in which a spot at v_s climbs calibration::climb_between_surfaces R_s, whatever
  /// the times of the calls in it after the first: finds the factors anew. Says whether it has.
  bool update(double now, Communicator& communicator);

  /// From now on what is asked for is the share that goes with this surface, if it is known.
  void fade(const FreeSurface& surface);

  /// nu_s, as it has been so far and is to be.
  const Injection& births() const { return births_; }
  /// From `now` on it is something else. All that comes keeps what was.
  void change(double now, const Injection& births);

  /// On nu_s, an outlet each.
  std::vector<double> factors() const;
  /// Of births, from now on.
  Injection rates() const { return births_.times(factors()); }

  void save(Bytes& bytes) const;
  /// Takes in what save() appended, on each of several ranks maybe, of which one counts what was counted. Throws
  /// InvalidState if it is damaged.
  void restore(ByteReader& saved, bool counts);

 private:
  double asked(std::size_t outlet, double from, double until) const;
  double depth(const Outlet& outlet, const FreeSurface& surface) const;

  bool on_;
  double fade_, radius_of_grain_;
  Outlets outlets_;
  Injection births_;             // what was long ago is forgotten once it changes
  std::vector<double> largest_;  // rates of births through time
  double volume_of_birth_;       // 1024 = grain_volume
  double delay_, memory_time_;
  Recurrence updates_;
  double updated_ = 0.0;               // when it was last
  std::vector<std::int64_t> counted_;  // by this rank, since then
  std::vector<double> missing_;        // M
  std::vector<double> shares_;         // of F, that are asked for now
};

}  // namespace spot
