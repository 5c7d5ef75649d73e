// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that somebody else brings, takes or moves.
#pragma once

#include <cstdint>
#include <vector>

#include "spot/packing/tiled_packing.hpp"

namespace spot {

/// Of the grains of all ranks, takes out those that go, in two steps: between them, a grain that comes where one goes
/// takes its place.
class GrainChange {
 public:
  explicit GrainChange(TiledPacking& packing) : packing_(packing) {}

  /// Collective. Marks the grains with these ids, of which each rank names some, as going; are there any? Throws
  /// InvalidPacking if one is not there.
  bool mark_going(const std::vector<std::int64_t>& ids);

  /// Collective. A grain that stays where it is under another id, or as a held one or no longer as one, keeps what is
  /// remembered of it. It may be on another rank than the one whose layers it has come to. Returns the others of those
  /// that come.
  std::vector<Grain> stay_under_other_ids(const std::vector<Grain>& come);

  /// Collective. Grains above those that go may have lost what bore them, on the ranks below and above, too.
  void take_out_going(const Container& container);

  /// Throw InvalidPacking, naming the grain.
  void require_new_ids(const std::vector<Grain>& incoming) const;
  void require_within_extent(const std::vector<Grain>& come) const;

 private:
  TiledPacking& packing_;
};

}  // namespace spot
