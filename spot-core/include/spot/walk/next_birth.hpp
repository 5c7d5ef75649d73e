// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/walk/injection.hpp"

namespace spot {

/// When the next spot is born, at rates that may be changed while it is awaited.
///
/// Its time is where the integral of the rates comes to a number that was drawn at the birth before. A change of rates
/// keeps what the integral has come to, so that births are those of a schedule that had known the change all the time,
/// to the last bit.
class NextBirth {
 public:
  double time() const { return time_; }

  /// Births are expected from `from` on at these rates, each times a factor of its outlet's, up to an exponentially
  /// distributed number of mean 1. Other factors count from the next birth on.
  void await(double from, double exponential, const Injection& rates, std::vector<double> factors);

  /// From `now` on, before the birth, other rates are what factors multiply.
  void change(double now, const Injection& before, const Injection& after);

  void save(Bytes& bytes) const;
  /// Takes in what save() appended. Throws InvalidState if it is damaged.
  void restore(ByteReader& saved);

 private:
  double time_ = 0.0;
  double from_ = 0.0, left_ = 0.0;  // births that are still expected from then on
  std::vector<double> factors_;
};

}  // namespace spot
