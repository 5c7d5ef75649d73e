// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/geometry/container.hpp"

namespace spot {

/// A regular grid of cells over a box, each holding the indices of the points in it.
///
/// Layout: cell (ix, iy, iz) is number (iz * ny + iy) * nx + ix; its members are the first count[cell] of the
/// `capacity` places from cell * capacity on. The outermost cells also hold what lies beyond the box.
class CellGrid {
 public:
  CellGrid() = default;

  /// An empty grid of cells of the given edge over the box. Throws InvalidPacking for more than 2^30 cells.
  CellGrid(const Vector3& low, const Vector3& high, double edge);

  std::size_t cells() const { return count_.size(); }
  std::uint32_t cell_of(double x, double y, double z) const {
    return static_cast<std::uint32_t>(
        (static_cast<std::size_t>(clamp((z - low_.z()) / edge_, nz_)) * ny_ + clamp((y - low_.y()) / edge_, ny_)) *
            nx_ +
        clamp((x - low_.x()) / edge_, nx_));
  }
  void insert(std::uint32_t cell, std::uint32_t index);
  void erase(std::uint32_t cell, std::uint32_t index);

  /// Calls visit(index) for every member of a cell that reaches into the ball.
  template <typename Visit>
  void visit_near(const Vector3& point, double reach, Visit&& visit) const;

  std::size_t memory() const { return sizeof(std::uint32_t) * members_.capacity() + count_.capacity(); }

 private:
  static int clamp(double cell, int n) { return cell < 0.0 ? 0 : cell >= n ? n - 1 : static_cast<int>(cell); }
  /// Distance along one axis from a place to a cell, in cells; the outermost cells reach to infinity.
  static double gap(double at, int cell, int n) {
    if (at < cell) return cell == 0 ? 0.0 : cell - at;
    if (at > cell + 1) return cell == n - 1 ? 0.0 : at - cell - 1;
    return 0.0;
  }
  void widen();

  Vector3 low_ = Vector3::Zero();
  double edge_ = 1.0;
  int nx_ = 0, ny_ = 0, nz_ = 0;
  std::size_t capacity_ = 4;
  std::vector<std::uint8_t> count_;
  std::vector<std::uint32_t> members_;
};

template <typename Visit>
void CellGrid::visit_near(const Vector3& point, double reach, Visit&& visit) const {
  if (count_.empty()) return;
  const Vector3 p = (point - low_) / edge_;
  const double r = reach / edge_;
  const int z_last = clamp(p.z() + r, nz_), y_last = clamp(p.y() + r, ny_);
  for (int iz = clamp(p.z() - r, nz_); iz <= z_last; ++iz) {
    const double gz = gap(p.z(), iz, nz_);
    for (int iy = clamp(p.y() - r, ny_); iy <= y_last; ++iy) {
      const double gy = gap(p.y(), iy, ny_);
      const double left = r * r - gy * gy - gz * gz;
      if (left < 0.0) continue;
      const double half = std::sqrt(left);
      const std::size_t row = (static_cast<std::size_t>(iz) * ny_ + iy) * nx_;
      const std::size_t last = row + clamp(p.x() + half, nx_);
      for (std::size_t cell = row + clamp(p.x() - half, nx_); cell <= last; ++cell)
        for (std::size_t k = cell * capacity_; k < cell * capacity_ + count_[cell]; ++k) visit(members_[k]);
    }
  }
}

}  // namespace spot
