// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/time_ordered_drainage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenes.hpp"
#include "spot/walk/nonaffine_motion.hpp"

namespace {

using spot::Container;
using spot::DrainageLimits;
using spot::Grain;
using spot::InvalidContainer;
using spot::InvalidPacking;
using spot::InvalidParameter;
using spot::Move;
using spot::Packing;
using spot::RelaxationParameters;
using spot::RelaxationSchedule;
using spot::RelaxationStrength;
using spot::SpotParameters;
using spot::Spots;
using spot::TimeOrderedDrainage;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;

/// A silo of 12 x 8 diameters, filled to a height.
std::vector<Grain> filling(double height) {
  return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, height}, 0.01, 1);
}

/// Larger steps of grains than in 2006, so that short tests see much happen.
SpotParameters strong_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = 0.02;
  return spots;
}

TimeOrderedDrainage drainage_of(const std::vector<Grain>& grains, const SpotParameters& spots = strong_spots(),
                                const RelaxationParameters& relaxation = {}, double outlet = -1.0) {
  return {spots, relaxation, DrainageLimits{outlet}, scenes::small_silo(6.0, 4.0), Packing(1.0, 100.0, grains)};
}

/// The algorithm of 2006 with nothing clever: every grain is looked at for every move, every pair for every
/// relaxation. Shares the spots, the walls and the list of moves with spot-core.
class PlainDrainage {
 public:
  PlainDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation, double outlet,
                std::shared_ptr<const Container> container, const std::vector<Grain>& grains, double extent)
      : spots_(spots),
        relaxation_(relaxation),
        outlet_(outlet),
        container_(std::move(container)),
        population_(spots, *container_, 1.0),
        critical_(spots, 1.0),
        q_(spot::Quantum(1.0, extent).length()),
        grains_(grains) {
    for (Grain& grain : grains_)
      for (double& coordinate : grain.position) coordinate = rounded(coordinate);
  }

  void carry_out_moves(int number) {
    for (int k = 0; k < number; ++k) carry_out(*population_.next_step(1e9, *container_));
  }
  void carry_out_until(double time) {
    while (const auto move = population_.next_step(time, *container_)) carry_out(*move);
  }
  double time() const { return time_; }
  int moves() const { return moves_; }
  const std::vector<Grain>& grains() const { return grains_; }
  const std::vector<Grain>& drained() const { return drained_; }
  /// Moves that moved grains, and relaxations.
  int effective_moves() const { return effective_moves_; }
  int sweeps() const { return sweeps_; }
  /// In parts of a newborn spot's volume.
  double volume_left() const { return volume_left_; }
  /// Of live spots, over that of a newborn one, where it is another.
  const std::map<std::int64_t, double>& volumes() const { return volumes_; }

 private:
  double rounded(double length) const { return std::nearbyint(length / q_) * q_; }

  double weight_of(const Move& move) {
    int enclosed = 0;
    for (const Grain& grain : grains_)
      enclosed += !grain.held && squared(grain.position - move.middle) <= spots_.radius * spots_.radius;
    enclosed *= spot::grain_volume;
    const double height = move.middle.z() - outlet_;
    if (!critical_.on()) return spot::fixed_volume_weight(spots_, height, enclosed);
    const double volume = volumes_.count(move.spot) > 0 ? volumes_[move.spot] : 1.0;
    volumes_[move.spot] = critical_.volume_after(volume, move, enclosed, spot::Strain(), *container_);
    volume_left_ += volume - volumes_[move.spot];
    return spot::fixed_volume_weight(spots_, height, enclosed, volume);
  }

  Vector3 own_way(const Grain& grain) const {
    const spot::NonaffineMotion motion(spots_);
    if (!motion.on()) return Vector3::Zero();
    spot::NonaffineMotion::Tilt tilt{};
    motion.update(tilt, grain.id, grain.position.z());
    return motion.unit() * Vector3(tilt.x, tilt.y, tilt.z);
  }

  bool relaxes_around(const Move& move) const {
    const int k = relaxation_.every;
    switch (relaxation_.schedule) {
      case RelaxationSchedule::moves:
        return k > 0 && moves_ % k == 0;
      case RelaxationSchedule::chance:
        return k > 0 && move.chance < 1.0 / k;
      case RelaxationSchedule::spot:
        return k > 0 && move.number % k == 0;
      default:
        return false;
    }
  }

  void carry_out(const Move& move) {
    if (relaxation_.schedule == RelaxationSchedule::global && relaxation_.every > 0) {
      const double interval = relaxation_.every * spots_.mean_waiting_time();
      for (; (relaxed_everywhere_ + 1) * interval <= move.time; ++relaxed_everywhere_) {
        std::vector<bool> movable;
        for (const Grain& grain : grains_) movable.push_back(!grain.held);
        relax(movable);
      }
    }
    time_ = move.time;
    ++moves_;
    const double weight = weight_of(move);
    const double reach = spots_.radius + relaxation_.shell;
    std::vector<bool> movable;
    int moved = 0;
    for (Grain& grain : grains_) {
      const double distance_squared = squared(grain.position - move.middle);
      movable.push_back(!grain.held && distance_squared <= reach * reach);
      if (grain.held || distance_squared > spots_.radius * spots_.radius) continue;
      const Vector3 whole = -spots_.influence * weight * move.step, own = own_way(grain);
      for (int axis = 0; axis < 3; ++axis)
        grain.position[axis] += rounded(whole[axis] + std::abs(whole.z()) * own[axis]);
      ++moved;
    }
    if (moved == 0) {
      if (move.middle.z() > container_->outlets().height() + spots_.radius) {
        population_.remove(move.spot);
        volumes_.erase(move.spot);
      }
      return;
    }
    ++effective_moves_;
    if (relaxes_around(move)) relax(movable);
    for (std::size_t i = grains_.size(); i-- > 0;)
      if (grains_[i].position.z() < outlet_) {
        drained_.push_back(grains_[i]);
        grains_.erase(grains_.begin() + static_cast<std::ptrdiff_t>(i));
      }
  }

  void relax(const std::vector<bool>& movable) {
    ++sweeps_;
    std::vector<Vector3> pushes(grains_.size(), Vector3::Zero());
    const auto push = [&](std::size_t i, double scale, const Vector3& along) {
      for (int axis = 0; axis < 3; ++axis) pushes[i][axis] += rounded(scale * along[axis]);
    };
    for (std::size_t i = 0; i < grains_.size(); ++i) {
      if (!movable[i]) continue;
      for (std::size_t j = 0; j < grains_.size(); ++j) {
        const Vector3 apart = grains_[i].position - grains_[j].position;
        const double widest = 1.0 + relaxation_.closing_gap;
        if (j == i || squared(apart) >= widest * widest) continue;
        double share = movable[j] ? relaxation_.pair_share() : relaxation_.fixed_share();
        if (squared(apart) > 1.0) share *= relaxation_.closing_share;
        const double distance = std::sqrt(squared(apart));
        push(i, share * (1.0 - distance) / distance, apart);
      }
      spot::WallContacts contacts;
      container_->contacts(grains_[i].position, 0.5, contacts);
      for (const spot::WallContact& wall : contacts)
        push(i, relaxation_.fixed_share() * (0.5 - wall.distance), wall.normal);
    }
    for (std::size_t i = 0; i < grains_.size(); ++i) grains_[i].position += pushes[i];
  }

  /// In the order of additions that spot-core has; Eigen promises none.
  static double squared(const Vector3& v) { return v.x() * v.x() + v.y() * v.y() + v.z() * v.z(); }

  SpotParameters spots_;
  RelaxationParameters relaxation_;
  double outlet_;
  std::shared_ptr<const Container> container_;
  Spots population_;
  spot::CriticalState critical_;
  std::map<std::int64_t, double> volumes_;
  double volume_left_ = 0.0;
  double q_;
  std::vector<Grain> grains_, drained_;
  double time_ = 0.0;
  int moves_ = 0, effective_moves_ = 0, sweeps_ = 0, relaxed_everywhere_ = 0;
};

std::vector<Grain> by_id(std::vector<Grain> grains) {
  std::sort(grains.begin(), grains.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return grains;
}

struct Scheme {
  std::string name;
  RelaxationParameters relaxation;
  double influence;
  double fixed_volume = 0.0;
  bool together = false;
  double critical_fraction = 0.0, nonaffine = 0.0;
};

void PrintTo(const Scheme& scheme, std::ostream* out) { *out << scheme.name; }

class DrainageBruteForce : public testing::TestWithParam<Scheme> {};

/// The schedules in their own words; moves that moved nobody are not followed by a relaxation.
void expect_as_many_sweeps_as_scheduled(const PlainDrainage& plain, const RelaxationParameters& relaxation,
                                        double waiting_time) {
  const double k = relaxation.every, n = plain.effective_moves();
  const auto sweeps = static_cast<double>(plain.sweeps());
  if (k == 0) {
    EXPECT_EQ(sweeps, 0);
  } else if (relaxation.schedule == RelaxationSchedule::chance) {
    EXPECT_NEAR(sweeps, n / k, 5.0 * std::sqrt(n / k * (1.0 - 1.0 / k)));
  } else if (relaxation.schedule == RelaxationSchedule::global) {
    EXPECT_EQ(sweeps, std::floor(plain.time() / (k * waiting_time) + 1e-9));
  } else if (k == 1) {
    EXPECT_EQ(sweeps, n);
  } else {
    // Every k-th of all moves or of each spot's, a spot with fewer of them moves none after its first k - 1.
    EXPECT_NEAR(sweeps, n / k, 0.15 * n / k);
  }
}

/// Equal to the last bit after a few hundred moves, and after a few thousand, when grains have left.
TEST_P(DrainageBruteForce, EqualsThePlainAlgorithmToTheLastBit) {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = GetParam().influence;
  spots.fixed_volume = GetParam().fixed_volume;
  spots.together = GetParam().together;
  spots.critical_fraction = GetParam().critical_fraction;
  spots.exchange_length = 0.2;
  spots.nonaffine = GetParam().nonaffine;
  spots.nonaffine_length = 0.1;
  if (spots.critical_fraction > 0.0) {  // to where they leave volume in fewer moves
    spots.step_height = 0.8;
    spots.injection_rate = 60.0;
  }
  std::vector<Grain> grains = filling(spots.critical_fraction > 0.0 ? 12.0 : 6.0);
  grains[40].held = grains[41].held = true;
  TimeOrderedDrainage drainage = drainage_of(grains, spots, GetParam().relaxation);
  PlainDrainage plain(spots, GetParam().relaxation, -1.0, scenes::small_silo(6.0, 4.0), grains, 100.0);
  for (const int moves : {300, 700, 2000}) {
    plain.carry_out_moves(moves);
    plain.carry_out_until(plain.time());  // what is left at the same time
    drainage.advance_to(plain.time());
    scenes::expect_identical(drainage.packing().grains(), by_id(plain.grains()));
  }
  scenes::expect_identical(drainage.take_drained(), by_id(plain.drained()));
  EXPECT_GE(plain.moves(), 3000);
  EXPECT_EQ(drainage.counters().moves, plain.moves());
  EXPECT_EQ(drainage.counters().sweeps, plain.sweeps());
  expect_as_many_sweeps_as_scheduled(plain, GetParam().relaxation, spots.mean_waiting_time());
  EXPECT_EQ(static_cast<double>(drainage.counters().volume_left) / spot::CriticalState::volume_parts,
            plain.volume_left());
  EXPECT_EQ(std::abs(plain.volume_left()) > 0.1, spots.critical_fraction > 0.0);
  for (const spot::Spot& spot : drainage.spots())
    EXPECT_EQ(spot.volume, plain.volumes().count(spot.id) > 0 ? plain.volumes().at(spot.id) : 1.0);
}

Scheme make_scheme(const std::string& name, double influence, RelaxationStrength strength, double shell, int every) {
  RelaxationParameters relaxation;
  relaxation.strength = strength;
  relaxation.shell = shell;
  relaxation.every = every;
  return {name, relaxation, influence};
}

Scheme make_scheme(const std::string& name, RelaxationSchedule schedule, int every) {
  Scheme scheme = make_scheme(name, 0.02, RelaxationStrength::half_each, 1.0, every);
  scheme.relaxation.schedule = schedule;
  return scheme;
}

Scheme with_closing(Scheme scheme, double gap, double share) {
  scheme.relaxation.closing_gap = gap;
  scheme.relaxation.closing_share = share;
  scheme.name += "Closing";
  return scheme;
}

Scheme with(Scheme scheme, double fixed_volume, bool together) {
  scheme.fixed_volume = fixed_volume;
  scheme.together = together;
  scheme.name += (fixed_volume > 0.0 ? "FixedVolume" : "") + std::string(together ? "Together" : "");
  return scheme;
}

Scheme with_ingredients(Scheme scheme, double fixed_volume, double critical_fraction, double nonaffine) {
  scheme.fixed_volume = fixed_volume;
  scheme.critical_fraction = critical_fraction;
  scheme.nonaffine = nonaffine;
  scheme.name += std::string(critical_fraction > 0.0 ? "Critical" : "") + (nonaffine > 0.0 ? "Nonaffine" : "");
  return scheme;
}

const Scheme strong = make_scheme("Strong", 0.02, RelaxationStrength::half_each, 1.0, 1);
const Scheme chance = make_scheme("Chance", RelaxationSchedule::chance, 4);
const Scheme global = make_scheme("Global", RelaxationSchedule::global, 3);

INSTANTIATE_TEST_SUITE_P(Schemes, DrainageBruteForce,
                         testing::Values(make_scheme("Of2006", 2.5e-3, RelaxationStrength::full_each, 1.0, 1),
                                         make_scheme("Of2010", 2.5e-3, RelaxationStrength::half_each, 1.0, 1), strong,
                                         with(strong, 77.0, false), with(strong, 0.0, true), with(strong, 77.0, true),
                                         with_closing(strong, 0.004, 0.1), with_closing(global, 0.05, 1.0),
                                         with_ingredients(strong, 77.0, 0.56, 0.0),
                                         with_ingredients(strong, 0.0, 0.0, 0.2),
                                         with_ingredients(strong, 77.0, 0.56, 0.2), chance, with(chance, 0.0, true),
                                         make_scheme("OneInOne", RelaxationSchedule::chance, 1),
                                         make_scheme("EachSpot", RelaxationSchedule::spot, 3),
                                         make_scheme("EachSpotEachMove", RelaxationSchedule::spot, 1), global,
                                         with(global, 77.0, true),
                                         make_scheme("GlobalNever", RelaxationSchedule::global, 0),
                                         make_scheme("ChanceNever", RelaxationSchedule::chance, 0),
                                         make_scheme("Rare", 0.02, RelaxationStrength::half_each, 1.0, 7),
                                         make_scheme("Never", 0.02, RelaxationStrength::half_each, 1.0, 0),
                                         make_scheme("NoShell", 0.02, RelaxationStrength::half_each, 0.0, 1)),
                         [](const auto& scheme) { return scheme.param.name; });

TEST(DrainageBruteForce, LargestOverlapIsThatOfAllPairs) {
  RelaxationParameters never;
  never.every = 0;
  TimeOrderedDrainage drainage = drainage_of(filling(6.0), strong_spots(), never);
  drainage.advance_to(1.0);
  double largest = 0.0;
  const auto grains = drainage.packing().grains();
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      largest = std::max(largest, 1.0 - (grains[i].position - grains[j].position).norm());
  EXPECT_GT(largest, 0.0);
  EXPECT_NEAR(drainage.largest_overlap().depth, largest, 1e-15);
}

/// All that a run leaves behind.
struct Outcome {
  std::vector<Grain> left, drained;
  spot::Counters counters;
};

Outcome outcome_of(TimeOrderedDrainage drainage, const std::vector<double>& times) {
  for (const double time : times) drainage.advance_to(time);
  return {drainage.packing().grains(), drainage.take_drained(), drainage.counters()};
}

void expect_identical(const Outcome& a, const Outcome& b) {
  scenes::expect_identical(a.left, b.left);
  scenes::expect_identical(a.drained, b.drained);
  EXPECT_EQ(a.counters.moves, b.counters.moves);
  EXPECT_EQ(a.counters.volume_moved, b.counters.volume_moved);
  EXPECT_EQ(a.counters.sweeps, b.counters.sweeps);
}

TEST(DrainageInvariance, ARerunIsIdentical) {
  const auto grains = filling(6.0);
  const Outcome outcome = outcome_of(drainage_of(grains), {1.5});
  EXPECT_GT(outcome.drained.size(), 50u);
  expect_identical(outcome_of(drainage_of(grains), {1.5}), outcome);
}

TEST(DrainageInvariance, OrderOfTheInputChangesNothing) {
  std::vector<Grain> grains = filling(6.0);
  const Outcome outcome = outcome_of(drainage_of(grains), {1.5});
  scenes::Draws draws(1);
  for (int order = 0; order < 3; ++order) {
    draws.shuffle(grains);
    expect_identical(outcome_of(drainage_of(grains), {1.5}), outcome);
  }
}

TEST(DrainageInvariance, AdvancingInPiecesChangesNothing) {
  const auto grains = filling(6.0);
  std::vector<double> pieces;
  for (int k = 1; k <= 1500; ++k) pieces.push_back(1e-3 * k);
  pieces.back() = 1.5;
  expect_identical(outcome_of(drainage_of(grains), pieces), outcome_of(drainage_of(grains), {1.5}));
}

TEST(DrainageInvariance, LookingOnChangesNothing) {
  const auto grains = filling(6.0);
  TimeOrderedDrainage watched = drainage_of(grains);
  std::vector<Grain> drained;
  for (int k = 1; k <= 150; ++k) {
    watched.advance_to(0.01 * k);
    watched.largest_overlap();
    for (const Grain& grain : watched.take_drained()) drained.push_back(grain);
  }
  const Outcome outcome = outcome_of(drainage_of(grains), {1.5});
  scenes::expect_identical(watched.packing().grains(), outcome.left);
  scenes::expect_identical(by_id(drained), outcome.drained);
}

TEST(DrainageInvariance, AnotherSeedGivesAnotherRun) {
  SpotParameters spots = strong_spots();
  const Outcome outcome = outcome_of(drainage_of(filling(6.0), spots), {0.5});
  ++spots.seed;
  const Outcome other = outcome_of(drainage_of(filling(6.0), spots), {0.5});
  EXPECT_NE(outcome.counters.moves, other.counters.moves);
}

/// Lengths in metres, times in seconds: the same run in other units, up to the rounding to another quantum.
TEST(DrainageInvariance, UnitsChangeOnlyTheLastDigits) {
  const double d = 3e-3, tau = 17.487e-3;
  SpotParameters spots = strong_spots();
  const auto grains = filling(6.0);
  const Outcome outcome = outcome_of(drainage_of(grains, spots), {0.2});
  std::vector<Grain> in_metres = grains;
  for (Grain& grain : in_metres) grain.position *= d;
  spots.radius *= d;
  spots.step_width *= d;
  spots.step_height *= d;
  spots.speed *= d / tau;
  spots.injection_rate = spots.injection_rate.largest() / tau;
  const spot::Orifice orifice{{0.0, 0.0, 0.0}, 4.0 * d};
  TimeOrderedDrainage metric(spots, {}, DrainageLimits{-d},
                             spot::box_silo(-6.0 * d, 6.0 * d, -4.0 * d, 4.0 * d, orifice, {d, spots.radius}),
                             Packing(d, 100.0 * d, in_metres));
  metric.advance_to(0.2 * tau);
  EXPECT_EQ(metric.counters().moves, outcome.counters.moves);
  const auto left = metric.packing().grains();
  ASSERT_EQ(left.size(), outcome.left.size());
  for (std::size_t i = 0; i < left.size(); ++i)
    EXPECT_LT((left[i].position / d - outcome.left[i].position).norm(), 1e-6) << "grain " << left[i].id;
}

TEST(DrainageUnit, EveryGrainIsEitherLeftOrDrainedOnce) {
  const auto grains = filling(8.0);
  TimeOrderedDrainage drainage = drainage_of(grains);
  std::set<std::int64_t> drained;
  for (int k = 1; k <= 20; ++k) {
    drainage.advance_to(0.2 * k);
    std::int64_t last = 0;
    for (const Grain& grain : drainage.take_drained()) {
      EXPECT_GT(grain.id, last) << "in increasing order of ids";
      last = grain.id;
      EXPECT_LT(grain.position.z(), -1.0);
      EXPECT_GT(grain.position.z(), -1.5) << "taken out as soon as it was below the outlet";
      EXPECT_TRUE(drained.insert(grain.id).second) << "grain " << grain.id << " was handed out twice";
    }
    EXPECT_TRUE(drainage.take_drained().empty());
    EXPECT_EQ(drainage.counters().drained, static_cast<std::int64_t>(drained.size()));
    const auto left = drainage.packing().grains();
    EXPECT_EQ(left.size(), drainage.packing().size());
    EXPECT_EQ(left.size() + drained.size(), grains.size());
    for (const Grain& grain : left) EXPECT_EQ(drained.count(grain.id), 0u);
  }
  EXPECT_GT(drained.size(), 200u);
}

TEST(DrainageUnit, NobodyLeavesTheContainerButThroughTheOrifice) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TimeOrderedDrainage drainage = drainage_of(filling(8.0));
  for (int k = 1; k <= 60; ++k) {
    drainage.advance_to(0.05 * k);
    for (const Grain& grain : drainage.packing().grains()) {
      if (grain.position.z() >= 0.0) {
        EXPECT_TRUE(silo->contains(grain.position)) << grain.position.transpose();
      } else {
        EXPECT_GE(grain.position.z(), -1.0);
        EXPECT_LT(grain.position.head<2>().norm(), 4.0) << "below the base, beside the orifice";
      }
    }
  }
}

TEST(DrainageUnit, HeldGrainsStay) {
  std::vector<Grain> grains = filling(6.0);
  for (std::size_t i = 0; i < grains.size(); i += 10) grains[i].held = true;
  const auto start = Packing(1.0, 100.0, grains).grains();
  TimeOrderedDrainage drainage = drainage_of(grains);
  drainage.advance_to(2.0);
  EXPECT_GT(drainage.counters().drained, 0);
  int held = 0;
  for (const Grain& grain : drainage.packing().grains()) {
    if (!grain.held) continue;
    ++held;
    EXPECT_EQ(grain.position, start[static_cast<std::size_t>(grain.id - 1)].position);
  }
  EXPECT_EQ(held, static_cast<int>((grains.size() + 9) / 10));
}

TEST(DrainageUnit, SpotsAreRemovedAboveThePacking) {
  TimeOrderedDrainage drainage = drainage_of(filling(6.0), scenes::paper_spots());
  drainage.advance_to(6.0);
  EXPECT_FALSE(drainage.spots().empty());
  double top = 0.0;
  for (const Grain& grain : drainage.packing().grains()) top = std::max(top, grain.position.z());
  for (const spot::Spot& spot : drainage.spots()) EXPECT_LT(spot.position.z(), top + 2.6 + 0.1);
  // Born at nu_s, alive while they climb from R_s below the orifice to R_s above the packing.
  EXPECT_LT(static_cast<double>(drainage.spots().size()), 363.0 * (top + 2.0 * 2.6) / 3.2 * 1.2);
}

TEST(DrainageUnit, MovesThatGrainsReceiveAreCounted) {
  RelaxationParameters never;
  never.every = 0;
  std::vector<Grain> grains = filling(8.0);
  grains[100].held = true;
  TimeOrderedDrainage drainage = drainage_of(grains, strong_spots(), never);
  drainage.advance_to(0.5);
  EXPECT_TRUE(drainage.take_moves_received().empty()) << "nobody has asked for it";
  const std::vector<Grain> before = drainage.grains();
  const std::int64_t moved_before = drainage.counters().volume_moved;
  drainage.count_moves_received();
  drainage.advance_to(2.0);
  spot::MovesReceived received = drainage.take_moves_received();
  std::int64_t moved = 0;
  for (const auto& [id, moves] : received) moved += moves;
  EXPECT_EQ(moved, (drainage.counters().volume_moved - moved_before) / spot::grain_volume);
  EXPECT_GT(drainage.counters().drained, 0);
  // Without relaxation every move takes a grain down by as much.
  const double down = drainage.quantum().round(strong_spots().influence * strong_spots().step_height);
  std::map<std::int64_t, double> start;
  for (const Grain& grain : before) start[grain.id] = grain.position.z();
  for (const Grain& grain : drainage.grains())
    EXPECT_EQ(start[grain.id] - grain.position.z(), down * static_cast<double>(received[grain.id])) << grain.id;
  EXPECT_TRUE(drainage.take_moves_received().empty()) << "taken already";
}

TEST(DrainageUnit, CountersAddUp) {
  RelaxationParameters relaxation;
  relaxation.every = 5;
  TimeOrderedDrainage drainage = drainage_of(filling(6.0), scenes::paper_spots(), relaxation);
  EXPECT_EQ(drainage.counters().grains_per_move(), 0.0);
  drainage.advance_to(1.0);
  const spot::Counters& counters = drainage.counters();
  EXPECT_GT(counters.moves, 1000);
  EXPECT_LE(counters.sweeps, counters.moves / 5);
  EXPECT_DOUBLE_EQ(counters.grains_per_move(), static_cast<double>(counters.volume_moved) / spot::grain_volume /
                                                   static_cast<double>(counters.moves));
}

TEST(DrainageUnit, AnEmptyPackingWorks) {
  TimeOrderedDrainage drainage = drainage_of({});
  drainage.advance_to(3.0);
  EXPECT_EQ(drainage.packing().size(), 0u);
  EXPECT_EQ(drainage.counters().drained, 0);
  EXPECT_TRUE(drainage.take_drained().empty());
  EXPECT_EQ(drainage.largest_overlap().depth, 0.0);
  EXPECT_LT(drainage.spots().size(), 2000u) << "spots in an empty silo do not climb for ever";
}

TEST(DrainageUnit, ASingleGrainDrains) {
  TimeOrderedDrainage drainage = drainage_of({{17, {0.3, -0.2, 0.5}}});
  drainage.advance_to(3.0);
  const auto drained = drainage.take_drained();
  ASSERT_EQ(drained.size(), 1u);
  EXPECT_EQ(drained[0].id, 17);
  EXPECT_LT(drained[0].position.head<2>().norm(), 4.0);
  drainage.advance_to(4.0);
  EXPECT_TRUE(drainage.take_drained().empty());
}

TEST(DrainageUnit, AGrainLeftInTheCornerStays) {
  TimeOrderedDrainage drainage = drainage_of({{1, {5.5, 3.5, 0.5}}});
  drainage.advance_to(2.0);
  EXPECT_EQ(drainage.packing().size(), 1u);
}

/// After somebody else has looked at the grains and changed nothing, the run goes on as if nobody had.
// Disabled: grains that fall between orifice and outlet count as outside, so that no run can be replaced by itself.
TEST(DrainageInvariance, ReplacingThePackingByItselfChangesNothing) {
  const auto grains = filling(6.0);
  TimeOrderedDrainage replaced = drainage_of(grains);
  replaced.advance_to(0.7);
  replaced.replace_container(scenes::small_silo(6.0, 4.0));
  replaced.replace_grains(replaced.grains());
  replaced.advance_to(1.5);
  const Outcome outcome = outcome_of(drainage_of(grains), {1.5});
  scenes::expect_identical(replaced.packing().grains(), outcome.left);
  scenes::expect_identical(replaced.take_drained(), outcome.drained);
}

TEST(DrainageUnit, ReplacingChecksTheNewGrains) {
  TimeOrderedDrainage drainage = drainage_of({{1, {0.0, 0.0, 1.0}}});
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                drainage.replace_grains({{9, {7.0, 0.0, 1.0}}});
              }),
              AllOf(HasSubstr("grain 9 "), HasSubstr("outside")));
  EXPECT_EQ(drainage.packing().grains()[0].id, 1) << "a refused packing changes nothing";
}

/// Without relaxation nothing keeps grains off the walls.
TEST(DrainageUnit, GrainsThatWereDrivenOutOfTheContainerAreNamed) {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = 0.7;
  RelaxationParameters never;
  never.every = 0;
  TimeOrderedDrainage drainage = drainage_of(filling(6.0), spots, never);
  EXPECT_NO_THROW(drainage.require_inside());
  drainage.advance_to(4.0);
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] { drainage.require_inside(); }),
              AllOf(HasSubstr("grain "), HasSubstr("is outside the container")));
}

/// The text of the error of a drainage with paper's spots, one number of them changed.
template <typename Number>
std::string refusal_of(Number SpotParameters::*number, double value) {
  SpotParameters spots = scenes::paper_spots();
  spots.*number = value;
  return scenes::text_of<InvalidParameter>([&] { drainage_of({{1, {0.0, 0.0, 1.0}}}, spots); });
}

TEST(DrainageUnit, StepsThatNoRelaxationCouldFollowAreRefusedWithTheirBound) {
  EXPECT_THAT(refusal_of(&SpotParameters::influence, 0.8), AllOf(HasSubstr("up to 0.549"), HasSubstr("at most 0.5")));
  // The weight of a spot with a fixed volume can be this over 20.
  EXPECT_THAT(refusal_of(&SpotParameters::fixed_volume, 6000.0),
              AllOf(HasSubstr("up to 0.515"), HasSubstr("at most 0.5"), HasSubstr("volume")));
  EXPECT_THAT(refusal_of(&SpotParameters::step_height, 17.0), AllOf(HasSubstr("17 diameters"), HasSubstr("most 16")));
  EXPECT_THAT(refusal_of(&SpotParameters::step_width, 17.0), AllOf(HasSubstr("17 diameters"), HasSubstr("most 16")));
  EXPECT_THAT(refusal_of(&SpotParameters::step_height, 1e-300), AllOf(HasSubstr("1e-300"), HasSubstr("least 1e-06")));
  EXPECT_THAT(refusal_of(&SpotParameters::injection_rate, 1e9), AllOf(HasSubstr("1e+09"), HasSubstr("most 10000000")));
  EXPECT_THAT(refusal_of(&SpotParameters::speed, 1e-12), AllOf(HasSubstr("3.63e+14"), HasSubstr("most 10000000")));
}

TEST(DrainageUnit, DisplacementIsBoundedWithWhatSpotsTakeUpAndGrainsOwnWays) {
  SpotParameters spots = scenes::paper_spots();
  spots.fixed_volume = 5000.0;
  spots.critical_fraction = 0.6;
  spots.exchange_length = 1.0;
  EXPECT_NO_THROW(drainage_of({}, spots)) << "one that carries more is cut off earlier";
  spots.nonaffine = 0.2;
  spots.nonaffine_length = 1e-300;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, spots); }),
              AllOf(HasSubstr("length of non-affine motion is 1e-300 "), HasSubstr("at least 0.01")));
  spots.nonaffine_length = 1.0;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, spots); }),
              AllOf(HasSubstr("up to 0.687"), HasSubstr("at most 0.5")));
}

TEST(DrainageUnit, APackingThatCollapsesInFlowIsAnError) {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = 0.2;
  RelaxationParameters weak;
  weak.alpha = 0.05;
  TimeOrderedDrainage drainage = drainage_of(filling(8.0), spots, weak);
  EXPECT_THAT(scenes::text_of<spot::CollapsedPacking>([&] { drainage.advance_to(4.0); }),
              AllOf(HasSubstr("grain"), HasSubstr("relax more")));
}

TEST(DrainageUnit, HowDeepOverlapsMayBeInFlowIsSettable) {
  const std::vector<Grain> pair = {{1, {0.0, 0.0, 1.0}}, {2, {0.6, 0.0, 1.0}}, {3, {0.0, 0.0, 3.0}}};
  RelaxationParameters weak;
  weak.alpha = 1e-3;
  const auto start = [&](double at_start, double in_flow) {
    return TimeOrderedDrainage(scenes::paper_spots(), weak, DrainageLimits{-1.0, at_start, in_flow},
                               scenes::small_silo(6.0, 4.0), Packing(1.0, 100.0, pair));
  };
  // What is allowed at the start is allowed later.
  EXPECT_NO_THROW(start(0.5, 0.3).advance_to(0.5));
  EXPECT_NO_THROW(start(0.41, 0.5).advance_to(0.5));
  EXPECT_THROW(start(0.41, 0.0), InvalidParameter);
}

TEST(DrainageUnit, GrainsThatOverlapAWallAtTheStartAreNamed) {
  const auto start = [](const Vector3& place, double at_start, bool held = false) {
    return TimeOrderedDrainage(scenes::paper_spots(), RelaxationParameters(), DrainageLimits{-1.0, at_start},
                               scenes::small_silo(6.0, 4.0), Packing(1.0, 100.0, {{1, {0, 0, 2}}, {7, place, held}}));
  };
  const auto says = [](const char* depth) {
    return AllOf(HasSubstr(spot::message("grain 7 overlaps a wall by ", depth)), HasSubstr("at most 0.03"));
  };
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] { start({5.625, 0.0, 3.0}, 0.03); }), says("0.125"));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] { start({6.0, 0.0, 3.0}, 0.03); }), says("0.5"));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] { start({5.0, 3.0, 0.25}, 0.03); }), says("0.25"));
  EXPECT_NO_THROW(start({5.52, 0.0, 3.0}, 0.03));
  EXPECT_NO_THROW(start({5.625, 0.0, 3.0}, 0.13));
  EXPECT_NO_THROW(start({5.625, 0.0, 3.0}, 0.03, true)) << "held grains may be part of the wall";
}

TEST(DrainageUnit, GrainsOutsideAreNamed) {
  for (const Vector3& outside : {Vector3(6.1, 0, 3), Vector3(0, -4.2, 3), Vector3(5.1, 0, -0.1), Vector3(0, 0, -1.1)})
    EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                  drainage_of({{1, {0.0, 0.0, 1.0}}, {42, outside}});
                }),
                AllOf(HasSubstr("grain 42 "), HasSubstr("outside the container")));
}

TEST(DrainageUnit, DeepOverlapsAtTheStartNameBothGrainsAndTheBound) {
  EXPECT_NO_THROW(drainage_of({{1, {0.0, 0.0, 1.0}}, {2, {0.971, 0.0, 1.0}}}));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([] {
                drainage_of({{31, {0.0, 0.0, 1.0}}, {12, {0.95, 0.0, 1.0}}, {5, {3.0, 0.0, 1.0}}});
              }),
              AllOf(HasSubstr("grains 12 and 31 "), HasSubstr("0.05"), HasSubstr("0.03")));
  EXPECT_NO_THROW(TimeOrderedDrainage(scenes::paper_spots(), {}, DrainageLimits{-1.0, 0.06},
                                      scenes::small_silo(6.0, 4.0),
                                      Packing(1.0, 100.0, {{31, {0.0, 0.0, 1.0}}, {12, {0.95, 0.0, 1.0}}})))
      << "the bound can be set";
}

TEST(DrainageUnit, OverlapIsMeasuredInDiameters) {
  const double d = 3e-3;
  SpotParameters spots = scenes::paper_spots();
  for (double* length : {&spots.radius, &spots.step_width, &spots.step_height, &spots.speed}) *length *= d;
  const auto start = [&](double distance) {
    const spot::Orifice orifice{{0.0, 0.0, 0.0}, 4.0 * d};
    TimeOrderedDrainage(spots, {}, DrainageLimits{-d},
                        spot::box_silo(-6.0 * d, 6.0 * d, -4.0 * d, 4.0 * d, orifice, {d, spots.radius}),
                        Packing(d, 1.0, {{1, {0.0, 0.0, d}}, {2, {distance * d, 0.0, d}}}));
  };
  EXPECT_NO_THROW(start(0.975));
  EXPECT_THAT(scenes::text_of<InvalidPacking>([&] { start(0.95); }), HasSubstr("overlap by 0.05"));
}

TEST(DrainageUnit, OutletOutOfReachOrAboveTheOrificeIsNamed) {
  for (const double bad : {-5.2, 0.1, std::nan("")})
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), {}, bad); }),
                AllOf(HasSubstr("outlet"), HasSubstr("-5.15"), HasSubstr("orifice, 0")));
  EXPECT_NO_THROW(drainage_of({}, scenes::paper_spots(), {}, 0.0));
}

TEST(DrainageUnit, BadParametersAreRefused) {
  EXPECT_THROW(drainage_of({}, SpotParameters()), InvalidParameter);
  RelaxationParameters relaxation;
  relaxation.alpha = -1.0;
  EXPECT_THROW(drainage_of({}, scenes::paper_spots(), relaxation), InvalidParameter);
  SpotParameters wide = scenes::paper_spots();
  wide.radius = 4.5;
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] { drainage_of({}, wide); }),
              AllOf(HasSubstr("orifice radius is 4"), HasSubstr("4.5")));
}

}  // namespace
