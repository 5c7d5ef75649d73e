// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/dilation_field.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

DilationField::DilationField(const SpotParameters& parameters, const Container& container, double diameter)
    : lattice_(container, std::max(parameters.radius, diameter)),
      spot_volume_(parameters.missing_volume(diameter)),
      reference_(parameters.dilation) {}

void DilationField::count(const std::vector<Vector3>& spots, Communicator& communicator, Workers& workers) {
  const NodeLattice::Box before = std::exchange(box_, lattice_.around(spots, communicator));
  counts_.assign(box_.size(), 0);
  std::vector<std::vector<std::int64_t>> of_workers(static_cast<std::size_t>(workers.size()), counts_);
  workers.share_out(spots.size(), [&](int worker, std::size_t first, std::size_t last) {
    std::vector<std::int64_t>& counts = of_workers[static_cast<std::size_t>(worker)];
    for (std::size_t k = first; k < last; ++k)
      for (const NodeLattice::Corner& corner : lattice_.corners(spots[k]))
        counts[box_.place(corner.node)] += corner.weight;
  });
  for (const std::vector<std::int64_t>& counts : of_workers)
    for (std::size_t k = 0; k < counts.size(); ++k) counts_[k] += counts[k];
  counts_ = communicator.sum(std::move(counts_));
  if (!(box_ == before)) find_volumes();
}

void DilationField::find_volumes() {
  counted_volumes_.resize(counts_.size());
  box_.visit([&](const NodeLattice::Node& node, std::size_t k) { counted_volumes_[k] = lattice_.volume(node); });
}

double DilationField::at(const Vector3& point) const {
  double spots = 0.0, volume = 0.0;
  for (const NodeLattice::Corner& corner : lattice_.corners(point)) {
    const auto weight = static_cast<double>(corner.weight);
    if (!box_.contains(corner.node)) {
      volume += weight * lattice_.volume(corner.node);
      continue;
    }
    const std::size_t at = box_.place(corner.node);
    volume += weight * counted_volumes_[at];
    spots += weight * static_cast<double>(counts_[at]);
  }
  return volume > 0.0 ? spots / static_cast<double>(NodeLattice::whole) * spot_volume_ / volume
                      : std::numeric_limits<double>::infinity();
}

double DilationField::relative_speed(const Vector3& point) const {
  const double ratio = at(point) / reference_;
  return std::clamp(ratio * ratio, calibration::slowest_relative_speed, calibration::fastest_relative_speed);
}

void DilationField::replace_container(const Container& container) {
  lattice_.replace_container(container);
  find_volumes();
}

void DilationField::save(Bytes& bytes) const {
  append(bytes, box_);
  append(bytes, counts_);
}

void DilationField::restore(ByteReader& saved) {
  box_ = take_box(saved);
  counts_ = saved.take_all<std::int64_t>();
  if (counts_.size() != box_.size()) throw InvalidState("the saved counts of spots are damaged");
  find_volumes();
}

std::size_t DilationField::memory() const { return bytes_in(counts_, counted_volumes_) + lattice_.memory(); }

}  // namespace spot
