// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernels.hpp"
#include "spot/tiled_packing.hpp"
#include "wrapped_integers.hpp"

namespace spot {

namespace {

float depth_of(const Point& push) {
  float depth;
  std::memcpy(&depth, &push.state, sizeof depth);
  return depth;
}

}  // namespace

std::size_t TiledPacking::sweep(const RelaxationParameters& parameters, double due, double deepest,
                                const Container& container, Workers& workers) {
  const auto parts = static_cast<std::int32_t>(std::min(due, 1e6) * parts_of_move);
  due_cells_.resize(last_owned() - first_owned());
  const std::size_t n =
      kernels_->find_reached(account_.data() + first_owned(), due_cells_.size(), parts, due_cells_.data());
  if (communicator_->sum(static_cast<std::int64_t>(n)) == 0) return 0;
  for (std::size_t k = 0; k < n; ++k) due_cells_[k] += first_owned();
  const auto shares = static_cast<std::size_t>(workers.size());
  shares_.resize(shares);
  for (std::size_t k = 0; k < shares; ++k) {
    shares_[k].first = static_cast<std::uint32_t>(n * k / shares);
    shares_[k].last = static_cast<std::uint32_t>(n * (k + 1) / shares);
  }
  workers.run([&](int worker) { push_apart(shares_[static_cast<std::size_t>(worker)], parameters, container); });
  if (!container.concurrent())
    for (Share& share : shares_) push_off_other_walls(share, parameters.fixed_share(), container);
  workers.run([&](int worker) {
    // 1 - r^2/d^2 is twice the overlap in diameters, to first order.
    apply(shares_[static_cast<std::size_t>(worker)], parts, static_cast<float>(2.0 * deepest),
          static_cast<float>(parameters.momentum));
  });
  update_lists(container);
  std::int64_t swept = 0;
  float depth = 0.0f;
  for (const Share& share : shares_) {
    swept += share.grains;
    depth = std::max(depth, share.depth);
  }
  overlap_swept_ = 1.0 - std::sqrt(1.0 - static_cast<double>(depth));
  return static_cast<std::size_t>(communicator_->sum(swept));
}

void TiledPacking::collect(Share& share) const {
  share.active.resize(static_cast<std::size_t>(share.last - share.first) * capacity_ + kernels::ahead);
  share.walled.clear();
  share.in_cell.clear();
  std::uint32_t n = 0;
  for (std::uint32_t k = share.first; k < share.last; ++k) {
    const std::uint32_t before = n, first = due_cells_[k] * capacity_;
    for (std::uint32_t slot = first; slot < first + capacity_; ++slot) {
      share.active[n] = slot;
      n += points_[slot].state == Point::free ? 1 : 0;
    }
    share.in_cell.push_back(static_cast<std::uint8_t>(n - before));
    if (cell_near_wall_[due_cells_[k]] == 0) continue;
    for (std::uint32_t place = before; place < n; ++place)
      if (near_wall_[share.active[place]] != 0) share.walled.push_back(place);
  }
  share.grains = n;
  std::fill_n(share.active.begin() + n, kernels::ahead, 0u);
}

void TiledPacking::push_apart(Share& share, const RelaxationParameters& parameters, const Container& container) const {
  collect(share);
  share.pushes.resize(share.grains);
  const double diameter = diameter_ / quantum_.length();
  kernels_->push_off_neighbours(
      points_.data(), share.active.data(), share.grains, {lists_.data(), list_size_.data(), list_capacity_},
      {static_cast<float>(1.0 / (diameter * diameter)), static_cast<float>(parameters.pair_share())},
      share.pushes.data());
  part_coincident(share, parameters.pair_share() * diameter_);
  push_off_planes(share, static_cast<float>(parameters.fixed_share()));
  if (container.concurrent()) push_off_other_walls(share, parameters.fixed_share(), container);
}

/// Centres that coincide have no line between them; part them along x, by id so that both agree.
void TiledPacking::part_coincident(Share& share, double by) const {
  for (std::size_t k = 0; k < share.grains; ++k) {
    if (depth_of(share.pushes[k]) < 1.0f) continue;
    const std::uint32_t i = share.active[k];
    for (std::uint32_t l = 0; l < list_size_[i]; ++l) {
      const std::uint32_t j = lists_[static_cast<std::size_t>(i) * list_capacity_ + l];
      if (points_[i].x == points_[j].x && points_[i].y == points_[j].y && points_[i].z == points_[j].z)
        push(share.pushes[k], {ids_[i] < ids_[j] ? -by : by, 0.0, 0.0});
    }
  }
}

void TiledPacking::push(Point& point, const Vector3& by) const {
  const auto q = quanta(by);
  point.x = add(point.x, wrap(q[0]));
  point.y = add(point.y, wrap(q[1]));
  point.z = add(point.z, wrap(q[2]));
}

void TiledPacking::apply(Share& share, int due, float deepest, float momentum) {
  share.corrections.resize(share.in_cell.size());
  kernels_->correct(points_.data(), momenta_.data(), share.active.data(), share.in_cell.data(), share.in_cell.size(),
                    share.pushes.data(), momentum, share.corrections.data());
  share.depth = 0.0f;
  for (std::uint32_t c = share.first; c < share.last; ++c) {
    const std::uint32_t cell = due_cells_[c];
    const Corrections& corrections = share.corrections[c - share.first];
    share.depth = std::max(share.depth, corrections.depth);
    account_[cell] -= due;
    if (corrections.depth > deepest) account_[cell] = std::max(account_[cell], due);
    // A little more than it may be, for the rounding.
    path_[cell] += static_cast<std::int32_t>(std::min(1.001f * std::sqrt(corrections.longest_squared), 1e9f)) + 1;
  }
}

}  // namespace spot
