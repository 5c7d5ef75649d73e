// SPDX-License-Identifier: GPL-2.0-or-later
// Lists of neighbours and marks of walls, by themselves.
#include "spot/packing/neighbour_lists.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "packing/kernel_builds.hpp"
#include "packing/wrapped_integers.hpp"
#include "scenes.hpp"

namespace {

using spot::Cells;
using spot::Point;
using spot::Vector3;

struct Listed {
  std::shared_ptr<const spot::Container> silo = scenes::small_silo(6.0, 4.0);
  Cells cells;
  spot::WallMarks walls{cells};
  spot::NeighbourLists lists{cells, walls, spot::kernels::best()};

  explicit Listed(const std::vector<spot::Grain>& grains) : cells(lattice()) {
    cells.hold(spot::Slabs(std::vector<std::int64_t>(static_cast<std::size_t>(cells.lattice().layers()), 1), 1), 0);
    walls.find_planes(*silo);
    for (const spot::Grain& grain : grains) put(grain.id, grain.position);
    cells.visit_own([&](std::uint32_t slot) { lists.list(slot, *silo); });
  }

  static spot::CellLattice lattice() {
    spot::CellLattice lattice(1.0, 100.0);
    lattice.span(Vector3(-6, -4, 0), Vector3(6, 4, 10));
    return lattice;
  }

  std::uint32_t put(std::int64_t id, const Vector3& place) {
    const Vector3 at = place - cells.lattice().low();
    const auto room = cells.ensure_room(cells.lattice().number_of(cells.lattice().cell_at(at)));
    cells.occupy(cells.slot(room), id, cells.lattice().wrapped(at), cells.lattice().wrapped(at), 0.5);
    return cells.slot(room);
  }

  std::uint32_t slot_of(std::int64_t id) const {
    return static_cast<std::uint32_t>(std::find(cells.ids.begin(), cells.ids.end(), id) - cells.ids.begin());
  }

  /// Against all pairs of references.
  void expect_right() const {
    std::size_t pairs = 0;
    cells.visit_own([&](std::uint32_t i) {
      std::multiset<std::int64_t> found, expected;
      for (const std::uint32_t j : lists.of(i)) found.insert(cells.ids[j]);
      cells.visit_own([&](std::uint32_t j) {
        const double apart = std::sqrt(spot::squared_distance(cells.references[i], cells.references[j]));
        if (i != j && apart * cells.lattice().quantum().length() <= 1.5) expected.insert(cells.ids[j]);
      });
      EXPECT_EQ(found, expected) << cells.ids[i];
      pairs += found.size();
    });
    EXPECT_GT(pairs, 100u);
  }
};

TEST(NeighbourListsBruteForce, AreThePairsWithReferencesWithinReach) {
  const auto grains = scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.01, 7);
  Listed listed(grains);
  listed.expect_right();
  // Many come to one place: lists and cells outgrow their rooms.
  scenes::Draws draws(3);
  for (std::int64_t id = 100000; id < 100060; ++id)
    listed.lists.list(listed.put(id, draws.in_box({0.0, 0.0, 4.0}, {1.5, 1.5, 5.5})), *listed.silo);
  listed.expect_right();
  for (std::size_t k = 0; k < grains.size(); k += 3) {
    const std::uint32_t slot = listed.slot_of(grains[k].id);
    listed.lists.unlist(slot);
    listed.cells.vacate(slot);
  }
  listed.expect_right();
}

TEST(NeighbourListsUnit, AListGoesAlongWithItsGrain) {
  Listed listed(scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.01, 7));
  const std::int64_t id = listed.cells.ids[listed.lists.of(listed.cells.first_slot(40)).first[0]];
  const std::uint32_t from = listed.slot_of(id),
                      to = listed.cells.slot(listed.cells.ensure_room(listed.cells.cell_of(from)));
  const std::uint32_t old = listed.slot_of(id);
  listed.cells.occupy(to, id, listed.cells.points[old], listed.cells.references[old], 0.5);
  listed.lists.rename(old, to);
  listed.cells.vacate(old);
  listed.expect_right();
}

TEST(NeighbourListsUnit, MoreThan128NeighboursAreACollapse) {
  Listed listed({});
  scenes::Draws draws(4);
  EXPECT_THROW(
      {
        for (std::int64_t id = 0; id < 200; ++id)
          listed.lists.list(listed.put(id, draws.in_box({0.1, 0.1, 4.1}, {0.2, 0.2, 4.2})), *listed.silo);
      },
      spot::InvalidPacking);
}

TEST(WallMarksUnit, SayWhoIsNearAWallAndWhereItPushes) {
  Listed listed({{1, {5.8, 0.0, 5.0}}, {2, {0.0, 0.0, 5.0}}, {3, {-5.2, -3.9, 5.0}}});
  const auto mark = [&](std::int64_t id) { return listed.walls.near_wall(listed.slot_of(id)); };
  EXPECT_TRUE(mark(1));
  EXPECT_FALSE(mark(2));
  EXPECT_TRUE(mark(3));
  const double quanta = 1.0 / listed.cells.lattice().quantum().length();
  Point push{};
  listed.walls.push_off_planes(listed.slot_of(1), 0.5f, push);
  EXPECT_NEAR(push.x, -0.5 * 0.3 * quanta, 2.0);
  EXPECT_EQ(push.y, 0);
  push = {};
  listed.walls.push_off_planes(listed.slot_of(3), 1.0f, push);
  EXPECT_EQ(push.x, 0) << "near, but not in the wall";
  EXPECT_NEAR(push.y, 0.4 * quanta, 2.0);
}

}  // namespace
