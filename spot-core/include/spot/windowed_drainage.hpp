// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/drainage.hpp"
#include "spot/tiled_packing.hpp"

namespace spot {

/// The fast driver. Per window of time all spots walk and displace their blocks, in order of birth; then the cells in
/// which that has used up the tolerance are relaxed, as often as it takes.
///
/// How much a cell needs is kept in its account, the number of moves that reached into it: n of them, each enclosing
/// one grain of a touching pair or the other with probability 1/4, add w^2 dx^2 n / 12 to the mean square overlap along
/// the line of centres. A cell is due when that exceeds the tolerance squared, and a sweep pays for that many moves.
///
/// With a fixed volume, the weight of a spot's moves is the one that it had at the end of the window before.
class WindowedDrainage : public Drainage {
 public:
  /// `window`: in the units of the rates. Throws as TimeOrderedDrainage does, and InvalidParameter unless window and
  /// relaxation.tolerance are positive.
  WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   double window, int threads, std::shared_ptr<const Container> container, double diameter,
                   double extent, const std::vector<Grain>& grains);

  void advance_to(double time) override;
  void replace_grains(const std::vector<Grain>& grains) override;
  void replace_container(std::shared_ptr<const Container> container) override;
  void visit_grains(const std::function<void(const Grain&)>& visit) const override { packing_.visit_grains(visit); }
  std::vector<Spot> spots() const override;
  Overlap largest_overlap() override { return packing_.largest_overlap(); }
  std::size_t memory() const override { return packing_.memory(); }

  /// Moves into a cell after which it is relaxed.
  double due() const { return due_; }

 private:
  void give_birth(double until);
  void walk(double until);
  void displace();
  void relax();
  void drop_removed();

  std::unique_ptr<Workers> workers_;
  double window_;
  double due_;
  TiledPacking packing_;
  SpotWalk walk_;
  std::vector<Spot> spots_;        // in order of birth
  std::vector<double> next_step_;  // of each spot; infinite once it is removed
  std::vector<double> weights_;    // of each spot's moves
  std::size_t removed_ = 0;
  std::int64_t born_ = 0, windows_ = 0;
  double next_birth_;

  // Of the window at hand.
  std::vector<Move> moves_;
  std::vector<std::size_t> movers_;  // places in spots_
  std::vector<int> moved_;           // grains
};

}  // namespace spot
