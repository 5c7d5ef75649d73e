// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "spot/base/bytes.hpp"

namespace spot {

/// From `time` on an outlet has this many births per time, until the next step.
struct RateStep {
  double time;  ///< in the units of the rates
  double rate;  ///< 0: closed, to spots and to grains, which stay above the height where they are taken out (1 / time)
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

  /// From a time on it is this, instead of all that was to come. Says whether that changes anything.
  bool change(double time, double rate);
  /// Nobody will ask for what was before a time: from 0 on it counts as what it is then.
  void forget_before(double time);

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
  /// What is left at `until` of such a number that was drawn for `time`, if there has been no birth.
  double left_of(double exponential, double time, double until) const;

  /// At which outlet a birth at this time is, for a uniform number from 0 to 1.
  std::size_t outlet_of_birth(double time, double uniform) const;

  /// Of one outlet: the rate at a time, and the births expected between two.
  double at(std::size_t outlet, double time) const { return outlets_[outlet].at(time); }
  double expected_births(std::size_t outlet, double from, double until) const {
    return outlets_[outlet].births(from, until);
  }

  /// From a time on an outlet has this rate, instead of all that was to come. Says whether that changes anything.
  /// Throws InvalidParameter, naming the outlet, unless there is one and the rate is finite and not negative.
  bool change(std::size_t outlet, double time, double rate);
  /// As RateSchedule does.
  void forget_before(double time);

  void save(Bytes& bytes) const;
  /// Takes in what save() appended, for as many outlets. Throws InvalidState if it is damaged.
  void restore(ByteReader& saved);

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
