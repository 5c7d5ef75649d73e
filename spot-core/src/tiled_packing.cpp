// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/tiled_packing.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernel_builds.hpp"
#include "spot/errors.hpp"

namespace spot {

namespace {

/// Positions in 32 bits reach 128 d at least before they wrap around; overlaps that matter are ten thousand quanta.
constexpr int quantum_bits = 24;

/// Lists cover this shell around the diameter. Thicker means longer lists, thinner means listing anew more often.
constexpr double skin_in_diameters = 0.5;

/// Grains that are this part of half a skin or more away from their references are listed anew once one of their cell
/// may have gone all the way.
constexpr double part_of_half_skin = 0.7;

/// How far beyond half a skin moves may bring a grain before anybody looks, in diameters: moves search for grains this
/// much farther out.
constexpr double leeway_in_diameters = 0.1;

/// Edges of a cell: in a dense packing it holds 3.7 grains, and nine hardly ever.
constexpr std::array<double, 3> edges_in_diameters = {1.5, 1.5, 1.5};

/// With more axis planes than bits for them in near_wall_, they are asked as all other walls are.
constexpr std::size_t most_planes = 7;
constexpr std::uint8_t near_other_wall = 1u << most_planes;

/// A point's state is the fourth of its coordinates, so this bounds how far a move can reach.
constexpr double largest_radius_in_diameters = 8.0;

/// Accounts are kept in sixteenths of a move, and a sweep can cost such parts.
constexpr std::int32_t parts_of_move = 16;

/// No account goes beyond this, however little is relaxed.
constexpr std::int32_t deepest_in_debt = 1 << 28;

std::int32_t wrap(std::int64_t quanta) { return static_cast<std::int32_t>(static_cast<std::uint64_t>(quanta)); }
std::int32_t add(std::int32_t a, std::int32_t b) { return wrap(static_cast<std::int64_t>(a) + b); }
std::int32_t minus(std::int32_t a, std::int32_t b) { return wrap(static_cast<std::int64_t>(a) - b); }

constexpr Point nobody = {0, 0, 0, Point::empty};

double square(double value) { return value * value; }

/// An upper bound, in whole quanta, of the length of a push or step.
std::int32_t length_of(const Point& by) {
  const double squared = square(by.x) + square(by.y) + square(by.z);
  return static_cast<std::int32_t>(std::min(std::sqrt(squared), 1e9)) + 1;
}

float depth_of(const Point& push) {
  float depth;
  std::memcpy(&depth, &push.state, sizeof depth);
  return depth;
}

}  // namespace

TiledPacking::TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
                           const Container& container)
    : kernels_(&kernels::best()),
      diameter_(diameter),
      extent_(extent),
      quantum_(diameter, extent, quantum_bits),
      skin_(skin_in_diameters * diameter),
      list_capacity_(kernels::lanes) {
  // Packing checks what can be wrong with grains.
  const std::vector<Grain> checked = Packing(diameter, extent, grains).grains();
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Grain& grain : checked) {
    low = low.cwiseMin(grain.position);
    high = high.cwiseMax(grain.position);
  }
  if (checked.empty()) low = high = Vector3(0.0, 0.0, outlet);
  low.z() = std::min(low.z(), outlet);
  double cells = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis] = quantum_.snap(low[axis]);
    edge_quanta_[axis] = std::llround(edges_in_diameters[axis] * diameter / quantum_.length());
    edge_[axis] = static_cast<double>(edge_quanta_[axis]) * quantum_.length();
    per_edge_[axis] = 1.0 / edge_[axis];
    const double n = std::floor((high[axis] - low[axis]) / edge_[axis]) + 1.0;
    cells *= n;
    if (cells * capacity_ * list_capacity_ > std::numeric_limits<std::uint32_t>::max())
      throw InvalidPacking(message("grains are spread over more than ", cells, " cells of ", edge_[0], " by ", edge_[1],
                                   " by ", edge_[2], ", which is too many"));
    n_[axis] = static_cast<int>(n);
  }
  account_.assign(static_cast<std::size_t>(cells), 0);
  find_planes(container);
  lay_out(checked, container);
}

void TiledPacking::lay_out(const std::vector<Grain>& grains, const Container& container) {
  const std::size_t slots = static_cast<std::size_t>(cells()) * capacity_;
  if (slots * list_capacity_ > std::numeric_limits<std::uint32_t>::max())
    throw InvalidPacking(message("one of ", cells(), " cells holds more than ", capacity_ / 2,
                                 " grains: the packing has collapsed, or is too large"));
  points_.assign(slots, nobody);
  references_.assign(slots, nobody);
  momenta_.assign(slots, {0, 0, 0, 0});
  ids_.assign(slots, -1);
  near_wall_.assign(slots, 0);
  lists_.assign(slots * list_capacity_, 0);
  list_size_.assign(slots, 0);
  marks_.assign(slots, 0);
  path_.assign(cells(), 0);
  size_ = 0;
  for (const Grain& grain : grains) {
    const Vector3 at = grain.position - low_;
    Point point = wrapped(at);
    if (grain.held) point.state = Point::held;
    const std::uint32_t slot = place(cell_at(at), grain.id, point);
    if (slot == points_.size()) {
      capacity_ += kernels::pack;
      lay_out(grains, container);
      return;
    }
    list(slot, container);
  }
}

std::array<std::int64_t, 3> TiledPacking::quanta(const Vector3& from_low) const {
  const double per_quantum = 1.0 / quantum_.length();  // a power of two
  return {std::llrint(from_low.x() * per_quantum), std::llrint(from_low.y() * per_quantum),
          std::llrint(from_low.z() * per_quantum)};
}

Point TiledPacking::wrapped(const Vector3& from_low) const {
  const auto q = quanta(from_low);
  return {wrap(q[0]), wrap(q[1]), wrap(q[2]), Point::free};
}

TiledPacking::Cell TiledPacking::cell(std::uint32_t index) const {
  const int i = static_cast<int>(index), in_layer = i % (n_[0] * n_[1]);
  return {in_layer % n_[0], in_layer / n_[0], i / (n_[0] * n_[1])};
}

Vector3 TiledPacking::from_low(const Point& point, std::uint32_t index) const {
  const Cell at = cell(index);
  const std::int64_t x = at.x * edge_quanta_[0], y = at.y * edge_quanta_[1], z = at.z * edge_quanta_[2];
  return quantum_.length() * Vector3(static_cast<double>(x + minus(point.x, wrap(x))),
                                     static_cast<double>(y + minus(point.y, wrap(y))),
                                     static_cast<double>(z + minus(point.z, wrap(z))));
}

Grain TiledPacking::grain(std::uint32_t slot) const {
  return {ids_[slot], position(slot), points_[slot].state == Point::held};
}

int TiledPacking::cell_coordinate(double from_low, int axis) const {
  const double cell = from_low * per_edge_[axis];
  return cell < 0.0 ? 0 : cell >= n_[axis] ? n_[axis] - 1 : static_cast<int>(cell);
}

std::uint32_t TiledPacking::cell_at(const Vector3& from_low) const {
  return static_cast<std::uint32_t>((cell_coordinate(from_low.z(), 2) * n_[1] + cell_coordinate(from_low.y(), 1)) *
                                        n_[0] +
                                    cell_coordinate(from_low.x(), 0));
}

std::uint32_t TiledPacking::place(std::uint32_t cell, std::int64_t id, const Point& point) {
  for (std::uint32_t slot = cell * capacity_; slot < (cell + 1) * capacity_; ++slot) {
    if (ids_[slot] >= 0) continue;
    ids_[slot] = id;
    points_[slot] = point;
    momenta_[slot] = {0, 0, 0, 0};
    ++size_;
    return slot;
  }
  return static_cast<std::uint32_t>(points_.size());
}

void TiledPacking::vacate(std::uint32_t slot) {
  ids_[slot] = -1;
  points_[slot] = references_[slot] = nobody;
  near_wall_[slot] = 0;
  --size_;
}

void TiledPacking::find_rows(const Vector3& at, double reach, std::vector<Row>& rows) const {
  const int z0 = cell_coordinate(at.z() - reach, 2), z1 = cell_coordinate(at.z() + reach, 2);
  const int y0 = cell_coordinate(at.y() - reach, 1), y1 = cell_coordinate(at.y() + reach, 1);
  // Squared distance along one axis to a cell; the outermost cells also hold what lies beyond the grid.
  const auto gap = [this](double from_low, int cell, int axis) {
    const double before = cell == 0 ? 0.0 : cell * edge_[axis] - from_low;
    const double beyond = cell == n_[axis] - 1 ? 0.0 : from_low - (cell + 1) * edge_[axis];
    return square(std::max(0.0, std::max(before, beyond)));
  };
  for (int iz = z0; iz <= z1; ++iz) {
    const double in_layer = square(reach) - gap(at.z(), iz, 2);
    for (int iy = y0; iy <= y1; ++iy) {
      const double in_row = in_layer - gap(at.y(), iy, 1);
      if (in_row < 0.0) continue;
      const double half = std::sqrt(in_row);
      const int row = (iz * n_[1] + iy) * n_[0];
      rows.push_back({static_cast<std::uint32_t>(row + cell_coordinate(at.x() - half, 0)),
                      static_cast<std::uint32_t>(row + cell_coordinate(at.x() + half, 0) + 1)});
    }
  }
}

// ---- lists

void TiledPacking::update_lists(const Container& container) {
  const double quantum = quantum_.length();
  const auto allowed = static_cast<std::int32_t>(0.5 * skin_ / quantum);
  const double kept = part_of_half_skin * allowed;
  wandered_cells_.resize(cells());
  const std::size_t n = kernels_->find_reached(path_.data(), cells(), allowed, wandered_cells_.data());
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t cell = wandered_cells_[k], first = cell * capacity_;
    const double squared = kernels_->farthest(points_.data() + first, references_.data() + first, capacity_);
    if (squared > kept * kept)
      for (std::uint32_t slot = first; slot < first + capacity_; ++slot) {
        const Point &p = points_[slot], &r = references_[slot];
        if (square(minus(p.x, r.x)) + square(minus(p.y, r.y)) + square(minus(p.z, r.z)) <= kept * kept) continue;
        if (!relist(slot, container)) return;
      }
    path_[cell] = static_cast<std::int32_t>(std::min(1.001 * std::sqrt(squared), kept)) + 1;
  }
}

/// Lists the grain where it is now. False if its cell was full and everything has been laid out anew.
bool TiledPacking::relist(std::uint32_t slot, const Container& container) {
  const std::uint32_t cell = cell_at(from_low(points_[slot], slot / capacity_));
  if (cell != slot / capacity_) {
    const std::uint32_t to = place(cell, ids_[slot], points_[slot]);
    if (to == points_.size()) {
      capacity_ += kernels::pack;
      lay_out_anew(container);
      return false;
    }
    momenta_[to] = momenta_[slot];
    rename(slot, to);
    vacate(slot);
    slot = to;
  }
  list(slot, container);
  return true;
}

/// With the capacity of cells that is now set.
void TiledPacking::lay_out_anew(const Container& container) {
  std::vector<std::pair<Grain, Point>> all;
  all.reserve(size_);
  for (std::uint32_t slot = 0; slot < points_.size(); ++slot)
    if (ids_[slot] >= 0) all.emplace_back(grain(slot), momenta_[slot]);
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first.id < b.first.id; });
  std::vector<Grain> grains;
  for (const auto& [grain, momentum] : all) grains.push_back(grain);
  lay_out(grains, container);
  for (std::uint32_t slot = 0; slot < points_.size(); ++slot) {
    if (ids_[slot] < 0) continue;
    const auto it = std::lower_bound(all.begin(), all.end(), ids_[slot],
                                     [](const auto& a, std::int64_t id) { return a.first.id < id; });
    momenta_[slot] = it->second;
  }
}

void TiledPacking::unlist(std::uint32_t slot) {
  const std::uint32_t* own = list_of(slot);
  for (std::uint32_t k = 0; k < list_size_[slot]; ++k) remove_neighbour(own[k], slot);
  list_size_[slot] = 0;
}

/// Hands the list of one slot to another, whose own is empty.
void TiledPacking::rename(std::uint32_t from, std::uint32_t to) {
  const std::uint32_t n = list_size_[from];
  const std::uint32_t *old = list_of(from), *own = std::copy_n(old, n, list_of(to)) - n;
  for (std::uint32_t k = 0; k < n; ++k) *std::find(list_of(own[k]), list_of(own[k]) + list_size_[own[k]], from) = to;
  list_size_[to] = list_size_[from];
  list_size_[from] = 0;
}

/// Makes the list of a grain's neighbours where it is now, and brings theirs up to date. Most stay the same.
void TiledPacking::list(std::uint32_t slot, const Container& container) {
  references_[slot] = nobody;  // so that it does not find itself
  const std::size_t n = find_neighbours(slot);
  const std::uint32_t *old = list_of(slot), *end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) marks_[*j] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    if (marks_[found_[k]] == 0) add_neighbour(found_[k], slot);
    marks_[found_[k]] = 0;
  }
  old = list_of(slot);  // lists may have become longer
  end = old + list_size_[slot];
  for (const std::uint32_t* j = old; j != end; ++j) {
    if (marks_[*j] != 0) remove_neighbour(*j, slot);
    marks_[*j] = 0;
  }
  list_size_[slot] = 0;
  for (std::size_t k = 0; k < n; ++k) add_neighbour(slot, found_[k]);
  references_[slot] = points_[slot];
  mark_near_wall(slot, container);
}

/// Puts the slots of all grains with references near this grain into found_; returns how many.
std::size_t TiledPacking::find_neighbours(std::uint32_t slot) {
  const double reach = diameter_ + skin_;
  const auto reach_squared = static_cast<float>(square(reach / quantum_.length()));
  near_rows_.clear();
  find_rows(from_low(points_[slot], slot / capacity_), reach, near_rows_);
  Point centre = points_[slot];
  centre.state = Point::free;
  std::size_t found = 0;
  for (const Row& row : near_rows_) {
    const std::uint32_t first = row.first * capacity_, n = (row.last - row.first) * capacity_;
    if (found_.size() < found + n) found_.resize(found + n);
    found += kernels_->find_within(references_.data() + first, n, centre, reach_squared, first, found_.data() + found);
  }
  return found;
}

void TiledPacking::remove_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  std::uint32_t* last = list_of(slot) + --list_size_[slot];
  *std::find(list_of(slot), last, neighbour) = *last;
}

void TiledPacking::add_neighbour(std::uint32_t slot, std::uint32_t neighbour) {
  if (list_size_[slot] == list_capacity_) {
    const std::uint32_t longer = 2 * list_capacity_;
    if (longer > 128)
      throw InvalidPacking(message("a grain has more than ", list_capacity_, " neighbours: the packing has collapsed"));
    std::vector<std::uint32_t> lists(points_.size() * longer, 0);
    for (std::size_t s = 0; s < points_.size(); ++s)
      std::copy_n(lists_.begin() + static_cast<std::ptrdiff_t>(s * list_capacity_), list_size_[s],
                  lists.begin() + static_cast<std::ptrdiff_t>(s * longer));
    lists_.swap(lists);
    list_capacity_ = longer;
  }
  list_of(slot)[list_size_[slot]++] = neighbour;
}

void TiledPacking::find_planes(const Container& container) {
  constexpr std::array<std::int32_t Point::*, 3> axes = {&Point::x, &Point::y, &Point::z};
  planes_.clear();
  if (container.axis_planes().size() > most_planes) return;
  for (const AxisPlane& plane : container.axis_planes()) {
    const double touching = plane.at + (plane.grains_below ? -0.5 : 0.5) * diameter_ - low_[plane.axis];
    planes_.push_back({axes[static_cast<std::size_t>(plane.axis)], wrap(std::llrint(touching / quantum_.length())),
                       plane.grains_below});
  }
}

/// The walls that are not in planes_.
void TiledPacking::other_contacts(const Container& container, const Vector3& centre, double reach,
                                  WallContacts& contacts) const {
  if (planes_.empty())
    container.contacts(centre, reach, contacts);
  else
    container.other_contacts(centre, reach, contacts);
}

void TiledPacking::mark_near_wall(std::uint32_t slot, const Container& container) {
  // Where it was listed: the mark holds for as long as the list.
  const Vector3 at = low_ + from_low(references_[slot], slot / capacity_);
  const double reach = 0.5 * (diameter_ + skin_);
  std::uint8_t mark = 0;
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    // Not in wrapped quanta: far walls would seem near.
    const AxisPlane& plane = container.axis_planes()[k];
    if ((plane.grains_below ? plane.at - at[plane.axis] : at[plane.axis] - plane.at) < reach)
      mark |= static_cast<std::uint8_t>(1u << k);
  }
  WallContacts contacts;
  other_contacts(container, at, reach, contacts);
  if (contacts.begin() != contacts.end()) mark |= near_other_wall;
  near_wall_[slot] = mark;
}

void TiledPacking::mark_near_walls(const Container& container) {
  find_planes(container);
  for (std::uint32_t slot = 0; slot < points_.size(); ++slot)
    if (ids_[slot] >= 0) mark_near_wall(slot, container);
}

// ---- moves

/// Charges the cells of a row with a move of this length; is one of them at the limit?
bool TiledPacking::charge(const Row& row, std::int32_t path, std::int32_t limit) {
  bool reached = false;
  for (std::uint32_t cell = row.first; cell < row.last; ++cell) {
    account_[cell] = std::min(account_[cell] + parts_of_move, deepest_in_debt);
    path_[cell] += path;
    reached |= path_[cell] > limit;
  }
  return reached;
}

void TiledPacking::require_radius(double radius, double diameter) {
  if (!(radius < largest_radius_in_diameters * diameter))
    throw InvalidParameter(message("spot radius is ", radius, " but must be below ", largest_radius_in_diameters,
                                   " grain diameters of ", diameter));
}

void TiledPacking::displace(const std::vector<Move>& moves, double radius, double influence, const Container& container,
                            Workers& workers, std::vector<int>& moved) {
  require_radius(radius, diameter_);
  const double quantum = quantum_.length();
  const auto radius_squared = static_cast<float>(square(radius / quantum));
  moved.assign(moves.size(), 0);
  middles_.clear();
  steps_.clear();
  std::int32_t longest = 0;
  for (const Move& move : moves) {
    middles_.push_back(wrapped(move.middle - low_));
    steps_.push_back(wrapped(-influence * move.weight * move.step));
    longest = std::max(longest, length_of(steps_.back()));
  }
  const double leeway = std::max(leeway_in_diameters * diameter_, 2.0 * longest * quantum);
  const double reach = radius + 0.5 * skin_ + leeway;
  const auto limit = static_cast<std::int32_t>((0.5 * skin_ + leeway) / quantum) - longest;
  rows_.clear();
  end_of_rows_.clear();
  std::size_t first = 0;
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const std::size_t first_row = rows_.size();
    find_rows(moves[m].middle - low_, reach, rows_);
    end_of_rows_.push_back(rows_.size());
    bool look = false;
    for (std::size_t r = first_row; r < rows_.size(); ++r) look |= charge(rows_[r], length_of(steps_[m]), limit);
    if (!look) continue;
    apply_moves(first, m + 1, radius_squared, workers, moved);
    update_lists(container);
    first = m + 1;
  }
  apply_moves(first, moves.size(), radius_squared, workers, moved);
  update_lists(container);
}

void TiledPacking::apply_moves(std::size_t first, std::size_t last, float radius_squared, Workers& workers,
                               std::vector<int>& moved) {
  // A worker owns some layers of the grid, and applies all moves in them, in order.
  const auto per_layer = static_cast<std::uint32_t>(n_[0] * n_[1]);
  const auto n = static_cast<std::uint32_t>(workers.size());
  moved_by_.resize(n);
  workers.run([&](int worker) {
    const auto w = static_cast<std::uint32_t>(worker);
    std::vector<int>& counts = moved_by_[w];
    counts.assign(last - first, 0);
    for (std::size_t m = first; m < last; ++m)
      for (std::size_t r = m == 0 ? 0 : end_of_rows_[m - 1]; r < end_of_rows_[m]; ++r) {
        const Row& row = rows_[r];
        if (n > 1 && row.first / per_layer % n != w) continue;
        counts[m - first] +=
            kernels_->displace(points_.data() + row.first * capacity_, (row.last - row.first) * capacity_, middles_[m],
                               radius_squared, steps_[m]);
      }
  });
  for (const std::vector<int>& counts : moved_by_)
    for (std::size_t m = first; m < last; ++m) moved[m] += counts[m - first];
}

// ---- sweeps

std::size_t TiledPacking::sweep(const RelaxationParameters& parameters, double due, double deepest,
                                const Container& container, Workers& workers) {
  const auto parts = static_cast<std::int32_t>(std::min(due, 1e6) * parts_of_move);
  due_cells_.resize(cells());
  const std::size_t n = kernels_->find_reached(account_.data(), cells(), parts, due_cells_.data());
  if (n == 0) return 0;
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
  std::size_t swept = 0;
  for (const Share& share : shares_) swept += share.active.size();
  return swept;
}

void TiledPacking::collect(Share& share) const {
  const std::size_t slots = static_cast<std::size_t>(share.last - share.first) * capacity_;
  share.active.resize(slots);
  share.walled.resize(slots);
  share.in_cell.clear();
  std::uint32_t n = 0, walled = 0;
  for (std::uint32_t k = share.first; k < share.last; ++k) {
    const std::uint32_t before = n, first = due_cells_[k] * capacity_;
    for (std::uint32_t slot = first; slot < first + capacity_; ++slot) {
      const bool active = points_[slot].state == Point::free;
      share.walled[walled] = n;
      walled += active && near_wall_[slot] != 0 ? 1 : 0;
      share.active[n] = slot;
      n += active ? 1 : 0;
    }
    share.in_cell.push_back(static_cast<std::uint8_t>(n - before));
  }
  share.active.resize(n);
  share.walled.resize(walled);
}

void TiledPacking::push_apart(Share& share, const RelaxationParameters& parameters, const Container& container) const {
  collect(share);
  share.pushes.resize(share.active.size());
  const double diameter = diameter_ / quantum_.length();
  kernels_->push_off_neighbours(
      points_.data(), share.active.data(), share.active.size(), {lists_.data(), list_size_.data(), list_capacity_},
      {static_cast<float>(1.0 / (diameter * diameter)), static_cast<float>(parameters.pair_share())},
      share.pushes.data());
  part_coincident(share, parameters.pair_share() * diameter_);
  push_off_planes(share, static_cast<float>(parameters.fixed_share()));
  if (container.concurrent()) push_off_other_walls(share, parameters.fixed_share(), container);
}

/// Centres that coincide have no line between them; part them along x, by id so that both agree.
void TiledPacking::part_coincident(Share& share, double by) const {
  for (std::size_t k = 0; k < share.active.size(); ++k) {
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

void TiledPacking::push_off_planes(Share& share, float strength) const {
  for (const std::uint32_t k : share.walled) {
    const std::uint32_t slot = share.active[k];
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      if ((near_wall_[slot] >> p & 1u) == 0) continue;
      const TouchingPlane& plane = planes_[p];
      const std::int32_t beyond = minus(points_[slot].*plane.axis, plane.at);
      if (plane.grains_below ? beyond > 0 : beyond < 0)
        share.pushes[k].*plane.axis -= static_cast<std::int32_t>(strength * static_cast<float>(beyond));
    }
  }
}

void TiledPacking::push_off_other_walls(Share& share, double strength, const Container& container) const {
  const double radius = 0.5 * diameter_;
  WallContacts contacts;
  for (const std::uint32_t k : share.walled) {
    if ((near_wall_[share.active[k]] & near_other_wall) == 0) continue;
    other_contacts(container, position(share.active[k]), radius, contacts);
    for (const WallContact& contact : contacts)
      push(share.pushes[k], strength * (radius - contact.distance) * contact.normal);
  }
}

void TiledPacking::apply(const Share& share, int due, float deepest, float momentum) {
  std::size_t k = 0;
  for (std::uint32_t c = share.first; c < share.last; ++c) {
    const std::uint32_t cell = due_cells_[c], n = share.in_cell[c - share.first];
    const kernels::Corrections corrections = kernels_->correct(points_.data(), momenta_.data(), share.active.data() + k,
                                                               n, share.pushes.data() + k, momentum);
    k += n;
    account_[cell] -= due;
    if (corrections.depth > deepest) account_[cell] = std::max(account_[cell], due);
    // A little more than it may be, for the rounding.
    path_[cell] += static_cast<std::int32_t>(std::min(1.001f * std::sqrt(corrections.longest_squared), 1e9f)) + 1;
  }
}

// ---- the rest

void TiledPacking::visit_grains(const std::function<void(const Grain&)>& visit) const {
  for (std::uint32_t slot = 0; slot < points_.size(); ++slot)
    if (ids_[slot] >= 0) visit(grain(slot));
}

void TiledPacking::take_out_below(double outlet, std::vector<Grain>& drained) {
  const int layers = cell_coordinate(outlet - low_.z() + skin_, 2) + 1;
  const std::uint32_t last = static_cast<std::uint32_t>(layers * n_[1] * n_[0]) * capacity_;
  for (std::uint32_t slot = 0; slot < last; ++slot) {
    if (points_[slot].state != Point::free || position(slot).z() >= outlet) continue;
    drained.push_back(grain(slot));
    unlist(slot);
    vacate(slot);
  }
}

Overlap TiledPacking::largest_overlap() const {
  Overlap largest;
  double least = square(diameter_ / quantum_.length());
  for (std::uint32_t i = 0; i < points_.size(); ++i)
    for (std::uint32_t k = 0; k < list_size_[i]; ++k) {
      const std::uint32_t j = lists_[static_cast<std::size_t>(i) * list_capacity_ + k];
      const Point &a = points_[i], &b = points_[j];
      const double squared = square(minus(a.x, b.x)) + square(minus(a.y, b.y)) + square(minus(a.z, b.z));
      if (squared >= least) continue;
      least = squared;
      largest = {1.0 - std::sqrt(squared) * quantum_.length() / diameter_, std::min(ids_[i], ids_[j]),
                 std::max(ids_[i], ids_[j])};
    }
  return largest;
}

std::size_t TiledPacking::memory() const {
  return points_.capacity() * (3 * sizeof(Point) + sizeof(std::int64_t) + 3) +
         lists_.capacity() * sizeof(std::uint32_t) + account_.capacity() * 2 * sizeof(std::int32_t);
}

}  // namespace spot
