// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "spot/packing/cells.hpp"
#include "spot/packing/point.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

namespace kernels {
struct Kernels;
}

/// The grains of some cells that a sweep has found the pushes of: cell after cell, `in_cell` of them in each.
struct SweptCells {
  const std::uint32_t* slots;
  const std::uint8_t* in_cell;
  std::size_t cells;
  const Point* pushes;
};

/// What a sweep makes of the pushes that it has found: the iteration that takes overlaps away.
///
/// Called by several threads, each for other cells.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Moves the grains, which are free from then on. `corrections`: of each cell, the longest and the deepest overlap.
  virtual void correct(Cells& cells, const SweptCells& swept, Corrections* corrections) const = 0;
};

/// Jacobi iteration: every grain goes by its push.
class Jacobi : public Solver {
 public:
  void correct(Cells& cells, const SweptCells& swept, Corrections* corrections) const override;
};

/// The heavy-ball method (Polyak, USSR Comput. Math. Math. Phys. 4, 1 (1964)): by its push, and by a share of its last
/// correction.
class HeavyBall : public Solver {
 public:
  HeavyBall(double momentum, const kernels::Kernels& kernels) : momentum_(momentum), kernels_(kernels) {}
  void correct(Cells& cells, const SweptCells& swept, Corrections* corrections) const override;

 private:
  double momentum_;
  const kernels::Kernels& kernels_;
};

/// The one that the parameters ask for.
std::unique_ptr<Solver> solver_for(const RelaxationParameters& parameters, const kernels::Kernels& kernels);

}  // namespace spot
