// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/base/quantum.hpp"
#include "spot/drivers/counters.hpp"
#include "spot/drivers/limits.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/packing/packing.hpp"
#include "spot/walk/parameters.hpp"
#include "spot/walk/spots.hpp"

namespace spot {

/// What somebody else has done to the grains. One that was moved, or is held now and was not, is among both.
/// Each is named by one rank, whichever.
struct GrainChanges {
  std::vector<std::int64_t> gone;  ///< ids
  std::vector<Grain> come;
};

/// A packing that drains as spots climb through it: what all drivers have in common.
class Drainage {
 public:
  virtual ~Drainage() = default;

  /// Goes on until `time`, in the units of the rates; births and steps start at time 0. A windowed driver stops at the
  /// last whole window before it. Throws CollapsedPacking if relaxation does not keep up with the moves.
  virtual void advance_to(double time) = 0;

  /// Goes on after somebody else moved, added or took grains; the spots stay. Grains that come, and those that stood on
  /// some that are gone, are moved down until contacts hold them, at no time of the spots'. Throws InvalidPacking if a
  /// grain that comes is outside, which changes nothing, or if it overlaps another more deeply than is allowed at the
  /// start, after which the drainage is of no use.
  void change_grains(const GrainChanges& changes);
  /// The same, told what all grains are now. On one rank only.
  void replace_grains(const std::vector<Grain>& grains);

  /// Goes on with other walls, which require_inside() holds grains against. Throws InvalidContainer unless there are as
  /// many outlets as before.
  void replace_container(std::shared_ptr<const Container> container);

  /// From `time` on, which it has been advanced to, an outlet has this many births per time, instead of what was to
  /// come. Throws InvalidParameter, naming what doesn't fit, and changes nothing then.
  void change_rate(std::size_t outlet, double time, double rate);

  /// Goes on with another number of threads, where the driver has any. Throws InvalidParameter as Workers does.
  virtual void set_threads(int) {}

  /// Calls visit(grain) for all grains, or for all that may have moved, or come, since forget_moved(), and perhaps
  /// others; in no particular order.
  virtual void visit_grains(const VisitGrain& visit, Which which = Which::all) const = 0;
  /// The same, from all threads of the driver at once.
  virtual void visit_grains_at_once(const VisitGrainAtOnce& visit, Which which = Which::all) const {
    visit_grains([&visit](const Grain& grain) { visit(grain, 0); }, which);
  }
  virtual void forget_moved() {}
  /// Calls job(first, last) for parts of 0 ... n, exclusive, on all threads of the driver.
  virtual void share_out(std::size_t n, const std::function<void(std::size_t, std::size_t)>& job) const { job(0, n); }

  virtual const Quantum& quantum() const = 0;  ///< all coordinates of grains are multiples of it
  virtual std::vector<Spot> spots() const = 0;
  virtual Overlap largest_overlap() = 0;
  /// Bytes that packing and spots take on this rank, with all that is kept from one move or window to the next.
  virtual std::size_t memory() const = 0;
  /// All that is needed to go on from here with the same bits, walls and parameters apart: the part of this rank.
  virtual Bytes save() const = 0;
  virtual Counters total() { return counters_; }  ///< over all ranks
  /// All grains, in increasing order of ids.
  std::vector<Grain> grains() const;

  /// Throws InvalidPacking, naming the grain, if one of these has left the container other than through an outlet.
  void require_inside(Which which = Which::all) const;
  /// Of this rank: its spots, its grains; of sweeps, those on all ranks.
  const Counters& counters() const { return counters_; }

  /// Grains that left since the last call, where they were then, in increasing order of ids.
  std::vector<Grain> take_drained();
  /// Counts from now on how many moves move each grain, which is not free.
  virtual void count_moves_received() = 0;
  /// What was counted since the last call, on this rank. A grain that came from another rank has been counted there,
  /// too; grains that have drained meanwhile are among them.
  virtual MovesReceived take_moves_received() = 0;

 protected:
  /// Throws InvalidParameter or InvalidContainer if spots, limits and container do not fit together.
  Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
           std::shared_ptr<const Container> container, double diameter);

  /// Throws InvalidPacking, naming the grains, if one is outside the container, or overlaps a wall or another too
  /// deeply.
  void require_valid_start();
  /// Collective. InvalidParameter, if the packing is looser than the state that spots would bring it to.
  void require_dense_start(Communicator& communicator) const;

  const SpotParameters& spot_parameters() const { return spots_; }
  const RelaxationParameters& relaxation_parameters() const { return relaxation_; }
  const DrainageLimits& limits() const { return checks_.limits(); }
  const GrainChecks& checks() const { return checks_; }
  const Container& container() const { return *container_; }
  double diameter() const { return diameter_; }
  /// What spots call to see where grains are.
  Spots::VisitGrains visit_positions() const {
    return [this](const auto& visit, const auto&) {
      visit_grains([&visit](const Grain& grain) { visit(grain.position); });
    };
  }

  /// `enclosed`: grain volume (1024 = grain_volume).
  void count_move(std::int64_t enclosed) {
    ++counters_.moves;
    counters_.volume_moved += enclosed;
  }
  /// The weight of a move that encloses this grain volume (1024 = grain_volume): by its fixed volume, if it has one,
  /// and by what its spot carries.
  double weigh(const Move& move, int enclosed, const Spots::Carried& carried);
  void count_sweep(std::size_t grains) {
    ++counters_.sweeps;
    counters_.grains_swept += static_cast<std::int64_t>(grains);
  }
  /// Goes on counting from a saved state.
  void set_counters(const Counters& counters) { counters_ = counters; }
  /// Grains have left below the outlet, which the driver's spots hear of.
  void add_drained(const std::vector<Grain>& grains, Spots& spots);

 private:
  /// Carries out what change_grains() has checked; returns the largest overlap of a grain that came, as it came.
  virtual Overlap carry_out(const GrainChanges& changes) = 0;
  virtual void take_new_container() = 0;  ///< there are other walls now
  /// Of births.
  virtual const Injection& rates() const = 0;
  /// They are others from a time on. Throws InvalidParameter if they are too many.
  virtual void take_new_rates(double time, const Injection& rates) = 0;

  SpotParameters spots_;
  RelaxationParameters relaxation_;
  std::shared_ptr<const Container> container_;
  double diameter_;
  GrainChecks checks_;
  Counters counters_;
  std::vector<Grain> drained_;
};

}  // namespace spot
