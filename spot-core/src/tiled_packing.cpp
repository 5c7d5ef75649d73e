// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/tiled_packing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels.hpp"
#include "spot/errors.hpp"

namespace spot {

namespace {

/// Where empty slots are: so far away that nothing reaches them, and finite, because kernels multiply by zero.
constexpr double far_away = 0x1p+500;
constexpr Point nobody = {far_away, far_away, far_away, 0.0};

/// Lists cover this shell around the diameter. Thicker means longer lists, thinner means listing anew more often.
constexpr double skin_in_diameters = 0.25;

/// Edge of a cell: with 1.5 d a cell of a dense packing holds 3.7 grains, and nine hardly ever.
constexpr double edge_in_diameters = 1.5;

}  // namespace

TiledPacking::TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
                           const Container& container)
    : kernels_(&kernels::best()),
      diameter_(diameter),
      extent_(extent),
      quantum_(diameter, extent),
      half_skin_(0.5 * skin_in_diameters * diameter),
      edge_(edge_in_diameters * diameter) {
  // Packing checks what can be wrong with grains, and snaps them to the quantum.
  const std::vector<Grain> checked = Packing(diameter, extent, grains).grains();
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Grain& grain : checked) {
    low = low.cwiseMin(grain.position);
    high = high.cwiseMax(grain.position);
  }
  if (checked.empty()) low = high = Vector3::Zero();
  low.z() = std::min(low.z(), outlet);
  low_ = low;
  nx_ = static_cast<int>((high.x() - low.x()) / edge_) + 1;
  ny_ = static_cast<int>((high.y() - low.y()) / edge_) + 1;
  nz_ = static_cast<int>((high.z() - low.z()) / edge_) + 1;
  lay_out(checked, container);
}

void TiledPacking::lay_out(const std::vector<Grain>& grains, const Container& container) {
  const std::size_t cells = static_cast<std::size_t>(nx_) * ny_ * nz_;
  if (cells * capacity_ * list_capacity_ > std::numeric_limits<std::uint32_t>::max())
    throw InvalidPacking(message("grains are spread over ", cells, " cells of ", edge_, ", which is too many"));
  nowhere_ = static_cast<std::uint32_t>(cells * capacity_);
  const std::size_t slots = nowhere_ + kernels::lanes;
  points_.assign(slots, nobody);
  references_.assign(slots, nobody);
  ids_.assign(slots, -1);
  held_.assign(slots, 0);
  held_slots_.clear();
  near_wall_.assign(slots, 0);
  lists_.assign(slots * list_capacity_, nowhere_);
  list_size_.assign(slots, 0);
  account_.resize(cells, 0);
  touched_.assign(cells, 0);
  size_ = 0;
  for (const Grain& grain : grains) {
    const std::uint32_t slot = place(cell_of(grain.position), grain);
    if (slot == nowhere_) {
      capacity_ *= 2;
      lay_out(grains, container);
      return;
    }
    list(slot, container);
  }
}

int TiledPacking::cell_coordinate(double position, double low, int n) const {
  const double cell = (position - low) / edge_;
  return cell < 0.0 ? 0 : cell >= n ? n - 1 : static_cast<int>(cell);
}

std::uint32_t TiledPacking::cell_of(const Vector3& at) const {
  return static_cast<std::uint32_t>(
      (cell_coordinate(at.z(), low_.z(), nz_) * ny_ + cell_coordinate(at.y(), low_.y(), ny_)) * nx_ +
      cell_coordinate(at.x(), low_.x(), nx_));
}

std::uint32_t TiledPacking::place(std::uint32_t cell, const Grain& grain) {
  for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot) {
    if (ids_[slot] >= 0) continue;
    ids_[slot] = grain.id;
    points_[slot] = {grain.position.x(), grain.position.y(), grain.position.z(), 0.0};
    held_[slot] = grain.held ? 1 : 0;
    if (grain.held) held_slots_.push_back(slot);
    ++size_;
    return slot;
  }
  return nowhere_;
}

void TiledPacking::vacate(std::uint32_t slot) {
  ids_[slot] = -1;
  points_[slot] = references_[slot] = nobody;
  held_[slot] = near_wall_[slot] = 0;
  --size_;
}

std::vector<Grain> TiledPacking::grains() const {
  std::vector<Grain> all;
  all.reserve(size_);
  visit_grains([&](const Grain& grain) { all.push_back(grain); });
  return all;
}

void TiledPacking::find_rows(const Vector3& point, double reach) {
  rows_.clear();
  const int z0 = cell_coordinate(point.z() - reach, low_.z(), nz_),
            z1 = cell_coordinate(point.z() + reach, low_.z(), nz_);
  const int y0 = cell_coordinate(point.y() - reach, low_.y(), ny_),
            y1 = cell_coordinate(point.y() + reach, low_.y(), ny_);
  // Distance along one axis to a cell; the outermost cells also hold what lies beyond the grid.
  const auto gap = [this](double at, double low, int cell, int n) {
    const double from = low + cell * edge_;
    if (at < from) return cell == 0 ? 0.0 : cell == n - 1 && at >= low + n * edge_ ? 0.0 : from - at;
    if (at > from + edge_) return cell == n - 1 ? 0.0 : at - from - edge_;
    return 0.0;
  };
  for (int iz = z0; iz <= z1; ++iz) {
    const double gz = gap(point.z(), low_.z(), iz, nz_);
    for (int iy = y0; iy <= y1; ++iy) {
      const double gy = gap(point.y(), low_.y(), iy, ny_);
      const double left = reach * reach - gy * gy - gz * gz;
      if (left < 0.0) continue;
      const double half = std::sqrt(left);
      const int row = (iz * ny_ + iy) * nx_;
      rows_.push_back({static_cast<std::uint32_t>(row + cell_coordinate(point.x() - half, low_.x(), nx_)),
                       static_cast<std::uint32_t>(row + cell_coordinate(point.x() + half, low_.x(), nx_) + 1)});
    }
  }
}

int TiledPacking::displace(const Move& move, double radius, double influence) {
  const Point by = {quantum_.round(-influence * move.step.x()), quantum_.round(-influence * move.step.y()),
                    quantum_.round(-influence * move.step.z()), 0.0};
  const Point middle = {move.middle.x(), move.middle.y(), move.middle.z(), 0.0};
  find_rows(move.middle, radius + half_skin_);
  int moved = 0;
  for (const Row& row : rows_) {
    moved += kernels_->displace(points_.data() + row.first * capacity_, (row.last - row.first) * capacity_, middle,
                                radius, by);
    for (std::uint32_t cell = row.first; cell < row.last; ++cell) {
      ++account_[cell];
      touched_[cell] = 1;
    }
  }
  // The kernel knows no obstacles; they are where they were listed.
  for (const std::uint32_t slot : held_slots_) {
    if (position(slot) == reference(slot)) continue;
    points_[slot] = references_[slot];
    --moved;
  }
  return moved;
}

void TiledPacking::find_wandered() {
  wandered_.clear();
  // A few cells at a time: mostly nobody in them has wandered.
  constexpr std::uint32_t batch = 8;
  for (std::uint32_t cell = 0; cell < cells(); cell += batch) {
    const std::uint32_t last = std::min(cell + batch, cells());
    if (std::find(touched_.begin() + cell, touched_.begin() + last, 1) == touched_.begin() + last) continue;
    std::fill(touched_.begin() + cell, touched_.begin() + last, 0);
    const std::uint32_t first = cell * capacity_;
    if (!kernels_->any_beyond(points_.data() + first, references_.data() + first, last * capacity_ - first, half_skin_))
      continue;
    for (std::uint32_t slot = first; slot < last * capacity_; ++slot)
      if ((position(slot) - reference(slot)).squaredNorm() > half_skin_ * half_skin_) wandered_.push_back(slot);
  }
}

void TiledPacking::update_lists(const Container& container) {
  find_wandered();
  for (std::uint32_t slot : wandered_) {
    unlist(slot);
    const std::uint32_t cell = cell_of(position(slot));
    if (cell != slot / capacity_) {
      const std::uint32_t to = place(cell, grain(slot));
      if (to == nowhere_) {
        capacity_ *= 2;
        lay_out(grains(), container);
        return;
      }
      vacate(slot);
      slot = to;
    }
    list(slot, container);
  }
}

void TiledPacking::unlist(std::uint32_t slot) {
  std::uint32_t* own = lists_.data() + static_cast<std::size_t>(slot) * list_capacity_;
  for (std::uint32_t k = 0; k < list_size_[slot]; ++k) {
    const std::uint32_t j = own[k];
    std::uint32_t* list = lists_.data() + static_cast<std::size_t>(j) * list_capacity_;
    std::uint32_t* last = list + --list_size_[j];
    *std::find(list, last, slot) = *last;
    *last = nowhere_;
    own[k] = nowhere_;
  }
  list_size_[slot] = 0;
  references_[slot] = nobody;
}

void TiledPacking::list(std::uint32_t slot, const Container& container) {
  const Vector3 at = position(slot);
  const double reach = diameter_ + 2.0 * half_skin_;
  references_[slot] = nobody;  // do not find oneself
  find_rows(at, reach);
  found_.clear();
  for (const Row& row : rows_)
    for (std::uint32_t j = row.first * capacity_; j < row.last * capacity_; ++j) {
      if ((reference(j) - at).squaredNorm() < reach * reach) found_.push_back(j);
    }
  for (const std::uint32_t j : found_) {
    add_neighbour(slot, j);
    add_neighbour(j, slot);
  }
  references_[slot] = points_[slot];
  mark_near_wall(slot, container);
}

void TiledPacking::mark_near_wall(std::uint32_t slot, const Container& container) {
  // Where it was listed: the mark holds for as long as the list.
  WallContacts contacts;
  container.contacts(reference(slot), 0.5 * diameter_ + half_skin_, contacts);
  near_wall_[slot] = contacts.begin() != contacts.end() ? 1 : 0;
}

void TiledPacking::mark_near_walls(const Container& container) {
  for (std::uint32_t slot = 0; slot < nowhere_; ++slot)
    if (ids_[slot] >= 0) mark_near_wall(slot, container);
}

void TiledPacking::add_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  if (list_size_[slot] == list_capacity_) {
    const std::uint32_t longer = 2 * list_capacity_;
    if (longer > 128)
      throw InvalidPacking(message("a grain has more than ", list_capacity_, " neighbours: the packing has collapsed"));
    std::vector<std::uint32_t> lists(static_cast<std::size_t>(nowhere_ + kernels::lanes) * longer, nowhere_);
    for (std::size_t s = 0; s < nowhere_; ++s)
      std::copy_n(lists_.begin() + static_cast<std::ptrdiff_t>(s * list_capacity_), list_size_[s],
                  lists.begin() + static_cast<std::ptrdiff_t>(s * longer));
    lists_.swap(lists);
    list_capacity_ = longer;
  }
  lists_[static_cast<std::size_t>(slot) * list_capacity_ + list_size_[slot]++] = neighbour;
}

void TiledPacking::select_due_cells(int due) {
  due_cells_.clear();
  for (std::uint32_t cell = 0; cell < cells(); ++cell)
    if (account_[cell] >= due) due_cells_.push_back(cell);
}

std::size_t TiledPacking::sweep(const RelaxationParameters& parameters, int due, int relief, double deepest,
                                const Container& container) {
  select_due_cells(due);
  if (due_cells_.empty()) return 0;
  active_.clear();
  for (const std::uint32_t cell : due_cells_) {
    account_[cell] /= relief;
    touched_[cell] = 1;
    for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot)
      if (ids_[slot] >= 0 && !held_[slot]) active_.push_back(slot);
  }
  pushes_.resize(active_.size());
  kernels_->push_off_neighbours(points_.data(), active_.data(), active_.size(),
                                {lists_.data(), list_size_.data(), list_capacity_},
                                {diameter_, parameters.pair_share(), quantum_.shift()}, pushes_.data());
  push_off_walls(container, parameters.fixed_share());
  for (std::size_t k = 0; k < active_.size(); ++k) {
    Point& point = points_[active_[k]];
    point.x += pushes_[k].x;
    point.y += pushes_[k].y;
    point.z += pushes_[k].z;
    // 1 - r^2/d^2 is twice the overlap in diameters, to first order.
    if (pushes_[k].depth > 2.0 * deepest) account_[active_[k] / capacity_] = due;
  }
  return active_.size();
}

void TiledPacking::push_off_walls(const Container& container, double share) {
  const double radius = 0.5 * diameter_;
  WallContacts contacts;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::uint32_t slot = active_[k];
    if (!near_wall_[slot]) continue;
    container.contacts(position(slot), radius, contacts);
    for (const WallContact& contact : contacts) {
      const Vector3 off = share * (radius - contact.distance) * contact.normal;
      pushes_[k].x += quantum_.round(off.x());
      pushes_[k].y += quantum_.round(off.y());
      pushes_[k].z += quantum_.round(off.z());
    }
  }
}

void TiledPacking::visit_grains(const std::function<void(const Grain&)>& visit) const {
  for (std::uint32_t slot = 0; slot < nowhere_; ++slot)
    if (ids_[slot] >= 0) visit(grain(slot));
}

void TiledPacking::take_out_below(double outlet, std::vector<Grain>& drained) {
  const int layers = cell_coordinate(outlet + half_skin_, low_.z(), nz_) + 1;
  const std::uint32_t last = static_cast<std::uint32_t>(layers * ny_ * nx_) * capacity_;
  for (std::uint32_t slot = 0; slot < last; ++slot) {
    if (ids_[slot] < 0 || points_[slot].z >= outlet || held_[slot]) continue;
    drained.push_back(grain(slot));
    unlist(slot);
    vacate(slot);
  }
}

Overlap TiledPacking::largest_overlap() const {
  Overlap largest;
  double least = diameter_ * diameter_;
  for (std::uint32_t i = 0; i < nowhere_; ++i)
    for (std::uint32_t k = 0; k < list_size_[i]; ++k) {
      const std::uint32_t j = lists_[static_cast<std::size_t>(i) * list_capacity_ + k];
      const double squared = (position(i) - position(j)).squaredNorm();
      if (squared >= least) continue;
      least = squared;
      largest = {1.0 - std::sqrt(squared) / diameter_, std::min(ids_[i], ids_[j]), std::max(ids_[i], ids_[j])};
    }
  return largest;
}

std::size_t TiledPacking::memory() const {
  return points_.capacity() * (2 * sizeof(Point) + sizeof(std::int64_t) + 3) +
         lists_.capacity() * sizeof(std::uint32_t) + account_.capacity() * 5;
}

}  // namespace spot
