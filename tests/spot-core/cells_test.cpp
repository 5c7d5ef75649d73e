// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/cells.hpp"

#include <gtest/gtest.h>

#include <map>

#include "scenes.hpp"

namespace {

using spot::Cells;
using spot::Place;
using spot::Point;
using spot::Vector3;

/// What is kept for a slot: the id of its grain.
class Ids : public spot::SlotData {
 public:
  std::vector<std::int64_t> of_slot;
  void renumber(const std::vector<std::uint32_t>& now, std::size_t slots) override {
    const auto old = of_slot;
    of_slot.assign(slots, -1);
    for (std::size_t slot = 0; slot < now.size(); ++slot) of_slot[now[slot]] = old[slot];
  }
};

std::unique_ptr<Cells> cells_of(int layers, int ranks, int rank) {
  spot::CellLattice lattice(1.0, 100.0);
  lattice.span(Vector3::Zero(), Vector3(4.0, 4.0, 1.5 * layers - 0.1));
  auto cells = std::make_unique<Cells>(lattice);
  cells->hold(spot::Slabs(std::vector<std::int64_t>(static_cast<std::size_t>(layers), 1), ranks), rank);
  return cells;
}

/// Many more grains in one cell than it had room for; slots change, and all that is kept of them follows.
TEST(CellsUnit, CellsGetAsMuchRoomAsTheyNeed) {
  const auto cells = cells_of(3, 1, 0);
  cells->allow_unequal();
  Ids ids;
  cells->attach(ids);
  ids.of_slot.assign(cells->slots(), -1);
  scenes::Draws draws(1);
  std::map<std::int64_t, std::pair<std::uint32_t, double>> expected;  // cell and radius
  const std::uint32_t before = cells->slots();
  for (std::int64_t id = 0; id < 200; ++id) {
    const auto cell = id % 3 == 0 ? 5u : static_cast<std::uint32_t>(draws.below(cells->count()));
    const std::uint32_t slot = cells->slot(cells->ensure_room(cell));
    const double radius = draws.uniform(0.25, 0.5);
    cells->occupy(slot, id, {static_cast<std::int32_t>(id), 0, 0, Point::free}, {0, 0, 0, Point::free}, radius);
    ids.of_slot[slot] = id;
    expected[id] = {cell, radius};
  }
  EXPECT_GT(cells->end_slot(5) - cells->first_slot(5), 66u);
  EXPECT_LT(cells->slots(), before + 66u + 8u * cells->count());
  std::size_t seen = 0;
  cells->visit_own([&](std::uint32_t slot) {
    const std::int64_t id = cells->ids[slot];
    EXPECT_EQ(ids.of_slot[slot], id);
    EXPECT_EQ(cells->points[slot].x, id);
    EXPECT_EQ(cells->cell_of(slot), expected[id].first);
    EXPECT_EQ(cells->radius(slot), expected[id].second);
    EXPECT_EQ(cells->slot(cells->place_of(slot)), slot);
    ++seen;
  });
  EXPECT_EQ(seen, 200u);
  EXPECT_EQ(cells->size(), 200u);
}

TEST(CellsUnit, RanksOwnTheirLayersAndHoldTheOnesNextToThem) {
  for (int rank = 0; rank < 3; ++rank) {
    const auto cells = cells_of(7, 3, rank);
    EXPECT_EQ(cells->has_ghosts(spot::below), rank > 0);
    EXPECT_EQ(cells->has_ghosts(spot::above), rank < 2);
    EXPECT_EQ(cells->lattice().first_layer(), cells->first_own_layer() - (rank > 0 ? 1 : 0));
    for (std::uint32_t cell = 0; cell < cells->count(); ++cell)
      EXPECT_EQ(cells->own(cell), cells->slabs().owner(cells->lattice().cell(cell).z) == rank);
  }
}

TEST(CellsUnit, NotesWhatNeighboursHaveCopiesOf) {
  const auto cells = cells_of(7, 3, 1);
  const std::uint32_t border = cells->first_of_border(spot::above), ghost = cells->first_of_ghosts(spot::above);
  for (const std::uint32_t cell : {border, ghost}) {
    const std::uint32_t slot = cells->slot(cells->ensure_room(cell));
    cells->occupy(slot, cell, {0, 0, 0, Point::free}, {0, 0, 0, Point::free}, 0.5);
  }
  const auto changed = cells->take_changes(spot::above);
  ASSERT_EQ(changed.size(), 1u) << "ghosts are others'";
  EXPECT_EQ(changed[0].cell, border);
  EXPECT_TRUE(cells->take_changes(spot::above).empty()) << "once";
  EXPECT_EQ(cells->size(), 1u);
  cells->vacate(cells->slot(changed[0]));
  EXPECT_EQ(cells->take_changes(spot::above).size(), 1u);
  EXPECT_EQ(cells->size(), 0u);
}

}  // namespace
