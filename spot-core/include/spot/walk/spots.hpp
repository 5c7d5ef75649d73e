// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/base/recurrence.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/workers.hpp"
#include "spot/walk/critical_state.hpp"
#include "spot/walk/dilation_field.hpp"
#include "spot/walk/flow_field.hpp"
#include "spot/walk/free_surface.hpp"
#include "spot/walk/next_birth.hpp"
#include "spot/walk/outflow_control.hpp"
#include "spot/walk/spot_walk.hpp"

namespace spot {

/// The live spots: births, relative speeds, steps and removals, for all drivers.
///
/// A driver asks either for one step after the other, in the order of time and on one rank, or for all steps until the
/// end of a window, spot by spot in the order of birth, on any number of ranks, each with its own. Spots stand while
/// their outlet has no births.
class Spots {
 public:
  /// Throws InvalidParameter, or InvalidContainer if the spots cannot enter.
  Spots(const SpotParameters& parameters, const Container& container, double diameter);

  using VisitGrains = FreeSurface::VisitGrains;

  /// In the order of (time, spot): the next step of any spot up to and including `time`, or none, carried out.
  /// Relative speeds are set, and the flow is found anew, whenever a spot has climbed R_s / 10 at v_s, the surface as
  /// by update_surface(). `visit_grains`: by default there are none.
  std::optional<Move> next_step(
      double time, const Container& container, const VisitGrains& visit_grains = [](const auto&, const auto&) {});

  /// Collective. From `now` on all spots climb as fast as the dilation there lets them.
  void set_relative_speeds(double now, Communicator& communicator, Workers& workers);
  /// Whom a spot belongs to.
  using Belongs = std::function<bool(const Spot&)>;
  /// Births up to and including `until`: every rank sees all of them, and keeps those that belong to it.
  void give_birth(double until, const Container& container, const Belongs& here);

  /// Steps up to and including `until`; then visit(spot, moves), one spot after the other, of those that made any.
  void step_until(double until, const Container& container, Workers& workers,
                  const std::function<void(const Spot&, const std::vector<Move>&)>& visit);

  struct Carried {
    double volume = 1.0;    ///< in the move, over that of a newborn spot
    std::int64_t left = 0;  ///< in the packing, less what was taken up there, in CriticalState::volume_parts-ths
  };
  /// What the spot of a move carries in it; from then on it carries what it has not left there (CriticalState). For
  /// each move once, in the order of a spot's moves. `enclosed`: grain volume (1024 = grain_volume).
  Carried carry(const Move& move, int enclosed, const Container& container);

  // In two parts. Several threads may do the first, for different spots.
  Carried exchange(const Move& move, int enclosed, const Container& container);
  void add_to_flow(const Move& move, double carried) {
    if (shears_) flow_.add(move, carried);
  }

  /// Collective. `elapsed` after the last time, spots learn how the flow is sheared now.
  void update_flow(double elapsed, Communicator& communicator);
  /// Collective. Spots learn where the free surface is, if they have to: once while a spot at v_s climbs
  /// calibration::climb_between_surfaces, whatever the times of the calls meanwhile.
  void update_surface(double now, const VisitGrains& visit_grains, Communicator& communicator);

  /// A grain of this rank, of this volume (1024 = grain_volume), has left through an outlet.
  void count_drained(std::size_t outlet, std::int64_t volume) { outflow_.count(outlet, volume); }
  /// Collective. Births follow what has left until now.
  void follow_outflow(double now, Communicator& communicator);
  /// Of births, as it was and is to be; what is asked for, where births follow the outflow.
  const Injection& rates() const { return outflow_.births(); }
  /// From `now` on, which all births have come up to, it is something else.
  void set_rates(double now, const Injection& rates);
  /// There is nothing left above the spot. One that is gone already may be named again.
  void remove(std::int64_t spot);
  std::vector<Spot> take_out_others(const Belongs& here);
  void take_in(const std::vector<Spot>& spots);

  /// In order of birth.
  std::vector<Spot> live() const;
  std::int64_t born() const { return born_; }
  void replace_container(const Container& container);

  void save(Bytes& bytes) const;
  /// Takes in what save() appended, on each of several ranks maybe, of which one `counts` what had left. Throws
  /// InvalidState if it is damaged.
  void restore(ByteReader& saved, bool counts = true);

  std::size_t memory() const;

 private:
  struct Place {
    Spot spot;
    bool removed;  // until there are enough of them to close the gaps
  };
  struct Event {
    double time;
    std::int64_t spot;
    std::size_t place;
    /// Order of a heap with the earliest event on top, ties by spot.
    bool operator<(const Event& other) const { return time != other.time ? time > other.time : spot > other.spot; }
  };

  /// What one worker has let spots do.
  struct Stepped {
    std::vector<Move> moves;
    std::vector<std::pair<std::size_t, std::size_t>> ends;  // places of spots, and the ends of their moves
  };

  void await_birth(double from);
  bool bear_next(const Container& container, const Belongs& here);
  std::vector<Place>::iterator find(std::int64_t spot);
  bool stands(const Spot& spot) const;
  void queue_all();
  void queue(std::size_t place);
  void drop_removed_events();
  double next_setting() const;
  void close_gaps();

  SpotWalk walk_;
  std::vector<Place> places_;  // in order of birth
  std::size_t removed_ = 0;
  std::vector<Stepped> stepped_;  // kept to save allocations
  OutflowControl outflow_;
  NextBirth next_birth_;
  std::int64_t born_ = 0;
  bool dilates_;
  DilationField dilation_;
  CriticalState critical_;
  bool shears_;  // do spots have to know how the flow is sheared?
  FlowField flow_;
  FreeSurface surface_;
  Recurrence surfaces_;  // when it is found anew

  // Of spots that step in the order of time.
  std::vector<Event> events_;  // a heap of next steps; those of removed spots are dropped when they come up
  bool queued_ = false;        // are all next steps in it?
  double setting_interval_;    // of relative speeds; 0: never
  std::int64_t settings_ = 0;
};

}  // namespace spot
