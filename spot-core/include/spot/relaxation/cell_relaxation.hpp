// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "spot/packing/tiled_packing.hpp"
#include "spot/relaxation/pushes.hpp"
#include "spot/relaxation/solver.hpp"

namespace spot {

/// The soft-core relaxation of a tiled packing (2006, section IV; 2010, section 2.3), in those cells only that many
/// moves have reached since they were relaxed.
class CellRelaxation {
 public:
  /// The packing must outlive it. Without a solver, the one that the parameters ask for.
  CellRelaxation(TiledPacking& packing, const RelaxationParameters& parameters,
                 std::unique_ptr<Solver> solver = nullptr);

  /// Collective. One sweep over the cells that `moves` unrelaxed moves or more have reached, which takes so many off
  /// their counts. Grains of other cells stay where they are, and those swept go all the way off them. A cell in which
  /// a grain was overlapped by more than `deepest` diameters is swept once more the next time. Returns the number of
  /// grains swept on all ranks, 0 when there was no such cell. Lists are up to date afterwards.
  std::size_t sweep(double moves, double deepest, const Container& container, Workers& workers);

  /// The largest overlap, in diameters, of the grains in the last sweep, before it pushed them apart.
  double largest_overlap() const { return largest_overlap_; }

  std::size_t memory() const;

 private:
  /// What one worker does in a sweep.
  struct Task {
    std::uint32_t first, last;          // of cells_swept_
    PushedGrains grains;                // in them
    std::vector<std::uint8_t> in_cell;  // how many are in each
    std::vector<Corrections> corrections;
    float depth;  // of the deepest overlap, as in a push
  };

  bool share_out(std::int32_t parts, std::size_t workers);
  void collect(Task& task);
  void set_ghosts(std::int32_t from, std::int32_t to, std::int32_t parts);
  void correct(Task& task, std::int32_t parts, float deepest);
  std::size_t sum_up();

  TiledPacking& packing_;
  RelaxationParameters parameters_;
  std::unique_ptr<Solver> solver_;
  double largest_overlap_ = 0.0;
  // Kept between sweeps to save allocations.
  std::vector<std::uint32_t> cells_swept_;
  std::size_t count_ = 0;  // of these
  std::vector<Task> tasks_;
};

}  // namespace spot
