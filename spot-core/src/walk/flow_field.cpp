// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/flow_field.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/geometry/half_width.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

constexpr double carried_parts = 1 << 16;

/// Of the weights of corners, so that sums of many steps fit.
constexpr int dropped_bits = 8;

constexpr double unknown = -1.0;

/// Of a lattice cell: with less of it inside the walls, a node is taken to be in the wall.
constexpr double least_part_inside = 0.05;

}  // namespace

double shear_by_walls(double kappa, const Container& container, const Vector3& place, double spacing) {
  return kappa > 0.0 ? kappa / half_width(container, place, calibration::farthest_walls * spacing) : 0.0;
}

FlowField::FlowField(const SpotParameters& parameters, const Container& container, double diameter)
    : container_(&container),
      lattice_(container, std::max(parameters.radius, diameter)),
      spreads_(parameters.spread > 0.0),
      strains_along_z_(parameters.full_strain > 0.0),
      wall_shear_(parameters.wall_shear),
      memory_time_(calibration::climb_of_flow_memory * parameters.radius / parameters.speed),
      step_height_(parameters.step_height),
      mobility_(parameters.mobility),
      fall_of_carried_(parameters.missing_volume(diameter) * parameters.step_height /
                       (calibration::packing_fraction_of_flow * carried_parts * (NodeLattice::whole >> dropped_bits))) {
}

void FlowField::add(const Move& move, double volume) {
  const double carried = volume * (move.step.z() / step_height_);
  added_.push_back({move.middle, static_cast<std::int64_t>(std::nearbyint(carried * carried_parts))});
}

void FlowField::update(double elapsed, Communicator& communicator) {
  std::vector<Vector3> middles;
  for (const Step& step : added_) middles.push_back(step.middle);
  grow_to(lattice_.around(middles, communicator));
  if (box_.size() == 0) return;
  std::vector<std::int64_t> sums(box_.size(), 0);
  for (const Step& step : added_)
    for (const NodeLattice::Corner& corner : lattice_.corners(step.middle))
      sums[box_.place(corner.node)] += step.carried * (corner.weight >> dropped_bits);
  added_.clear();
  sums = communicator.sum(std::move(sums));
  const double kept = exp(-elapsed / memory_time_);
  for (std::size_t k = 0; k < sums.size(); ++k) carried_[k] = kept * carried_[k] + static_cast<double>(sums[k]);
  for (std::size_t k = 0; k < total_.size(); ++k) total_[k] += static_cast<double>(sums[k]);
  find_slopes();
}

void FlowField::grow_to(const NodeLattice::Box& box) {
  const NodeLattice::Box grown = box_.united(box);
  if (grown == box_) return;
  carried_ = box_.values_in(grown, carried_, 0.0);
  if (mobility_.on()) total_ = box_.values_in(grown, total_, 0.0);
  walls_ = box_.values_in(grown, walls_, unknown);
  box_ = grown;
  find_volumes();
  find_walls();
}

void FlowField::find_volumes() {
  volumes_.assign(box_.size(), 0.0);
  box_.visit([&](const NodeLattice::Node& node, std::size_t k) {
    const double volume = lattice_.volume(node);
    if (volume > least_part_inside * lattice_.cell_volume()) volumes_[k] = volume;
  });
}

void FlowField::find_walls() {
  box_.visit([&](const NodeLattice::Node& node, std::size_t k) {
    if (walls_[k] != unknown) return;
    walls_[k] = 0.0;
    if (wall_shear_ == 0.0 || volumes_[k] == 0.0) return;
    walls_[k] = shear_by_walls(wall_shear_, *container_, place_inside(node), lattice_.spacing().x());
  });
}

/// A place inside the walls and above the outlets that is closest to a node, of some around it; the node if there is
/// none.
Vector3 FlowField::place_inside(const NodeLattice::Node& node) const {
  const Vector3 middle = lattice_.point(node);
  const double lowest = container_->outlets().height() + 1e-3 * lattice_.spacing().z();
  for (const double shift : {0.0, 0.25, 0.5, 0.75})
    for (const double x : {-shift, 0.0, shift})
      for (const double y : {-shift, 0.0, shift})
        for (const double z : {0.0, shift}) {
          Vector3 place = middle + lattice_.spacing().cwiseProduct(Vector3(x, y, z));
          place.z() = std::max(place.z(), lowest);
          if (container_->contains(place)) return place;
        }
  return middle;
}

/// Of the values at the nodes of the box that at a node; `elsewhere` beyond the box, `otherwise` in walls.
double FlowField::at(const std::vector<double>& values, double elsewhere, const NodeLattice::Node& unwrapped,
                     double otherwise) const {
  const NodeLattice::Node node = lattice_.wrapped(unwrapped);
  if (!box_.contains(node))
    return lattice_.volume(node) > least_part_inside * lattice_.cell_volume() ? elsewhere : otherwise;
  const std::size_t k = box_.place(node);
  return volumes_[k] > 0.0 ? values[k] : otherwise;
}

/// The values on either side of a node along an axis: in walls, across which nothing changes, that at the node.
std::pair<double, double> FlowField::beside(const std::vector<double>& values, double elsewhere, int axis,
                                            const NodeLattice::Node& node) const {
  NodeLattice::Node before = node, after = node;
  --before[static_cast<std::size_t>(axis)];
  ++after[static_cast<std::size_t>(axis)];
  const double here = values[box_.place(node)];
  return {at(values, elsewhere, before, here), at(values, elsewhere, after, here)};
}

void FlowField::find_shear() {
  std::vector<double> flow(box_.size(), 0.0);
  for (std::size_t k = 0; k < flow.size(); ++k)
    if (volumes_[k] > 0.0) flow[k] = carried_[k] / volumes_[k];
  // Over the flow itself: two over the spacing at most.
  const auto relative_slope = [&](int axis, const NodeLattice::Node& node, double here) {
    const auto [low, high] = beside(flow, 0.0, axis, node);
    const double mean = 0.25 * (low + high) + 0.5 * here;
    return mean > 0.0 ? (high - low) / (2.0 * lattice_.spacing()[axis] * mean) : 0.0;
  };
  strains_.assign(box_.size(), Eigen::Array2d::Zero());
  slope_.assign(spreads_ ? box_.size() : 0, Vector3::Zero());
  box_.visit([&](const NodeLattice::Node& node, std::size_t k) {
    if (volumes_[k] == 0.0) return;
    const double x = relative_slope(0, node, flow[k]), y = relative_slope(1, node, flow[k]);
    strains_[k][0] = std::sqrt(x * x + y * y) + walls_[k];
    if (strains_along_z_) {
      const double z = relative_slope(2, node, flow[k]);
      strains_[k][1] = std::sqrt(x * x + y * y + z * z) + walls_[k];
    }
    if (spreads_) slope_[k] = Vector3(x, y, 0.0);
  });
}

void FlowField::find_slope_of_mobility() {
  if (!mobility_.on()) return;
  const double at_rest = mobility_.logarithm(0.0);
  std::vector<double> logarithm(box_.size(), at_rest);
  for (std::size_t k = 0; k < logarithm.size(); ++k)
    if (volumes_[k] > 0.0) logarithm[k] = mobility_.logarithm(fall_of_carried_ * total_[k] / volumes_[k]);
  slope_of_mobility_.assign(box_.size(), Vector3::Zero());
  box_.visit([&](const NodeLattice::Node& node, std::size_t k) {
    if (volumes_[k] == 0.0) return;
    for (const int axis : {0, 1}) {
      const auto [low, high] = beside(logarithm, at_rest, axis, node);
      slope_of_mobility_[k][axis] = (high - low) / (2.0 * lattice_.spacing()[axis]);
    }
  });
}

void FlowField::find_slopes() {
  find_shear();
  find_slope_of_mobility();
}

/// Between nodes, each counted by the volume around it; `none` where there is none.
template <typename Value>
Value FlowField::mean_of(const std::vector<Value>& values, const Vector3& point, Value none) const {
  Value sum = none;
  double volume = 0.0;
  for (const NodeLattice::Corner& corner : lattice_.corners(point)) {
    if (!box_.contains(corner.node)) continue;
    const std::size_t k = box_.place(corner.node);
    const double weight = static_cast<double>(corner.weight) * volumes_[k];
    sum += weight * values[k];
    volume += weight;
  }
  return volume > 0.0 ? Value(sum / volume) : none;
}

double FlowField::shear(const Vector3& point) const { return strain(point).shear; }

Strain FlowField::strain(const Vector3& point) const {
  const Eigen::Array2d none = Eigen::Array2d::Zero(), mean = mean_of(strains_, point, none);
  return {mean[0], mean[1]};
}

Vector3 FlowField::slope(const Vector3& point) const {
  const Vector3 none = Vector3::Zero();
  return slope_.empty() ? none : mean_of(slope_, point, none);
}

Vector3 FlowField::slope_of_mobility(const Vector3& point) const {
  const Vector3 none = Vector3::Zero();
  return slope_of_mobility_.empty() ? none : mean_of(slope_of_mobility_, point, none);
}

void FlowField::replace_container(const Container& container) {
  container_ = &container;
  lattice_.replace_container(container);
  find_volumes();
  walls_.assign(box_.size(), unknown);
  find_walls();
  find_slopes();
}

void FlowField::save(Bytes& bytes) const {
  append(bytes, box_);
  append(bytes, carried_);
  append(bytes, total_);
  append(bytes, static_cast<std::uint64_t>(added_.size()));
  for (const Step& step : added_) {
    append(bytes, step.middle);
    append(bytes, step.carried);
  }
}

void FlowField::restore(ByteReader& saved) {
  box_ = take_box(saved);
  carried_ = saved.take_all<double>();
  total_ = saved.take_all<double>();
  if (carried_.size() != box_.size() || total_.size() != (mobility_.on() ? box_.size() : 0))
    throw InvalidState("the saved flow is damaged");
  for (auto n = saved.take<std::uint64_t>(); n > 0; --n) {
    const auto middle = saved.take<Vector3>();
    added_.push_back({middle, saved.take<std::int64_t>()});
  }
  find_volumes();
  walls_.assign(box_.size(), unknown);
  find_walls();
  find_slopes();
}

std::size_t FlowField::memory() const {
  return bytes_in(added_, carried_, total_, volumes_, walls_, strains_, slope_, slope_of_mobility_) + lattice_.memory();
}

}  // namespace spot
