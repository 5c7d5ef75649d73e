// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <utility>
#include <vector>

#include "spot/geometry/outlets.hpp"
#include "spot/walk/parameters.hpp"

namespace spotcore {

/// A hole, and how many spots enter through it when.
struct Outlet {
  /// What `rate` is.
  enum class Rate { births, outflow, gravity };
  using Schedule = std::vector<std::pair<double, double>>;  // from a time on, so many times the rate

  spot::Outlet hole;
  Rate kind;
  double rate;
  Schedule schedule;

  /// Births through time. Throws spot::InvalidParameter, naming the hole, if Beverloo's law has no outflow through it.
  spot::RateSchedule births(const spot::SpotParameters& spots, double diameter) const;

  /// The same where the schedule's factor is 1.
  double full_births(const spot::SpotParameters& spots, double diameter) const;
};

spot::Outlets holes_of(const std::vector<Outlet>& outlets);
/// Warns, in Python, of holes that are beyond the range of Beverloo's law.
spot::Injection injection_of(const std::vector<Outlet>& outlets, const spot::SpotParameters& spots, double diameter);

/// Whether births follow what leaves. Throws spot::InvalidParameter if they do at some outlets only.
bool holds_outflow(const std::vector<Outlet>& outlets);

void bind_outlets(pybind11::module_& module);

}  // namespace spotcore
