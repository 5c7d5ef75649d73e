// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/next_birth.hpp"

#include <utility>

#include "spot/base/errors.hpp"

namespace spot {

void NextBirth::await(double from, double exponential, const Injection& rates, std::vector<double> factors) {
  from_ = from;
  left_ = exponential;
  factors_ = std::move(factors);
  time_ = rates.times(factors_).next_birth(from_, left_);
}

void NextBirth::change(double now, const Injection& before, const Injection& after) {
  left_ = before.times(factors_).left_of(left_, from_, now);
  from_ = now;
  time_ = after.times(factors_).next_birth(from_, left_);
}

void NextBirth::save(Bytes& bytes) const {
  append(bytes, time_);
  append(bytes, from_);
  append(bytes, left_);
  append(bytes, factors_);
}

void NextBirth::restore(ByteReader& saved) {
  time_ = saved.take<double>();
  from_ = saved.take<double>();
  left_ = saved.take<double>();
  const auto factors = saved.take_all<double>();
  if (factors.size() != factors_.size()) throw InvalidState("the saved time of the next birth is damaged");
  factors_ = factors;
}

}  // namespace spot
