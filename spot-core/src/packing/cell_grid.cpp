// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cell_grid.hpp"

#include <algorithm>

#include "spot/base/errors.hpp"

namespace spot {

CellGrid::CellGrid(const Vector3& low, const Vector3& high, double edge) : low_(low), edge_(edge) {
  const Vector3 cells = (high - low) / edge + Vector3::Ones();
  constexpr double most = 1 << 30;
  if (!(cells.prod() <= most))
    throw InvalidPacking(
        message("grains are spread over ", cells.prod(), " cells of ", edge, "; at most ", most, " are allowed"));
  nx_ = static_cast<int>(cells.x());
  ny_ = static_cast<int>(cells.y());
  nz_ = static_cast<int>(cells.z());
  count_.assign(static_cast<std::size_t>(nx_) * ny_ * nz_, 0);
  members_.resize(count_.size() * capacity_);
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
        message("more than ", capacity_, " grains lie in one cell of edge ", edge_, ": the packing has collapsed"));
  std::vector<std::uint32_t> members(count_.size() * capacity);
  for (std::size_t cell = 0; cell < count_.size(); ++cell)
    std::copy_n(members_.begin() + static_cast<std::ptrdiff_t>(cell * capacity_), count_[cell],
                members.begin() + static_cast<std::ptrdiff_t>(cell * capacity));
  members_.swap(members);
  capacity_ = capacity;
}

}  // namespace spot
