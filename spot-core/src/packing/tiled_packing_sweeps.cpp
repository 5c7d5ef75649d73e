// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// A sweep of a grain takes as long as finding, weighing and displacing the grains in so many cells (perf,
/// examples/silo).
constexpr std::int64_t work_of_grain = 2;

}  // namespace

std::size_t TiledPacking::sweep(const RelaxationParameters& parameters, double due, double deepest,
                                const Container& container, Workers& workers) {
  const auto parts = static_cast<std::int32_t>(std::min(due, 1e6) * parts_of_move);
  due_cells_.resize(last_owned() - first_owned());
  const std::size_t n =
      kernels_->find_reached(account_.data() + first_owned(), due_cells_.size(), parts, due_cells_.data());
  if (communicator_->sum(static_cast<std::int64_t>(n)) == 0) return 0;
  for (std::size_t k = 0; k < n; ++k) due_cells_[k] += first_owned();
  const auto tasks = static_cast<std::size_t>(workers.size());
  tasks_.resize(tasks);
  for (std::size_t k = 0; k < tasks; ++k) {
    tasks_[k].first = static_cast<std::uint32_t>(n * k / tasks);
    tasks_[k].last = static_cast<std::uint32_t>(n * (k + 1) / tasks);
  }
  workers.run([&](int worker) { collect(tasks_[static_cast<std::size_t>(worker)]); });
  choose_sent(parts);
  set_border(Point::free, Point::due, parts);
  workers.run([&](int worker) { push_apart(tasks_[static_cast<std::size_t>(worker)], parameters, container); });
  if (!container.concurrent())
    for (Task& task : tasks_) push_off_other_walls(task, parameters.fixed_share(), container);
  workers.run([&](int worker) {
    // 1 - r^2/d^2 is twice the overlap beyond that in contact, in diameters, to first order.
    apply(tasks_[static_cast<std::size_t>(worker)], parts, static_cast<float>(2.0 * deepest),
          static_cast<float>(parameters.momentum));
  });
  set_border(Point::due, Point::free, parts);
  update_lists(container, workers);
  std::int64_t swept = 0;
  float depth = 0.0f;
  for (const Task& task : tasks_) {
    for (std::uint32_t c = task.first; c < task.last; ++c)
      work_[(due_cells_[c] - first_owned()) / cells_in_layer()] += work_of_grain * task.in_cell[c - task.first];
    swept += task.grains;
    depth = std::max(depth, task.depth);
  }
  overlap_swept_ = 1.0 - parameters.distance_in_contact(1.0) * std::sqrt(1.0 - static_cast<double>(depth));
  return static_cast<std::size_t>(communicator_->sum(swept));
}

/// Finds the grains in the cells of a task, which are due from now on.
void TiledPacking::collect(Task& task) {
  task.active.resize(static_cast<std::size_t>(task.last - task.first) * capacity_ + kernels::ahead);
  task.walled.clear();
  task.in_cell.clear();
  std::uint32_t n = 0;
  for (std::uint32_t k = task.first; k < task.last; ++k) {
    const std::uint32_t before = n, first = due_cells_[k] * capacity_;
    for (std::uint32_t slot = first; slot < first + capacity_; ++slot) {
      // Without branches, which no processor could foresee.
      std::int32_t& state = points_[slot].state;
      const bool is_free = state == Point::free;
      state = is_free ? Point::due : state;
      task.active[n] = slot;
      n += is_free ? 1 : 0;
    }
    task.in_cell.push_back(static_cast<std::uint8_t>(n - before));
    if (cell_near_wall_[due_cells_[k]] == 0) continue;
    for (std::uint32_t place = before; place < n; ++place)
      if (near_wall_[task.active[place]] != 0) task.walled.push_back(place);
  }
  task.grains = n;
  std::fill_n(task.active.begin() + n, kernels::ahead, 0u);
}

/// Changes the state of the copies of grains in other ranks' cells that are due there.
void TiledPacking::set_border(std::int32_t from, std::int32_t to, std::int32_t due) {
  const auto set = [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t cell = first; cell < last; ++cell) {
      if (account_[cell] < due) continue;
      for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot)
        if (points_[slot].state == from) points_[slot].state = to;
    }
  };
  set(0, first_owned());
  set(last_owned(), cells());
}

void TiledPacking::push_apart(Task& task, const RelaxationParameters& parameters, const Container& container) const {
  task.pushes.resize(task.grains);
  const double parted = parameters.distance_in_contact(diameter_) / quantum_.length();
  kernels_->push_off_neighbours(
      points_.data(), task.active.data(), task.grains, {lists_.data(), list_size_.data(), list_capacity_},
      {static_cast<float>(1.0 / (parted * parted)), static_cast<float>(parameters.pair_share()),
       static_cast<float>(parameters.fixed_share())},
      task.pushes.data());
  part_coincident(task, parameters.pair_share() * diameter_);
  push_off_planes(task, static_cast<float>(parameters.fixed_share()));
  if (container.concurrent()) push_off_other_walls(task, parameters.fixed_share(), container);
}

/// Centres that coincide have no line between them; part them along x, by id so that both agree.
void TiledPacking::part_coincident(Task& task, double by) const {
  for (std::size_t k = 0; k < task.grains; ++k) {
    if (depth_of(task.pushes[k]) < 1.0f) continue;
    const std::uint32_t i = task.active[k];
    for (std::uint32_t l = 0; l < list_size_[i]; ++l) {
      const std::uint32_t j = lists_[static_cast<std::size_t>(i) * list_capacity_ + l];
      if (points_[i].x == points_[j].x && points_[i].y == points_[j].y && points_[i].z == points_[j].z)
        push(task.pushes[k], {ids_[i] < ids_[j] ? -by : by, 0.0, 0.0});
    }
  }
}

void TiledPacking::push(Point& point, const Vector3& by) const {
  const auto q = quanta(by);
  point.x = add(point.x, wrap(q[0]));
  point.y = add(point.y, wrap(q[1]));
  point.z = add(point.z, wrap(q[2]));
}

void TiledPacking::apply(Task& task, int due, float deepest, float momentum) {
  task.corrections.resize(task.in_cell.size());
  kernels_->correct(points_.data(), momenta_.data(), task.active.data(), task.in_cell.data(), task.in_cell.size(),
                    task.pushes.data(), momentum, task.corrections.data());
  task.depth = 0.0f;
  for (std::uint32_t c = task.first; c < task.last; ++c) {
    const std::uint32_t cell = due_cells_[c];
    const Corrections& corrections = task.corrections[c - task.first];
    task.depth = std::max(task.depth, corrections.depth);
    account_[cell] -= due;
    if (corrections.depth > deepest) account_[cell] = std::max(account_[cell], due);
    // A little more than it may be, for the rounding.
    path_[cell] += static_cast<std::int32_t>(std::min(1.001f * std::sqrt(corrections.longest_squared), 1e9f)) + 1;
  }
}

}  // namespace spot
