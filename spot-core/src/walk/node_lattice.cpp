// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/node_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"

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

NodeLattice::NodeLattice(const Container& container, double spacing)
    : container_(&container), origin_(container.outlets()[0].centre), spacing_(Vector3::Constant(spacing)) {
  const Periodic& periodic = container.periodic();
  for (int axis = 0; axis < 2; ++axis) {
    if (!periodic.along(axis)) continue;
    const double nodes = std::max(1.0, std::floor(periodic.length(axis) / spacing_[axis]));
    spacing_[axis] = periodic.length(axis) / nodes;
    period_[static_cast<std::size_t>(axis)] = static_cast<int>(nodes);
  }
}

NodeLattice::Node NodeLattice::wrapped(Node node) const {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (period_[axis] == 0) continue;
    node[axis] %= period_[axis];
    if (node[axis] < 0) node[axis] += period_[axis];
  }
  return node;
}

std::array<NodeLattice::Corner, 8> NodeLattice::corners(const Vector3& point) const {
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

double NodeLattice::volume(const Node& node) const {
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

void NodeLattice::replace_container(const Container& container) {
  container_ = &container;
  volumes_.clear();
}

NodeLattice::Box NodeLattice::around(const std::vector<Vector3>& points, Communicator& communicator) const {
  std::vector<double> ends(6, std::numeric_limits<double>::infinity());  // least nodes, and those of mirrored axes
  if (!points.empty()) {
    Vector3 low = points.front(), high = low;
    for (const Vector3& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ends[axis] = std::floor(cell_of(low, axis));
      ends[3 + axis] = -1.0 - std::floor(cell_of(high, axis));
    }
  }
  ends = communicator.least(ends);
  Box box;
  if (std::isinf(ends[0])) return box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = static_cast<int>(ends[axis]);
    box.high[axis] = static_cast<int>(-ends[3 + axis]) + 1;
    if (period_[axis] == 0) continue;
    box.low[axis] = 0;
    box.high[axis] = period_[axis];
  }
  return box;
}

bool NodeLattice::Box::contains(const Node& node) const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (node[axis] < low[axis] || node[axis] >= high[axis]) return false;
  return true;
}

std::size_t NodeLattice::Box::size() const {
  std::size_t nodes = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    nodes *= static_cast<std::size_t>(std::max<std::int64_t>(0, std::int64_t{high[axis]} - low[axis]));
  return nodes;
}

std::size_t NodeLattice::Box::place(const Node& node) const {
  std::size_t place = 0;
  for (std::size_t axis = 3; axis-- > 0;)
    place = place * static_cast<std::size_t>(high[axis] - low[axis]) + static_cast<std::size_t>(node[axis] - low[axis]);
  return place;
}

NodeLattice::Box NodeLattice::Box::united(const Box& other) const {
  if (size() == 0) return other;
  if (other.size() == 0) return *this;
  Box both;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::min(low[axis], other.low[axis]);
    both.high[axis] = std::max(high[axis], other.high[axis]);
  }
  return both;
}

std::vector<double> NodeLattice::Box::values_in(const Box& larger, const std::vector<double>& values,
                                                double otherwise) const {
  std::vector<double> all(larger.size(), otherwise);
  visit([&](const Node& node, std::size_t k) { all[larger.place(node)] = values[k]; });
  return all;
}

NodeLattice::Box take_box(ByteReader& saved) {
  NodeLattice::Box box;
  box.low = saved.take<NodeLattice::Node>();
  box.high = saved.take<NodeLattice::Node>();
  return box;
}

}  // namespace spot
