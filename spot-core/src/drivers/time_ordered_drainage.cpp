// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/time_ordered_drainage.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "packing/packed_grain.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/relaxation/calibration.hpp"
#include "spot/relaxation/settling.hpp"

namespace spot {

namespace {

std::vector<Grain> take_grains(ByteReader& saved) {
  std::vector<Grain> grains;
  for (auto n = saved.take<std::uint64_t>(); n > 0; --n) grains.push_back(take_grain(saved));
  return grains;
}

}  // namespace

TimeOrderedDrainage::TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                         const DrainageLimits& limits, std::shared_ptr<const Container> container,
                                         Packing packing)
    : Drainage(spots, relaxation, limits, std::move(container), packing.diameter()),
      packing_(std::move(packing)),
      spots_(spots, Drainage::container(), packing_.diameter()),
      relaxation_(relaxation) {
  require_same_periods();
  packing_.hold_gaps(relaxation.closing_gap * packing_.diameter());
  require_valid_start();
  TiledPacking tiled(packing_.diameter(), packing_.extent(), limits.outlet, packing_.grains(), Drainage::container());
  let_settle(tiled, true);
  Alone alone;
  require_dense_start(alone);
}

TimeOrderedDrainage::TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                         const DrainageLimits& limits, std::shared_ptr<const Container> container,
                                         double diameter, double extent, const Bytes& saved)
    : TimeOrderedDrainage(spots, relaxation, limits, std::move(container), diameter, extent, unseal(saved)) {}

TimeOrderedDrainage::TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                         const DrainageLimits& limits, std::shared_ptr<const Container> container,
                                         double diameter, double extent, ByteReader saved)
    : Drainage(spots, relaxation, limits, std::move(container), diameter),
      packing_(diameter, extent, take_grains(saved), Drainage::container().periodic()),
      spots_(spots, Drainage::container(), diameter),
      relaxation_(relaxation) {
  packing_.hold_gaps(relaxation.closing_gap * diameter);
  spots_.restore(saved);
  set_counters(saved.take<Counters>());
  relaxed_everywhere_ = saved.take<std::int64_t>();
}

void TimeOrderedDrainage::require_same_periods() const {
  container().periodic().require_same_as(packing_.periodic(), packing_.quantum());
}

void TimeOrderedDrainage::replace_packing(const std::vector<Grain>& grains) {
  packing_ = Packing(packing_.diameter(), packing_.extent(), grains, packing_.periodic());
  packing_.hold_gaps(relaxation_parameters().closing_gap * packing_.diameter());
}

/// Lists need not be saved: no bit depends on them.
Bytes TimeOrderedDrainage::save() const {
  Bytes bytes;
  append(bytes, static_cast<std::uint64_t>(packing_.size()));
  for (const Grain& grain : packing_.grains()) append(bytes, grain);
  spots_.save(bytes);
  append(bytes, counters());
  append(bytes, relaxed_everywhere_);
  seal(bytes);
  return bytes;
}

void TimeOrderedDrainage::advance_to(double time) {
  const bool global =
      relaxation_parameters().schedule == RelaxationSchedule::global && relaxation_parameters().every > 0;
  const double interval = relaxation_parameters().every * spot_parameters().mean_waiting_time();
  while (const auto move = spots_.next_step(time, container(), visit_positions())) {
    while (global && static_cast<double>(relaxed_everywhere_ + 1) * interval <= move->time) relax_everywhere();
    carry_out(*move);
  }
}

void TimeOrderedDrainage::carry_out(Move move) {
  packing_.refresh(container());
  const double reach = spot_parameters().radius + relaxation_parameters().shell * packing_.diameter();
  packing_.find_movable(move.middle, reach, near_);
  if (spot_parameters().fixed_volume > 0.0) {
    const int enclosed = enclosed_volume(packing_, near_, move, spot_parameters());
    move.weight = weigh(move, enclosed, spots_.carry(move, enclosed, container()));
  }
  const int enclosed = displace(packing_, near_, move, spot_parameters(), received_ ? &*received_ : nullptr);
  count_move(enclosed);
  if (enclosed == 0) {
    // Below the outlets a spot may meet no grains yet; above it, it has come out at the top of the packing.
    if (move.middle.z() > container().outlets().height() + spot_parameters().radius) spots_.remove(move.spot);
    return;
  }
  if (relaxes_around(move)) {
    packing_.update_lists(container());
    relax(near_);
  }
  if (move.middle.z() - reach < limits().outlet) take_out_drained(move.time);
}

bool TimeOrderedDrainage::relaxes_around(const Move& move) const {
  const int k = relaxation_parameters().every;
  if (k == 0) return false;
  switch (relaxation_parameters().schedule) {
    case RelaxationSchedule::moves:
      return counters().moves % k == 0;
    case RelaxationSchedule::chance:
      return move.chance * k < 1.0;
    case RelaxationSchedule::spot:
      return move.number % k == 0;
    default:
      return false;
  }
}

void TimeOrderedDrainage::relax(const std::vector<std::uint32_t>& grains) {
  const double deepest = relaxation_.sweep(packing_, container(), grains);
  count_sweep(grains.size());
  if (!relaxes_every_move() || deepest <= calibration::part_of_overlap_to_check_from * limits().overlap_allowed())
    return;
  packing_.update_lists(container());
  checks().require_no_collapse(packing_.largest_overlap(grains));
}

void TimeOrderedDrainage::relax_everywhere() {
  packing_.refresh(container());
  near_.clear();
  for (std::uint32_t i = 0; i < packing_.slots(); ++i)
    if (packing_.present(i) && !packing_.held(i)) near_.push_back(i);
  relax(near_);
  ++relaxed_everywhere_;
}

void TimeOrderedDrainage::take_out_drained(double time) {
  packing_.update_lists(container());
  std::vector<Grain> drained;
  for (const std::uint32_t i : near_) {
    const double below = limits().outlet - packing_.z()[i], quantum = packing_.quantum().length();
    if (below <= 0.0) continue;
    if (rates().at(container().nearest_outlet_index(packing_.position(i)), time) == 0.0)
      packing_.move(i, 0.0, 0.0, std::ceil(below / quantum) * quantum);
    else
      drained.push_back(packing_.remove(i));
  }
  add_drained(drained, spots_);
  if (relaxes_every_move()) checks().require_left_through_orifice(drained);
}

Overlap TimeOrderedDrainage::carry_out(const GrainChanges& changes) {
  TiledPacking tiled(packing_.diameter(), packing_.extent(), limits().outlet, packing_.grains(), container());
  const Overlap largest = tiled.change(changes.gone, changes.come, container());
  const std::set<std::int64_t> gone(changes.gone.begin(), changes.gone.end());
  std::vector<Grain> grains;
  for (const Grain& grain : packing_.grains())
    if (gone.count(grain.id) == 0) grains.push_back(grain);
  grains.insert(grains.end(), changes.come.begin(), changes.come.end());
  replace_packing(grains);
  if (largest.depth <= limits().largest_overlap) let_settle(tiled, false);
  return largest;
}

/// In the cells of the windowed driver, whose quantum is a multiple of the one here.
void TimeOrderedDrainage::let_settle(TiledPacking& tiled, bool everybody) {
  Workers alone(1);
  std::map<std::int64_t, Vector3> before;
  tiled.visit_grains([&](const Grain& grain) { before[grain.id] = grain.position; });
  Settling settling(tiled, spot_parameters().seed, relaxation_parameters().contact_overlap, container(), alone);
  if (settling.run(everybody) == 0) return;
  std::map<std::int64_t, Vector3> moved;
  tiled.visit_grains([&](const Grain& grain) {
    if (grain.position != before[grain.id]) moved[grain.id] = grain.position;
  });
  std::vector<Grain> grains = packing_.grains();
  for (Grain& grain : grains)
    if (const auto found = moved.find(grain.id); found != moved.end()) grain.position = found->second;
  replace_packing(grains);
}

void TimeOrderedDrainage::take_new_container() {
  require_same_periods();
  packing_.mark_near_walls(container());
  spots_.replace_container(container());
}

void TimeOrderedDrainage::visit_grains(const VisitGrain& visit, Which) const {
  for (std::size_t i = 0; i < packing_.slots(); ++i)
    if (packing_.present(i)) visit(packing_.grain(i));
}

Overlap TimeOrderedDrainage::largest_overlap() {
  packing_.refresh(container());
  return packing_.largest_overlap();
}

}  // namespace spot
