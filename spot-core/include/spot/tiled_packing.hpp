// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "spot/container.hpp"
#include "spot/displacement.hpp"
#include "spot/packing.hpp"
#include "spot/parameters.hpp"
#include "spot/point.hpp"
#include "spot/quantum.hpp"
#include "spot/workers.hpp"

namespace spot {

namespace kernels {
struct Kernels;
}

/// Equal spheres laid out for vector kernels and threads.
///
/// Positions are whole numbers of quanta of 2^-24 d, in 32 bits, from the lowest corner of the grid; they wrap around,
/// and the cell that a grain is listed in tells where it is. Integer sums are exact, so neither cells, lists, threads
/// nor instruction sets can change a bit of the result.
///
/// Layout: the cells of a grid, x fastest, have `capacity` slots each; a row of cells is one contiguous range of slots,
/// so that kernels run over whole ranges and need no list of who is there. As in Packing, cells and neighbour lists are
/// functions of the *references*, the places where grains were listed last; a grain half a skin away from its reference
/// is listed anew. Nobody looks for such grains before the moves and pushes in a cell, laid end to end, could have
/// brought one there. Lists have `list_capacity` places a slot.
///
/// Every cell keeps an account: how many moves have reached into it, less those that sweeps have paid for.
class TiledPacking {
 public:
  /// Grains may go down to `outlet`. Throws InvalidPacking as Packing does, and InvalidParameter if
  /// the environment variable SPOT_INSTRUCTION_SET names kernels that cannot run here.
  TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
               const Container& container);

  /// Throws InvalidParameter unless spots of this radius are small enough, below 8 diameters.
  static void require_radius(double radius, double diameter);

  double diameter() const { return diameter_; }
  std::size_t size() const { return size_; }
  double extent() const { return extent_; }

  /// Calls visit(grain) for all grains, in no particular order.
  void visit_grains(const std::function<void(const Grain&)>& visit) const;

  /// Applies the moves, one after the other to every grain: as displace(), moves the grains within `radius` of a move's
  /// middle. Each cell that a move may have reached is charged one move. Lists are up to date afterwards.
  /// `moved`: for each move, how many grains it moved. Throws InvalidParameter unless the radius is below 8 diameters.
  void displace(const std::vector<Move>& moves, double radius, double influence, const Container& container,
                Workers& workers, std::vector<int>& moved);

  /// One sweep over the cells that are due, those charged with `due` moves or more, which pays for `due` of them; a
  /// cell in which a grain was overlapped by more than `deepest` diameters stays due.
  /// Returns the number of grains swept, 0 when no cell was due. Lists are up to date afterwards.
  std::size_t sweep(const RelaxationParameters& parameters, double due, double deepest, const Container& container,
                    Workers& workers);

  /// Marks the grains near walls anew, as after the walls changed.
  void mark_near_walls(const Container& container);

  /// Takes out the grains with centres below the outlet and adds them to `drained`.
  void take_out_below(double outlet, std::vector<Grain>& drained);

  Overlap largest_overlap() const;
  std::size_t memory() const;

 private:
  struct Row {
    std::uint32_t first, last;  // cells
  };
  struct Cell {
    int x, y, z;
  };

  /// What one worker has to do in a sweep.
  struct Share {
    std::uint32_t first, last;          // of due_cells_
    std::vector<std::uint32_t> active;  // slots, cell by cell
    std::vector<std::uint8_t> in_cell;  // how many of them are in each cell
    std::vector<std::uint32_t> walled;  // places in `active` of those near walls
    std::vector<Point> pushes;
  };

  struct TouchingPlane {
    std::int32_t Point::*axis;
    std::int32_t at;  // where grains that touch it have their centres, in wrapped quanta from low
    bool grains_below;
  };

  // Places. "From low": in deck units, from the lowest corner of the grid.
  std::array<std::int64_t, 3> quanta(const Vector3& from_low) const;
  Point wrapped(const Vector3& from_low) const;
  Vector3 from_low(const Point& point, std::uint32_t cell) const;
  Vector3 position(std::uint32_t slot) const { return low_ + from_low(points_[slot], slot / capacity_); }
  Grain grain(std::uint32_t slot) const;
  int cell_coordinate(double from_low, int axis) const;
  std::uint32_t cell_at(const Vector3& from_low) const;
  Cell cell(std::uint32_t index) const;
  void find_rows(const Vector3& from_low, double reach, std::vector<Row>& rows) const;
  std::uint32_t cells() const { return static_cast<std::uint32_t>(account_.size()); }

  void lay_out(const std::vector<Grain>& grains, const Container& container);
  std::uint32_t place(std::uint32_t cell, std::int64_t id, const Point& point);
  void lay_out_anew(const Container& container);
  void vacate(std::uint32_t slot);

  // Lists.
  void update_lists(const Container& container);
  bool relist(std::uint32_t slot, const Container& container);
  void unlist(std::uint32_t slot);
  void rename(std::uint32_t from, std::uint32_t to);
  void list(std::uint32_t slot, const Container& container);
  void find_planes(const Container& container);
  void other_contacts(const Container& container, const Vector3& centre, double reach, WallContacts& contacts) const;
  std::size_t find_neighbours(std::uint32_t slot);
  void remove_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  std::uint32_t* list_of(std::uint32_t slot) { return lists_.data() + static_cast<std::size_t>(slot) * list_capacity_; }
  void add_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  void mark_near_wall(std::uint32_t slot, const Container& container);

  // Moves.
  bool charge(const Row& row, std::int32_t path, std::int32_t limit);
  void apply_moves(std::size_t first, std::size_t last, float radius_squared, Workers& workers,
                   std::vector<int>& moved);

  // Sweeps.
  void collect(Share& share) const;
  void push_apart(Share& share, const RelaxationParameters& parameters, const Container& container) const;
  void part_coincident(Share& share, double push) const;
  void push_off_planes(Share& share, float strength) const;
  void push_off_other_walls(Share& share, double strength, const Container& container) const;
  void push(Point& point, const Vector3& by) const;
  void apply(const Share& share, int due, float deepest, float momentum);

  const kernels::Kernels* kernels_;
  double diameter_, extent_;
  Quantum quantum_;
  double skin_;
  Vector3 low_ = Vector3::Zero();
  std::array<double, 3> edge_, per_edge_;    // of a cell, and 1 over it
  std::array<std::int64_t, 3> edge_quanta_;  // the same
  std::array<int, 3> n_ = {0, 0, 0};         // cells along each axis
  std::uint32_t capacity_ = 8;
  std::uint32_t list_capacity_;
  std::size_t size_ = 0;

  std::vector<Point> points_, references_;
  std::vector<Point> momenta_;           // the last correction, as far as it is carried on
  std::vector<std::int64_t> ids_;        // -1 in empty slots
  std::vector<TouchingPlane> planes_;    // the container's axis planes, unless there are too many
  std::vector<std::uint8_t> near_wall_;  // a bit for each of these; the highest for all other walls
  std::vector<std::uint32_t> lists_;
  std::vector<std::uint8_t> list_size_;
  std::vector<std::uint8_t> marks_;    // of slots, zero between uses
  std::vector<std::int32_t> account_;  // in parts of a move
  std::vector<std::int32_t> path_;     // of each cell: no grain in it is farther from its reference, in quanta

  // Kept between calls to save allocations.
  std::vector<Row> rows_, near_rows_;
  std::vector<std::size_t> end_of_rows_;  // in rows_, of each move
  std::vector<Point> middles_, steps_;
  std::vector<std::vector<int>> moved_by_;  // of each worker
  std::vector<std::uint32_t> found_, wandered_cells_, due_cells_;
  std::vector<Share> shares_;
};

}  // namespace spot
