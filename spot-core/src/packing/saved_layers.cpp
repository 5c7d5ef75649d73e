// SPDX-License-Identifier: GPL-2.0-or-later
#include "packing/saved_layers.hpp"

#include <algorithm>

#include "spot/base/errors.hpp"

namespace spot {

void append_layers(Bytes& bytes, const Cells& cells, int first, int last) {
  const CellLattice& lattice = cells.lattice();
  SavedLayers saved;
  for (std::uint32_t cell = cells.lattice().first_cell_of(first); cell < cells.lattice().first_cell_of(last); ++cell) {
    if (cells.is_image(cell)) continue;
    const std::int64_t number = lattice.number_in_all(lattice.cell(cell));
    if (cells.unrelaxed[cell] != 0 || cells.drift[cell] != 0)
      saved.cells.push_back({number, cells.unrelaxed[cell], cells.drift[cell]});
    cells.visit(cell, cell + 1, [&](std::uint32_t slot) {
      saved.grains.push_back({cells.ids[slot], number, cells.points[slot], cells.references[slot],
                              cells.corrections[slot], cells.radius(slot)});
    });
  }
  append(bytes, saved.grains);
  append(bytes, saved.cells);
}

void SavedLayers::take(ByteReader& reader, const CellLattice& lattice) {
  const std::int64_t all_cells = static_cast<std::int64_t>(lattice.size()[0]) * lattice.size()[1] * lattice.layers();
  const auto take = [&](auto& all, const auto& part) {
    for (const auto& one : part) {
      if (one.cell < 0 || one.cell >= all_cells)
        throw InvalidState(message("the saved state has cell ", one.cell, " of ", all_cells));
      all.push_back(one);
    }
  };
  take(grains, reader.take_all<SavedGrain>());
  for (const SavedGrain& grain : grains)
    if (grain.id < 0) throw InvalidState(message("the saved state has grain id ", grain.id, ", which is negative"));
  for (const SavedGrain& grain : grains)
    if (!(grain.radius >= 0.25 * lattice.diameter() && grain.radius <= 0.5 * lattice.diameter()))
      throw InvalidState(message("the saved state has grain ", grain.id, " of radius ", grain.radius));
  take(cells, reader.take_all<SavedCell>());
}

bool SavedLayers::unequal(double diameter) const {
  return std::any_of(grains.begin(), grains.end(),
                     [&](const SavedGrain& grain) { return grain.radius != 0.5 * diameter; });
}

void SavedLayers::fill(Cells& into) const {
  const CellLattice& lattice = into.lattice();
  const auto is_own = [&](std::int64_t cell) { return into.slabs().owner(lattice.cell_in_all(cell).z) == into.rank(); };
  const auto held = [&](std::int64_t cell) { return lattice.number_of(lattice.cell_in_all(cell)); };
  for (const SavedGrain& grain : grains) {
    if (!is_own(grain.cell)) continue;
    const Place place = into.ensure_room(held(grain.cell));
    into.occupy(into.slot(place), grain.id, grain.point, grain.reference, grain.radius);
    into.corrections[into.slot(place)] = grain.correction;
  }
  for (const SavedCell& cell : cells) {
    if (!is_own(cell.cell)) continue;
    into.unrelaxed[held(cell.cell)] = cell.unrelaxed;
    into.drift.set(held(cell.cell), cell.drift);
  }
}

std::vector<std::int64_t> SavedLayers::grains_in_layers(const CellLattice& lattice) const {
  std::vector<std::int64_t> in_layer(static_cast<std::size_t>(lattice.layers()), 0);
  for (const SavedGrain& grain : grains) ++in_layer[static_cast<std::size_t>(lattice.cell_in_all(grain.cell).z)];
  return in_layer;
}

}  // namespace spot
