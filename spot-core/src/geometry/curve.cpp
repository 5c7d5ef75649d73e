// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/curve.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/directions.hpp"
#include "geometry/search.hpp"

namespace spot {

namespace {

constexpr int intervals = 128;  // of a curve's parameter between two samples

}  // namespace

void StraightCurve::visit_nearest(const Vector3& place, double,
                                  const std::function<void(const Vector3&)>& visit) const {
  visit(line_.at(line_.direction.dot(place - line_.origin)));
}

std::vector<Vector3> StraightCurve::meetings(const Surface& surface, double tolerance) const {
  std::vector<Vector3> points;
  for (const double s : Crossings(surface.along(line_))) {
    const Vector3 point = line_.at(s);
    const bool lies_in_it = std::abs(surface.depth(line_.at(s + 1e6 * tolerance))) < tolerance;
    if (!lies_in_it && std::abs(surface.depth(point)) < tolerance) points.push_back(point);
  }
  return points;
}

void SampledCurve::take_samples(bool closed) {
  closed_ = closed;
  for (int k = 0; k <= intervals; ++k) samples_.push_back(at(static_cast<double>(k) / intervals));
  if (closed) samples_.back() = samples_.front();
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const std::size_t before = k == 0 ? (closed ? intervals - 1 : 0) : k - 1;
    const std::size_t after = k == intervals ? (closed ? 1 : k) : k + 1;
    gaps_.push_back(std::max((samples_[k] - samples_[before]).norm(), (samples_[k] - samples_[after]).norm()));
  }
}

void SampledCurve::visit_nearest(const Vector3& place, double reach,
                                 const std::function<void(const Vector3&)>& visit) const {
  std::array<double, intervals + 1> distance;
  for (std::size_t k = 0; k <= intervals; ++k) distance[k] = (samples_[k] - place).norm();
  const auto from_place = [&](double parameter) { return (at(parameter) - place).squaredNorm(); };
  for (std::size_t k = 0; k < intervals + (closed_ ? 0 : 1); ++k) {
    if (distance[k] > reach + 2.0 * gaps_[k]) continue;
    const bool first = k == 0 && !closed_, last = k == intervals;
    const double before = first ? distance[0] : distance[k == 0 ? intervals - 1 : k - 1];
    const double after = last ? distance[k] : distance[k + 1];
    if (before < distance[k] || after < distance[k]) continue;
    const double low = (static_cast<double>(k) - (first ? 0.0 : 1.0)) / intervals;
    const double high = (static_cast<double>(k) + (last ? 0.0 : 1.0)) / intervals;
    visit(at(place_of_minimum(from_place, low, high)));
  }
}

std::vector<Vector3> SampledCurve::meetings(const Surface& surface, double tolerance) const {
  std::vector<double> depths;
  for (const Vector3& sample : samples_) depths.push_back(surface.depth(sample));
  const auto depth = [&](double parameter) { return surface.depth(at(parameter)); };
  if (std::all_of(depths.begin(), depths.end(), [&](double d) { return std::abs(d) < tolerance; })) return {};
  std::vector<Vector3> points;
  const auto close_in = [&](double yes, double no) {
    const bool inner = depth(yes) >= 0.0;
    points.push_back(at(last_where([&](double parameter) { return (depth(parameter) >= 0.0) == inner; }, yes, no)));
  };
  const auto parameter = [](std::size_t k) { return static_cast<double>(k) / intervals; };
  for (std::size_t k = 0; k < intervals; ++k)
    if ((depths[k] >= 0.0) != (depths[k + 1] >= 0.0)) close_in(parameter(k), parameter(k + 1));
  // It may go through and come back between two samples.
  for (std::size_t k = 0; k < intervals + (closed_ ? 0 : 1); ++k) {
    const std::size_t before = k > 0     ? k - 1
                               : closed_ ? intervals - 1
                                         : 0,
                      after = std::min<std::size_t>(k + 1, intervals);
    const double sign = depths[k] >= 0.0 ? 1.0 : -1.0;
    if (std::abs(depths[k]) > 2.0 * gaps_[k]) continue;
    if (!(sign * depths[before] >= sign * depths[k] && sign * depths[after] >= sign * depths[k])) continue;
    const double low = parameter(k) - (k > 0 || closed_ ? 1.0 / intervals : 0.0), high = parameter(after);
    const double lowest = place_of_minimum([&](double p) { return sign * depth(p); }, low, high);
    if (std::abs(depth(lowest)) < tolerance) points.push_back(at(lowest));
    if (sign * depth(lowest) >= 0.0) continue;
    if (sign * depth(low) > 0.0) close_in(low, lowest);
    if (sign * depth(high) > 0.0) close_in(high, lowest);
  }
  // An open curve may end in it.
  for (const std::size_t k : {std::size_t{0}, std::size_t{intervals}})
    if (!closed_ && std::abs(depths[k]) < tolerance) points.push_back(samples_[k]);
  return points;
}

Circle::Circle(const Vector3& centre, const Vector3& axis, double radius)
    : centre_(centre), axis_(axis), first_(across(axis)), second_(axis.cross(first_)), radius_(radius) {
  take_samples(true);
}

void Circle::visit_nearest(const Vector3& place, double, const std::function<void(const Vector3&)>& visit) const {
  const Vector3 from_centre = place - centre_;
  const Vector3 out = from_centre - axis_.dot(from_centre) * axis_;
  const double distance = out.norm();
  visit(centre_ + radius_ * (distance > 0.0 ? Vector3(out / distance) : first_));
}

Vector3 Circle::at(double parameter) const { return centre_ + radius_ * around(parameter, first_, second_); }

CurveOverGenerators::CurveOverGenerators(const Surface& ruled, const Surface& other, bool plus, double first,
                                         double last, bool closed)
    : ruled_(ruled), other_(other), plus_(plus), first_(first), last_(last), closed_(closed) {
  take_samples(closed);
}

Vector3 CurveOverGenerators::at(double parameter) const {
  // At its ends the curve goes on along the other root, at a right angle to the generator's turn; in this parameter
  // smoothly.
  const double share = closed_ ? parameter : parameter * parameter * (3.0 - 2.0 * parameter);
  const Line line = ruled_.generator(first_ + share * (last_ - first_));
  Quadratic equation = other_.along(line);
  // Between its ends there is a root, whatever rounding says.
  if (equation.discriminant() < 0.0) return line.at(-equation.half_linear / equation.squared);
  return line.at(equation.root(plus_));
}

}  // namespace spot
