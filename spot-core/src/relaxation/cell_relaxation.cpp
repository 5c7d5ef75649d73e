// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/cell_relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// A sweep of a grain takes as long as finding, weighing and displacing the grains in so many cells (perf,
/// examples/silo).
constexpr std::int64_t work_of_grain = 2;

}  // namespace

CellRelaxation::CellRelaxation(TiledPacking& packing, const RelaxationParameters& parameters,
                               std::unique_ptr<Solver> solver)
    : packing_(packing),
      parameters_(parameters),
      solver_(solver ? std::move(solver) : solver_for(parameters, packing.kernels())) {
  packing.lists().hold_gaps(parameters.closing_gap * packing.diameter());
}

std::size_t CellRelaxation::sweep(double moves, double deepest, const Container& container, Workers& workers) {
  const auto parts = static_cast<std::int32_t>(std::min(moves, 1e6) * Cells::parts_of_move);
  if (!share_out(parts, static_cast<std::size_t>(workers.size()))) return 0;
  const auto task_of = [this](int worker) -> Task& { return tasks_[static_cast<std::size_t>(worker)]; };
  workers.run([&](int worker) { collect(task_of(worker)); });
  packing_.ghosts().send_positions_of_unrelaxed(parts);
  set_ghosts(Point::free, Point::swept, parts);
  const PushStrength strength = {parameters_.contact_overlap, parameters_.pair_share(), parameters_.fixed_share(),
                                 parameters_.closing_gap, parameters_.closing_share};
  const auto ask_container = [&](Task& task) {
    add_pushes_of_other_walls(packing_, strength.fixed_share, container, task.grains);
  };
  workers.run([&](int worker) {
    find_pushes(packing_, strength, task_of(worker).grains);
    if (container.concurrent()) ask_container(task_of(worker));
  });
  if (!container.concurrent())
    for (Task& of_worker : tasks_) ask_container(of_worker);
  // 1 - r^2/d^2 is twice the overlap beyond that in contact, in diameters, to first order.
  workers.run([&](int worker) { correct(task_of(worker), parts, static_cast<float>(2.0 * deepest)); });
  set_ghosts(Point::swept, Point::free, parts);
  packing_.update_lists(container, workers);
  return sum_up();
}

/// Finds the cells to be swept, and shares them out among workers. Are there any on any rank?
bool CellRelaxation::share_out(std::int32_t parts, std::size_t workers) {
  const Cells& cells = packing_.cells();
  cells_swept_.resize(cells.last_own() - cells.first_own());
  count_ = packing_.kernels().find_reached(cells.unrelaxed.data() + cells.first_own(), cells_swept_.size(), parts,
                                           cells_swept_.data());
  for (std::size_t k = 0; k < count_; ++k) cells_swept_[k] += cells.first_own();
  if (cells.repeat()) {
    const auto end = cells_swept_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto images =
        std::remove_if(cells_swept_.begin(), end, [&](std::uint32_t cell) { return cells.is_image(cell); });
    count_ = static_cast<std::size_t>(images - cells_swept_.begin());
  }
  if (packing_.communicator().sum(static_cast<std::int64_t>(count_)) == 0) return false;
  tasks_.resize(workers);
  for (std::size_t k = 0; k < workers; ++k) {
    tasks_[k].first = static_cast<std::uint32_t>(count_ * k / workers);
    tasks_[k].last = static_cast<std::uint32_t>(count_ * (k + 1) / workers);
  }
  return true;
}

/// Finds the grains in the cells of a task, which are swept from now on.
void CellRelaxation::collect(Task& task) {
  Cells& cells = packing_.cells();
  std::size_t most = kernels::ahead;
  for (std::uint32_t k = task.first; k < task.last; ++k)
    most += cells.end_slot(cells_swept_[k]) - cells.first_slot(cells_swept_[k]);
  task.grains.slots.resize(most);
  task.grains.near_walls.clear();
  task.in_cell.clear();
  std::uint32_t n = 0;
  for (std::uint32_t k = task.first; k < task.last; ++k) {
    const std::uint32_t before = n, cell = cells_swept_[k], end = cells.end_slot(cell);
    for (std::uint32_t slot = cells.first_slot(cell); slot < end; ++slot) {
      // Without branches, which no processor could foresee.
      std::int32_t& state = cells.points[slot].state;
      const bool is_free = state == Point::free;
      state = is_free ? Point::swept : state;
      task.grains.slots[n] = slot;
      n += is_free ? 1 : 0;
    }
    task.in_cell.push_back(static_cast<std::uint8_t>(n - before));
    if (!packing_.walls().cell_near_wall(cell)) continue;
    for (std::uint32_t place = before; place < n; ++place)
      if (packing_.walls().near_wall(task.grains.slots[place])) task.grains.near_walls.push_back(place);
  }
  task.grains.count = n;
  std::fill_n(task.grains.slots.begin() + n, kernels::ahead, 0u);
}

/// Changes the state of the copies of grains in other ranks' cells that are swept there.
void CellRelaxation::set_ghosts(std::int32_t from, std::int32_t to, std::int32_t parts) {
  Cells& cells = packing_.cells();
  cells.visit_ghosts([&](std::uint32_t slot) {
    if (cells.points[slot].state == from && cells.unrelaxed[cells.cell_of(slot)] >= parts)
      cells.points[slot].state = to;
  });
}

void CellRelaxation::correct(Task& task, std::int32_t parts, float deepest) {
  Cells& cells = packing_.cells();
  task.corrections.resize(task.in_cell.size());
  solver_->correct(cells,
                   {task.grains.slots.data(), task.in_cell.data(), task.in_cell.size(), task.grains.pushes.data()},
                   task.corrections.data());
  task.depth = 0.0f;
  for (std::uint32_t c = task.first; c < task.last; ++c) {
    const std::uint32_t cell = cells_swept_[c];
    const Corrections& corrections = task.corrections[c - task.first];
    task.depth = std::max(task.depth, corrections.depth);
    cells.unrelaxed[cell] -= parts;
    if (corrections.depth > deepest) cells.unrelaxed[cell] = std::max(cells.unrelaxed[cell], parts);
    // A little more than it may be, for the rounding.
    cells.drift.add(cell,
                    static_cast<std::int32_t>(std::min(1.001f * std::sqrt(corrections.longest_squared), 1e9f)) + 1);
  }
}

/// Grains swept on all ranks.
std::size_t CellRelaxation::sum_up() {
  std::int64_t swept = 0;
  float depth = 0.0f;
  for (const Task& task : tasks_) {
    for (std::uint32_t c = task.first; c < task.last; ++c)
      packing_.add_work(cells_swept_[c], work_of_grain * task.in_cell[c - task.first]);
    swept += static_cast<std::int64_t>(task.grains.count);
    depth = std::max(depth, task.depth);
  }
  largest_overlap_ = 1.0 - parameters_.distance_in_contact(1.0) * std::sqrt(1.0 - static_cast<double>(depth));
  return static_cast<std::size_t>(packing_.communicator().sum(swept));
}

std::size_t CellRelaxation::memory() const {
  std::size_t bytes = bytes_in(cells_swept_, tasks_);
  for (const Task& task : tasks_)
    bytes += bytes_in(task.grains.slots, task.grains.near_walls, task.grains.pushes, task.in_cell, task.corrections);
  return bytes;
}

}  // namespace spot
