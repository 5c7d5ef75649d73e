// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/ghost_layers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <mutex>

#include "general_scene.hpp"
#include "packing/kernel_builds.hpp"
#include "packing/wrapped_integers.hpp"
#include "ranks_of_threads.hpp"
#include "scenes.hpp"

namespace {

using spot::Cells;
using spot::Grain;
using spot::Point;
using spot::Vector3;

const Vector3 low(-6.0, -5.0, 0.0), high(6.0, 5.0, 14.0);

/// The cells of one rank, with its part of some grains.
struct Rank {
  std::shared_ptr<const spot::Container> silo;
  Cells cells;
  spot::WallMarks walls{cells};
  spot::NeighbourLists lists{cells, walls, spot::kernels::best()};
  spot::GhostLayers ghosts;

  Rank(std::shared_ptr<const spot::Container> container, std::shared_ptr<spot::Communicator> communicator)
      : silo(std::move(container)), cells(lattice(*silo)), ghosts(cells, lists, communicator) {
    const int layers = cells.lattice().layers();
    cells.hold(spot::Slabs(std::vector<std::int64_t>(static_cast<std::size_t>(layers), 1), communicator->size()),
               communicator->rank());
    walls.find_planes(*silo);
    for (const Grain& grain : scenes::unequal_grains(400, low, high, silo->periodic(), 5)) {
      const Vector3 at = grain.position - cells.lattice().low();
      const spot::Cell cell = cells.lattice().cell_at(at);
      if (cells.slabs().owner(cell.z) != communicator->rank()) continue;
      const std::uint32_t slot = cells.slot(cells.ensure_room(cells.lattice().number_of(cell)));
      cells.occupy(slot, grain.id, cells.lattice().wrapped(at), cells.lattice().wrapped(at), 0.5);
    }
    cells.visit_own([&](std::uint32_t slot) { lists.list(slot, *silo); });
  }

  static spot::CellLattice lattice(const spot::Container& silo) {
    spot::CellLattice lattice(1.0, 100.0, silo.periodic());
    lattice.span(low, high);
    return lattice;
  }
};

using Places = std::map<std::int64_t, std::array<std::int32_t, 3>>;

void note(const Cells& cells, std::uint32_t slot, Places& places) {
  const Point& point = cells.points[slot];
  places[cells.ids[slot]] = {point.x, point.y, point.z};
}

/// What ranks hold copies of is where its owner has it, after lists and after positions were sent.
TEST(GhostLayersBruteForce, CopiesAreWhatTheirOwnersHave) {
  constexpr int ranks = 3;
  std::array<Places, ranks> own, copied;
  std::array<std::size_t, ranks> lost{};
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    Rank rank(scenes::repeated_silo(low, high, false, false, {{0, 0, 0}, 2.0}, {0.5, 0.5}), communicator);
    const auto me = static_cast<std::size_t>(communicator->rank());
    rank.ghosts.send_positions();
    rank.ghosts.exchange(*rank.silo);
    rank.cells.visit_own([&](std::uint32_t slot) { rank.cells.points[slot].x += 1000 + static_cast<int>(me); });
    rank.ghosts.send_no_positions();
    rank.ghosts.exchange(*rank.silo);
    Places before;
    rank.cells.visit_ghosts([&](std::uint32_t slot) { note(rank.cells, slot, before); });
    rank.ghosts.send_positions();
    rank.ghosts.exchange(*rank.silo);
    rank.cells.visit_own([&](std::uint32_t slot) { note(rank.cells, slot, own[me]); });
    rank.cells.visit_ghosts([&](std::uint32_t slot) { note(rank.cells, slot, copied[me]); });
    for (const auto& [id, place] : before) lost[me] += copied[me].at(id) == place ? 1 : 0;
  });
  for (std::size_t me = 0; me < ranks; ++me) {
    EXPECT_GT(copied[me].size(), 20u);
    EXPECT_EQ(lost[me], 0u) << "positions that nobody asked for";
    for (const auto& [id, place] : copied[me]) {
      const std::size_t below = me == 0 ? me + 1 : me - 1, above = me == 2 ? me - 1 : me + 1;
      const Places& of = own[below].count(id) > 0 ? own[below] : own[above];
      ASSERT_EQ(of.count(id), 1u) << id;
      EXPECT_EQ(of.at(id), place) << id;
    }
  }
}

/// Where space repeats, a rank is its own neighbour.
TEST(GhostLayersBruteForce, ImagesAreAPeriodAway) {
  Rank rank(scenes::repeated_silo(low, high, true, true, {{0, 0, 0}, 2.0}, {0.5, 0.5}),
            std::make_shared<spot::Alone>());
  rank.ghosts.send_positions();
  rank.ghosts.exchange(*rank.silo);
  rank.cells.visit_own([&](std::uint32_t slot) { rank.cells.points[slot].y += 77; });
  rank.ghosts.exchange(*rank.silo);
  Places own;
  rank.cells.visit_own([&](std::uint32_t slot) { note(rank.cells, slot, own); });
  std::size_t images = 0, corners = 0;
  rank.cells.visit_ghosts([&](std::uint32_t slot) {
    const spot::Cell cell = rank.cells.lattice().cell(rank.cells.cell_of(slot));
    const Point by = rank.cells.lattice().shift_to(cell), &point = rank.cells.points[slot];
    const auto& source = own.at(rank.cells.ids[slot]);
    EXPECT_EQ(point.x, spot::add(source[0], by.x));
    EXPECT_EQ(point.y, spot::add(source[1], by.y));
    EXPECT_EQ(point.z, source[2]);
    ++images;
    corners += by.x != 0 && by.y != 0 ? 1 : 0;
  });
  EXPECT_GT(images, 100u);
  EXPECT_GT(corners, 5u);
}

}  // namespace
