// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/packing_at_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "spot/walk/calibration.hpp"
#include "spot/walk/critical_state.hpp"
#include "spot/walk/flow_field.hpp"
#include "spot/walk/free_surface.hpp"
#include "spot/walk/grain_volume.hpp"
#include "spot/walk/node_lattice.hpp"

namespace spot {

namespace {

/// Below the free surface, in diameters, and around a place: grains lie loosely on top, and one that lies alone does
/// not make the surface of what is beside it.
constexpr double margin = 2.0;

/// Over how many nodes is a packing that every grain has one of? Two, with the largest grains and nodes as close as
/// they get; the rest is air.
constexpr std::int64_t most_places_per_grain = 2;

class Places {
 public:
  Places(const SpotParameters& parameters, const Container& container, double diameter)
      : container_(container),
        profile_(*parameters.profile),
        radius_(parameters.radius),
        margin_(margin * diameter),
        lattice_(container, std::max(parameters.radius, diameter)) {}

  /// The nodes around grains that are in the bulk, up to so many and one.
  void find(const NodeLattice::Box& box, const FreeSurface& surface, std::size_t most) {
    const double low = container_.outlets().height() + calibration::least_height_of_exchange * radius_;
    NodeLattice::Node node;
    for (node[1] = box.low[1]; node[1] < box.high[1]; ++node[1])
      for (node[0] = box.low[0]; node[0] < box.high[0]; ++node[0])
        for (node[2] = static_cast<int>(std::ceil(lattice_.cell_of({0.0, 0.0, low}, 2)));; ++node[2]) {
          const Vector3 place = lattice_.point(node);
          if (place.z() + radius_ + margin_ > lowest_surface_around(place, surface) || places_.size() > most) break;
          if (container_.contains(place)) places_.emplace(node, places_.size());
        }
  }

  std::size_t size() const { return places_.size(); }
  const NodeLattice& lattice() const { return lattice_; }

  /// The volume of these grains in each, counted by their share of the influence; 1024 = grain_volume.
  std::vector<std::int64_t> enclosed(const std::vector<EnclosedGrain>& grains) const {
    std::vector<std::int64_t> sums(places_.size(), 0);
    for (const EnclosedGrain& grain : grains) {
      const Vector3 centre = container_.periodic().wrap(grain.position);
      NodeLattice::Box near;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double reach = radius_ / lattice_.spacing()[static_cast<int>(axis)];
        near.low[axis] = static_cast<int>(std::ceil(lattice_.cell_of(centre, axis) - reach));
        near.high[axis] = static_cast<int>(std::floor(lattice_.cell_of(centre, axis) + reach)) + 1;
      }
      near.visit([&](const NodeLattice::Node& node, std::size_t) {
        const double squared = (lattice_.point(node) - centre).squaredNorm();
        if (squared > radius_ * radius_) return;
        const auto place = places_.find(lattice_.wrapped(node));
        if (place != places_.end())
          sums[place->second] += static_cast<int>(profile_.share(squared, radius_) * grain.volume);
      });
    }
    return sums;
  }

  /// What all of them together enclose at the critical packing fraction, in grain volumes, where walls shear by
  /// `wall_shear` over the half-width.
  double critical(const CriticalState& state, double wall_shear) const {
    double sum = 0.0;
    for (const auto& [node, number] : places_) {
      const Vector3 place = lattice_.point(node);
      const double shear = shear_by_walls(wall_shear, container_, place, lattice_.spacing().x());
      sum += state.enclosed(place, shear, container_);
    }
    return sum;
  }

 private:
  /// As far as the walls reach.
  double lowest_surface_around(const Vector3& place, const FreeSurface& surface) const {
    constexpr double diagonal = 0.70710678118654752;
    constexpr std::array<std::array<double, 2>, 8> ways = {{{1, 0},
                                                            {-1, 0},
                                                            {0, 1},
                                                            {0, -1},
                                                            {diagonal, diagonal},
                                                            {-diagonal, diagonal},
                                                            {diagonal, -diagonal},
                                                            {-diagonal, -diagonal}}};
    double lowest = surface.height(place);
    for (const auto& [x, y] : ways) {
      const Vector3 beside = container_.periodic().wrap(place + (radius_ + margin_) * Vector3(x, y, 0.0));
      if (container_.contains(beside)) lowest = std::min(lowest, surface.height(beside));
    }
    return lowest;
  }

  const Container& container_;
  const InfluenceProfile& profile_;
  double radius_, margin_;
  NodeLattice lattice_;
  std::map<NodeLattice::Node, std::size_t> places_;  // numbered as they were found
};

}  // namespace

std::optional<PackingAtRest> packing_at_rest(const SpotParameters& parameters, const Container& container,
                                             double diameter, const std::vector<EnclosedGrain>& grains,
                                             Communicator& communicator) {
  FreeSurface surface(parameters, container, diameter);
  std::vector<Vector3> centres;
  for (const EnclosedGrain& grain : grains) {
    surface.add(grain.position);
    centres.push_back(container.periodic().wrap(grain.position));
  }
  surface.gather(communicator);
  const auto most =
      static_cast<std::size_t>(most_places_per_grain * communicator.sum(static_cast<std::int64_t>(grains.size())));
  Places places(parameters, container, diameter);
  places.find(places.lattice().around(centres, communicator), surface, most);
  if (places.size() < calibration::least_places_at_rest || places.size() > most) return std::nullopt;
  std::int64_t enclosed = 0;
  for (const std::int64_t volume : communicator.sum(places.enclosed(grains))) enclosed += volume;
  const CriticalState state(parameters, diameter);
  const double phi_c = parameters.critical_fraction, unsheared = places.critical(state, 0.0);
  return PackingAtRest{phi_c * (static_cast<double>(enclosed) / grain_volume) / unsheared,
                       phi_c * places.critical(state, parameters.wall_shear) / unsheared};
}

}  // namespace spot
