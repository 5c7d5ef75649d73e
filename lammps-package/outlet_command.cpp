// SPDX-License-Identifier: GPL-2.0-only
#include "outlet_command.h"

#include <cmath>
#include <memory>

#include "spot/drivers/defaults.hpp"
#include "spot/geometry/hopper.hpp"
#include "spot/geometry/round_hole.hpp"
#include "spot/geometry/silo_width.hpp"
#include "spot/geometry/slot.hpp"
#include "words.h"

using spot::InvalidParameter;
using spot::message;

namespace {

double read_angle(Words& words, const char* what) {
  const double degrees = words.positive(what);
  if (degrees >= 90.0)
    throw InvalidParameter(message("'hopper' is ", degrees, " but ", what, " must be below 90 degrees"));
  return degrees;
}

double degrees_of(double slope) { return std::atan(slope) * 180.0 / 3.14159265358979323846; }  // for texts only

}  // namespace

void OutletCommand::add(const spot::Outlet& outlet, const std::string& text) {
  outlets_.push_back(outlet);
  texts_.push_back(text);
}

void OutletCommand::read_orifice(Words& words) {
  const double x = words.number("x"), y = words.number("y"), z = words.number("z"),
               radius = words.positive("the orifice's radius");
  last_orifice_ = spot::Orifice{{x, y, z}, radius};
  add(*last_orifice_, precise(x, ' ', y, ' ', z, ' ', radius));
}

void OutletCommand::read_slot(Words& words) {
  const double x = words.number("x"), y = words.number("y"), z = words.number("z"),
               along_x = words.positive("the slot's width along x"),
               along_y = words.positive("the slot's width along y");
  add({{x, y, z}, std::make_shared<spot::Slot>(along_x, along_y)},
      precise("slot ", x, ' ', y, ' ', z, ' ', along_x, ' ', along_y));
}

void OutletCommand::read_injection(Words& words) {
  rates_ = {words.not_negative("the injection rate")};
  while (words.next_is_number()) rates_.push_back(words.not_negative("the injection rate"));
}

void OutletCommand::read_outflow(Words& words) {
  outflow_ = {words.not_negative("the outflow, in grains per time,")};
  while (words.next_is_number()) outflow_.push_back(words.not_negative("the outflow, in grains per time,"));
}

void OutletCommand::read_beverloo(Words& words) {
  gravity_ = words.positive("the acceleration of gravity");
  law_ = {};
  if (words.next_is_number()) {
    law_.round = words.positive("C of round outlets");
    law_.margin = words.not_negative("k");
  }
  if (words.next_is_number()) law_.slot = words.positive("C of slots");
}

void OutletCommand::read_hopper(Words& words) {
  hopper_ = Hopper{read_angle(words, "the angle of repose"), std::nullopt};
  if (words.next_is_number()) hopper_->half_angle = read_angle(words, "the half-angle");
}

void OutletCommand::read_schedule(Words& words) {
  const auto outlet = static_cast<std::size_t>(words.integer("the number of an outlet", 1));
  if (schedules_.count(outlet) > 0) throw InvalidParameter(message("'schedule ", outlet, "' is given twice"));
  Schedule& schedule = schedules_[outlet];
  if (words.next_begins_with("v_")) {
    const std::string word = words.value("v_name");
    schedule.variable = word.substr(2);
    if (schedule.variable.empty())
      throw InvalidParameter(message("'schedule ", outlet, " v_' has no name: v_name stands for the variable 'name'"));
    if (words.next_is_number())
      throw InvalidParameter(message("'schedule ", outlet, ' ', word,
                                     "' goes on with a number, but has either a variable, or times and factors"));
    return;
  }
  std::vector<Step>& steps = schedule.steps;
  do {
    const double time = words.not_negative("the time of a step of the schedule");
    if (!steps.empty() && time <= steps.back().time)
      throw InvalidParameter(message("'schedule ", outlet, "' goes from time ", steps.back().time, " to ", time,
                                     " but times must increase"));
    steps.push_back({time, words.not_negative("the factor on the rate")});
  } while (words.next_is_number());
}

void OutletCommand::validate() const {
  if (outlets_.empty())
    throw InvalidParameter(
        "keyword 'orifice' is missing: 'orifice x y z radius' or 'slot x y z width_x width_y' says where grains leave "
        "and spots enter");
  if (!rates_.empty() + !outflow_.empty() + gravity_.has_value() > 1)
    throw InvalidParameter("only one of 'injection', 'outflow' and 'beverloo' can be given");
  if (hopper_ && !gravity_) throw InvalidParameter("'hopper' goes with 'beverloo', whose outflow it multiplies");
  if (rates_.empty() && outflow_.empty() && !gravity_)
    throw InvalidParameter(
        "keyword 'outflow' is missing: grains that leave per time through each outlet; or 'injection', spots born per "
        "time, or 'beverloo g', which predicts the outflow");
  if (!rates_.empty()) require_number_of("injection", rates_.size());
  if (!outflow_.empty()) require_number_of("outflow", outflow_.size());
  if (!schedules_.empty() && schedules_.rbegin()->first > outlets_.size())
    throw InvalidParameter(message("'schedule ", schedules_.rbegin()->first,
                                   "' is for an outlet that is not there: ", "they count from 1 to ", outlets_.size()));
  require_births();
  static_cast<void>(outlets());
}

/// At one outlet, at some time.
void OutletCommand::require_births() const {
  std::string closed;
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const std::vector<double>& given = rates_.empty() ? outflow_ : rates_;
    if (!given.empty() && given[k] == 0.0) continue;
    const auto found = schedules_.find(k + 1);
    if (found == schedules_.end() || found->second.steps.empty() || found->second.steps.front().time > 0.0) return;
    for (const Step& step : found->second.steps)
      if (step.factor > 0.0) return;
    closed += message(closed.empty() ? "'schedule " : ", 'schedule ", k + 1, "'");
  }
  if (closed.empty())
    throw InvalidParameter(message("'", rate_keyword(), "' is 0", outlets_.size() > 1 ? " at all outlets" : "",
                                   " but must be positive", outlets_.size() > 1 ? " at one of them at least" : ""));
  throw InvalidParameter(message(closed, " is 0 from time 0 on, so that nothing ever leaves, but one factor of an ",
                                 "outlet with an outflow must be positive"));
}

const char* OutletCommand::rate_keyword() const {
  return gravity_ ? "beverloo" : rates_.empty() ? "outflow" : "injection";
}

void OutletCommand::require_number_of(const char* keyword, std::size_t rates) const {
  if (rates == outlets_.size()) return;
  throw InvalidParameter(
      message("'", keyword, "' has ", rates, rates == 1 ? " rate" : " rates",
              outlets_.size() == 1 ? " but there is " : " but there are ", outlets_.size(),
              outlets_.size() == 1 ? " outlet: give one" : " outlets: give one for each, in the order of the outlets"));
}

void OutletCommand::repeat(const spot::Periodic& periodic) {
  const spot::Outlets repeated = outlets().repeated(periodic);
  outlets_.assign(repeated.begin(), repeated.end());
}

void OutletCommand::look_at_walls(const spot::Container& walls) {
  slopes_.clear();
  widths_.clear();
  if (!gravity_) return;
  for (const spot::Outlet& outlet : outlets_) {
    widths_.push_back(spot::silo_width(walls, outlet));
    slopes_.push_back(spot::hopper_slope(walls, outlet));
    if (!hopper_ || hopper_->half_angle || slopes_.back()) continue;
    throw InvalidParameter(message("'hopper' finds no hopper that ends at the ", outlet.name(),
                                   ": walls from its rim on, at one angle up to its radius above; give the half-angle, "
                                   "'hopper ",
                                   hopper_->of_material, " half-angle'"));
  }
}

std::optional<spot::Orifice> OutletCommand::single_orifice() const {
  return outlets_.size() == 1 ? last_orifice_ : std::nullopt;
}

std::vector<double> OutletCommand::births(const spot::SpotParameters& spots, double diameter) const {
  std::vector<double> rates = rates_;
  for (const double grains : outflow_) rates.push_back(spot::births_for(grains, spots, diameter));
  for (const double grains : predicted_outflow(diameter)) rates.push_back(spot::births_for(grains, spots, diameter));
  return rates;
}

spot::Injection OutletCommand::injection(const spot::SpotParameters& spots, double diameter) const {
  const std::vector<double> rates = births(spots, diameter);
  std::vector<spot::RateSchedule> all;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    std::vector<spot::RateStep> steps;
    if (const auto schedule = schedules_.find(k + 1); schedule != schedules_.end())
      for (const Step& step : schedule->second.steps) steps.push_back({step.time, step.factor * rates[k]});
    if (steps.empty() || steps.front().time > 0.0) steps.insert(steps.begin(), {0.0, rates[k]});
    all.emplace_back(steps);
  }
  return spot::Injection(all);
}

std::map<std::size_t, std::string> OutletCommand::variables() const {
  std::map<std::size_t, std::string> names;
  for (const auto& [outlet, schedule] : schedules_)
    if (!schedule.variable.empty()) names[outlet - 1] = schedule.variable;
  return names;
}

std::vector<double> OutletCommand::predicted_outflow(double diameter) const {
  std::vector<double> outflow;
  if (!gravity_) return outflow;
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    const double over_flat_base = spot::predicted_outflow(*outlets_[k].hole, law_, *gravity_, diameter);
    if (over_flat_base == 0.0)
      throw InvalidParameter(message("Beverloo's law predicts no outflow through the ", outlets_[k].name(),
                                     ", which is not wider than ", law_.margin, " diameters of ", diameter));
    outflow.push_back(hopper_factor(k) * over_flat_base);
  }
  return outflow;
}

/// The tangent of the half-angle of the hopper at an outlet, as given or as the walls have it; none over a flat base.
std::optional<double> OutletCommand::slope_at(std::size_t outlet) const {
  if (hopper_ && hopper_->half_angle) return spot::tangent(*hopper_->half_angle);
  return outlet < slopes_.size() ? slopes_[outlet] : std::nullopt;
}

double OutletCommand::hopper_factor(std::size_t outlet) const {
  const auto slope = slope_at(outlet);
  if (!hopper_ || !slope) return 1.0;
  if (*slope == 0.0)
    throw InvalidParameter(message("'hopper' finds a pipe above the ", outlets_[outlet].name(),
                                   ", for which there is no outflow by Beverloo's law: use 'injection'"));
  return spot::hopper_factor(*slope, spot::tangent(hopper_->of_material));
}

std::string OutletCommand::text_of_hopper(std::size_t outlet) const {
  const auto slope = slope_at(outlet);
  if (!hopper_ || !slope) return "";
  return message(hopper_factor(outlet), " times that over a flat base, for a hopper with a half-angle of ",
                 degrees_of(*slope), " degrees, by Rose and Tanaka, who have cones of less than ",
                 90.0 - hopper_->of_material);
}

std::string OutletCommand::range_of_law() {
  using Law = spot::BeverlooLaw;
  return message("Beverloo's law is for flat bases, outlets of ", Law::least_width, " diameters or more, silos wider ",
                 "than ", Law::least_silo_in_holes, " outlets and than an outlet and ", Law::least_silo_beyond,
                 " diameters, and beds deeper than ", Law::least_depth_in_silos, " widths of the silo and ",
                 Law::least_depth_in_holes, " of the outlet");
}

std::vector<std::string> OutletCommand::doubts(double diameter, const std::vector<double>& depths) const {
  std::vector<std::string> doubts;
  if (!gravity_) return doubts;
  for (std::size_t k = 0; k < outlets_.size(); ++k) {
    if (const double width = 2.0 * outlets_[k].hole->widest_radius() / diameter; width < spot::BeverlooLaw::least_width)
      doubts.push_back(message("the ", outlets_[k].name(), " is ", width, " diameters wide: below ",
                               spot::BeverlooLaw::least_width,
                               " grains may clog, which neither Beverloo's law nor the spot model knows"));
    add_doubts_of_hopper(k, doubts);
    add_doubts_of_silo(k, diameter, depths.empty() ? std::nullopt : std::optional(depths[k]), doubts);
  }
  return doubts;
}

/// In diameters. What is wide by the walls of a hopper, or deep, is another law's.
void OutletCommand::add_doubts_of_silo(std::size_t outlet, double diameter, std::optional<double> depth,
                                       std::vector<std::string>& doubts) const {
  using Law = spot::BeverlooLaw;
  if (slope_at(outlet) || outlet >= widths_.size()) return;
  const double hole = 2.0 * outlets_[outlet].hole->widest_radius() / diameter;
  const double least_silo = std::max(Law::least_silo_in_holes * hole, hole + Law::least_silo_beyond);
  double least_depth = Law::least_depth_in_holes * hole;
  if (widths_[outlet]) {
    const double silo = *widths_[outlet] / diameter;
    least_depth = std::max(least_depth, Law::least_depth_in_silos * silo);
    if (silo < least_silo)
      doubts.push_back(message("the nearest wall is ", 0.5 * silo, " diameters from the middle of the ",
                               outlets_[outlet].name(), ": Beverloo's law is for ", 0.5 * least_silo, " or more"));
  }
  if (depth && *depth / diameter < least_depth)
    doubts.push_back(message("the bed above the ", outlets_[outlet].name(), " is ", *depth / diameter,
                             " diameters deep: Beverloo's law is for ", least_depth, " or more"));
}

void OutletCommand::add_doubts_of_hopper(std::size_t outlet, std::vector<std::string>& doubts) const {
  const auto slope = slope_at(outlet);
  if (!slope) return;
  const double degrees = degrees_of(*slope);
  const auto doubt = [&](const auto&... parts) {
    doubts.push_back(message("the ", outlets_[outlet].name(), " is the end of a hopper with a half-angle of ", degrees,
                             " degrees: ", parts...));
  };
  if (!hopper_) {
    doubt("Beverloo's law is for flat bases; keyword 'hopper' multiplies it by what a hopper makes of it");
    return;
  }
  if (degrees < spot::least_half_angle)
    doubt("below ", spot::least_half_angle, " the factor of 'hopper' grows without a bound");
  if (degrees >= 90.0 - hopper_->of_material)
    doubt("from ", 90.0 - hopper_->of_material, " on the factor of 'hopper' is 1, as over a flat base");
  if (outlets_[outlet].hole->half_width(0) != outlets_[outlet].hole->half_width(1))
    doubt("the factor of 'hopper' was measured with cones, not with wedges");
}

std::string OutletCommand::text_of_outlets() const {
  std::string text;
  for (const std::string& one : texts_) text += (text.empty() ? "" : "; ") + one;
  return text;
}

std::string OutletCommand::text_of_rates() const {
  std::string text = gravity_ ? precise("beverloo ", *gravity_, ' ', law_.round, ' ', law_.margin, ' ', law_.slot) : "";
  if (hopper_) text += precise(" hopper ", hopper_->of_material);
  if (hopper_ && hopper_->half_angle) text += precise(' ', *hopper_->half_angle);
  if (!outflow_.empty()) text += "outflow";
  for (const double rate : outflow_) text += precise(' ', rate);
  for (const double rate : rates_) text += (text.empty() ? "" : " ") + precise(rate);
  for (const auto& [outlet, schedule] : schedules_) {
    text += message("; schedule ", outlet);
    if (!schedule.variable.empty()) text += " v_" + schedule.variable;
    for (const Step& step : schedule.steps) text += precise(' ', step.time, ' ', step.factor);
  }
  return text;
}
