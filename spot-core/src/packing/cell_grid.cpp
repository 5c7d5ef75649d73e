// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cell_grid.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

CellGrid::CellGrid(const Vector3& low, const Vector3& high, double edge, const Periodic& periodic) {
  Vector3 cells = (high - low) / edge + Vector3::Ones();
  for (int axis = 0; axis < 2; ++axis)
    if (periodic.along(axis)) cells[axis] = std::max(1.0, periodic.length(axis) / edge);
  constexpr double most = 1 << 30;
  if (!(cells.prod() <= most))
    throw InvalidPacking(
        message("grains are spread over ", cells.prod(), " cells of ", edge, "; at most ", most, " are allowed"));
  const auto divide = [&](int axis) {
    const int n = static_cast<int>(cells[axis]);
    return periodic.along(axis) ? Axis{periodic.low(axis), periodic.length(axis) / n, n, true}
                                : Axis{low[axis], edge, n, false};
  };
  x_ = divide(0);
  y_ = divide(1);
  z_ = divide(2);
  count_.assign(x_.size() * y_.size() * z_.size(), 0);
  members_.resize(count_.size() * capacity_);
}

CellGrid::Span CellGrid::Axis::span_around(double at, double reach) const {
  const double first = std::floor(at - reach), last = std::floor(at + reach);
  if (last - first >= n) return {0, n - 1, true};
  return {static_cast<int>(first), static_cast<int>(last)};
}

void CellGrid::insert(std::uint32_t cell, std::uint32_t index) {
  if (count_[cell] == capacity_) widen();
  members_[cell * capacity_ + count_[cell]++] = index;
}

void CellGrid::erase(std::uint32_t cell, std::uint32_t index) {
  const auto first = members_.begin() + static_cast<std::ptrdiff_t>(cell * capacity_);
  const auto last = first + count_[cell];
  *std::find(first, last, index) = *(last - 1);
  --count_[cell];
}

void CellGrid::widen() {
  const std::size_t capacity = 2 * capacity_;
  if (capacity > 255)
    throw InvalidPacking(
        message("more than ", capacity_, " grains lie in one cell of edge ", z_.edge, ": the packing has collapsed"));
  std::vector<std::uint32_t> members(count_.size() * capacity);
  for (std::size_t cell = 0; cell < count_.size(); ++cell)
    std::copy_n(members_.begin() + static_cast<std::ptrdiff_t>(cell * capacity_), count_[cell],
                members.begin() + static_cast<std::ptrdiff_t>(cell * capacity));
  members_.swap(members);
  capacity_ = capacity;
}

}  // namespace spot
