// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/tiled_packing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels.hpp"
#include "spot/errors.hpp"

namespace spot {

namespace {

const kernels::Kernels& kernels_ = kernels::best();

/// Where empty slots are: so far away that nothing reaches them, and finite, because kernels multiply by zero.
constexpr double infinity = 0x1p+500;

/// Lists cover this shell around the diameter. Thicker means longer lists, thinner means listing anew more often.
constexpr double skin_in_diameters = 0.25;

/// Edge of a cell: with 1.5 d a cell of a dense packing holds 3.7 grains, and nine hardly ever.
constexpr double edge_in_diameters = 1.5;

}  // namespace

TiledPacking::TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
                           const Container& container)
    : diameter_(diameter),
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
  for (auto* v : {&x_, &y_, &z_, &reference_x_, &reference_y_, &reference_z_}) v->assign(slots, infinity);
  ids_.assign(slots, -1);
  held_.assign(slots, 0);
  near_wall_.assign(slots, 0);
  lists_.assign(slots * list_capacity_, nowhere_);
  list_size_.assign(slots, 0);
  account_.resize(cells, 0);
  touched_.assign(cells, 0);
  size_ = 0;
  for (const Grain& grain : grains) {
    const std::uint32_t slot =
        place(cell_of(grain.position.x(), grain.position.y(), grain.position.z()), grain);
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

std::uint32_t TiledPacking::cell_of(double x, double y, double z) const {
  return static_cast<std::uint32_t>((cell_coordinate(z, low_.z(), nz_) * ny_ + cell_coordinate(y, low_.y(), ny_)) *
                                        nx_ +
                                    cell_coordinate(x, low_.x(), nx_));
}

std::uint32_t TiledPacking::place(std::uint32_t cell, const Grain& grain) {
  for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot) {
    if (ids_[slot] >= 0) continue;
    ids_[slot] = grain.id;
    x_[slot] = grain.position.x();
    y_[slot] = grain.position.y();
    z_[slot] = grain.position.z();
    held_[slot] = grain.held ? 1 : 0;
    ++size_;
    return slot;
  }
  return nowhere_;
}

void TiledPacking::vacate(std::uint32_t slot) {
  ids_[slot] = -1;
  x_[slot] = y_[slot] = z_[slot] = infinity;
  reference_x_[slot] = reference_y_[slot] = reference_z_[slot] = infinity;
  held_[slot] = near_wall_[slot] = 0;
  --size_;
}

std::vector<Grain> TiledPacking::grains() const {
  std::vector<Grain> all;
  all.reserve(size_);
  for (std::uint32_t slot = 0; slot < nowhere_; ++slot)
    if (ids_[slot] >= 0) all.push_back(grain(slot));
  std::sort(all.begin(), all.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return all;
}

void TiledPacking::find_rows(const Vector3& point, double reach) {
  rows_.clear();
  const int z0 = cell_coordinate(point.z() - reach, low_.z(), nz_), z1 = cell_coordinate(point.z() + reach, low_.z(), nz_);
  const int y0 = cell_coordinate(point.y() - reach, low_.y(), ny_), y1 = cell_coordinate(point.y() + reach, low_.y(), ny_);
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
  const double by[3] = {quantum_.round(-influence * move.step.x()), quantum_.round(-influence * move.step.y()),
                        quantum_.round(-influence * move.step.z())};
  find_rows(move.middle, radius + half_skin_);
  int moved = 0;
  for (const Row& row : rows_) {
    const std::uint32_t first = row.first * capacity_;
    moved += kernels_.displace(x_.data() + first, y_.data() + first, z_.data() + first, (row.last - row.first) * capacity_,
                            move.middle.data(), radius * radius, by);
    for (std::uint32_t cell = row.first; cell < row.last; ++cell) {
      ++account_[cell];
      touched_[cell] = 1;
    }
  }
  return moved;
}

void TiledPacking::update_lists(const Container& container) {
  wandered_.clear();
  for (std::uint32_t cell = 0; cell < cells(); ++cell) {
    if (!touched_[cell]) continue;
    touched_[cell] = 0;
    const std::uint32_t first = cell * capacity_;
    if (!kernels_.any_beyond(x_.data() + first, y_.data() + first, z_.data() + first, reference_x_.data() + first,
                      reference_y_.data() + first, reference_z_.data() + first, capacity_, half_skin_ * half_skin_))
      continue;
    for (std::uint32_t slot = first; slot < first + capacity_; ++slot) {
      const double dx = x_[slot] - reference_x_[slot], dy = y_[slot] - reference_y_[slot],
                   dz = z_[slot] - reference_z_[slot];
      if (dx * dx + dy * dy + dz * dz > half_skin_ * half_skin_) wandered_.push_back(slot);
    }
  }
  for (std::uint32_t slot : wandered_) {
    unlist(slot);
    const std::uint32_t cell = cell_of(x_[slot], y_[slot], z_[slot]);
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
  reference_x_[slot] = infinity;
}

void TiledPacking::list(std::uint32_t slot, const Container& container) {
  const Vector3 at(x_[slot], y_[slot], z_[slot]);
  const double reach = diameter_ + 2.0 * half_skin_;
  reference_x_[slot] = infinity;  // do not find oneself
  find_rows(at, reach);
  found_.clear();
  for (const Row& row : rows_)
    for (std::uint32_t j = row.first * capacity_; j < row.last * capacity_; ++j) {
      const double dx = reference_x_[j] - at.x(), dy = reference_y_[j] - at.y(), dz = reference_z_[j] - at.z();
      if (dx * dx + dy * dy + dz * dz < reach * reach) found_.push_back(j);
    }
  for (const std::uint32_t j : found_) {
    add_neighbour(slot, j);
    add_neighbour(j, slot);
  }
  reference_x_[slot] = at.x();
  reference_y_[slot] = at.y();
  reference_z_[slot] = at.z();
  WallContacts contacts;
  container.contacts(at, 0.5 * diameter_ + half_skin_, contacts);
  near_wall_[slot] = contacts.begin() != contacts.end() ? 1 : 0;
}

void TiledPacking::add_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  if (list_size_[slot] == list_capacity_) {
    const std::uint32_t longer = 2 * list_capacity_;
    if (longer > 128) throw InvalidPacking(message("a grain has more than ", list_capacity_, " neighbours: the packing has collapsed"));
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
  for (int iz = 0; iz < nz_; ++iz)
    for (int iy = 0; iy < ny_; ++iy)
      for (int ix = 0; ix < nx_; ++ix) {
        const std::uint32_t cell = static_cast<std::uint32_t>((iz * ny_ + iy) * nx_ + ix);
        if (account_[cell] >= due) due_cells_.push_back(cell);
      }
}

std::size_t TiledPacking::sweep(const RelaxationParameters& parameters, int due, int relief,
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
  const std::size_t n = active_.size();
  while (active_.size() % kernels::lanes != 0) active_.push_back(nowhere_);
  push_x_.resize(active_.size());
  push_y_.resize(active_.size());
  push_z_.resize(active_.size());
  const kernels::Slots arrays{x_.data(),      y_.data(),       z_.data(), lists_.data(), list_capacity_,
                          diameter_ * diameter_, parameters.pair_share(), 1.5 * std::ldexp(quantum_.length(), 52)};
  for (std::size_t k = 0; k < active_.size(); k += kernels::lanes) {
    std::uint32_t longest = 0;
    for (int l = 0; l < kernels::lanes; ++l) longest = std::max<std::uint32_t>(longest, list_size_[active_[k + l]]);
    kernels_.push_off_neighbours(arrays, active_.data() + k, longest, push_x_.data() + k, push_y_.data() + k, push_z_.data() + k);
  }
  active_.resize(n);
  push_off_walls(container, parameters.fixed_share());
  for (std::size_t k = 0; k < n; ++k) {
    x_[active_[k]] += push_x_[k];
    y_[active_[k]] += push_y_[k];
    z_[active_[k]] += push_z_[k];
  }
  return n;
}

void TiledPacking::push_off_walls(const Container& container, double share) {
  const double radius = 0.5 * diameter_;
  WallContacts contacts;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::uint32_t slot = active_[k];
    if (!near_wall_[slot]) continue;
    container.contacts({x_[slot], y_[slot], z_[slot]}, radius, contacts);
    for (const WallContact& contact : contacts) {
      const Vector3 off = share * (radius - contact.distance) * contact.normal;
      push_x_[k] += quantum_.round(off.x());
      push_y_[k] += quantum_.round(off.y());
      push_z_[k] += quantum_.round(off.z());
    }
  }
}

void TiledPacking::take_out_below(double outlet, std::vector<Grain>& drained) {
  const int layers = cell_coordinate(outlet + half_skin_, low_.z(), nz_) + 1;
  const std::uint32_t last = static_cast<std::uint32_t>(layers * ny_ * nx_) * capacity_;
  for (std::uint32_t slot = 0; slot < last; ++slot) {
    if (ids_[slot] < 0 || z_[slot] >= outlet || held_[slot]) continue;
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
      const double dx = x_[i] - x_[j], dy = y_[i] - y_[j], dz = z_[i] - z_[j];
      const double squared = dx * dx + dy * dy + dz * dz;
      if (squared >= least) continue;
      least = squared;
      largest = {diameter_ - std::sqrt(squared), std::min(ids_[i], ids_[j]), std::max(ids_[i], ids_[j])};
    }
  return largest;
}

std::size_t TiledPacking::memory() const {
  return x_.capacity() * (6 * sizeof(double) + sizeof(std::int64_t) + 3) + lists_.capacity() * sizeof(std::uint32_t) +
         account_.capacity() * 5;
}

}  // namespace spot
