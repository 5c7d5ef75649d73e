// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/solver.hpp"

#include <algorithm>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"

namespace spot {

void Jacobi::correct(Cells& cells, const SweptCells& swept, Corrections* corrections) const {
  const std::uint32_t* slot = swept.slots;
  const Point* push = swept.pushes;
  for (std::size_t cell = 0; cell < swept.cells; ++cell) {
    float longest_squared = 0.0f, depth = 0.0f;
    for (std::uint32_t k = 0; k < swept.in_cell[cell]; ++k, ++slot, ++push) {
      add(cells.points[*slot], *push);
      cells.points[*slot].state = Point::free;
      const auto x = static_cast<float>(push->x), y = static_cast<float>(push->y), z = static_cast<float>(push->z);
      longest_squared = std::max(longest_squared, (x * x + y * y) + z * z);
      depth = std::max(depth, depth_of(*push));
    }
    corrections[cell] = {longest_squared, depth};
  }
}

void HeavyBall::correct(Cells& cells, const SweptCells& swept, Corrections* corrections) const {
  kernels_.correct(cells.points.data(), cells.corrections.data(), swept.slots, swept.in_cell, swept.cells, swept.pushes,
                   static_cast<float>(momentum_), corrections);
}

std::unique_ptr<Solver> solver_for(const RelaxationParameters& parameters, const kernels::Kernels& kernels) {
  if (parameters.momentum == 0.0) return std::make_unique<Jacobi>();
  return std::make_unique<HeavyBall>(parameters.momentum, kernels);
}

}  // namespace spot
