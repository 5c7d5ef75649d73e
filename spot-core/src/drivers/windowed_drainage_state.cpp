// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include "spot/base/errors.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "walk/packed_spot.hpp"

namespace spot {

Bytes WindowedDrainage::save() const {
  Bytes bytes;
  append(bytes, windows_);
  append(bytes, born_);
  append(bytes, next_birth_);
  append(bytes, counters_);
  append(bytes, static_cast<std::uint64_t>(walkers_.size()));
  for (const Walker& walker : walkers_) {
    append(bytes, walker.spot);
    append(bytes, walker.removed);
  }
  append(bytes, packing_.save());
  seal(bytes);
  return bytes;
}

/// The packings' parts of a state.
std::vector<Bytes> WindowedDrainage::read(const std::vector<Bytes>& saved) {
  if (saved.empty()) throw InvalidState("there is no saved state");
  std::vector<Bytes> packings;
  for (const Bytes& part : saved) {
    ByteReader reader = unseal(part);
    windows_ = reader.take<std::int64_t>();
    born_ = reader.take<std::int64_t>();
    next_birth_ = reader.take<double>();
    const auto counters = reader.take<Counters>();
    counters_.sweeps = counters.sweeps;
    counters_.grains_swept = counters.grains_swept;
    if (communicator_->rank() == 0) {  // which goes on counting for all
      counters_.moves += counters.moves;
      counters_.shares_moved += counters.shares_moved;
      counters_.drained += counters.drained;
    }
    for (auto spots = reader.take<std::uint64_t>(); spots > 0; --spots) {
      const Spot spot = take_spot(reader);
      walkers_.push_back({spot, reader.take<bool>()});
    }
    packings.push_back(reader.take_all<char>());
  }
  return packings;
}

/// After the packing has been made: of all spots that were read, keeps this rank's.
void WindowedDrainage::keep_own_spots() {
  const auto others = std::remove_if(walkers_.begin(), walkers_.end(),
                                     [this](const Walker& walker) { return !here(walker.spot.position); });
  walkers_.erase(others, walkers_.end());
  std::sort(walkers_.begin(), walkers_.end(), [](const Walker& a, const Walker& b) { return a.spot.id < b.spot.id; });
  removed_ = 0;
  for (const Walker& walker : walkers_) removed_ += walker.removed ? 1 : 0;
}

WindowedDrainage::WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                   const DrainageLimits& limits, double window, int threads,
                                   std::shared_ptr<const Container> container, double diameter, double extent,
                                   const std::vector<Bytes>& saved, std::shared_ptr<Communicator> communicator)
    : Drainage(spots, relaxation, limits, std::move(container), diameter),
      communicator_(std::move(communicator)),
      workers_(std::make_unique<Workers>(threads)),
      window_(positive_window(window)),
      due_(moves_until_due(spots, relaxation.tolerance, diameter)),
      packing_(diameter, extent, read(saved), *container_, communicator_),
      relaxation_(packing_, relaxation),
      walk_(spots, *container_),
      dilation_(spots, *container_, diameter) {
  BlockMoves::require_radius(spots.radius, diameter);
  require_fitting_window();
  keep_own_spots();
}

}  // namespace spot
