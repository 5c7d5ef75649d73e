// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/packing/cells.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/workers.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/nonaffine_motion.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

namespace kernels {
struct Kernels;
struct Places;
}  // namespace kernels

/// The moves of a window, as they displace the blocks of grains in the cells: which rows of cells each may reach, what
/// it encloses, and its displacements, one move after the other.
///
/// Each worker owns some rows of cells, and does there all that moves do in them, in the order of the moves; so the
/// number of workers changes nothing. Every move has rows of all workers in its reach. (In layers of their own most
/// would wait: moves that follow each other are of spots of one age, at one height.)
class BlockMoves {
 public:
  BlockMoves(Cells& cells, const kernels::Kernels& kernels) : cells_(cells), kernels_(kernels) {}

  /// Throws InvalidParameter unless spots of this radius are small enough, below 8 diameters.
  static void require_radius(double radius, double diameter);

  /// From the middle of a move to the references of the grains that it may move.
  static double reach(double radius, const CellLattice& lattice);

  /// Finds what moves reach. `work`: cells reached are added to it, layer by layer. Returns the volume of own
  /// grains that each encloses.
  const std::vector<int>& find(const std::vector<Move>& moves, const SpotParameters& spots, Workers& workers,
                               std::vector<std::int64_t>& work);

  /// The displacements of what has been found, now that moves have their weights.
  void weigh(const std::vector<Move>& moves, const SpotParameters& spots);

  /// Collective. The end of the moves, from `first` on, that can be applied before a grain may be too far from its
  /// reference for the next, on any rank.
  std::size_t end_before_rebuild(const std::vector<Move>& moves, std::size_t first, Communicator& communicator,
                                 Workers& workers);
  /// Do lists have to be brought up to date, on all ranks, before there can be a next move?
  bool must_rebuild() const { return must_rebuild_; }

  /// Displaces the grains by some of the moves, and counts each as one more of its cells' unrelaxed moves. Only
  /// Cells::coordinates say where grains are then, until they are written back. `received`, if there is one: counts
  /// the moves of the grain in each slot.
  void apply(std::size_t first, std::size_t end, Workers& workers, std::uint32_t* received);

  /// Writes back to Cells::points where the grains of a cell are now, or all that moves may have reached.
  void write_back(std::uint32_t cell);
  void write_back(Workers& workers);

  std::size_t memory() const;

 private:
  /// What one worker does: what the moves do in some rows of the own layers.
  struct Part {
    RowsAsked asked;
    std::vector<CellRow> rows;             // of cells that moves may reach, move by move
    std::vector<Point> shifts;             // of each row, to the image of the move that reaches it, if space repeats
    std::vector<std::size_t> end_of_rows;  // in `rows`, of each move
    std::vector<CellRow> reached;          // by any move: in each row of the lattice, from the first to the last cell
    std::vector<std::uint32_t> blocks;     // of slots, that the move at hand may reach
    std::vector<int> enclosed;             // volume of the grains here, by each move
    std::vector<std::int64_t> work;        // cells reached by the moves, in each own layer
    std::size_t counted;                   // the end of the moves whose lengths are in the drift of cells
    bool must_rebuild;                     // has the drift of a cell become too long?

    std::size_t first_row(std::size_t move) const { return move == 0 ? 0 : end_of_rows[move - 1]; }
    template <typename Visit>
    void visit_cells(std::size_t move, const Visit& visit) const {
      for (std::size_t r = first_row(move); r < end_of_rows[move]; ++r)
        for (std::uint32_t cell = rows[r].first; cell < rows[r].last; ++cell) visit(cell);
    }
  };

  void set_parts(int workers);
  void find_rows_of_images(Part& part, const Vector3& middle, double reach) const;
  template <typename Visit>
  void visit_blocks(const CellRow& row, const Visit& visit) const;
  template <typename Visit>
  void visit_images(Part& part, std::size_t move, const Visit& visit);
  void find_rows(Part& part, const std::vector<Move>& moves, double radius);
  void add_reached(Part& part, const CellRow& row) const;
  void take_places(const Part& part);
  void count_enclosed(Part& part);
  void update_tilts(const Part& part, const NonaffineMotion& motion);
  void add_drift(Part& part, std::size_t first, std::int32_t limit);
  void apply(Part& part, std::size_t first, std::size_t end, std::uint32_t* received);
  void displace(const kernels::Places& places, const Point& middle, std::size_t move) const;

  Cells& cells_;
  const kernels::Kernels& kernels_;
  std::vector<Part> parts_;  // one for each worker
  std::vector<Point> middles_, steps_;
  std::vector<std::int32_t> lengths_;  // of the displacements, at most, in quanta
  float tilt_unit_ = 0.0f;             // NonaffineMotion::unit()
  Reach reach_{};
  std::vector<int> enclosed_;  // volume of own grains, by each move
  bool must_rebuild_ = false;
};

}  // namespace spot
