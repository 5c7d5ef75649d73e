// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/injection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The first step after a time.
auto step_after(const std::vector<RateStep>& steps, double time) {
  return std::upper_bound(steps.begin(), steps.end(), time,
                          [](double t, const RateStep& step) { return t < step.time; });
}

}  // namespace

double RateSchedule::at(double time) const { return std::prev(step_after(steps_, time))->rate; }

double RateSchedule::next_change(double time) const {
  const auto next = step_after(steps_, time);
  return next == steps_.end() ? never : next->time;
}

double RateSchedule::births(double from, double until) const {
  double births = 0.0;
  while (from < until) {
    const double change = std::min(next_change(from), until);
    births += at(from) * (change - from);
    from = change;
  }
  return births;
}

RateSchedule RateSchedule::times(double factor) const {
  std::vector<RateStep> steps = steps_;
  for (RateStep& step : steps) step.rate *= factor;
  return RateSchedule(std::move(steps));
}

bool RateSchedule::change(double time, double rate) {
  if (at(time) == rate && next_change(time) == never) return false;
  while (!steps_.empty() && steps_.back().time >= time) steps_.pop_back();
  if (steps_.empty())
    steps_.push_back({0.0, rate});
  else if (steps_.back().rate != rate)
    steps_.push_back({time, rate});
  return true;
}

void RateSchedule::forget_before(double time) {
  steps_.erase(steps_.begin(), std::prev(step_after(steps_, time)));
  steps_.front().time = 0.0;
}

void RateSchedule::validate(std::size_t outlet) const {
  if (steps_.empty()) throw InvalidParameter(message("outlet ", outlet, " has no spot injection rate"));
  if (steps_.front().time != 0.0)
    throw InvalidParameter(message("spot injection rates of outlet ", outlet, " begin at time ", steps_.front().time,
                                   " but must begin at 0"));
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const auto [time, rate] = steps_[k];
    if (!std::isfinite(time) || (k > 0 && !(time > steps_[k - 1].time)))
      throw InvalidParameter(message("spot injection rates of outlet ", outlet, " change at time ", time, " after ",
                                     steps_[k - 1].time, " but times must be finite and increase"));
    if (!(rate >= 0.0) || !std::isfinite(rate))
      throw InvalidParameter(message("spot injection rate is ", rate, " at outlet ", outlet, " from time ", time,
                                     " but must be finite and not negative"));
  }
}

double Injection::total(double time) const {
  double sum = 0.0;
  for (const RateSchedule& outlet : outlets_) sum += outlet.at(time);
  return sum;
}

double Injection::next_change(double time) const {
  double next = never;
  for (const RateSchedule& outlet : outlets_) next = std::min(next, outlet.next_change(time));
  return next;
}

double Injection::largest(std::size_t outlet) const {
  double most = 0.0;
  for (const RateStep& step : outlets_[outlet].steps()) most = std::max(most, step.rate);
  return most;
}

double Injection::largest() const {
  double most = total(0.0);
  for (double time = next_change(0.0); time < never; time = next_change(time)) most = std::max(most, total(time));
  return most;
}

double Injection::next_birth(double time, double exponential) const {
  while (true) {
    const double rate = total(time), change = next_change(time);
    if (rate > 0.0) {
      const double birth = time + exponential / rate;
      if (birth < change) return birth;
    }
    if (change == never) return never;
    exponential = left_of(exponential, time, change);
    time = change;
  }
}

double Injection::left_of(double exponential, double time, double until) const {
  while (time < until) {
    const double change = std::min(next_change(time), until);
    exponential = std::max(0.0, exponential - total(time) * (change - time));
    time = change;
  }
  return exponential;
}

std::size_t Injection::outlet_of_birth(double time, double uniform) const {
  double left = uniform * total(time);
  std::size_t outlet = 0;
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const double rate = outlets_[k].at(time);
    if (rate > 0.0) outlet = k;
    if (left < rate) break;
    left -= rate;
  }
  return outlet;
}

bool Injection::change(std::size_t outlet, double time, double rate) {
  if (outlet >= outlets_.size())
    throw InvalidParameter(
        message("there is no outlet ", outlet + 1, " to change the rate of: they count from 1 to ", outlets_.size()));
  RateSchedule changed = outlets_[outlet];
  if (!changed.change(time, rate)) return false;
  changed.validate(outlet + 1);
  outlets_[outlet] = std::move(changed);
  return true;
}

void Injection::forget_before(double time) {
  for (RateSchedule& outlet : outlets_) outlet.forget_before(time);
}

void Injection::save(Bytes& bytes) const {
  for (const RateSchedule& outlet : outlets_) append(bytes, outlet.steps());
}

void Injection::restore(ByteReader& saved) {
  for (RateSchedule& outlet : outlets_) {
    outlet = RateSchedule(saved.take_all<RateStep>());
    if (outlet.steps().empty()) throw InvalidState("the saved rates of births are damaged");
  }
}

Injection& Injection::operator*=(double factor) {
  for (RateSchedule& outlet : outlets_) outlet = outlet.times(factor);
  return *this;
}

Injection Injection::times(const std::vector<double>& factors) const {
  std::vector<RateSchedule> outlets;
  for (std::size_t k = 0; k < outlets_.size(); ++k) outlets.push_back(outlets_[k].times(factors[k]));
  return Injection(std::move(outlets));
}

void Injection::validate() const {
  // Of one that never changes, in the words for a number.
  if (outlets_.size() == 1 && outlets_[0].steps().size() == 1) {
    const double rate = outlets_[0].steps()[0].rate;
    if (!(rate > 0.0) || !std::isfinite(rate))
      throw InvalidParameter(message("spot injection rate is ", rate, " but must be positive and finite"));
  }
  for (std::size_t k = 0; k < outlets_.size(); ++k) outlets_[k].validate(k + 1);
  if (outlets_.empty()) throw InvalidParameter("there is no spot injection rate, for no outlet");
  if (!(largest() > 0.0)) throw InvalidParameter("spot injection rates of all outlets are 0 at all times");
}

}  // namespace spot
