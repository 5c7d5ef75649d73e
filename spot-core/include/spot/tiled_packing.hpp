// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

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

namespace spot {

namespace kernels {
struct Kernels;
}

/// Equal spheres laid out for vector kernels.
///
/// Layout: the cells of a grid, x fastest, have `capacity` slots each; a row of cells is one contiguous range of
/// slots. An empty slot holds a grain at infinity, which nothing reaches; so kernels run over whole ranges
/// and need no list of who is there. As in Packing, cells and neighbour lists are functions of the *references*,
/// the places where grains were listed last; a grain half a skin away from its reference is listed anew.
/// Lists have `list_capacity` places a slot, filled up with a slot that is always empty.
///
/// Every cell keeps an account: how many moves have reached into it since it was relaxed last.
class TiledPacking {
 public:
  /// Grains may go down to `outlet`. Throws InvalidPacking as Packing does, and InvalidParameter if
  /// the environment variable SPOT_INSTRUCTION_SET names kernels that cannot run here.
  TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
               const Container& container);

  double diameter() const { return diameter_; }
  std::size_t size() const { return size_; }
  double extent() const { return extent_; }

  /// Calls visit(grain) for all grains, in no particular order.
  void visit_grains(const std::function<void(const Grain&)>& visit) const;

  /// Moves the grains within `radius` of the move's middle, as displace() does; returns how many. Cells that the
  /// move may have reached are charged one move.
  int displace(const Move& move, double radius, double influence);

  /// Lists anew the grains that have wandered half a skin, as far as moves or sweeps have touched their cells.
  void update_lists(const Container& container);

  /// One sweep over the cells that are due, those charged with `due` moves or more. Their accounts are divided by
  /// `relief`; a cell in which a grain was overlapped by more than `deepest` diameters stays due.
  /// Returns the number of grains swept, 0 when no cell was due.
  std::size_t sweep(const RelaxationParameters& parameters, int due, int relief, double deepest,
                    const Container& container);

  /// Marks the grains near walls anew, as after the walls changed.
  void mark_near_walls(const Container& container);

  /// Takes out the grains with centres below the outlet and adds them to `drained`.
  void take_out_below(double outlet, std::vector<Grain>& drained);

  Overlap largest_overlap() const;
  std::size_t memory() const;

 private:
  struct Row {
    std::uint32_t first, last;  // slots
  };

  std::vector<Grain> grains() const;
  void lay_out(const std::vector<Grain>& grains, const Container& container);
  int cell_coordinate(double position, double low, int n) const;
  std::uint32_t cell_of(const Vector3& at) const;
  void find_rows(const Vector3& point, double reach);
  std::uint32_t place(std::uint32_t cell, const Grain& grain);
  void vacate(std::uint32_t slot);
  void unlist(std::uint32_t slot);
  void list(std::uint32_t slot, const Container& container);
  void mark_near_wall(std::uint32_t slot, const Container& container);
  void add_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  void find_wandered();
  void select_due_cells(int due);
  void push_off_walls(const Container& container, double share);
  Vector3 position(std::uint32_t slot) const { return {points_[slot].x, points_[slot].y, points_[slot].z}; }
  Vector3 reference(std::uint32_t slot) const {
    return {references_[slot].x, references_[slot].y, references_[slot].z};
  }
  Grain grain(std::uint32_t slot) const { return {ids_[slot], position(slot), held_[slot] != 0}; }
  std::uint32_t cells() const { return static_cast<std::uint32_t>(account_.size()); }

  const kernels::Kernels* kernels_;
  double diameter_, extent_;
  Quantum quantum_;
  double half_skin_;
  Vector3 low_ = Vector3::Zero();
  double edge_;
  int nx_ = 0, ny_ = 0, nz_ = 0;
  std::uint32_t capacity_ = 8;
  std::uint32_t list_capacity_ = 16;
  std::uint32_t nowhere_ = 0;  // the slot that is always empty
  std::size_t size_ = 0;

  std::vector<Point> points_, references_;
  std::vector<std::int64_t> ids_;  // -1 in empty slots
  std::vector<char> held_, near_wall_;
  std::vector<std::uint32_t> held_slots_;  // obstacles never leave their slots
  std::vector<std::uint32_t> lists_;
  std::vector<std::uint8_t> list_size_;
  std::vector<std::int32_t> account_;
  std::vector<char> touched_;  // cells in which somebody moved since update_lists()

  // Kept between calls to save allocations.
  std::vector<Row> rows_;
  std::vector<std::uint32_t> wandered_, found_, due_cells_, active_;
  std::vector<Point> pushes_;
};

}  // namespace spot
