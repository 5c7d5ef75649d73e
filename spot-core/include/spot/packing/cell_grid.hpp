// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/periodic.hpp"

namespace spot {

/// A regular grid of cells over a box, each holding the indices of the points in it.
///
/// Layout: cell (ix, iy, iz) is number (iz * ny + iy) * nx + ix; its members are the first count[cell] of the
/// `capacity` places from cell * capacity on. The outermost cells also hold what lies beyond the box, and along axes on
/// which space repeats the first cell comes after the last.
class CellGrid {
 public:
  CellGrid() = default;

  /// An empty grid of cells of the given edge over the box. Along axes on which space repeats it is over the cell of
  /// that instead, in cells of the least edge from the given one on that fits. Throws InvalidPacking for more than 2^30
  /// cells.
  CellGrid(const Vector3& low, const Vector3& high, double edge, const Periodic& periodic = {});

  std::size_t cells() const { return count_.size(); }
  std::uint32_t cell_of(double x, double y, double z) const {
    return static_cast<std::uint32_t>((static_cast<std::size_t>(z_.clamp(z_.at(z))) * y_.size() + y_.clamp(y_.at(y))) *
                                          x_.size() +
                                      x_.clamp(x_.at(x)));
  }
  void insert(std::uint32_t cell, std::uint32_t index);
  void erase(std::uint32_t cell, std::uint32_t index);

  /// Calls visit(index), once, for every member of a cell that reaches into the ball or, where space repeats, into an
  /// image of it.
  template <typename Visit>
  void visit_near(const Vector3& point, double reach, Visit&& visit) const;

  std::size_t memory() const { return sizeof(std::uint32_t) * members_.capacity() + count_.capacity(); }

 private:
  /// Cells along an axis, first to last; where space repeats, counted on beyond the ends.
  struct Span {
    int first, last;
    bool around = false;  ///< all of them, for the ball and its images reach around
  };

  struct Axis {
    double low = 0.0, edge = 1.0;
    int n = 0;
    bool periodic = false;

    std::size_t size() const { return static_cast<std::size_t>(n); }
    double at(double coordinate) const { return (coordinate - low) / edge; }
    int clamp(double cell) const { return cell < 0.0 ? 0 : cell >= n ? n - 1 : static_cast<int>(cell); }
    Span span(double at, double reach) const {
      return periodic ? span_around(at, reach) : Span{clamp(at - reach), clamp(at + reach)};
    }
    Span span_around(double at, double reach) const;
    /// The number of a cell of a span.
    std::size_t number(int cell) const {
      if (!periodic || (cell >= 0 && cell < n)) return static_cast<std::size_t>(cell);
      const int rest = cell % n;
      return static_cast<std::size_t>(rest < 0 ? rest + n : rest);
    }
    /// Distance from a place to a cell, in cells; the outermost cells reach to infinity if nothing repeats.
    double gap(double at, int cell, const Span& span) const {
      if (span.around) return 0.0;
      if (at < cell) return cell == 0 && !periodic ? 0.0 : cell - at;
      if (at > cell + 1) return cell == n - 1 && !periodic ? 0.0 : at - cell - 1;
      return 0.0;
    }
  };

  template <typename Visit>
  void visit_cells(std::size_t first, std::size_t last, Visit&& visit) const {
    for (std::size_t cell = first; cell <= last; ++cell)
      for (std::size_t k = cell * capacity_; k < cell * capacity_ + count_[cell]; ++k) visit(members_[k]);
  }
  void widen();

  Axis x_, y_, z_;
  std::size_t capacity_ = 4;
  std::vector<std::uint8_t> count_;
  std::vector<std::uint32_t> members_;
};

template <typename Visit>
void CellGrid::visit_near(const Vector3& point, double reach, Visit&& visit) const {
  if (count_.empty()) return;
  const double px = x_.at(point.x()), py = y_.at(point.y()), pz = z_.at(point.z());
  // Gaps in edges along x, whichever axis they are along.
  const double r = reach / x_.edge, per_y = y_.edge / x_.edge, per_z = z_.edge / x_.edge;
  const Span zs = z_.span(pz, reach / z_.edge), ys = y_.span(py, reach / y_.edge);
  for (int iz = zs.first; iz <= zs.last; ++iz) {
    const double gz = per_z * z_.gap(pz, iz, zs);
    for (int iy = ys.first; iy <= ys.last; ++iy) {
      const double gy = per_y * y_.gap(py, iy, ys);
      const double left = r * r - gy * gy - gz * gz;
      if (left < 0.0) continue;
      const std::size_t row = (z_.number(iz) * y_.size() + y_.number(iy)) * x_.size();
      const Span xs = x_.span(px, std::sqrt(left));
      const std::size_t first = x_.number(xs.first), last = x_.number(xs.last);
      if (first <= last) {
        visit_cells(row + first, row + last, visit);
      } else {
        visit_cells(row + first, row + x_.size() - 1, visit);
        visit_cells(row, row + last, visit);
      }
    }
  }
}

}  // namespace spot
