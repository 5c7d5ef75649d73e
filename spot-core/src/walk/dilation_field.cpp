// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/dilation_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

constexpr std::int64_t parts = 1 << 8;  // of a spot, along one axis
constexpr int samples = 1024;           // of the volume around a node

/// Places between -1 and 1 along each axis, so even that walls across an axis cut off the right share of them: the
/// additive recurrence with powers of the root of x^4 = x + 1.
Vector3 sample(int number) {
  constexpr double root = 1.2207440846057596;
  double step = 1.0;
  Vector3 place;
  for (int axis = 0; axis < 3; ++axis) {
    step /= root;
    const double at = 0.5 + number * step;
    place[axis] = 2.0 * (at - std::floor(at)) - 1.0;
  }
  return place;
}

}  // namespace

DilationField::DilationField(const SpotParameters& parameters, const Container& container, double diameter)
    : container_(&container),
      origin_(container.outlets()[0].centre),
      spacing_(Vector3::Constant(std::max(parameters.radius, diameter))),
      spot_volume_(parameters.missing_volume(diameter)),
      reference_(parameters.dilation) {
  const Periodic& periodic = container.periodic();
  for (int axis = 0; axis < 2; ++axis) {
    if (!periodic.along(axis)) continue;
    const double nodes = std::max(1.0, std::floor(periodic.length(axis) / spacing_[axis]));
    spacing_[axis] = periodic.length(axis) / nodes;
    period_[static_cast<std::size_t>(axis)] = static_cast<int>(nodes);
  }
}

DilationField::Node DilationField::wrapped(Node node) const {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (period_[axis] == 0) continue;
    node[axis] %= period_[axis];
    if (node[axis] < 0) node[axis] += period_[axis];
  }
  return node;
}

std::array<DilationField::Corner, 8> DilationField::corners(const Vector3& point) const {
  Node low;
  std::array<std::int64_t, 3> share;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = cell_of(point, axis);
    low[axis] = static_cast<int>(std::floor(at));
    share[axis] = static_cast<std::int64_t>((at - low[axis]) * parts + 0.5);
  }
  std::array<Corner, 8> all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k] = {low, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool upper = (k >> axis & 1) != 0;
      all[k].node[axis] += upper ? 1 : 0;
      all[k].weight *= upper ? share[axis] : parts - share[axis];
    }
  }
  if (period_[0] != 0 || period_[1] != 0)
    for (Corner& corner : all) corner.node = wrapped(corner.node);
  return all;
}

bool DilationField::counted(const Node& node) const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (node[axis] < low_[axis] || node[axis] >= high_[axis]) return false;
  return true;
}

std::size_t DilationField::place(const Node& node) const {
  std::size_t place = 0;
  for (std::size_t axis = 3; axis-- > 0;)
    place =
        place * static_cast<std::size_t>(high_[axis] - low_[axis]) + static_cast<std::size_t>(node[axis] - low_[axis]);
  return place;
}

void DilationField::count(const std::vector<Vector3>& spots, Communicator& communicator) {
  std::vector<double> ends(6, std::numeric_limits<double>::infinity());  // least nodes, and those of mirrored axes
  for (const Vector3& spot : spots)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = std::floor(cell_of(spot, axis));
      ends[axis] = std::min(ends[axis], low);
      ends[3 + axis] = std::min(ends[3 + axis], -1.0 - low);
    }
  ends = communicator.least(ends);
  counts_.clear();
  counted_volumes_.clear();
  low_ = high_ = {0, 0, 0};
  if (std::isinf(ends[0])) return;  // nowhere is a spot
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis] = static_cast<int>(ends[axis]);
    high_[axis] = static_cast<int>(-ends[3 + axis]) + 1;
    if (period_[axis] == 0) continue;
    low_[axis] = 0;
    high_[axis] = period_[axis];
  }
  counts_.resize(place({low_[0], low_[1], high_[2]}));
  for (const Vector3& spot : spots)
    for (const Corner& corner : corners(spot)) counts_[place(corner.node)] += corner.weight;
  counts_ = communicator.sum(std::move(counts_));
  find_volumes();
}

void DilationField::find_volumes() {
  counted_volumes_.resize(counts_.size());
  Node node;
  for (node[2] = low_[2]; node[2] < high_[2]; ++node[2])
    for (node[1] = low_[1]; node[1] < high_[1]; ++node[1])
      for (node[0] = low_[0]; node[0] < high_[0]; ++node[0]) counted_volumes_[place(node)] = volume_of(node);
}

/// Of the lattice cell around a node, nearness to it being the weight.
double DilationField::volume_of(const Node& node) const {
  const auto known = volumes_.find(node);
  if (known != volumes_.end()) return known->second;
  double inside = 0.0, all = 0.0;
  for (int number = 0; number < samples; ++number) {
    const Vector3 from_node = sample(number);
    const double weight = (1.0 - from_node.array().abs()).prod();
    all += weight;
    if (container_->contains(origin_ + spacing_.cwiseProduct(Vector3(node[0], node[1], node[2]) + from_node)))
      inside += weight;
  }
  return volumes_[node] = inside / all * spacing_.x() * spacing_.y() * spacing_.z();
}

double DilationField::at(const Vector3& point) const {
  double spots = 0.0, volume = 0.0;
  for (const Corner& corner : corners(point)) {
    const auto weight = static_cast<double>(corner.weight);
    if (!counted(corner.node)) {
      volume += weight * volume_of(corner.node);
      continue;
    }
    const std::size_t at = place(corner.node);
    volume += weight * counted_volumes_[at];
    spots += weight * static_cast<double>(counts_[at]);
  }
  constexpr double whole = static_cast<double>(parts) * parts * parts;
  return volume > 0.0 ? spots / whole * spot_volume_ / volume : std::numeric_limits<double>::infinity();
}

double DilationField::relative_speed(const Vector3& point) const {
  const double ratio = at(point) / reference_;
  return std::clamp(ratio * ratio, calibration::slowest_relative_speed, calibration::fastest_relative_speed);
}

void DilationField::replace_container(const Container& container) {
  container_ = &container;
  volumes_.clear();
  find_volumes();
}

void DilationField::save(Bytes& bytes) const {
  append(bytes, low_);
  append(bytes, high_);
  append(bytes, counts_);
}

void DilationField::restore(ByteReader& saved) {
  low_ = saved.take<Node>();
  high_ = saved.take<Node>();
  counts_ = saved.take_all<std::int64_t>();
  std::size_t nodes = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    nodes *= static_cast<std::size_t>(std::max<std::int64_t>(0, std::int64_t{high_[axis]} - low_[axis]));
  if (counts_.size() != nodes) throw InvalidState("the saved counts of spots are damaged");
  find_volumes();
}

std::size_t DilationField::memory() const {
  return bytes_in(counts_, counted_volumes_) + volumes_.size() * sizeof(std::pair<const Node, double>);
}

}  // namespace spot
