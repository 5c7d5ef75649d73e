// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/free_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// Of a column, in diameters: wide enough to hold a grain at the surface, narrow beside a spot.
constexpr double width_of_column = 2.0;

constexpr double none = -std::numeric_limits<double>::infinity();

}  // namespace

FreeSurface::FreeSurface(const SpotParameters& parameters, const Container& container, double diameter)
    : needed_(parameters.surface_exponent > 0.0 || parameters.spread > 0.0 || parameters.fade > 0.0),
      container_(&container),
      profile_(parameters.profile),
      radius_(parameters.radius),
      beta_(parameters.surface_exponent),
      margin_(parameters.radius + parameters.step_height),
      lattice_(container, width_of_column * diameter),
      lowest_(container.outlets().height()) {}

void FreeSurface::clear() {
  box_ = {};
  heights_.clear();
}

/// That around a place, where nothing repeats.
NodeLattice::Node FreeSurface::column(const Vector3& place) const {
  NodeLattice::Node column = {0, 0, 0};
  for (std::size_t axis = 0; axis < 2; ++axis)
    column[axis] = static_cast<int>(std::floor(lattice_.cell_of(place, axis) + 0.5));
  return column;
}

void FreeSurface::add(const Vector3& grain) {
  const NodeLattice::Node column = lattice_.wrapped(this->column(container_->periodic().wrap(grain)));
  if (!box_.contains(column)) cover({column, {column[0] + 1, column[1] + 1, 1}});
  double& height = heights_[box_.place(column)];
  height = std::max(height, grain.z());
}

bool FreeSurface::covers(const Vector3& low, const Vector3& high) const {
  const NodeLattice::Node first = column(low), last = column(high);
  for (NodeLattice::Node node = first; node[1] <= last[1]; ++node[1])
    for (node[0] = first[0]; node[0] <= last[0]; ++node[0]) {
      const NodeLattice::Node known = lattice_.wrapped(node);
      if (!box_.contains(known) || heights_[box_.place(known)] < high.z()) return false;
    }
  return true;
}

void FreeSurface::cover(const NodeLattice::Box& box) {
  const NodeLattice::Box grown = box_.united(box);
  heights_ = box_.values_in(grown, heights_, none);
  box_ = grown;
}

void FreeSurface::gather(Communicator& communicator) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> ends(4, far);  // least columns, and those of mirrored axes
  if (box_.size() > 0)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      ends[axis] = box_.low[axis];
      ends[2 + axis] = -box_.high[axis];
    }
  ends = communicator.least(ends);
  if (ends[0] == far) return;  // nowhere is a grain
  cover({{static_cast<int>(ends[0]), static_cast<int>(ends[1]), 0},
         {static_cast<int>(-ends[2]), static_cast<int>(-ends[3]), 1}});
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
double FreeSurface::height_over(NodeLattice::Node column) const {
  column = lattice_.wrapped(column);
  for (std::size_t axis = 0; axis < 2; ++axis)
    column[axis] = std::clamp(column[axis], box_.low[axis], box_.high[axis] - 1);
  return heights_[box_.place(column)];
}

double FreeSurface::height(const Vector3& place) const {
  if (heights_.empty()) return container_->outlets().height();
  const double x = lattice_.cell_of(place, 0), y = lattice_.cell_of(place, 1);
  const double low_x = std::floor(x), low_y = std::floor(y);
  const int first = static_cast<int>(low_x), row = static_cast<int>(low_y);
  const auto along_x = [&](int in_row) {
    return (1.0 - (x - low_x)) * height_over({first, in_row, 0}) + (x - low_x) * height_over({first + 1, in_row, 0});
  };
  return (1.0 - (y - low_y)) * along_x(row) + (y - low_y) * along_x(row + 1);
}

double FreeSurface::weight(const Vector3& middle) const {
  // As much of it is below the surface as is above a plane as far on the other side.
  const double below = profile_->part_above((height(middle) - middle.z()) / radius_);
  return pow(std::clamp(below, 0.0, 1.0), beta_);  // of rounded sums, which may be below 0
}

void FreeSurface::replace_container(const Container& container) {
  container_ = &container;
  lattice_.replace_container(container);
}

void FreeSurface::save(Bytes& bytes) const {
  append(bytes, box_);
  append(bytes, heights_);
}

void FreeSurface::restore(ByteReader& saved) {
  box_ = take_box(saved);
  heights_ = saved.take_all<double>();
  if (heights_.size() != box_.size()) throw InvalidState("the saved heights of the surface are damaged");
  find_lowest();
}

std::size_t FreeSurface::memory() const { return bytes_in(heights_) + lattice_.memory(); }

}  // namespace spot
