// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/tiled_packing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "packing/kernel_builds.hpp"
#include "packing/packed_grain.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// Positions in 32 bits reach 128 d at least before they wrap around; overlaps that matter are ten thousand quanta.
constexpr int quantum_bits = 24;

/// Lists cover this shell around the diameter. Thicker means longer lists, thinner means listing anew more often.
constexpr double skin_in_diameters = 0.5;

/// Edges of a cell, as long as lists reach: in a dense packing it holds 3.7 grains, and nine hardly ever.
constexpr std::array<double, 3> edges_in_diameters = {1.5, 1.5, 1.5};

}  // namespace

TiledPacking::TiledPacking(double diameter, double extent, std::shared_ptr<Communicator> communicator)
    : kernels_(&kernels::best()),
      diameter_(diameter),
      extent_(extent),
      quantum_(diameter, extent, quantum_bits),
      skin_(skin_in_diameters * diameter),
      list_capacity_(kernels::lanes),
      communicator_(std::move(communicator)) {
  set_edges();
}

TiledPacking::TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
                           const Container& container, std::shared_ptr<Communicator> communicator)
    : TiledPacking(diameter, extent, std::move(communicator)) {
  // Packing checks what can be wrong with grains.
  const std::vector<Grain> checked = Packing(diameter, extent, grains).grains();
  constexpr double far = std::numeric_limits<double>::max();
  std::vector<double> box(6, far);  // lowest coordinates, and the highest with the other sign
  box[2] = outlet;
  for (const Grain& grain : checked)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = grain.position[static_cast<Eigen::Index>(axis)];
      box[axis] = std::min(box[axis], at);
      box[axis + 3] = std::min(box[axis + 3], -at);
    }
  box = communicator_->least(box);
  if (box[0] == far) box = {0.0, 0.0, outlet, 0.0, 0.0, -outlet};
  set_grid({box[0], box[1], box[2]}, {-box[3], -box[4], -box[5]});
  std::vector<std::int64_t> in_layer(static_cast<std::size_t>(n_[2]), 0);
  for (const Grain& grain : checked) ++in_layer[static_cast<std::size_t>(layer(grain.position.z()))];
  set_slabs(Slabs(communicator_->sum(in_layer), communicator_->size()));
  for (const Grain& grain : take_own(checked)) {
    const Vector3 at = grain.position - low_;
    Point point = wrapped(at);
    if (grain.held) point.state = Point::held;
    const Place place = ensure_room(cell_at(at));
    occupy(slot(place), grain.id, point, point);
  }
  list_all(container);
}

// ---- the grid

void TiledPacking::set_edges() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    edge_quanta_[axis] = std::llround(edges_in_diameters[axis] * diameter_ / quantum_.length());
    edge_[axis] = static_cast<double>(edge_quanta_[axis]) * quantum_.length();
    per_edge_[axis] = 1.0 / edge_[axis];
  }
}

void TiledPacking::set_grid(const Vector3& low, const Vector3& high) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    low_[axis] = quantum_.snap(low[axis]);
    const double n = std::floor((high[axis] - low[axis]) / edge_[a]) + 1.0;
    if (n > std::numeric_limits<std::int32_t>::max())
      throw InvalidPacking(
          message("grains are spread over ", n, " cells of ", edge_[a], " along ", "xyz"[axis], ", which is too many"));
    n_[a] = static_cast<int>(n);
  }
}

/// Makes room for this rank's layers, which are empty.
void TiledPacking::set_slabs(const Slabs& slabs) {
  slabs_ = slabs;
  const int first = slabs_.first(communicator_->rank()), layers = rank_layers();
  border_ = {layers > 0 && first > 0 ? 1 : 0, layers > 0 && first + layers < n_[2] ? 1 : 0};
  first_layer_ = first - border_[0];
  const double cells = (static_cast<double>(layers) + border_[0] + border_[1]) * n_[0] * n_[1];
  if (cells * capacity_ * list_capacity_ > std::numeric_limits<std::uint32_t>::max())
    throw InvalidPacking(message("grains are spread over more than ", cells, " cells of ", edge_[0], " by ", edge_[1],
                                 " by ", edge_[2], ", which is too many"));
  const auto slots = static_cast<std::size_t>(cells) * capacity_;
  account_.assign(static_cast<std::size_t>(cells), 0);
  path_.assign(static_cast<std::size_t>(cells), 0);
  cell_near_wall_.assign(static_cast<std::size_t>(cells), 0);
  points_.assign(slots, nobody);
  references_.assign(slots, nobody);
  momenta_.assign(slots, {0, 0, 0, 0});
  ids_.assign(slots, -1);
  near_wall_.assign(slots, 0);
  lists_.assign(slots * list_capacity_, 0);
  list_size_.assign(slots, 0);
  marks_.assign(slots, 0);
  work_.assign(static_cast<std::size_t>(layers), 0);
  cells_reached_.assign(static_cast<std::size_t>(layers), 1);
  changed_ = {};
  size_ = 0;
}

/// Of the grains that all ranks bring together, those in this rank's layers.
std::vector<Grain> TiledPacking::take_own(const std::vector<Grain>& grains) const {
  std::vector<Bytes> outgoing(static_cast<std::size_t>(communicator_->size()));
  for (const Grain& grain : grains) append(outgoing[static_cast<std::size_t>(owner(grain.position.z()))], grain);
  std::vector<Grain> own;
  for (const Bytes& bytes : communicator_->exchange(std::move(outgoing)))
    for (ByteReader reader(bytes); !reader.at_end();) own.push_back(take_grain(reader));
  return own;
}

std::pair<int, int> TiledPacking::reached(double height, double radius) const {
  const double reach = reach_of_move(radius);
  return {owner(height - reach), owner(height + reach)};
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
  return {in_layer % n_[0], in_layer / n_[0], i / (n_[0] * n_[1]) + first_layer_};
}

Vector3 TiledPacking::from_low(const Point& point, const Cell& at) const {
  const std::int64_t x = at.x * edge_quanta_[0], y = at.y * edge_quanta_[1], z = at.z * edge_quanta_[2];
  return quantum_.length() * Vector3(static_cast<double>(x + minus(point.x, wrap(x))),
                                     static_cast<double>(y + minus(point.y, wrap(y))),
                                     static_cast<double>(z + minus(point.z, wrap(z))));
}

Grain TiledPacking::grain(std::uint32_t slot) const {
  return {ids_[slot], position(slot), points_[slot].state == Point::held, 0.5 * diameter_};
}

int TiledPacking::cell_coordinate(double from_low, int axis) const {
  const double cell = from_low * per_edge_[axis];
  return cell < 0.0 ? 0 : cell >= n_[axis] ? n_[axis] - 1 : static_cast<int>(cell);
}

/// In a layer that this rank holds.
std::uint32_t TiledPacking::cell_at(const Vector3& from_low) const {
  const int z = cell_coordinate(from_low.z(), 2) - first_layer_;
  return static_cast<std::uint32_t>((z * n_[1] + cell_coordinate(from_low.y(), 1)) * n_[0] +
                                    cell_coordinate(from_low.x(), 0));
}

/// Adds the rows of cells within reach in the layers from `first` to `last`, exclusive.
void TiledPacking::find_rows(const Vector3& at, double reach, int first, int last, std::vector<Row>& rows) const {
  const int z0 = std::max(first, cell_coordinate(at.z() - reach, 2));
  const int z1 = std::min(last - 1, cell_coordinate(at.z() + reach, 2));
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
      const int row = ((iz - first_layer_) * n_[1] + iy) * n_[0];
      rows.push_back({static_cast<std::uint32_t>(row + cell_coordinate(at.x() - half, 0)),
                      static_cast<std::uint32_t>(row + cell_coordinate(at.x() + half, 0) + 1)});
    }
  }
}

// ---- slots

void TiledPacking::occupy(std::uint32_t slot, std::int64_t id, const Point& point, const Point& reference) {
  ids_[slot] = id;
  points_[slot] = point;
  references_[slot] = reference;
  momenta_[slot] = {0, 0, 0, 0};
  if (owned(slot / capacity_)) ++size_;
  if (point.state != Point::free && point.state != Point::held)
    falling_.push_back({slot / capacity_, slot % capacity_});
  note_change(slot);
}

void TiledPacking::vacate(std::uint32_t slot) {
  ids_[slot] = -1;
  points_[slot] = references_[slot] = nobody;
  near_wall_[slot] = 0;
  if (owned(slot / capacity_)) --size_;
  note_change(slot);
}

/// An empty place in a cell; if there is none, all cells are made larger, and slots change.
TiledPacking::Place TiledPacking::ensure_room(std::uint32_t cell) {
  std::uint32_t k = 0;
  while (k < capacity_ && ids_[cell * capacity_ + k] >= 0) ++k;
  if (k == capacity_) set_capacity(capacity_ + kernels::pack);
  return {cell, k};
}

void TiledPacking::set_capacity(std::uint32_t capacity) {
  const std::size_t slots = static_cast<std::size_t>(cells()) * capacity;
  if (slots * list_capacity_ > std::numeric_limits<std::uint32_t>::max())
    throw InvalidPacking(message("one of ", cells(), " cells holds more than ", capacity_,
                                 " grains: the packing has collapsed, or is too large"));
  const auto moved = [&](std::uint32_t slot) { return slot / capacity_ * capacity + slot % capacity_; };
  const auto spread = [&](auto& values, const auto& empty, std::size_t each) {
    auto old = std::move(values);
    values.assign(slots * each, empty);
    for (std::uint32_t slot = 0; slot < cells() * capacity_; ++slot)
      std::copy_n(old.begin() + static_cast<std::ptrdiff_t>(slot * each), each,
                  values.begin() + static_cast<std::ptrdiff_t>(moved(slot) * each));
  };
  for (std::uint32_t& neighbour : lists_) neighbour = moved(neighbour);
  spread(lists_, 0u, list_capacity_);
  spread(list_size_, std::uint8_t{0}, 1);
  spread(points_, nobody, 1);
  spread(references_, nobody, 1);
  spread(momenta_, Point{0, 0, 0, 0}, 1);
  spread(ids_, std::int64_t{-1}, 1);
  spread(near_wall_, std::uint8_t{0}, 1);
  marks_.assign(slots, 0);
  capacity_ = capacity;
}

// ---- the rest

void TiledPacking::visit_grains(const std::function<void(const Grain&)>& visit) const {
  for (std::uint32_t index = first_owned(); index < last_owned(); ++index) {
    const Cell at = cell(index);
    for (std::uint32_t slot = index * capacity_; slot < (index + 1) * capacity_; ++slot)
      if (ids_[slot] >= 0)
        visit({ids_[slot], low_ + from_low(points_[slot], at), points_[slot].state == Point::held, 0.5 * diameter_});
  }
}

void TiledPacking::take_out_below(double outlet, std::vector<Grain>& drained) {
  const int layers = std::clamp(layer(outlet + skin_) + 1 - first_layer_ - border_[0], 0, rank_layers());
  const std::uint32_t first = first_owned() * capacity_;
  const std::uint32_t last = first + static_cast<std::uint32_t>(layers) * cells_in_layer() * capacity_;
  for (std::uint32_t slot = first; slot < last; ++slot) {
    if (points_[slot].state != Point::free || position(slot).z() >= outlet) continue;
    drained.push_back(grain(slot));
    unlist(slot);
    vacate(slot);
  }
}

/// The kernel tells how deep each grain overlaps any other, in single precision; only those that may be the deepest so
/// far are looked at closely.
Overlap TiledPacking::largest_overlap() const {
  constexpr std::uint32_t at_a_time = 1024;
  constexpr double precision = 1e-5;
  const double diameter = diameter_ / quantum_.length(), per_square = 1.0 / square(diameter);
  std::array<std::uint32_t, at_a_time + kernels::ahead> grains{};
  std::array<Point, at_a_time> pushes;
  Overlap largest;
  double least = square(diameter);
  for (std::uint32_t slot = first_owned() * capacity_, end = last_owned() * capacity_; slot < end;) {
    std::uint32_t n = 0;
    for (; slot < end && n < at_a_time; ++slot)
      if (ids_[slot] >= 0) grains[n++] = slot;
    kernels_->push_off_neighbours(points_.data(), grains.data(), n, {lists_.data(), list_size_.data(), list_capacity_},
                                  {static_cast<float>(per_square), 0.0f, 0.0f}, pushes.data());
    for (std::uint32_t k = 0; k < n; ++k)
      if (depth_of(pushes[k]) > 1.0 - least * per_square - precision) find_larger_overlap(grains[k], least, largest);
  }
  return largest;
}

/// `least`: the squared distance, in quanta, of the two grains with the largest overlap.
void TiledPacking::find_larger_overlap(std::uint32_t slot, double& least, Overlap& largest) const {
  for (std::uint32_t k = 0; k < list_size_[slot]; ++k) {
    const std::uint32_t other = lists_[static_cast<std::size_t>(slot) * list_capacity_ + k];
    const double squared = squared_distance(points_[slot], points_[other]);
    if (squared >= least) continue;
    least = squared;
    largest = {1.0 - std::sqrt(squared) * quantum_.length() / diameter_, std::min(ids_[slot], ids_[other]),
               std::max(ids_[slot], ids_[other])};
  }
}

std::size_t TiledPacking::memory() const {
  std::size_t bytes = bytes_in(points_, references_, momenta_, ids_, near_wall_, cell_near_wall_, lists_, list_size_,
                               marks_, account_, path_, work_, loosened_, falling_, laid_, middles_, steps_, shares_,
                               received_, wandered_cells_, due_cells_, wandered_, findings_, parts_, cells_reached_);
  for (const Part& part : parts_) bytes += bytes_in(part.rows, part.end_of_rows, part.shares);
  for (const Finding& finding : findings_) bytes += bytes_in(finding.found, finding.ends, finding.rows);
  for (const Task& task : tasks_)
    bytes += bytes_in(task.active, task.in_cell, task.walled, task.pushes, task.corrections);
  return bytes;
}

}  // namespace spot
