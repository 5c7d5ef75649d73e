// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/drainage.hpp"
#include "spot/spot_walk.hpp"
#include "spot/tiled_packing.hpp"

namespace spot {

/// When cells are relaxed in the windowed driver.
struct WindowParameters {
  double window;     ///< time of one window
  int due = 20;      ///< moves into a cell after which it is relaxed
  int relief = 4;    ///< a sweep divides a cell's account by this
  int rounds = 8;    ///< most sweeps in one window
};

/// The windowed driver: per window of time all spots walk and displace, then the cells that are due are relaxed.
class WindowedDrainage {
 public:
  WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   const WindowParameters& window, std::shared_ptr<const Container> container, double diameter,
                   double extent, const std::vector<Grain>& grains);

  void advance_to(double time);
  const TiledPacking& packing() const { return packing_; }
  const std::vector<Spot>& spots() const { return spots_; }
  const Counters& counters() const { return counters_; }
  std::vector<Grain> take_drained();

 private:
  void give_birth(double until);
  void walk(double until);
  void relax();
  void drop_removed();

  SpotParameters parameters_;
  RelaxationParameters relaxation_;
  DrainageLimits limits_;
  WindowParameters window_;
  std::shared_ptr<const Container> container_;
  TiledPacking packing_;
  SpotWalk walk_;
  std::vector<Spot> spots_;        // in order of birth
  std::vector<double> next_step_;  // of each spot; infinite once it is removed
  std::size_t removed_ = 0;
  std::int64_t born_ = 0, windows_ = 0;
  double next_birth_;
  Counters counters_;
  std::vector<Grain> drained_;
};

}  // namespace spot
