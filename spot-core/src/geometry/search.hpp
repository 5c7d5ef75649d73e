// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// Between a number for which something holds and one for which it does not: where it ends to hold.
template <typename Holds>
double last_where(Holds&& holds, double yes, double no) {
  constexpr int halvings = 60;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (yes + no);
    if (middle == yes || middle == no) break;
    (holds(middle) ? yes : no) = middle;
  }
  return yes;
}

/// The place of a function's minimum between two others, to within the square root of double's precision: there the
/// function itself is known to all its digits (golden section: Kiefer, Proc. AMS 4, 502, 1953).
template <typename Function>
double place_of_minimum(Function&& function, double low, double high) {
  constexpr double golden = 0.61803398874989485, narrow = 1e-13;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = function(a), at_b = function(b);
  while (high - low > narrow) {
    if (at_a <= at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = function(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = function(b);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace spot
