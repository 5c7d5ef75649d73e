// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/drivers/drainage.hpp"
#include "spot/drivers/shared_moves.hpp"
#include "spot/packing/tiled_packing.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/relaxation/cell_relaxation.hpp"
#include "spot/walk/spots.hpp"

namespace spot {

/// The fast driver. Per window of time all spots walk and displace their blocks, in order of birth; then the cells in
/// which that has used up the tolerance are relaxed, as often as it takes.
///
/// Each cell counts its unrelaxed moves, those that reached into it: n of them add w^2 dx^2 n s / 3 to the mean square
/// overlap along the line of centres, s being the mean square difference of the shares of two grains in touch. A cell
/// is swept when that exceeds the tolerance squared, and each sweep takes that many moves off its count.
///
/// With a fixed volume, moves are weighed by what they enclose before the first move of their window.
///
/// Several ranks can share the grains and the spots: a spot belongs to the rank whose layers it is in. Once in a window
/// its moves go to all ranks whose grains they may reach, what they enclose there comes back, and weights go out
/// (SharedMoves).
/// Constructors, advance_to(), change_grains() and total() are collective then.
class WindowedDrainage : public Drainage {
 public:
  /// `window`: in the units of the rates. `grains`: of which each rank brings some. Throws as TimeOrderedDrainage does,
  /// and InvalidParameter unless window and relaxation.tolerance are positive.
  WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   double window, int threads, std::shared_ptr<const Container> container, double diameter,
                   double extent, const std::vector<Grain>& grains,
                   std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  /// Goes on from a saved state: what save() gave on every rank, of however many. Everything else must be as it was.
  /// Throws InvalidState if it is damaged.
  WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   double window, int threads, std::shared_ptr<const Container> container, double diameter,
                   double extent, const std::vector<Bytes>& saved,
                   std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  Bytes save() const override;
  void advance_to(double time) override;
  void set_threads(int threads) override { workers_ = std::make_unique<Workers>(threads); }
  void visit_grains(const VisitGrain& visit, Which which = Which::all) const override {
    packing_.visit_grains(visit, which);
  }
  void visit_grains_at_once(const VisitGrainAtOnce& visit, Which which = Which::all) const override {
    packing_.visit_grains_at_once(visit, which, *workers_);
  }
  void forget_moved() override { packing_.cells().drift.forget_moved(); }
  void share_out(std::size_t n, const std::function<void(std::size_t, std::size_t)>& job) const override {
    workers_->share_out(n, [&](int, std::size_t first, std::size_t last) { job(first, last); });
  }
  const Quantum& quantum() const override { return packing_.quantum(); }
  std::vector<Spot> spots() const override { return spots_.live(); }
  Overlap largest_overlap() override { return packing_.largest_overlap(); }
  void count_moves_received() override { packing_.received().start(); }
  MovesReceived take_moves_received() override { return packing_.received().take(); }
  std::size_t memory() const override;
  Counters total() override;

  /// How far the grains over an outlet go down in this time, on average, where and when that is most (diameters).
  static double flow_through_orifice(const SpotParameters& spots, double time, double diameter, const Outlets& outlets);

  /// Moves into a cell after which it is swept.
  double moves_between_sweeps() const { return moves_between_sweeps_; }

 private:
  Overlap carry_out(const GrainChanges& changes) override;
  static double moves_between_sweeps_for(const SpotParameters& spots, double tolerance, double diameter);
  static double positive_window(double window);
  /// Throws InvalidParameter if relaxation could not follow what spots do in a window.
  void require_fitting_window(const SpotParameters& spots) const;
  int owner(const Spot& spot) const { return packing_.owner(spot.position.z()); }
  bool here(const Spot& spot) const { return owner(spot) == communicator_->rank(); }
  std::pair<int, int> reached(const Move& move) const {
    return packing_.reached(move.middle.z(), spot_parameters().radius);
  }
  void take_new_container() override;
  const Injection& rates() const override { return spots_.rates(); }
  void take_new_rates(double time, const Injection& rates) override;
  void step_to(double until);
  void displace();
  void weigh(const std::vector<int>& enclosed, std::vector<Move>& moves);
  void carry();
  void remove_spots_above();
  void let_settle(bool everybody);
  void relax();
  void take_out_drained(double from, double until);
  std::vector<Bytes> read(const std::vector<Bytes>& saved);

  std::shared_ptr<Communicator> communicator_;
  std::unique_ptr<Workers> workers_;
  double window_;
  double moves_between_sweeps_;
  // What read() sets stands before the packing.
  Spots spots_;
  std::int64_t windows_ = 0;
  TiledPacking packing_;
  CellRelaxation relaxation_;

  // Of the window at hand.
  SharedMoves moves_;
  std::vector<Move> displacing_;  // in the same order
  std::vector<Spots::Carried> carried_;
};

}  // namespace spot
