// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cell_lattice.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "scenes.hpp"

namespace {

using spot::Cell;
using spot::CellLattice;
using spot::Interval;
using spot::Periodic;
using spot::Vector3;

const Vector3 low(-7.0, -5.0, 0.0), high(7.0, 5.0, 12.0);

CellLattice lattice(const Periodic& periodic = {}) {
  CellLattice lattice(1.0, 100.0, periodic);
  lattice.span(low, high);
  lattice.hold(1, lattice.layers() - 1);
  return lattice;
}

const Periodic none, along_x(Interval{-7.0, 7.0}, {}), along_both(Interval{-7.0, 7.0}, Interval{-5.0, 5.0});

TEST(CellLatticeUnit, NumbersAndCellsAreOfEachOther) {
  for (const Periodic& periodic : {none, along_x, along_both}) {
    const CellLattice of = lattice(periodic);
    for (std::uint32_t number = 0; number < of.cells_held(); ++number) {
      const Cell cell = of.cell(number);
      EXPECT_EQ(of.number_of(cell), number);
      EXPECT_EQ(of.is_image(cell), of.is_image({cell.x, 0, cell.z}) || of.is_image({0, cell.y, cell.z}));
      if (of.is_image(cell)) {
        EXPECT_FALSE(of.is_image(of.source_of(cell)));
        continue;
      }
      const Cell back = of.cell_in_all(of.number_in_all(cell));
      EXPECT_TRUE(back.x == cell.x && back.y == cell.y && back.z == cell.z);
    }
  }
}

/// Coordinates wrap around; the cell tells which turn is meant.
TEST(CellLatticeUnit, PlacesComeBackToTheQuantum) {
  CellLattice wide(1.0, 1000.0);
  wide.span(Vector3::Constant(-500.0), Vector3::Constant(500.0));
  wide.hold(0, wide.layers());
  scenes::Draws draws(1);
  for (int k = 0; k < 1000; ++k) {
    Vector3 place = draws.in_box(Vector3::Constant(-500.0), Vector3::Constant(500.0));
    for (double& at : place) at = wide.quantum().snap(at);
    const Vector3 at = place - wide.low();
    EXPECT_EQ(wide.low() + wide.from_low(wide.wrapped(at), wide.cell_at(at)), place);
  }
}

/// Every place within reach is in one of the rows, and every cell of a row has a place within reach; places are drawn
/// in all images that are held, or in the period.
TEST(CellLatticeBruteForce, RowsAreTheCellsWithinReach) {
  scenes::Draws draws(2);
  for (const Periodic& periodic : {none, along_x, along_both})
    for (const bool with_images : {false, true}) {
      const CellLattice of = lattice(periodic);
      const double margin = with_images ? of.edge()[0] : 0.0;
      for (int k = 0; k < 30; ++k) {
        const Vector3 centre = draws.in_box(low, high) - of.low();
        const double reach = draws.uniform(0.5, 4.0);
        std::vector<spot::CellRow> rows;
        of.find_rows(centre, reach, {of.first_layer(), of.last_layer(), with_images}, rows);
        std::set<std::uint32_t> found;
        for (const auto& row : rows)
          for (std::uint32_t cell = row.first; cell < row.last; ++cell) EXPECT_TRUE(found.insert(cell).second);
        for (int l = 0; l < 300; ++l) {
          const Vector3 at = centre + draws.in_box(Vector3::Constant(-reach), Vector3::Constant(reach));
          if ((at - centre).norm() > reach) continue;
          Cell cell = of.cell_at(at);
          bool held = cell.z >= of.first_layer() && cell.z < of.last_layer();
          for (int axis = 0; axis < 2; ++axis) {
            if (!periodic.along(axis)) continue;
            held = held && at[axis] >= -margin && at[axis] < periodic.length(axis) + margin;
            int& index = axis == 0 ? cell.x : cell.y;
            if (at[axis] < 0.0) index = -1;
            if (at[axis] >= periodic.length(axis)) index = of.size()[static_cast<std::size_t>(axis)];
          }
          if (!held) continue;
          EXPECT_EQ(found.count(of.number_of(cell)), 1u);
        }
      }
    }
}

TEST(CellLatticeBruteForce, PartsHaveEachRowOnceAndNeighboursInOthers) {
  scenes::Draws draws(3);
  for (const Periodic& periodic : {none, along_both})
    for (const int parts : {2, 3}) {
      const CellLattice of = lattice(periodic);
      const Vector3 centre = draws.in_box(low, high) - of.low();
      std::vector<spot::CellRow> all;
      of.find_rows(centre, 3.0, {of.first_layer(), of.last_layer(), true}, all);
      std::map<std::uint32_t, int> part_of;
      for (int part = 0; part < parts; ++part) {
        std::vector<spot::CellRow> rows;
        of.find_rows(centre, 3.0, {of.first_layer(), of.last_layer(), true, part, parts}, rows);
        for (const auto& row : rows) EXPECT_TRUE(part_of.emplace(row.first / of.cells_in_row(), part).second);
      }
      EXPECT_EQ(part_of.size(), all.size());
      const std::uint32_t in_layer = of.cells_in_layer() / of.cells_in_row();
      for (const auto& [row, part] : part_of) {
        const auto beside = part_of.find(row + 1), above = part_of.find(row + in_layer);
        if (beside != part_of.end() && (row + 1) % in_layer != 0) {
          EXPECT_NE(beside->second, part);
        }
        if (above != part_of.end()) {
          EXPECT_NE(above->second, part);
        }
      }
    }
}

TEST(CellLatticeUnit, GrowsByWholeCells) {
  CellLattice of = lattice();
  const Vector3 far(9.0, -11.0, 30.0);
  const auto missing = of.cells_to(far);
  EXPECT_GT(missing[1], 0);
  EXPECT_GT(missing[3], 0);
  EXPECT_GT(missing[5], 0);
  EXPECT_EQ(missing[0] + missing[2] + missing[4], 0);
  const Vector3 corner = of.low();
  of.grow({missing[0], missing[1], missing[2]}, {missing[3], missing[4], missing[5]});
  EXPECT_EQ(of.low().y(), corner.y() - missing[1] * of.edge()[1]);
  for (const int cells : of.cells_to(far)) EXPECT_EQ(cells, 0);
}

/// Inside the lattice, and far beyond it on all sides.
TEST(CellLatticeBruteForce, GrainsAreBetweenTheCornersOfTheCellInWhichTheyAreListed) {
  for (const Periodic& periodic : {none, along_x, along_both}) {
    CellLattice of = lattice(periodic);
    scenes::Draws draws(3);
    const Vector3 middle = 0.5 * (low + high);
    for (const double scale : {1.0, 1.3, 4.0})
      for (int k = 0; k < 1000; ++k) {
        const Vector3 place = periodic.wrap(Vector3(middle + scale * (draws.in_box(low, high) - middle)));
        of.note_listed(place - of.low());
        const auto [lowest, highest] = of.corners(of.cell_at(place - of.low()));
        EXPECT_TRUE((place.array() >= lowest.array() - 1e-9).all() && (place.array() <= highest.array() + 1e-9).all())
            << place.transpose();
        const double largest = (highest - lowest).maxCoeff();
        EXPECT_LT(largest, scale == 1.0 ? 3.0 : 40.0);
      }
  }
}

TEST(CellLatticeUnit, RefusesTooManyCells) {
  CellLattice of(1.0, 1e9);
  EXPECT_THROW(of.span(Vector3::Constant(-5e9), Vector3::Constant(5e9)), spot::InvalidPacking);
  CellLattice repeated = lattice(along_x);
  EXPECT_THROW(repeated.span(low, std::array<int, 3>{3, 3, 3}), spot::InvalidState);
}

}  // namespace
