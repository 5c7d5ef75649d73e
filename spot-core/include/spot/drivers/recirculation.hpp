// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/grain.hpp"
#include "spot/parallel/communicator.hpp"

namespace spot {

class Drainage;

/// Where grains come in again: places are drawn uniformly from a box, and of these, those count that `contains` knows
/// (all, without it).
struct Inlet {
  Vector3 low, high;        ///< corners of the box; no grain comes to lie higher (length)
  bool on_surface = false;  ///< of a place only x and y count: a grain comes in right above the bed that it finds there
  std::function<bool(const Vector3&)> contains;
  std::string name;  ///< what errors call it
};

/// Drained grains go round: each comes in at a random place of the inlet, and comes down as grains do that somebody
/// else puts in (Settling). As in pebble beds, whose pebbles are put back on top (Rycroft et al. 2006, Phys. Rev. E 74,
/// 021306). Places depend on the seed, the grain's id and the time alone, on any ranks.
class Recirculation {
 public:
  /// `diameter` is that of the largest grains. Throws InvalidContainer, naming the inlet, if none of thousands of
  /// places in it has room for one between the walls.
  Recirculation(std::uint64_t seed, Inlet inlet, std::shared_ptr<const Container> container, double diameter);

  /// Collective. Puts back what has drained, of which each rank knows some; `time` counts the calls, or what they are
  /// made at, and never comes again. Throws InvalidPacking, naming the grain, if there is no place for it that is free.
  void put_back(Drainage& drainage, const std::vector<Grain>& drained, std::int64_t time,
                Communicator& communicator) const;

 private:
  Vector3 draw(std::int64_t grain, std::int64_t time, int attempt) const;
  bool fits(const Vector3& place, double radius) const;
  std::vector<Grain> place_all(const Drainage& drainage, std::vector<Grain> waiting, std::int64_t time,
                               Communicator& communicator) const;

  std::uint64_t seed_;
  Inlet inlet_;
  std::shared_ptr<const Container> container_;
  double diameter_;
};

}  // namespace spot
