// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace spot {

/// From `time` on an outlet has this many births per time, until the next step.
struct RateStep {
  double time;  ///< in the units of the rates
  double rate;  ///< 0: closed, to spots; grains stand in the hole as they do before the first spots come (1 / time)
};

/// The rate of births of one outlet through time, constant in pieces, of which the last has no end.
class RateSchedule {
 public:
  /// Always the same.
  RateSchedule(double rate) : steps_{RateStep{0.0, rate}} {}
  explicit RateSchedule(std::vector<RateStep> steps) : steps_(std::move(steps)) {}

  double at(double time) const;
  /// When it changes next after a time; infinite if it does not.
  double next_change(double time) const;
  /// The integral of the rate: births that are expected between two times.
  double births(double from, double until) const;
  const std::vector<RateStep>& steps() const { return steps_; }
  RateSchedule times(double factor) const;

  /// Throws InvalidParameter, naming the outlet, unless the first step is at time 0, times increase, and all are finite
  /// and no rate below 0.
  void validate(std::size_t outlet) const;

 private:
  std::vector<RateStep> steps_;
};

/// nu_s(t): how many spots are born at each outlet of a container. Births are Poisson, at each outlet by itself: the
/// rates' sum decides when there is one, and the rates at that time, where.
class Injection {
 public:
  /// One outlet with the same rate all the time.
  Injection(double rate) : outlets_{RateSchedule(rate)} {}
  /// In the order of the container's outlets.
  explicit Injection(std::vector<RateSchedule> outlets) : outlets_(std::move(outlets)) {}

  std::size_t outlets() const { return outlets_.size(); }

  /// The largest through time: of one outlet, and of all together (1 / time).
  double largest(std::size_t outlet) const;
  double largest() const;

  /// When a birth follows one at `time`, or the start at time 0, for an exponentially distributed number of mean 1:
  /// when the integral of the rates has come to it. Infinite if it never does.
  double next_birth(double time, double exponential) const;

  /// At which outlet a birth at this time is, for a uniform number from 0 to 1.
  std::size_t outlet_of_birth(double time, double uniform) const;

  /// Of one outlet: the rate at a time, and the births expected between two.
  double at(std::size_t outlet, double time) const { return outlets_[outlet].at(time); }
  double expected_births(std::size_t outlet, double from, double until) const {
    return outlets_[outlet].births(from, until);
  }

  /// All rates times this.
  Injection& operator*=(double factor);
  /// The rates of each outlet times a factor.
  Injection times(const std::vector<double>& factors) const;

  /// Throws InvalidParameter, naming the number, as RateSchedule does, or if there are no births at all.
  void validate() const;

 private:
  double total(double time) const;
  double next_change(double time) const;

  std::vector<RateSchedule> outlets_;
};

}  // namespace spot
