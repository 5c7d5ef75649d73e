// SPDX-License-Identifier: GPL-2.0-or-later
// The algorithm of the tiled packing, obvious and slow: no cells, no lists, no wrapped coordinates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "spot/base/quantum.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/packing/packing.hpp"
#include "spot/walk/nonaffine_motion.hpp"
#include "spot/walk/parameters.hpp"

namespace scenes {

class PlainPacking {
 public:
  /// Places in quanta from the lowest corner, which TiledPacking counts from, too: it decides how the middles of moves
  /// are rounded.
  using Place = std::array<std::int64_t, 3>;

  PlainPacking(double diameter, double extent, double outlet, const std::vector<spot::Grain>& grains,
               const spot::Container& container)
      : diameter_(diameter), quantum_(diameter, extent, 24), container_(container) {
    const auto checked = spot::Packing(diameter, extent, grains, container.periodic()).grains();
    low_ = checked.empty() ? spot::Vector3(0.0, 0.0, outlet) : checked[0].position;
    for (const spot::Grain& grain : checked) low_ = low_.cwiseMin(grain.position);
    low_.z() = std::min(low_.z(), outlet);
    for (double& coordinate : low_) coordinate = quantum_.snap(coordinate);
    periodic_ = container.periodic().on(quantum_);
    for (int axis = 0; axis < 2; ++axis) {
      if (!periodic_.along(axis)) continue;
      low_[axis] = periodic_.low(axis);
      period_[static_cast<std::size_t>(axis)] = std::llround(periodic_.length(axis) / quantum_.length());
    }
    for (const spot::Grain& grain : checked) {
      bodies_.push_back({grain.id, grain.held, quanta(grain.position - low_), {0, 0, 0}, grain.radius});
      unequal_ = unequal_ || grain.radius != 0.5 * diameter;
    }
  }

  /// Of all grains in a move, in parts.
  int shares(const spot::Move& move, const spot::SpotParameters& spots) const {
    int sum = 0;
    for (const Body& body : bodies_)
      sum +=
          static_cast<int>(share(body, move, spots) * static_cast<float>(spot::volume_parts(diameter_, body.radius)));
    return sum;
  }

  /// At the start of a window, where grains go against their neighbours.
  void draw_tilts(const spot::SpotParameters& spots) {
    const spot::NonaffineMotion motion(spots);
    for (Body& body : bodies_) {
      body.tilt = {};
      if (motion.on()) motion.update(body.tilt, body.id, position(body).z());
    }
  }

  void displace(const spot::Move& move, const spot::SpotParameters& spots) {
    const Place by = quanta(-spots.influence * move.weight * move.step);
    for (Body& body : bodies_) {
      if (within(body, move, spots)) ++received[body.id];
      const float part = share(body, move, spots);
      const float unit = static_cast<float>(spot::NonaffineMotion(spots).unit()) * static_cast<float>(std::abs(by[2]));
      const std::array<std::int16_t, 3> tilt = {body.tilt.x, body.tilt.y, body.tilt.z};
      for (std::size_t axis = 0; axis < 3; ++axis)
        body.at[axis] +=
            static_cast<std::int64_t>(part * (static_cast<float>(by[axis]) + unit * static_cast<float>(tilt[axis])));
    }
  }

  spot::MovesReceived received;

  /// Over all grains that are not held.
  void sweep(const spot::RelaxationParameters& parameters) {
    sweep(parameters, [](std::int64_t) { return true; });
  }

  /// Over those of them for which is_swept(id) holds.
  template <typename IsSwept>
  void sweep(const spot::RelaxationParameters& parameters, const IsSwept& is_swept) {
    for (Body& body : bodies_) body.swept = !body.held && is_swept(body.id);
    std::vector<Place> pushes;
    for (const Body& body : bodies_) pushes.push_back(body.swept ? push_on(body, parameters) : Place{0, 0, 0});
    const auto momentum = static_cast<float>(parameters.momentum);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!bodies_[i].swept) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto carried = static_cast<std::int64_t>(momentum * static_cast<float>(bodies_[i].last[axis]));
        bodies_[i].last[axis] = pushes[i][axis] + carried;
        bodies_[i].at[axis] += bodies_[i].last[axis];
      }
    }
  }

  std::vector<spot::Grain> take_out_below(double outlet) {
    std::vector<spot::Grain> out;
    for (std::size_t i = bodies_.size(); i-- > 0;) {
      if (bodies_[i].held || position(bodies_[i]).z() >= outlet) continue;
      out.push_back(grain(bodies_[i]));
      bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return out;
  }

  /// In increasing order of ids.
  std::vector<spot::Grain> grains() const {
    std::vector<spot::Grain> all;
    for (const Body& body : bodies_) all.push_back(grain(body));
    return all;
  }

 private:
  struct Body {
    std::int64_t id;
    bool held;
    Place at, last;
    double radius;
    bool swept = false;
    spot::NonaffineMotion::Tilt tilt{};
  };

  float squared_distance(const Body& body, const spot::Move& move) const {
    const Place middle = quanta(move.middle - low_);
    const auto [x, y, z] = differences(body.at, middle);
    return (x * x + y * y) + z * z;
  }

  bool within(const Body& body, const spot::Move& move, const spot::SpotParameters& spots) const {
    const double radius = spots.radius / quantum_.length();
    return !body.held && squared_distance(body, move) <= static_cast<float>(radius * radius);
  }

  /// Of a grain, in a move.
  float share(const Body& body, const spot::Move& move, const spot::SpotParameters& spots) const {
    if (body.held) return 0.0f;
    const double radius_squared = (spots.radius / quantum_.length()) * (spots.radius / quantum_.length());
    const bool uniform = spots.profile == spot::InfluenceProfile::uniform;
    const float per_square = uniform ? 1.0f : static_cast<float>(1.0 / radius_squared);
    const float part = (static_cast<float>(radius_squared) - squared_distance(body, move)) * per_square;
    return std::min(std::max(part, 0.0f), 1.0f);
  }

  Place quanta(const spot::Vector3& length) const {
    const spot::Vector3 q = length / quantum_.length();
    return {std::llrint(q.x()), std::llrint(q.y()), std::llrint(q.z())};
  }
  /// To the nearest image.
  std::array<float, 3> differences(const Place& a, const Place& b) const {
    std::array<float, 3> apart{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int64_t difference = a[axis] - b[axis];
      const std::int64_t period = period_[axis];
      while (period > 0 && 2 * difference > period) difference -= period;
      while (period > 0 && 2 * difference < -period) difference += period;
      apart[axis] = static_cast<float>(difference);
    }
    return apart;
  }
  /// 1 - r^2 / p^2, p being how far grains are apart that are left alone.
  float overlap(float squared, const Body& a, const Body& b, double contact_overlap) const {
    const double parted = (1.0 - contact_overlap) * diameter_ / quantum_.length();
    if (!unequal_) return 1.0f - squared * static_cast<float>(1.0 / (parted * parted));
    const auto in_quanta = [&](const Body& body) { return static_cast<float>(body.radius / quantum_.length()); };
    const float apart = (in_quanta(a) + in_quanta(b)) * static_cast<float>(1.0 - contact_overlap);
    return 1.0f - squared / (apart * apart);
  }
  spot::Vector3 position(const Body& body) const {
    return low_ + quantum_.length() * spot::Vector3(static_cast<double>(body.at[0]), static_cast<double>(body.at[1]),
                                                    static_cast<double>(body.at[2]));
  }
  spot::Grain grain(const Body& body) const {
    return {body.id, periodic_.wrap(position(body)), body.held, body.radius};
  }

  Place push_on(const Body& own, const spot::RelaxationParameters& parameters) const {
    Place sum = {0, 0, 0};
    const auto add = [&sum](const Place& push) {
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += push[axis];
    };
    for (const Body& other : bodies_) {
      if (&other == &own) continue;
      const auto [x, y, z] = differences(own.at, other.at);
      const float s = overlap((x * x + y * y) + z * z, own, other, parameters.contact_overlap);
      const double widest = 1.0 + parameters.closing_gap / (1.0 - parameters.contact_overlap);
      if (!(s > -static_cast<float>(widest * widest - 1.0))) continue;
      auto share = static_cast<float>(other.swept ? parameters.pair_share() : parameters.fixed_share());
      if (s < 0.0f) share *= static_cast<float>(parameters.closing_share);
      const float scale = (share * s) * (0.5f + s * (0.375f + s * (0.3125f + s * 0.2734375f)));
      add({static_cast<std::int64_t>(scale * x), static_cast<std::int64_t>(scale * y),
           static_cast<std::int64_t>(scale * z)});
      const double apart = parameters.pair_share() * (own.radius + other.radius);
      if (own.at == other.at) add(quanta({own.id < other.id ? -apart : apart, 0.0, 0.0}));
    }
    for (const spot::AxisPlane& plane : container_.axis_planes()) {
      const auto axis = static_cast<std::size_t>(plane.axis);
      const double touching = plane.at + (plane.grains_below ? -own.radius : own.radius) - low_[plane.axis];
      const std::int64_t beyond = own.at[axis] - std::llrint(touching / quantum_.length());
      if (plane.grains_below ? beyond > 0 : beyond < 0)
        sum[axis] -=
            static_cast<std::int64_t>(static_cast<float>(parameters.fixed_share()) * static_cast<float>(beyond));
    }
    spot::WallContacts contacts;
    container_.other_contacts(position(own), own.radius, contacts);
    for (const spot::WallContact& wall : contacts)
      add(quanta(parameters.fixed_share() * (own.radius - wall.distance) * wall.normal));
    return sum;
  }

  double diameter_;
  spot::Quantum quantum_;
  const spot::Container& container_;
  spot::Vector3 low_;
  spot::Periodic periodic_;
  Place period_ = {0, 0, 0};  // in quanta; 0 where space does not repeat
  bool unequal_ = false;
  std::vector<Body> bodies_;
};

}  // namespace scenes
