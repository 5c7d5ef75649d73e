// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/recirculation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "spot/base/errors.hpp"
#include "spot/base/random.hpp"
#include "spot/drivers/drainage.hpp"

namespace spot {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Places that are drawn for a grain before there is none; and to see whether an inlet has any room.
constexpr int most_attempts = 1024, places_to_try = 8192;

/// Between a grain that comes in and all others, in diameters.
constexpr double gap = 0.01;

/// What has drained on all ranks, in increasing order of ids.
std::vector<Grain> of_all_ranks(const std::vector<Grain>& own, Communicator& communicator) {
  struct Sent {
    std::int64_t id;
    double radius;
  };
  std::vector<Sent> sent;
  for (const Grain& grain : own) sent.push_back({grain.id, grain.radius});
  Bytes bytes;
  append(bytes, sent);
  std::vector<Grain> all;
  for (const Bytes& of_one : communicator.share_with_all(bytes))
    for (const Sent& grain : ByteReader(of_one).take_all<Sent>())
      all.push_back({grain.id, Vector3::Zero(), false, grain.radius});
  std::sort(all.begin(), all.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return all;
}

/// What other grains leave of a place drawn for a grain.
class Room {
 public:
  Room(const Grain& grain, double diameter, const Periodic& periodic, bool above)
      : at_(grain.position),
        radius_(radius_in(diameter, grain)),
        gap_(gap * diameter),
        periodic_(periodic),
        above_(above) {}

  /// Counts another grain.
  void add(const Vector3& other, double radius) {
    Vector3 apart = periodic_.nearest(Vector3(at_ - other));
    const double least = radius_ + radius + gap_, squared = least * least;
    if (above_) apart.z() = 0.0;
    const double distance = apart.squaredNorm();
    if (distance >= squared) return;
    height_ = std::max(height_, above_ ? other.z() + std::sqrt(squared - distance) : infinite);
  }

  double x() const { return at_.x(); }

  /// At which the place is free, at the lowest, as far as was counted.
  double height() const { return height_; }

 private:
  Vector3 at_;
  double radius_, gap_;
  const Periodic& periodic_;
  bool above_;
  double height_ = -infinite;
};

/// Rooms in increasing order of x, so that a grain meets those only that it may be in.
class RoomsByX {
 public:
  /// `reach`: at least of the largest grain to a room that it is in.
  RoomsByX(std::vector<Room>& rooms, double reach, const Periodic& periodic) : reach_(reach) {
    for (Room& room : rooms) {
      by_x_.push_back({room.x(), &room});
      if (!periodic.along(0)) continue;
      for (const double period : {-periodic.length(0), periodic.length(0)}) by_x_.push_back({room.x() + period, &room});
    }
    std::sort(by_x_.begin(), by_x_.end(), [](const Entry& a, const Entry& b) { return a.x < b.x; });
  }

  void add(const Grain& grain, double radius) {
    const double x = grain.position.x();
    auto entry =
        std::lower_bound(by_x_.begin(), by_x_.end(), x - reach_, [](const Entry& e, double at) { return e.x < at; });
    for (; entry != by_x_.end() && entry->x <= x + reach_; ++entry) entry->room->add(grain.position, radius);
  }

 private:
  struct Entry {
    double x;
    Room* room;
  };
  double reach_;
  std::vector<Entry> by_x_;
};

/// Counts the grains of all ranks. Returns the height of each room, and last that of the bed.
std::vector<double> free_heights(const Drainage& drainage, std::vector<Room>& rooms, double diameter,
                                 const Periodic& periodic, Communicator& communicator) {
  double highest = -infinite;
  RoomsByX by_x(rooms, (1.0 + 2.0 * gap) * diameter, periodic);
  drainage.visit_grains([&](const Grain& grain) {
    by_x.add(grain, radius_in(diameter, grain));
    highest = std::max(highest, grain.position.z() + diameter);
  });
  std::vector<double> heights;
  for (const Room& room : rooms) heights.push_back(-room.height());
  heights.push_back(-highest);
  heights = communicator.least(heights);
  for (double& height : heights) height = -height;
  return heights;
}

}  // namespace

Recirculation::Recirculation(std::uint64_t seed, Inlet inlet, std::shared_ptr<const Container> container,
                             double diameter)
    : seed_(seed), inlet_(std::move(inlet)), container_(std::move(container)), diameter_(diameter) {
  for (int k = 0; k < places_to_try; ++k)
    if (fits(draw(k, 0, 0), 0.5 * diameter_)) return;
  throw InvalidContainer(message(inlet_.name, " has no place inside the walls that a grain of diameter ", diameter_,
                                 " fits into: none of ", places_to_try, " that were drawn"));
}

Vector3 Recirculation::draw(std::int64_t grain, std::int64_t time, int attempt) const {
  const auto numbers = uniform(seed_, RandomPurpose::recirculation, static_cast<std::uint64_t>(grain),
                               static_cast<std::uint64_t>(time) * most_attempts + static_cast<std::uint64_t>(attempt));
  return inlet_.low + Vector3(numbers[0], numbers[1], numbers[2]).cwiseProduct(inlet_.high - inlet_.low);
}

bool Recirculation::fits(const Vector3& place, double radius) const {
  if (place.z() > inlet_.high.z() || !container_->contains(place)) return false;
  if (inlet_.contains && !inlet_.contains(place)) return false;
  WallContacts walls;
  container_->contacts(place, radius, walls);
  return walls.begin() == walls.end();
}

/// In rounds, in each of which every grain that waits draws a place. Of two that draw the same, that with the lower id
/// gets it, or the lower one.
std::vector<Grain> Recirculation::place_all(const Drainage& drainage, std::vector<Grain> waiting, std::int64_t time,
                                            Communicator& communicator) const {
  const Periodic periodic = container_->periodic().on(drainage.quantum());
  std::vector<Grain> placed;
  for (int attempt = 0; attempt < most_attempts && !waiting.empty(); ++attempt) {
    std::vector<Room> rooms;
    for (Grain& grain : waiting) {
      grain.position = draw(grain.id, time, attempt);
      rooms.emplace_back(grain, diameter_, periodic, inlet_.on_surface);
    }
    const std::vector<double> heights = free_heights(drainage, rooms, diameter_, periodic, communicator);
    std::vector<Grain> left;
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      Grain grain = waiting[k];
      const double radius = radius_in(diameter_, grain);
      for (const Grain& other : placed) rooms[k].add(other.position, radius_in(diameter_, other));
      const double height = std::max(heights[k], rooms[k].height());
      if (inlet_.on_surface) {
        // Where the bed has a hole down to the walls, from as high as it is elsewhere.
        const double top = std::max(heights.back(), container_->outlets().height() + diameter_);
        grain.position.z() = height > -infinite ? height : top;
      }
      for (double& at : grain.position) at = drainage.quantum().snap(at);
      grain.position = periodic.wrap(grain.position);
      const bool free = inlet_.on_surface || height == -infinite;
      (free && fits(grain.position, radius) ? placed : left).push_back(grain);
    }
    waiting.swap(left);
  }
  if (waiting.empty()) return placed;
  throw InvalidPacking(message(inlet_.name, " has no free place for grain ", waiting[0].id,
                               ", which has drained: ", most_attempts, " were drawn"));
}

void Recirculation::put_back(Drainage& drainage, const std::vector<Grain>& drained, std::int64_t time,
                             Communicator& communicator) const {
  const std::vector<Grain> all = of_all_ranks(drained, communicator);
  if (all.empty()) return;
  GrainChanges changes;
  for (const Grain& grain : place_all(drainage, all, time, communicator))
    if (grain.id % communicator.size() == communicator.rank()) changes.come.push_back(grain);
  drainage.change_grains(changes);
}

}  // namespace spot
