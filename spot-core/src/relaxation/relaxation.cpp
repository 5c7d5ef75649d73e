// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "packing/wrapped_integers.hpp"

namespace spot {

Relaxation::Relaxation(const RelaxationParameters& parameters) : parameters_(parameters) { parameters_.validate(); }

double Relaxation::push_off_neighbours(const Packing& packing, std::uint32_t i, Push& push) const {
  const double *x = packing.x(), *y = packing.y(), *z = packing.z();
  const double xi = x[i], yi = y[i], zi = z[i];
  const double radius = packing.radius(i);
  const Quantum& quantum = packing.quantum();
  const Periodic& periodic = packing.periodic();
  const double reach = std::max(1.0, parameters_.distance_in_contact(1.0) + parameters_.closing_gap);
  double deepest = 0.0;
  const auto [first, last] = packing.neighbours(i);
  for (const std::uint32_t* j = first; j != last; ++j) {
    double dx = xi - x[*j], dy = yi - y[*j];
    const double dz = zi - z[*j];
    periodic.shorten(dx, dy);
    const double squared = dx * dx + dy * dy + dz * dz;
    const double touching = radius + packing.radius(*j);
    if (squared >= square(reach * touching)) continue;
    const double distance = std::sqrt(squared), parted = parameters_.distance_in_contact(touching);
    deepest = std::max(deepest, 1.0 - distance / touching);
    if (squared >= square(parted + parameters_.closing_gap * touching)) continue;
    double share = is_movable_[*j] ? parameters_.pair_share() : parameters_.fixed_share();
    if (squared > square(parted)) share *= parameters_.closing_share;
    if (distance == 0.0) {
      // Centres that coincide have no line between them; part them along x, by id so that both agree.
      push.x += quantum.round(packing.id(i) < packing.id(*j) ? -share * touching : share * touching);
      continue;
    }
    const double scale = share * (parted - distance) / distance;
    // Every push is rounded by itself: then their sum does not depend on the order of the neighbours.
    push.x += quantum.round(scale * dx);
    push.y += quantum.round(scale * dy);
    push.z += quantum.round(scale * dz);
  }
  return deepest;
}

void Relaxation::push_off_walls(const Packing& packing, const Container& container, std::uint32_t i, Push& push) {
  const double radius = packing.radius(i);
  const Quantum& quantum = packing.quantum();
  container.contacts(packing.position(i), radius, contacts_);
  for (const WallContact& contact : contacts_) {
    const Vector3 off = parameters_.fixed_share() * (radius - contact.distance) * contact.normal;
    push.x += quantum.round(off.x());
    push.y += quantum.round(off.y());
    push.z += quantum.round(off.z());
  }
}

double Relaxation::sweep(Packing& packing, const Container& container, const std::vector<std::uint32_t>& movable) {
  is_movable_.resize(packing.slots());
  for (const std::uint32_t i : movable) is_movable_[i] = 1;
  pushes_.assign(movable.size(), Push());
  double deepest = 0.0;
  for (std::size_t k = 0; k < movable.size(); ++k) {
    deepest = std::max(deepest, push_off_neighbours(packing, movable[k], pushes_[k]));
    if (packing.near_wall(movable[k])) push_off_walls(packing, container, movable[k], pushes_[k]);
  }
  for (std::size_t k = 0; k < movable.size(); ++k) {
    is_movable_[movable[k]] = 0;
    if (pushes_[k].x != 0.0 || pushes_[k].y != 0.0 || pushes_[k].z != 0.0)
      packing.move(movable[k], pushes_[k].x, pushes_[k].y, pushes_[k].z);
  }
  return deepest;
}

}  // namespace spot
