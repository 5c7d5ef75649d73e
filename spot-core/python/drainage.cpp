// SPDX-License-Identifier: GPL-2.0-or-later
#include "drainage.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>

#include "spot/base/errors.hpp"
#include "spot/drivers/defaults.hpp"

namespace spotcore {

namespace {

/// Sets a flag as long as it lives.
class Flag {
 public:
  explicit Flag(bool& flag) : flag_(flag) { flag_ = true; }
  ~Flag() { flag_ = false; }
  Flag(const Flag&) = delete;
  Flag& operator=(const Flag&) = delete;

 private:
  bool& flag_;
};

void require_diameter_of(const Parameters& parameters, const Packing& packing) {
  if (packing.size() == 0) throw spot::InvalidPacking("the packing has no grains");
  constexpr double slack = 0.01;
  if (parameters.diameter < (1.0 - slack) * packing.smallest_diameter() ||
      parameters.diameter > (1.0 + slack) * packing.diameter())
    throw spot::InvalidParameter(spot::message("parameters are for grains of diameter ", parameters.diameter,
                                               " but those of the packing have ", packing.smallest_diameter(), " to ",
                                               packing.diameter()));
}

/// No coordinate is ever larger.
double extent_of(const Packing& packing, const Walls& walls, const spot::Outlets& outlets, double outlet_height) {
  double extent = std::max({packing.extent(), walls.extent, std::abs(outlet_height)});
  for (const spot::Outlet& outlet : outlets)
    for (int axis = 0; axis < 2; ++axis)
      extent = std::max(extent, std::abs(outlet.centre[axis]) + outlet.hole->half_width(axis));
  return extent + packing.diameter();
}

std::int64_t whole_windows(double time, double window) {
  return static_cast<std::int64_t>(std::floor(time / window * (1.0 + 1e-12)));
}

}  // namespace

Drainage::Drainage(const Packing& packing, const Walls& walls, const std::vector<Outlet>& outlets,
                   const Parameters& parameters, int threads, std::optional<double> window,
                   std::optional<double> outlet_height)
    : diameter_(packing.diameter()) {
  require_diameter_of(parameters, packing);
  const spot::Outlets holes = holes_of(outlets);
  spot::SpotParameters spots = parameters.complete();
  spots.injection_rate = injection_of(outlets, spots, diameter_);
  spots.holds_outflow = holds_outflow(outlets);
  for (const Outlet& outlet : outlets) full_births_.push_back(outlet.full_births(spots, diameter_));
  const std::vector<spot::Grain> grains = packing.grains();
  const spot::DrainageLimits limits{outlet_height.value_or(holes.height()), parameters.largest_overlap};
  const double extent = extent_of(packing, walls, holes, limits.outlet);
  grains_ = static_cast<std::int64_t>(grains.size());

  const py::gil_scoped_release release;
  spots.validate();
  container_ = walls.make(holes, parameters.buffers);
  window_ = window ? *window : spot::longest_window(spots, diameter_, diameter_, container_->outlets());
  drainage_ = std::make_unique<spot::WindowedDrainage>(spots, parameters.relaxation, limits, window_, threads,
                                                       container_, diameter_, extent, grains);
}

spot::WindowedDrainage& Drainage::quiet() const {
  if (running_) throw std::runtime_error("the drainage is running in another thread");
  return *drainage_;
}

void Drainage::take_drained() {
  for (const spot::Grain& grain : drainage_->take_drained()) {
    drained_.grains.push_back(grain);
    drained_.times.push_back(time());
    drained_.outlets.push_back(static_cast<std::int64_t>(container_->nearest_outlet_index(grain.position)));
  }
}

void Drainage::run_some(std::int64_t last) {
  const Flag running(running_);
  const py::gil_scoped_release release;
  const auto stop = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  do {
    drainage_->advance_to(static_cast<double>(windows_ + 1) * window_);
    ++windows_;
    take_drained();
  } while (windows_ < last && std::chrono::steady_clock::now() < stop);
  if (windows_ == last) drainage_->require_inside();
}

Progress Drainage::progress(double until) const {
  const auto drained = static_cast<std::int64_t>(drained_.grains.size());
  return {time(), until, grains_ - drained, drained, static_cast<std::int64_t>(drainage_->spots().size())};
}

bool Drainage::advance_to(double until, const py::object& callback, std::optional<double> every) {
  quiet();
  if (advancing_) throw std::runtime_error("the drainage is advancing already: a callback must not call it");
  if (failed_) throw std::runtime_error("the drainage has failed and cannot go on");
  if (!std::isfinite(until) || until < 0.0 || until / window_ > 9e15)
    throw spot::InvalidParameter(spot::message("time is ", until, " but must be finite and not negative"));
  if (until < time()) throw spot::InvalidParameter(spot::message("time is ", until, " but it is ", time(), " already"));
  if (!callback.is_none() && PyCallable_Check(callback.ptr()) == 0) throw py::type_error("callback cannot be called");
  if (every && (!(*every > 0.0) || !std::isfinite(*every)))
    throw spot::InvalidParameter(spot::message("every is ", *every, " but must be positive and finite"));
  const std::int64_t last = whole_windows(until, window_);
  const double between = every.value_or(std::max(until - time(), 0.0) / 100.0) / window_;
  const auto stride = static_cast<std::int64_t>(std::clamp(std::round(between), 1.0, 9e15));
  const Flag advancing(advancing_);
  while (windows_ < last) {
    const std::int64_t next = std::min(last, windows_ + stride);
    while (windows_ < next) {
      try {
        run_some(next);
      } catch (...) {
        failed_ = true;
        throw;
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
    if (callback.is_none()) continue;
    const py::object answer = callback(progress(until));
    const int truth = answer.is_none() ? 1 : PyObject_IsTrue(answer.ptr());
    if (truth < 0) throw py::error_already_set();
    if (truth == 0) return false;
  }
  return true;
}

Packing Drainage::packing() const {
  const spot::WindowedDrainage& drainage = quiet();
  std::vector<std::int64_t> ids;
  drainage.visit_grains([&ids](const spot::Grain& grain) { ids.push_back(grain.id); });
  std::sort(ids.begin(), ids.end());
  const auto n = static_cast<py::ssize_t>(ids.size());
  Doubles positions({n, py::ssize_t{3}}), radii(n);
  Integers all(n);
  Booleans held(n);
  std::copy(ids.begin(), ids.end(), all.mutable_data());
  double *position = positions.mutable_data(), *radius = radii.mutable_data();
  bool* holds = held.mutable_data();
  drainage.visit_grains([&](const spot::Grain& grain) {
    const auto i = std::lower_bound(ids.begin(), ids.end(), grain.id) - ids.begin();
    std::copy_n(grain.position.data(), 3, position + 3 * i);
    radius[i] = grain.radius > 0.0 ? grain.radius : 0.5 * diameter_;
    holds[i] = grain.held;
  });
  return Packing(positions, radii, all, held);
}

void Drainage::set_factor(std::int64_t outlet, double factor) {
  spot::WindowedDrainage& drainage = quiet();
  const auto outlets = static_cast<std::int64_t>(full_births_.size());
  if (outlet < 0 || outlet >= outlets)
    throw spot::InvalidParameter(spot::message("outlet is ", outlet, " but must be from 0 to ", outlets - 1));
  if (!(factor >= 0.0) || !std::isfinite(factor))
    throw spot::InvalidParameter(spot::message("factor is ", factor, " but must be finite and not negative"));
  const auto number = static_cast<std::size_t>(outlet);
  drainage.change_rate(number, time(), factor * full_births_[number]);
}

std::vector<std::int64_t> Drainage::drained_through() const {
  quiet();
  std::vector<std::int64_t> counts(container_->outlets().size(), 0);
  for (const std::int64_t outlet : drained_.outlets) ++counts[static_cast<std::size_t>(outlet)];
  return counts;
}

namespace {

constexpr const char* arguments = R"(
packing: Packing, inside the walls, at rest.
walls: Walls.
outlets: a list of Outlet.
parameters: Parameters, for grains of this size.
)";

constexpr const char* options = R"(
threads: how many share the work; results do not depend on it.
window: time in which all spots walk before grains are relaxed; by default the longest that was validated.
outlet_height: grains are taken out below this z (length); by default, at the outlets.

ValueError, naming the value and its bound, for numbers out of range, grains outside the walls or in each other, and
outlets that spots do not fit into.)";

}  // namespace

void bind_drainage(py::module_& module) {
  bind_results(module);
  static const std::string init = std::string("A drainage at time 0.\n") + arguments + options;
  static const std::string drain_text = std::string("Drains a packing until a time; returns the Drainage.\n") +
                                        arguments + R"(time: from the start.
callback, every: as of Drainage.advance_to(); where it stops, Drainage.time tells.
)" + options + R"( CollapsedPacking if relaxation does not keep up.

>>> packing = Packing(lattice((-8, -5, 0), (8, 5, 8), 1.0), 0.5)
>>> silo = Walls.box((-8, 8), (-5, 5)), [Outlet.round((0, 0, 0), 4.0, outflow=40.0)]
>>> drainage = drain(packing, *silo, Parameters.glass_beads(1.0, 1.0), 5.0)
>>> drainage.drained_through.tolist() == [len(drainage.drained)]
True
)";
  py::class_<Drainage> bound(module, "Drainage", R"(A packing that drains as spots climb through it.

>>> packing = Packing(lattice((-8, -5, 0), (8, 5, 8), 1.0), 0.5)
>>> drainage = Drainage(packing, Walls.box((-8, 8), (-5, 5)), [Outlet.round((0, 0, 0), 4.0, outflow=40.0)],
...                     Parameters.glass_beads(1.0, 1.0))
>>> drainage.advance_to(1.0), drainage.advance_to(2.0, callback=lambda progress: False)
(True, False)
>>> drainage.time < 1.2
True
)");
  bound
      .def(py::init<const Packing&, const Walls&, const std::vector<Outlet>&, const Parameters&, int,
                    std::optional<double>, std::optional<double>>(),
           py::arg("packing"), py::arg("walls"), py::arg("outlets"), py::arg("parameters"), py::kw_only(),
           py::arg("threads") = 1, py::arg("window") = py::none(), py::arg("outlet_height") = py::none(), init.c_str())
      .def("advance_to", &Drainage::advance_to, py::arg("time"), py::arg("callback") = py::none(),
           py::arg("every") = py::none(),
           R"(Goes on until a time since the start: until the last whole window before it.

callback: is called with a Progress, and ends the call by returning something false, but not None.
every: time between calls of it, and there is one at the end; by default a hundredth of what is ahead.

Returns False if the callback has ended it. Other threads of Python go on while windows run. After a KeyboardInterrupt,
or what a callback raises, the drainage is at a whole window and can go on.

CollapsedPacking if relaxation does not keep up; the drainage is of no use then.)")
      .def_property_readonly("time", &Drainage::time, "To which it has drained: whole windows.")
      .def_property_readonly("window", &Drainage::window, "(time).")
      .def_property_readonly("packing", &Drainage::packing, "The grains that are left, in increasing order of ids.")
      .def_property_readonly(
          "spots", [](const Drainage& drainage) { return drainage.spots(); }, "Those that are in the packing.")
      .def_property_readonly(
          "drained", [](const Drainage& drainage) { return Drained(drainage.drained()); },
          "Those that have left so far.")
      .def_property_readonly(
          "drained_through",
          [](const Drainage& drainage) {
            const std::vector<std::int64_t> counts = drainage.drained_through();
            return Integers(static_cast<py::ssize_t>(counts.size()), counts.data());
          },
          "Grains that have left through each outlet, an array in the order of outlets.")
      .def_property_readonly("counters", &Drainage::counters, "What has happened so far.")
      .def_property_readonly("largest_overlap", &Drainage::largest_overlap,
                             "Of two grains: 1 less their distance over the sum of their radii.")
      .def("set_threads", &Drainage::set_threads, py::arg("threads"), "From now on so many share the work.")
      .def("set_factor", &Drainage::set_factor, py::arg("outlet"), py::arg("factor"),
           R"(From now on an outlet has so many times its rate, whatever its schedule says; 0 closes it to spots.

outlet: its number, from 0. A callback of advance_to() may call this, too.
ValueError for outlets that are not there, and for factors below 0 or too large.)");
  module.def(
      "drain",
      [](const Packing& packing, const Walls& walls, const std::vector<Outlet>& outlets, const Parameters& parameters,
         double time, const py::object& callback, std::optional<double> every, int threads,
         std::optional<double> window, std::optional<double> outlet_height) {
        auto drainage = std::make_unique<Drainage>(packing, walls, outlets, parameters, threads, window, outlet_height);
        drainage->advance_to(time, callback, every);
        return drainage;
      },
      py::arg("packing"), py::arg("walls"), py::arg("outlets"), py::arg("parameters"), py::arg("time"), py::kw_only(),
      py::arg("callback") = py::none(), py::arg("every") = py::none(), py::arg("threads") = 1,
      py::arg("window") = py::none(), py::arg("outlet_height") = py::none(), drain_text.c_str());
}

}  // namespace spotcore
