// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "spot/base/memory.hpp"
#include "spot/drivers/drainage.hpp"
#include "spot/packing/packing.hpp"
#include "spot/packing/tiled_packing.hpp"
#include "spot/relaxation/relaxation.hpp"
#include "spot/walk/spots.hpp"

namespace spot {

/// The strictly time-ordered driver of 2006, the reference: every step of every spot, in order of time, displaces its
/// block of grains and is followed by a relaxation of the grains around it.
class TimeOrderedDrainage : public Drainage {
 public:
  /// Throws InvalidParameter, InvalidContainer or InvalidPacking, naming the grain, if the start is not
  /// valid: grains outside the container or overlapping too deeply, an outlet that newborn spots do not reach.
  TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                      std::shared_ptr<const Container> container, Packing packing);

  /// Goes on from what save() gave. Everything else must be as it was. Throws InvalidState if it is damaged.
  TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                      std::shared_ptr<const Container> container, double diameter, double extent, const Bytes& saved);

  Bytes save() const override;
  void advance_to(double time) override;
  void visit_grains(const VisitGrain& visit, Which which = Which::all) const override;
  const Quantum& quantum() const override { return packing_.quantum(); }
  std::vector<Spot> spots() const override { return spots_.live(); }
  Overlap largest_overlap() override;
  void count_moves_received() override { received_.emplace(); }
  MovesReceived take_moves_received() override { return received_ ? std::exchange(*received_, {}) : MovesReceived(); }
  std::size_t memory() const override {
    return packing_.memory() + relaxation_.memory() + spots_.memory() + bytes_in(near_);
  }

  const Packing& packing() const { return packing_; }

 private:
  TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                      std::shared_ptr<const Container> container, double diameter, double extent, ByteReader saved);
  void require_same_periods() const;
  void replace_packing(const std::vector<Grain>& grains);
  Overlap carry_out(const GrainChanges& changes) override;
  void take_new_container() override;
  const Injection& rates() const override { return spots_.rates(); }
  void take_new_rates(double time, const Injection& rates) override { spots_.set_rates(time, rates); }
  void let_settle(TiledPacking& packing, bool everybody);
  void carry_out(Move move);
  bool relaxes_around(const Move& move) const;
  /// As in 2006. The other schedules are there to see what comes of less, and may let the packing collapse.
  bool relaxes_every_move() const {
    return relaxation_parameters().schedule == RelaxationSchedule::moves && relaxation_parameters().every == 1;
  }
  void relax(const std::vector<std::uint32_t>& grains);
  void relax_everywhere();
  void take_out_drained(double time);

  Packing packing_;
  Spots spots_;
  Relaxation relaxation_;
  std::int64_t relaxed_everywhere_ = 0;    // times
  std::vector<std::uint32_t> near_;        // grains around a move; kept to save allocations
  std::optional<MovesReceived> received_;  // if they are counted
};

}  // namespace spot
