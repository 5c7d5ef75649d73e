// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/packing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// Thickness of the shell around the diameter that lists cover. Thicker means longer lists, thinner means
/// that grains are listed anew more often.
constexpr double skin_in_diameters = 0.2;

/// More than twice what lists reach while grains are on their way, in diameters: then one image is the nearest.
constexpr double least_period = 4.0;

template <typename T>
void reorder(const std::vector<std::uint32_t>& order, std::vector<T>& values) {
  std::vector<T> sorted(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
  values.swap(sorted);
}

}  // namespace

Packing::Packing(double diameter, double extent, const std::vector<Grain>& grains, const Periodic& periodic)
    : diameter_(diameter),
      extent_(extent),
      half_skin_(0.5 * skin_in_diameters * diameter),
      largest_drift_(half_skin_),
      quantum_(diameter, extent),
      periodic_(periodic.on(quantum_)) {
  periodic_.require_length(least_period * diameter, "four diameters, so that no grain touches another twice");
  for (int axis = 0; axis < 2; ++axis)
    if (periodic_.along(axis) && std::max(-periodic_.low(axis), periodic_.high(axis)) > extent)
      throw InvalidContainer(message("space repeats from ", periodic_.low(axis), " to ", periodic_.high(axis),
                                     " along ", "xy"[axis], ", farther from the origin than ", extent));
  if (grains.size() >= nowhere)
    throw InvalidPacking(message("a packing of ", grains.size(), " grains is too large; below 2^32 are allowed"));
  for (const Grain& grain : grains) {
    if (grain.id < 0) throw InvalidPacking(message("grain id ", grain.id, " is negative"));
    if (!grain.position.allFinite()) throw InvalidPacking(message("position of grain ", grain.id, " is not finite"));
    if (grain.position.cwiseAbs().maxCoeff() > extent)
      throw InvalidPacking(message("grain ", grain.id, " is farther from the origin than ", extent));
    ids_.push_back(grain.id);
    x_.push_back(periodic_.wrap(quantum_.snap(grain.position.x()), 0));
    y_.push_back(periodic_.wrap(quantum_.snap(grain.position.y()), 1));
    z_.push_back(quantum_.snap(grain.position.z()));
    radii_.push_back(radius_in(diameter, grain));
    volumes_.push_back(static_cast<std::uint16_t>(volume_parts(diameter, radii_.back())));
    held_.push_back(grain.held ? 1 : 0);
  }
  std::vector<std::int64_t> sorted = ids_;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) throw InvalidPacking(message("grain id ", *twice, " occurs twice"));
  cell_.assign(ids_.size(), 0);
}

std::vector<Grain> Packing::grains() const {
  std::vector<Grain> all;
  all.reserve(size());
  for (std::size_t i = 0; i < slots(); ++i)
    if (present(i)) all.push_back(grain(i));
  std::sort(all.begin(), all.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return all;
}

Grain Packing::remove(std::uint32_t i) {
  unlist(i);
  cell_[i] = nowhere;
  ++removed_;
  return grain(i);
}

void Packing::find_movable(const Vector3& point, double reach, std::vector<std::uint32_t>& found) const {
  std::size_t n = 0;
  const double reach_squared = reach * reach;
  // Written without a branch, which the processor could not predict: every candidate is stored, and the
  // next one takes its place unless it counts.
  grid_.visit_near(point, reach + half_skin_, [&, x = x(), y = y(), z = z(), held = held_.data()](std::uint32_t i) {
    if (n == found.size()) found.resize(2 * n + 64);
    double dx = x[i] - point.x(), dy = y[i] - point.y();
    const double dz = z[i] - point.z();
    periodic_.shorten(dx, dy);
    found[n] = i;
    n += (dx * dx + dy * dy + dz * dz <= reach_squared) & (held[i] == 0) ? 1 : 0;
  });
  found.resize(n);
}

void Packing::hold_gaps(double widest) {
  largest_drift_ = half_skin_ - 0.5 * widest;
  sort_after_ = 0;  // some grains may be farther from their references already
}

void Packing::list_drifted(const Container& container) {
  for (const std::uint32_t i : drifted_) {
    if (!present(i)) continue;
    unlist(i);
    list(i, container);
  }
  listed_since_sort_ += drifted_.size();
  drifted_.clear();
}

void Packing::sort(const Container& container) {
  std::vector<std::uint32_t> order;
  order.reserve(size());
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (std::uint32_t i = 0; i < slots(); ++i) {
    if (!present(i)) continue;
    order.push_back(i);
    low = low.cwiseMin(position(i));
    high = high.cwiseMax(position(i));
  }
  removed_ = 0;
  if (order.empty()) low = high = Vector3::Zero();
  grid_ = CellGrid(low, high, diameter_ + 2.0 * half_skin_, periodic_);
  for (const std::uint32_t i : order) cell_[i] = grid_.cell_of(x_[i], y_[i], z_[i]);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return cell_[a] != cell_[b] ? cell_[a] < cell_[b] : ids_[a] < ids_[b];
  });
  reorder(order, ids_);
  reorder(order, x_);
  reorder(order, y_);
  reorder(order, z_);
  reorder(order, radii_);
  reorder(order, volumes_);
  reorder(order, held_);

  const std::size_t n = order.size();
  cell_.assign(n, nowhere);
  reference_x_.resize(n);
  reference_y_.resize(n);
  reference_z_.resize(n);
  near_wall_.resize(n);
  list_size_.assign(n, 0);
  neighbours_.assign(n * list_capacity_, 0);
  // Every pair is found by the later of the two, when the earlier is in its cell already.
  for (std::uint32_t i = 0; i < n; ++i) list(i, container);
  drifted_.clear();
  listed_since_sort_ = 0;
  sort_after_ = 2 * n + 1;  // grains that are near in space stay near in memory
}

void Packing::unlist(std::uint32_t i) {
  const auto [first, last] = neighbours(i);
  for (const std::uint32_t* j = first; j != last; ++j) {
    std::uint32_t* list = neighbours_.data() + *j * list_capacity_;
    std::uint32_t* end = list + list_size_[*j];
    *std::find(list, end, i) = *(end - 1);
    --list_size_[*j];
  }
  list_size_[i] = 0;
  grid_.erase(cell_[i], i);
}

void Packing::list(std::uint32_t i, const Container& container) {
  reference_x_[i] = x_[i];
  reference_y_[i] = y_[i];
  reference_z_[i] = z_[i];
  const double reach = diameter_ + 2.0 * half_skin_;
  grid_.visit_near(position(i), reach, [&](std::uint32_t j) {
    double dx = reference_x_[j] - x_[i], dy = reference_y_[j] - y_[i];
    const double dz = reference_z_[j] - z_[i];
    periodic_.shorten(dx, dy);
    if (dx * dx + dy * dy + dz * dz >= reach * reach) return;
    add_neighbour(i, j);
    add_neighbour(j, i);
  });
  cell_[i] = grid_.cell_of(x_[i], y_[i], z_[i]);
  grid_.insert(cell_[i], i);
  mark_near_wall(i, container);
}

void Packing::mark_near_wall(std::uint32_t i, const Container& container) {
  // Where it was listed: the mark holds for as long as the list.
  WallContacts contacts;
  container.contacts({reference_x_[i], reference_y_[i], reference_z_[i]}, radii_[i] + half_skin_, contacts);
  near_wall_[i] = contacts.begin() != contacts.end() ? 1 : 0;
}

void Packing::mark_near_walls(const Container& container) {
  refresh(container);
  for (std::uint32_t i = 0; i < slots(); ++i)
    if (present(i)) mark_near_wall(i, container);
}

void Packing::add_neighbour(std::uint32_t i, std::uint32_t j) {
  if (list_size_[i] == list_capacity_) lengthen_lists();
  neighbours_[i * list_capacity_ + list_size_[i]++] = j;
}

void Packing::lengthen_lists() {
  const std::size_t capacity = 2 * list_capacity_;
  if (capacity > std::numeric_limits<std::uint16_t>::max())
    throw InvalidPacking(message("a grain has more than ", list_capacity_, " neighbours: the packing has collapsed"));
  std::vector<std::uint32_t> lists(slots() * capacity);
  for (std::size_t i = 0; i < slots(); ++i)
    std::copy_n(neighbours_.begin() + static_cast<std::ptrdiff_t>(i * list_capacity_), list_size_[i],
                lists.begin() + static_cast<std::ptrdiff_t>(i * capacity));
  neighbours_.swap(lists);
  list_capacity_ = capacity;
}

void Packing::find_deeper_overlap(std::uint32_t i, Overlap& overlap) const {
  const auto [first, last] = neighbours(i);
  for (const std::uint32_t* j = first; j != last; ++j) {
    const double squared = distance_squared(i, position(*j)), touching = radii_[i] + radii_[*j];
    if (squared >= touching * touching) continue;
    const double depth = 1.0 - std::sqrt(squared) / touching;
    if (depth > overlap.depth) overlap = {depth, std::min(ids_[i], ids_[*j]), std::max(ids_[i], ids_[*j])};
  }
}

Overlap Packing::largest_overlap() const {
  Overlap largest;
  for (std::uint32_t i = 0; i < slots(); ++i) find_deeper_overlap(i, largest);
  return largest;
}

Overlap Packing::largest_overlap(const std::vector<std::uint32_t>& grains) const {
  Overlap largest;
  for (const std::uint32_t i : grains) find_deeper_overlap(i, largest);
  return largest;
}

std::size_t Packing::memory() const {
  return bytes_in(ids_, x_, y_, z_, radii_, volumes_, reference_x_, reference_y_, reference_z_, held_, near_wall_,
                  cell_, neighbours_, list_size_, drifted_) +
         grid_.memory();
}

}  // namespace spot
