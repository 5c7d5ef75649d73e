// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "outlets.hpp"
#include "packing.hpp"
#include "parameters.hpp"
#include "results.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "walls.hpp"

namespace spotcore {

/// A packing that drains, for Python: the windowed driver, alone. Python's lock is released while windows run.
class Drainage {
 public:
  /// Throws as the driver does, and spot::InvalidParameter if parameters are for other grains.
  Drainage(const Packing& packing, const Walls& walls, const std::vector<Outlet>& outlets, const Parameters& parameters,
           int threads, std::optional<double> window, std::optional<double> outlet_height);

  /// Until the last whole window before a time. `callback`: None, or called with Progress every so much time, and at
  /// the end. Returns whether it came to the end, and was not stopped by the callback. Throws whatever Python throws
  /// there or for signals; the drainage can go on after that, but not after an error of its own.
  bool advance_to(double time, const pybind11::object& callback, std::optional<double> every);

  double time() const { return static_cast<double>(windows_) * window_; }
  double window() const { return window_; }

  // All that follows throws std::runtime_error while windows run in another thread of Python.
  Packing packing() const;
  Spots spots() const { return {quiet().spots()}; }
  const Drained& drained() const { return quiet(), drained_; }
  std::vector<std::int64_t> drained_through() const;
  spot::Counters counters() const { return quiet().total(); }
  double largest_overlap() const { return quiet().largest_overlap().depth; }
  void set_threads(int threads) { quiet().set_threads(threads); }
  /// Throws spot::InvalidParameter, naming what doesn't fit, and changes nothing then.
  void set_factor(std::int64_t outlet, double factor);

 private:
  spot::WindowedDrainage& quiet() const;
  /// Windows until `last`, or until it is time to see whether Python has signals.
  void run_some(std::int64_t last);
  void take_drained();
  Progress progress(double until) const;

  std::shared_ptr<const spot::Container> container_;
  std::unique_ptr<spot::WindowedDrainage> drainage_;
  double diameter_, window_ = 0.0;
  std::int64_t windows_ = 0, grains_ = 0;
  std::vector<double> full_births_;  // at each outlet, by a factor of 1
  Drained drained_;
  bool running_ = false;    // windows, without Python's lock
  bool advancing_ = false;  // a call of advance_to
  bool failed_ = false;
};

void bind_drainage(pybind11::module_& module);

}  // namespace spotcore
