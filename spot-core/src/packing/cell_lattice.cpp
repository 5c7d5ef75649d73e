// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cell_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Positions in 32 bits reach 128 d at least before they wrap around; overlaps that matter are ten thousand quanta.
constexpr int quantum_bits = 24;

/// Lists cover this shell around the diameter. Thicker means longer lists, thinner means listing anew more often.
constexpr double skin_in_diameters = 0.5;

/// Edges of a cell, as long as lists reach: in a dense packing it holds 3.7 grains, and nine hardly ever.
constexpr std::array<double, 3> edges_in_diameters = {1.5, 1.5, 1.5};

void require_countable(double n, double most, double edge, std::size_t axis) {
  if (n > most)
    throw InvalidPacking(
        message("grains are spread over ", n, " cells of ", edge, " along ", "xyz"[axis], ", which is too many"));
}

}  // namespace

CellLattice::CellLattice(double diameter, double extent, const Periodic& periodic)
    : diameter_(diameter),
      extent_(extent),
      quantum_(diameter, extent, quantum_bits),
      periodic_(periodic.on(quantum_)),
      skin_(skin_in_diameters * diameter) {
  for (std::size_t axis = 0; axis < 3; ++axis) set_edge(axis);
}

/// Along an axis on which space repeats, a whole number of cells, none smaller than elsewhere, takes up the period; the
/// last one has the quanta that are left over.
void CellLattice::set_edge(std::size_t axis) {
  edge_quanta_[axis] = std::llround(edges_in_diameters[axis] * diameter_ / quantum_.length());
  if (periodic_.along(static_cast<int>(axis))) {
    period_[axis] = std::llround(periodic_.length(static_cast<int>(axis)) / quantum_.length());
    n_[axis] = static_cast<int>(std::max<std::int64_t>(1, period_[axis] / edge_quanta_[axis]));
    edge_quanta_[axis] = period_[axis] / n_[axis];
    low_[static_cast<Eigen::Index>(axis)] = periodic_.low(static_cast<int>(axis));
    images_[axis] = 1;
  }
  edge_[axis] = static_cast<double>(edge_quanta_[axis]) * quantum_.length();
  per_edge_[axis] = 1.0 / edge_[axis];
}

void CellLattice::span(const Vector3& low, const Vector3& high) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (images_[a] != 0) continue;
    low_[axis] = quantum_.snap(low[axis]);
    const double n = std::floor((high[axis] - low[axis]) / edge_[a]) + 1.0;
    require_countable(n, std::numeric_limits<std::int32_t>::max(), edge_[a], a);
    n_[a] = static_cast<int>(n);
  }
}

void CellLattice::span(const Vector3& low, const std::array<int, 3>& size) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (images_[axis] != 0 &&
        (size[axis] != n_[axis] || low[static_cast<Eigen::Index>(axis)] != low_[static_cast<Eigen::Index>(axis)]))
      throw InvalidState(message("the saved state does not repeat along ", "xyz"[axis], " as the container does"));
  low_ = low;
  n_ = size;
}

std::array<int, 6> CellLattice::cells_to(const Vector3& place) const {
  std::array<int, 6> cells{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (images_[axis] != 0) continue;
    const double at = (place[static_cast<Eigen::Index>(axis)] - low_[static_cast<Eigen::Index>(axis)]);
    cells[axis] = at < 0.0 ? static_cast<int>(std::ceil(-at * per_edge_[axis])) : 0;
    cells[axis + 3] = std::max(0, static_cast<int>(std::floor(at * per_edge_[axis])) + 1 - n_[axis]);
  }
  return cells;
}

void CellLattice::grow(const std::array<int, 3>& below, const std::array<int, 3>& above) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    require_countable(static_cast<double>(n_[axis]) + below[axis] + above[axis],
                      std::numeric_limits<std::int32_t>::max() / 2, edge_[axis], axis);
    low_[static_cast<Eigen::Index>(axis)] -= below[axis] * edge_[axis];
    n_[axis] += below[axis] + above[axis];
  }
}

Cell CellLattice::cell(std::uint32_t number) const {
  const int i = static_cast<int>(number), layer = held(0) * held(1), in_layer = i % layer;
  return {in_layer % held(0) - images_[0], in_layer / held(0) - images_[1], i / layer + first_layer_};
}

void CellLattice::note_listed(const Vector3& from_low) {
  const Vector3 size(n_[0] * edge_[0], n_[1] * edge_[1], n_[2] * edge_[2]);
  beyond_[0] = beyond_[0].cwiseMax(-from_low);
  beyond_[1] = beyond_[1].cwiseMax(from_low - size);
}

std::pair<Vector3, Vector3> CellLattice::corners(const Cell& cell) const {
  const std::array<int, 3> at = {cell.x, cell.y, cell.z};
  Vector3 low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    low[k] = low_[k] + at[axis] * edge_[axis] - (at[axis] == 0 ? beyond_[0][k] : 0.0);
    high[k] = low_[k] + (at[axis] + 1) * edge_[axis] + (at[axis] == n_[axis] - 1 ? beyond_[1][k] : 0.0);
  }
  return {low, high};
}

std::array<std::int64_t, 3> CellLattice::quanta(const Vector3& from_low) const {
  const double per_quantum = 1.0 / quantum_.length();  // a power of two
  return {std::llrint(from_low.x() * per_quantum), std::llrint(from_low.y() * per_quantum),
          std::llrint(from_low.z() * per_quantum)};
}

Point CellLattice::wrapped(const Vector3& from_low) const {
  const auto q = quanta(from_low);
  return {wrap(q[0]), wrap(q[1]), wrap(q[2]), Point::free};
}

Vector3 CellLattice::from_low(const Point& point, const Cell& at) const {
  const std::int64_t x = at.x * edge_quanta_[0], y = at.y * edge_quanta_[1], z = at.z * edge_quanta_[2];
  return quantum_.length() * Vector3(static_cast<double>(x + minus(point.x, wrap(x))),
                                     static_cast<double>(y + minus(point.y, wrap(y))),
                                     static_cast<double>(z + minus(point.z, wrap(z))));
}

Point CellLattice::wrapped_cells(const std::array<int, 3>& cells) const {
  return {wrap(cells[0] * edge_quanta_[0]), wrap(cells[1] * edge_quanta_[1]), wrap(cells[2] * edge_quanta_[2]), 0};
}

Point CellLattice::periods(int along_x, int along_y) const {
  return {wrap(along_x * period_[0]), wrap(along_y * period_[1]), 0, 0};
}

Point CellLattice::shift_to(const Cell& image) const {
  const auto side = [](int cell, int n) { return cell < 0 ? -1 : cell >= n ? 1 : 0; };
  return periods(side(image.x, n_[0]), side(image.y, n_[1]));
}

namespace {

/// Along an axis, which cells a place may be in, and how far it is from one. The outermost cells also hold what lies
/// beyond the lattice.
struct OpenAxis {
  double edge, per_edge;
  int n;

  int cell(double from_low) const {
    const double at = from_low * per_edge;
    return at < 0.0 ? 0 : at >= n ? n - 1 : static_cast<int>(at);
  }
  double gap(double from_low, int cell) const {
    const double before = cell == 0 ? 0.0 : cell * edge - from_low;
    const double beyond = cell == n - 1 ? 0.0 : from_low - (cell + 1) * edge;
    return std::max(0.0, std::max(before, beyond));
  }
};

/// The same where space repeats: images stand at the ends, or, where none are asked for, nothing does.
struct RepeatingAxis {
  OpenAxis open;
  double period;
  bool with_images;

  int cell(double from_low) const {
    if (!with_images) return open.cell(from_low);
    return from_low < 0.0 ? -1 : from_low >= period ? open.n : open.cell(from_low);
  }
  double gap(double from_low, int cell) const {
    return std::max(0.0, std::max(end(cell) - from_low, from_low - end(cell + 1)));
  }
  double end(int cell) const {
    if (cell < 0) return (open.n - 1) * open.edge - period;
    return cell < open.n ? cell * open.edge : period + (cell - open.n) * open.edge;
  }
};

}  // namespace

template <typename X, typename Y>
void CellLattice::find_rows(const Vector3& at, double reach, const RowsAsked& asked, const X& along_x, const Y& along_y,
                            std::vector<CellRow>& rows) const {
  const OpenAxis along_z = {edge_[2], per_edge_[2], n_[2]};
  const int z0 = std::max(asked.first_layer, along_z.cell(at.z() - reach));
  const int z1 = std::min(asked.last_layer - 1, along_z.cell(at.z() + reach));
  const int y0 = along_y.cell(at.y() - reach), y1 = along_y.cell(at.y() + reach);
  for (int iz = z0; iz <= z1; ++iz) {
    const double in_layer = square(reach) - square(along_z.gap(at.z(), iz));
    for (int iy = y0; iy <= y1; ++iy) {
      if (!asked.contain(iy, iz)) continue;
      const double in_row = in_layer - square(along_y.gap(at.y(), iy));
      if (in_row < 0.0) continue;
      const double half = std::sqrt(in_row);
      const std::uint32_t row = number_of({0, iy, iz});
      rows.push_back({row + static_cast<std::uint32_t>(along_x.cell(at.x() - half)),
                      row + static_cast<std::uint32_t>(along_x.cell(at.x() + half)) + 1});
    }
  }
}

void CellLattice::find_rows(const Vector3& from_low, double reach, const RowsAsked& asked,
                            std::vector<CellRow>& rows) const {
  const OpenAxis x = {edge_[0], per_edge_[0], n_[0]}, y = {edge_[1], per_edge_[1], n_[1]};
  const RepeatingAxis around_x = {x, periodic_.length(0), asked.with_images},
                      around_y = {y, periodic_.length(1), asked.with_images};
  if (images_[0] == 0 && images_[1] == 0)
    find_rows(from_low, reach, asked, x, y, rows);
  else if (images_[0] == 0)
    find_rows(from_low, reach, asked, x, around_y, rows);
  else if (images_[1] == 0)
    find_rows(from_low, reach, asked, around_x, y, rows);
  else
    find_rows(from_low, reach, asked, around_x, around_y, rows);
}

}  // namespace spot
