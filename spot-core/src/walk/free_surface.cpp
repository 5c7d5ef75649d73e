// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/free_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Of a column, in diameters: wide enough to hold a grain at the surface, narrow beside a spot.
constexpr double width_of_column = 2.0;

constexpr double none = -std::numeric_limits<double>::infinity();

}  // namespace

FreeSurface::FreeSurface(const SpotParameters& parameters, const Container& container, double diameter)
    : container_(&container),
      profile_(parameters.profile),
      radius_(parameters.radius),
      beta_(parameters.surface_exponent),
      margin_(parameters.radius + parameters.step_height),
      origin_(container.outlets()[0].centre),
      lowest_(container.outlets().height()) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    width_[axis] = width_of_column * diameter;
    const auto i = static_cast<int>(axis);
    const Periodic& periodic = container.periodic();
    if (!periodic.along(i)) continue;
    const double columns = std::max(1.0, std::floor(periodic.length(i) / width_[axis]));
    width_[axis] = periodic.length(i) / columns;
    period_[axis] = static_cast<int>(columns);
  }
}

/// In columns from the first outlet's centre, which is the axis of one.
double FreeSurface::place_of(const Vector3& place, std::size_t axis) const {
  const auto i = static_cast<int>(axis);
  return (place[i] - origin_[i]) / width_[axis];
}

bool FreeSurface::covered(const Column& column) const {
  return !heights_.empty() && column[0] >= low_[0] && column[0] < high_[0] && column[1] >= low_[1] &&
         column[1] < high_[1];
}

std::size_t FreeSurface::at(const Column& column) const {
  return static_cast<std::size_t>(column[1] - low_[1]) * static_cast<std::size_t>(high_[0] - low_[0]) +
         static_cast<std::size_t>(column[0] - low_[0]);
}

/// Covers all columns from low to high, exclusive, besides those that are covered.
void FreeSurface::cover(const Column& low, const Column& high) {
  const Column old_low = low_, old_high = high_;
  const std::vector<double> old = std::move(heights_);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    low_[axis] = old.empty() ? low[axis] : std::min(low[axis], old_low[axis]);
    high_[axis] = old.empty() ? high[axis] : std::max(high[axis], old_high[axis]);
  }
  heights_.assign(static_cast<std::size_t>(high_[0] - low_[0]) * static_cast<std::size_t>(high_[1] - low_[1]), none);
  std::size_t k = 0;
  if (!old.empty())
    for (int y = old_low[1]; y < old_high[1]; ++y)
      for (int x = old_low[0]; x < old_high[0]; ++x) heights_[at({x, y})] = old[k++];
}

void FreeSurface::add(const Vector3& grain) {
  Column column;
  const Vector3 place = container_->periodic().wrap(grain);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    column[axis] = static_cast<int>(std::floor(place_of(place, axis) + 0.5));
    if (period_[axis] != 0) column[axis] = (column[axis] % period_[axis] + period_[axis]) % period_[axis];
  }
  if (!covered(column)) cover(column, {column[0] + 1, column[1] + 1});
  double& height = heights_[at(column)];
  height = std::max(height, grain.z());
}

void FreeSurface::gather(Communicator& communicator) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> ends(4, far);  // least columns, and those of mirrored axes
  if (!heights_.empty())
    for (std::size_t axis = 0; axis < 2; ++axis) {
      ends[axis] = low_[axis];
      ends[2 + axis] = -high_[axis];
    }
  ends = communicator.least(ends);
  if (ends[0] == far) return;  // nowhere is a grain
  cover({static_cast<int>(ends[0]), static_cast<int>(ends[1])},
        {static_cast<int>(-ends[2]), static_cast<int>(-ends[3])});
  std::vector<double> depths;
  for (const double height : heights_) depths.push_back(-height);
  depths = communicator.least(depths);
  for (std::size_t k = 0; k < depths.size(); ++k) heights_[k] = std::max(-depths[k], container_->outlets().height());
  find_lowest();
}

void FreeSurface::find_lowest() {
  lowest_ = heights_.empty() ? container_->outlets().height() : *std::min_element(heights_.begin(), heights_.end());
}

/// Beyond the last column it is as over that.
double FreeSurface::height_over(Column column) const {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (period_[axis] != 0) column[axis] = (column[axis] % period_[axis] + period_[axis]) % period_[axis];
    column[axis] = std::clamp(column[axis], low_[axis], high_[axis] - 1);
  }
  return heights_[at(column)];
}

double FreeSurface::height(const Vector3& place) const {
  if (heights_.empty()) return container_->outlets().height();
  const double x = place_of(place, 0), y = place_of(place, 1), low_x = std::floor(x), low_y = std::floor(y);
  const Column column = {static_cast<int>(low_x), static_cast<int>(low_y)};
  const auto along_x = [&](int row) {
    return (1.0 - (x - low_x)) * height_over({column[0], row}) + (x - low_x) * height_over({column[0] + 1, row});
  };
  return (1.0 - (y - low_y)) * along_x(column[1]) + (y - low_y) * along_x(column[1] + 1);
}

std::size_t FreeSurface::choose(const std::vector<Vector3>& middles, double uniform) const {
  std::vector<double> weights;
  double sum = 0.0;
  for (const Vector3& middle : middles) {
    // As much of it is below the surface as is above a plane as far on the other side.
    const double below = profile_->part_above((height(middle) - middle.z()) / radius_);
    weights.push_back(pow(std::clamp(below, 0.0, 1.0), beta_));  // of rounded sums, which may be below 0
    sum += weights.back();
  }
  const std::size_t last = middles.size() - 1;
  if (sum == 0.0) return std::min(last, static_cast<std::size_t>(uniform * static_cast<double>(middles.size())));
  double left = uniform * sum;
  for (std::size_t k = 0; k < last; ++k) {
    if (left < weights[k]) return k;
    left -= weights[k];
  }
  return last;
}

void FreeSurface::save(Bytes& bytes) const {
  append(bytes, low_);
  append(bytes, high_);
  append(bytes, heights_);
}

void FreeSurface::restore(ByteReader& saved) {
  low_ = saved.take<Column>();
  high_ = saved.take<Column>();
  heights_ = saved.take_all<double>();
  const std::int64_t columns = (std::int64_t{high_[0]} - low_[0]) * (std::int64_t{high_[1]} - low_[1]);
  if (!heights_.empty() &&
      (columns <= 0 || high_[0] <= low_[0] || static_cast<std::size_t>(columns) != heights_.size()))
    throw InvalidState("the saved heights of the surface are damaged");
  find_lowest();
}

}  // namespace spot
