// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/held_cells.hpp"

#include "spot/base/errors.hpp"

namespace spot {

void HeldCells::hold_layers(const Slabs& slabs, int rank, double most_cells) {
  slabs_ = slabs;
  rank_ = rank;
  const int first = first_own_layer(), layers = own_layers();
  ghost_layers_ = {layers > 0 && first > 0 ? 1 : 0, layers > 0 && first + layers < lattice_.layers() ? 1 : 0};
  const double cells =
      (static_cast<double>(layers) + ghost_layers_[below] + ghost_layers_[above]) * lattice_.cells_in_layer();
  if (cells > most_cells)
    throw InvalidPacking(message("grains are spread over more than ", cells, " cells of ", lattice_.edge()[0], " by ",
                                 lattice_.edge()[1], " by ", lattice_.edge()[2], ", which is too many"));
  lattice_.hold(first - ghost_layers_[below], first + layers + ghost_layers_[above]);
  is_image_.clear();
  images_.clear();
  if (!lattice_.periodic().any()) return;
  is_image_.assign(count(), 0);
  images_.assign(count(), {});
  for (std::uint32_t number = 0; number < count(); ++number) {
    const Cell cell = lattice_.cell(number);
    if (!lattice_.is_image(cell)) continue;
    is_image_[number] = 1;
    images_[lattice_.number_of(lattice_.source_of(cell))].push_back(number);
  }
}

}  // namespace spot
