// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/errors.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace spot {

Bytes WindowedDrainage::save() const {
  Bytes bytes;
  append(bytes, windows_);
  append(bytes, counters());
  spots_.save(bytes);
  append(bytes, packing_.save());
  seal(bytes);
  return bytes;
}

/// The packings' parts of a state.
std::vector<Bytes> WindowedDrainage::read(const std::vector<Bytes>& saved) {
  if (saved.empty()) throw InvalidState("there is no saved state");
  std::vector<Bytes> packings;
  Counters counters;
  for (const Bytes& part : saved) {
    ByteReader reader = unseal(part);
    windows_ = reader.take<std::int64_t>();
    const auto read = reader.take<Counters>();
    counters.sweeps = read.sweeps;
    counters.grains_swept = read.grains_swept;
    if (communicator_->rank() == 0) {  // which goes on counting for all
      counters.moves += read.moves;
      counters.volume_moved += read.volume_moved;
      counters.volume_left += read.volume_left;
      counters.drained += read.drained;
    }
    spots_.restore(reader, communicator_->rank() == 0);
    packings.push_back(reader.take_all<char>());
  }
  set_counters(counters);
  return packings;
}

WindowedDrainage::WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                   const DrainageLimits& limits, double window, int threads,
                                   std::shared_ptr<const Container> container, double diameter, double extent,
                                   const std::vector<Bytes>& saved, std::shared_ptr<Communicator> communicator)
    : Drainage(spots, relaxation, limits, std::move(container), diameter),
      communicator_(std::move(communicator)),
      workers_(std::make_unique<Workers>(threads)),
      window_(positive_window(window)),
      moves_between_sweeps_(moves_between_sweeps_for(spots, relaxation.tolerance, spots.mean_diameter(diameter))),
      spots_(spots, Drainage::container(), diameter),
      packing_(diameter, extent, read(saved), Drainage::container(), communicator_),
      relaxation_(packing_, relaxation),
      moves_(communicator_) {
  BlockMoves::require_radius(spots.radius, diameter);
  require_fitting_window(spots);
  spots_.take_out_others([this](const Spot& spot) { return here(spot); });
}

}  // namespace spot
