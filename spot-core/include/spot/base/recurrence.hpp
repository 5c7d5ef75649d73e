// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/base/bytes.hpp"

namespace spot {

/// What is done once in each interval of time, at the first call in it, whatever the times of the others.
class Recurrence {
 public:
  explicit Recurrence(double interval) : interval_(interval) {}

  /// Whether it is to be done now: then it counts as done. Times don't decrease.
  bool due(double now) {
    constexpr double rounded = 1.0 + 1e-12;  // times of calls are sums of shorter intervals
    if (now * rounded < static_cast<double>(next_) * interval_) return false;
    next_ = static_cast<std::int64_t>(now * rounded / interval_) + 1;
    return true;
  }

  void save(Bytes& bytes) const { append(bytes, next_); }
  void restore(ByteReader& saved) { next_ = saved.take<std::int64_t>(); }

 private:
  double interval_;
  std::int64_t next_ = 0;  // in intervals
};

}  // namespace spot
