// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/windowed_drainage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "invariants.hpp"
#include "plain_packing.hpp"
#include "scenes.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/walk/calibration.hpp"

namespace {

using spot::DrainageLimits;
using spot::Grain;
using spot::InvalidParameter;
using spot::Move;
using spot::RelaxationParameters;
using spot::SpotParameters;
using spot::WindowedDrainage;
using testing::AllOf;
using testing::HasSubstr;

constexpr double window = 5e-3;

std::vector<Grain> filling(double height) {
  return scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, height}, 0.01, 2);
}

WindowedDrainage drainage_of(const std::vector<Grain>& grains, const SpotParameters& spots = scenes::paper_spots(),
                             const RelaxationParameters& relaxation = {}, double length = window, int threads = 1,
                             double overlap_in_flow = 0.3) {
  return WindowedDrainage(spots, relaxation, DrainageLimits{-1.0, 0.03, overlap_in_flow}, length, threads,
                          scenes::small_silo(6.0, 4.0), 1.0, 100.0, grains);
}

/// As far as 2006 can be coarsened: large steps, momentum.
SpotParameters coarse_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.step_height = 0.8;
  spots.step_width = spot::step_width_for(1.25, spots.step_height);
  return spots;
}

RelaxationParameters coarse_relaxation() {
  RelaxationParameters relaxation;
  relaxation.tolerance = 4e-3;
  relaxation.alpha = 1.2;
  relaxation.momentum = 0.7;
  return relaxation;
}

std::vector<Grain> by_id(std::vector<Grain> grains) {
  std::sort(grains.begin(), grains.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return grains;
}

/// Births, walks and displacements of a windowed drainage that never relaxes, with nothing clever.
class PlainWindows {
 public:
  PlainWindows(const SpotParameters& spots, double length, const std::vector<Grain>& grains)
      : spots_(spots),
        window_(length),
        silo_(scenes::small_silo(6.0, 4.0)),
        walk_(spots, *silo_),
        packing_(1.0, 100.0, outlet, grains, *silo_),
        critical_(spots, 1.0),
        flow_(spots, *silo_, 1.0),
        surface_(spots, *silo_, 1.0),
        next_birth_(time_of_birth(0, 0.0)) {}

  double time_of_birth(std::int64_t id, double time_before) const {
    return spots_.injection_rate.next_birth(time_before, walk_.births_expected(id));
  }

  void advance_by_a_window() {
    const double now = windows_ * window_, until = ++windows_ * window_;
    spot::DilationField field(spots_, *silo_, 1.0);
    std::vector<spot::Vector3> places;
    for (const Live& live : live_)
      if (!live.out) places.push_back(live.spot.position);
    spot::Alone alone;
    spot::Workers workers(1);
    field.count(places, alone, workers);
    const auto set_speed = [&](spot::Spot& spot, double time) {
      if (spots_.dilation > 0.0) walk_.set_relative_speed(spot, time, field.relative_speed(spot.position));
    };
    for (Live& live : live_) set_speed(live.spot, now);
    for (; next_birth_ <= until; next_birth_ = time_of_birth(++born_, next_birth_)) {
      live_.push_back({walk_.birth(born_, next_birth_, *silo_), false});
      set_speed(live_.back().spot, next_birth_);
    }
    if (const double interval = spot::calibration::climb_between_surfaces * spots_.radius / spots_.speed;
        windows_ == 1 || std::floor(now / interval) > std::floor((now - window_) / interval)) {
      surface_.clear();
      for (const Grain& grain : packing_.grains()) surface_.add(grain.position);
      surface_.gather(alone);
    }
    for (Live& live : live_) {
      while (live.spot.next_step <= until && !live.out)
        moves_of_window_.emplace_back(walk_.step(live.spot, *silo_, surface_, flow_), &live);
    }
    packing_.draw_tilts(spots_);
    // All are weighed before the first is carried out.
    for (auto& [move, live] : moves_of_window_) {
      const int shares = packing_.shares(move, spots_);
      ++moves;
      volume_moved += shares;
      move.weight = spot::fixed_volume_weight(spots_, move.middle.z() - outlet, shares, live->spot.volume);
      flow_.add(move, live->spot.volume);
      if (critical_.on())
        live->spot.volume = critical_.volume_after(live->spot.volume, move, shares, flow_.strain(move.middle), *silo_);
      if (shares == 0 && move.middle.z() > spots_.radius) live->out = true;
    }
    for (const auto& [move, live] : moves_of_window_) packing_.displace(move, spots_);
    moves_of_window_.clear();
    flow_.update(window_, alone);
    for (const Grain& grain : packing_.take_out_below(outlet)) drained.push_back(grain);
  }

  static constexpr double outlet = -1.0;
  std::int64_t moves = 0, volume_moved = 0;
  std::vector<Grain> drained;
  std::vector<Grain> grains() const { return packing_.grains(); }
  const spot::MovesReceived& received() const { return packing_.received; }

 private:
  struct Live {
    spot::Spot spot;
    bool out;
  };

  SpotParameters spots_;
  double window_;
  std::shared_ptr<const spot::Container> silo_;
  spot::SpotWalk walk_;
  scenes::PlainPacking packing_;
  spot::CriticalState critical_;
  spot::FlowField flow_;
  spot::FreeSurface surface_;
  std::vector<Live> live_;
  std::vector<std::pair<Move, Live*>> moves_of_window_;
  double next_birth_;
  std::int64_t born_ = 0;
  int windows_ = 0;
};

struct Spots {
  std::string name;
  double fixed_volume;
  bool together;
  bool parabolic = false;
  double dilation = 0.0;
  double critical_fraction = 0.0, dilatancy = 0.0, surface_exponent = 0.0, nonaffine = 0.0, spread = 0.0;
  bool mobility = false;
  double full_strain = 0.0;
};

class WindowedDrainageBruteForce : public testing::TestWithParam<Spots> {};

TEST_P(WindowedDrainageBruteForce, WithoutRelaxationItEqualsThePlainAlgorithmToTheLastBit) {
  SpotParameters spots = coarse_spots();
  spots.influence = 0.01;
  spots.injection_rate = 60.0;
  spots.fixed_volume = GetParam().fixed_volume;
  spots.together = GetParam().together;
  spots.dilation = GetParam().dilation;
  spots.critical_fraction = GetParam().critical_fraction;
  spots.exchange_length = 1.0;
  spots.dilatancy = GetParam().dilatancy;
  spots.surface_exponent = GetParam().surface_exponent;
  spots.nonaffine = GetParam().nonaffine;
  spots.nonaffine_length = 0.05;
  spots.spread = GetParam().spread;
  spots.wall_shear = 0.7;
  spots.full_strain = GetParam().full_strain;
  if (GetParam().mobility) spots.mobility = {0.3, 0.3, 2.0};
  if (GetParam().parabolic) spots.profile = spot::InfluenceProfile::parabolic;
  RelaxationParameters never;
  never.tolerance = 1e6;
  constexpr double length = 0.06;
  WindowedDrainage drainage = drainage_of(filling(8.0), spots, never, length, 2, 1.0);
  drainage.count_moves_received();
  PlainWindows plain(spots, length, filling(8.0));
  for (int k = 1; k <= 100; ++k) {
    plain.advance_by_a_window();
    if (k % 20 != 0) continue;
    drainage.advance_to(k * length);
    scenes::expect_identical(drainage.grains(), plain.grains());
    ASSERT_FALSE(HasFailure()) << "window " << k;
  }
  scenes::expect_identical(drainage.take_drained(), by_id(plain.drained));
  EXPECT_EQ(drainage.counters().moves, plain.moves);
  EXPECT_EQ(drainage.counters().volume_moved, plain.volume_moved);
  EXPECT_EQ(drainage.take_moves_received(), plain.received());
  EXPECT_EQ(drainage.counters().sweeps, 0);
  EXPECT_GT(drainage.counters().drained, 50);
}

INSTANTIATE_TEST_SUITE_P(
    Schemes, WindowedDrainageBruteForce,
    testing::Values(Spots{"Poisson", 0.0, false}, Spots{"FixedVolume", 77.0, false},
                    Spots{"Parabolic", 77.0, false, true}, Spots{"Dilation", 77.0, false, true, 0.03},
                    Spots{"Together", 0.0, true}, Spots{"FixedVolumeTogether", 77.0, true},
                    Spots{"CriticalState", 77.0, false, true, 0.0, 0.6},
                    Spots{"Dilatancy", 77.0, false, true, 0.03, 0.6, 0.1},
                    Spots{"Nonaffine", 77.0, false, true, 0.0, 0.0, 0.0, 0.0, 0.2},
                    Spots{"Surface", 77.0, false, true, 0.0, 0.0, 0.0, 3.0},
                    Spots{"Spread", 77.0, false, true, 0.0, 0.0, 0.0, 0.0, 0.0, 0.6},
                    Spots{"Mobility", 77.0, false, true, 0.0, 0.0, 0.0, 0.0, 0.0, 0.6, true},
                    Spots{"FullStrain", 77.0, false, true, 0.0, 0.6, 0.0, 0.0, 0.0, 0.0, false, 0.8},
                    Spots{"AllIngredients", 77.0, false, true, 0.03, 0.6, 0.1, 3.0, 0.2, 0.6}),
    [](const auto& spots) { return spots.param.name; });

TEST(WindowedDrainageInvariance, ARerunIsIdentical) {
  WindowedDrainage one = drainage_of(filling(15.0)), other = drainage_of(filling(15.0));
  one.advance_to(4.0);
  other.advance_to(4.0);
  EXPECT_GT(one.counters().drained, 100);
  scenes::expect_identical(one.grains(), other.grains());
  scenes::expect_identical(one.take_drained(), other.take_drained());
}

TEST(WindowedDrainageInvariance, OrderOfTheInputChangesNothing) {
  std::vector<Grain> grains = filling(15.0);
  WindowedDrainage one = drainage_of(grains);
  scenes::Draws(1).shuffle(grains);
  WindowedDrainage other = drainage_of(grains);
  one.advance_to(4.0);
  other.advance_to(4.0);
  scenes::expect_identical(one.grains(), other.grains());
}

TEST(WindowedDrainageInvariance, AdvancingInPiecesChangesNothing) {
  WindowedDrainage one = drainage_of(filling(15.0)), other = drainage_of(filling(15.0));
  one.advance_to(4.0);
  for (int k = 1; k <= 400; ++k) {
    other.advance_to(0.01 * k);
    other.largest_overlap();
  }
  EXPECT_EQ(one.counters().moves, other.counters().moves);
  scenes::expect_identical(one.grains(), other.grains());
}

TEST(WindowedDrainageInvariance, ThreadsChangeNothing) {
  SpotParameters spots = coarse_spots();
  spots.fixed_volume = 77.0;
  WindowedDrainage one = drainage_of(filling(15.0), spots, coarse_relaxation(), 0.02);
  one.advance_to(6.0);
  EXPECT_GT(one.counters().drained, 200);
  EXPECT_GT(one.counters().sweeps, 100);
  const auto drained = one.take_drained();
  for (const int threads : {2, 3, 4}) {
    WindowedDrainage other = drainage_of(filling(15.0), spots, coarse_relaxation(), 0.02, threads);
    other.advance_to(6.0);
    EXPECT_EQ(other.counters().volume_moved, one.counters().volume_moved) << threads;
    EXPECT_EQ(other.counters().grains_swept, one.counters().grains_swept) << threads;
    scenes::expect_identical(other.grains(), one.grains());
    scenes::expect_identical(other.take_drained(), drained);
  }
}

/// As every wall of a container that threads must not ask at the same time is asked by one of them.
class OneAtATime : public spot::Container {
 public:
  bool contains(const spot::Vector3& centre) const override { return walls_->contains(centre); }
  void contacts(const spot::Vector3& centre, double reach, spot::WallContacts& contacts) const override {
    EXPECT_EQ(std::this_thread::get_id(), owner_);
    walls_->contacts(centre, reach, contacts);
  }
  bool concurrent() const override { return false; }
  const spot::Outlets& outlets() const override { return walls_->outlets(); }
  std::optional<spot::WallOnPath> first_wall(const spot::Vector3& from, const spot::Vector3& to) const override {
    return walls_->first_wall(from, to);
  }

 private:
  std::optional<spot::Vector3> reflect_spot(const spot::Vector3& start, const spot::Vector3& target) const override {
    return walls_->keep_spot_inside(start, target);
  }

  std::shared_ptr<const spot::Container> walls_ = scenes::small_silo(6.0, 4.0);
  std::thread::id owner_ = std::this_thread::get_id();
};

TEST(WindowedDrainageInvariance, ThreadsMayComeAndGo) {
  WindowedDrainage one = drainage_of(filling(8.0)), other = drainage_of(filling(8.0));
  one.advance_to(2.0);
  for (const int threads : {3, 1, 2}) {
    other.advance_to(threads == 3 ? 0.5 : 1.0);
    other.set_threads(threads);
  }
  EXPECT_THROW(other.set_threads(0), InvalidParameter);
  other.advance_to(2.0);
  scenes::expect_identical(one.grains(), other.grains());
}

TEST(WindowedDrainageInvariance, ThreadsChangeNothingWithWallsThatAreAskedOneAtATime) {
  std::vector<std::vector<Grain>> left;
  for (const int threads : {1, 3}) {
    WindowedDrainage drainage(coarse_spots(), coarse_relaxation(), DrainageLimits{-1.0}, 0.02, threads,
                              std::make_shared<OneAtATime>(), 1.0, 100.0, filling(10.0));
    drainage.advance_to(3.0);
    EXPECT_GT(drainage.counters().drained, 50);
    left.push_back(drainage.grains());
  }
  scenes::expect_identical(left[1], left[0]);
}

TEST(WindowedDrainageInvariance, AnotherSeedGivesAnotherRun) {
  SpotParameters spots = scenes::paper_spots();
  WindowedDrainage one = drainage_of(filling(15.0), spots);
  ++spots.seed;
  WindowedDrainage other = drainage_of(filling(15.0), spots);
  one.advance_to(1.0);
  other.advance_to(1.0);
  EXPECT_NE(one.counters().moves, other.counters().moves);
}

TEST(WindowedDrainageUnit, NobodyIsLostOrOutside) {
  const auto grains = filling(15.0);
  WindowedDrainage drainage = drainage_of(grains);
  std::set<std::int64_t> drained;
  for (int k = 1; k <= 10; ++k) {
    drainage.advance_to(k);
    drainage.require_inside();
    for (const Grain& grain : drainage.take_drained()) EXPECT_TRUE(drained.insert(grain.id).second);
    EXPECT_EQ(drained.size(), static_cast<std::size_t>(drainage.counters().drained));
    EXPECT_EQ(drainage.grains().size() + drained.size(), grains.size());
    EXPECT_LT(drainage.largest_overlap().depth, 0.1);
  }
}

TEST(WindowedDrainageUnit, WhoIsFarFromTheFlowIsAtRest) {
  const auto grains = scenes::dense_grains({-29.5, -3.5, 0.5}, {29.5, 3.5, 6.0}, 0.01, 2);
  WindowedDrainage drainage(coarse_spots(), coarse_relaxation(), {-1.0}, window, 2, scenes::small_silo(30.0, 4.0), 1.0,
                            100.0, grains);
  invariants::Followed followed;
  for (int step = 0; step < 20; ++step) {
    drainage.advance_to(0.1 * step);
    ASSERT_EQ(followed.check(drainage), -1) << step;
  }
  EXPECT_GT(drainage.counters().drained, 10);
  EXPECT_GT(followed.share(), 0.05 + 0.1) << "all of them once, then those that flow";
  EXPECT_LT(followed.share(), 0.5);
}

TEST(WindowedDrainageUnit, WindowsThatAreTooLongAreRefusedWithTheirBound) {
  const auto refusal = [](const SpotParameters& spots, double length) {
    return scenes::text_of<InvalidParameter>([&] { drainage_of(filling(3.0), spots, {}, length); });
  };
  const SpotParameters paper = scenes::paper_spots();
  EXPECT_THAT(refusal(paper, 1.0), AllOf(HasSubstr("window of 1 "), HasSubstr("1.329"), HasSubstr("at most 1 ")));
  EXPECT_THAT(refusal(paper, 30.0), AllOf(HasSubstr("96 diameters are climbed"), HasSubstr("at most 64")));
  SpotParameters spots = paper;
  spots.step_height = 2e-6;
  EXPECT_THAT(refusal(spots, 10.0), AllOf(HasSubstr("16000000 steps"), HasSubstr("at most 1000000")));
  spots = paper;
  spots.injection_rate = 2e7;
  EXPECT_THAT(refusal(spots, 1.0), AllOf(HasSubstr("20000000 spots are born"), HasSubstr("at most 10000000")));
  // What steps together goes as far as in all of the time between.
  spots = coarse_spots();
  EXPECT_NO_THROW(drainage_of(filling(3.0), spots));
  spots.together = true;
  spots.injection_rate *= 4.0;
  EXPECT_THAT(refusal(spots, window), AllOf(HasSubstr("window of 0.25 "), HasSubstr("at most 1 ")));
  EXPECT_THAT(refusal(paper, 1e-300), AllOf(HasSubstr("3.2e-300 diameters"), HasSubstr("at least 1e-06")));
}

/// Whether or not the sweeps themselves come across it.
TEST(WindowedDrainageUnit, APackingThatCollapsesInFlowIsAnError) {
  for (const double tolerance : {0.01, 1e6}) {
    RelaxationParameters weak;
    weak.tolerance = tolerance;
    weak.alpha = 0.01;
    SpotParameters spots = coarse_spots();
    spots.influence = 0.01;
    WindowedDrainage drainage = drainage_of(filling(15.0), spots, weak);
    EXPECT_THAT(scenes::text_of<spot::CollapsedPacking>([&] { drainage.advance_to(10.0); }),
                AllOf(HasSubstr("grain"), HasSubstr("relax more")))
        << tolerance;
  }
}

/// Every pair that overlaps is in the lists, however long grains flow and however far they jump.
TEST(WindowedDrainageBruteForce, ListsAreCompleteInLongFlow) {
  SpotParameters spots = coarse_spots();
  spots.influence = 0.02;
  spots.injection_rate = 40.0;
  RelaxationParameters seldom = coarse_relaxation();
  seldom.tolerance = 0.08;
  WindowedDrainage drainage = drainage_of(filling(15.0), spots, seldom, 0.05, 2);
  const auto start = drainage.grains();
  for (int k = 1; k <= 40; ++k) {
    drainage.advance_to(0.25 * k);
    const auto grains = drainage.grains();
    double least = 1.0;
    std::pair<std::int64_t, std::int64_t> pair;
    for (std::size_t j = 0; j < grains.size(); ++j)
      for (std::size_t i = 0; i < j; ++i) {
        const double squared = (grains[i].position - grains[j].position).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        pair = {grains[i].id, grains[j].id};
      }
    const spot::Overlap overlap = drainage.largest_overlap();
    ASSERT_NEAR(overlap.depth, 1.0 - std::sqrt(least), 1e-9) << "time " << 0.25 * k;
    EXPECT_EQ(std::make_pair(overlap.first, overlap.second), pair);
  }
  double fallen = 0.0;
  for (const Grain& grain : drainage.grains())
    fallen += start[static_cast<std::size_t>(grain.id - 1)].position.z() - grain.position.z();
  EXPECT_GT(fallen / static_cast<double>(drainage.grains().size()), 1.5) << "many skins";
}

TEST(WindowedDrainageUnit, MemoryIsSmallAndDoesNotGrow) {
  WindowedDrainage drainage = drainage_of(filling(15.0), coarse_spots(), coarse_relaxation(), 0.02);
  const auto grains = static_cast<double>(drainage.grains().size());
  EXPECT_GT(static_cast<double>(drainage.memory()) / grains, 100.0);
  // Lists become longer once if a grain gets more neighbours than any had at the start.
  drainage.advance_to(6.0);
  const std::size_t early = drainage.memory();
  EXPECT_LT(static_cast<double>(early) / grains, 1200.0);
  drainage.advance_to(15.0);
  EXPECT_LT(static_cast<double>(drainage.memory()), 1.1 * static_cast<double>(early));
}

TEST(WindowedDrainageUnit, SpotsComeOutAtTheTop) {
  WindowedDrainage drainage = drainage_of(filling(6.0));
  drainage.advance_to(5.0);
  for (const spot::Spot& spot : drainage.spots()) EXPECT_LT(spot.position.z(), 10.0);
}

TEST(WindowedDrainageUnit, AnEmptySiloIsNoError) {
  WindowedDrainage drainage = drainage_of({});
  drainage.advance_to(2.0);
  EXPECT_EQ(drainage.counters().drained, 0);
}

TEST(WindowedDrainageUnit, ASmallerToleranceSweepsMore) {
  RelaxationParameters fine, coarse;
  fine.tolerance = 1e-3;
  coarse.tolerance = 4e-3;
  WindowedDrainage often = drainage_of(filling(10.0), scenes::paper_spots(), fine);
  WindowedDrainage seldom = drainage_of(filling(10.0), scenes::paper_spots(), coarse);
  const double displacement = 2.5e-3 * 0.68;  // w dx
  EXPECT_NEAR(often.moves_between_sweeps(), 12.0 * 1e-6 / (displacement * displacement), 1.0);
  EXPECT_NEAR(seldom.moves_between_sweeps(), 12.0 * 16e-6 / (displacement * displacement), 1.0);
  often.advance_to(3.0);
  seldom.advance_to(3.0);
  EXPECT_GT(often.counters().grains_swept, 2 * seldom.counters().grains_swept);
}

TEST(WindowedDrainageUnit, BadParametersAreNamed) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    RelaxationParameters relaxation;
    relaxation.tolerance = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), relaxation); }),
                HasSubstr("tolerance"));
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), {}, bad); }),
                HasSubstr("window"));
  }
  for (const int bad : {0, -3, 1000})
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), {}, window, bad); }),
                AllOf(HasSubstr("threads is " + std::to_string(bad)), HasSubstr("from 1 to ")));
  RelaxationParameters lasting;
  lasting.momentum = 1.0;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { drainage_of({}, scenes::paper_spots(), lasting); }),
              HasSubstr("momentum is 1 "));
}

/// Each spot steps once in every window that is one waiting time long.
TEST(WindowedDrainageUnit, SpotsStepTogether) {
  SpotParameters spots = coarse_spots();
  spots.together = true;
  WindowedDrainage drainage = drainage_of(filling(15.0), spots, coarse_relaxation(), 0.25);
  std::int64_t moves = 0;
  std::size_t live = 0;
  for (int k = 1; k <= 16; ++k) {
    drainage.advance_to(0.25 * k);
    const auto now = drainage.spots();
    // Those that were there before, and what was born since: a newborn spot steps at the end of its first window.
    if (k <= 8) {
      EXPECT_EQ(drainage.counters().moves - moves, static_cast<std::int64_t>(now.size())) << "none is out yet";
    }
    for (const spot::Spot& spot : now) EXPECT_DOUBLE_EQ(spot.next_step, 0.25 * (k + 1));
    moves = drainage.counters().moves;
    live = now.size();
  }
  EXPECT_GT(live, 500u);
}

/// Same spots, another algorithm: as many grains drain, up to noise. The walks are the same with the same step height,
/// so births are no noise. Over seeds 1-7 the ratio is 0.996 +- 0.005 with small steps and 1.006 +- 0.011 with large
/// ones; the bounds are the mean and four standard deviations.
TEST(WindowedDrainageStatistical, DrainsAsManyAsTheTimeOrderedDriver) {
  const auto grains = filling(15.0);
  spot::TimeOrderedDrainage reference(scenes::paper_spots(), {}, DrainageLimits{-1.0}, scenes::small_silo(6.0, 4.0),
                                      spot::Packing(1.0, 100.0, grains));
  reference.advance_to(8.0);
  const auto drained = static_cast<double>(reference.counters().drained);
  EXPECT_GT(drained, 250.0);
  WindowedDrainage fine = drainage_of(grains);
  fine.advance_to(8.0);
  EXPECT_NEAR(static_cast<double>(fine.counters().drained) / drained, 1.0, 0.025);
  SpotParameters large_steps = coarse_spots();
  large_steps.step_width = spot::step_width_for(scenes::paper_spots().diffusion_length(), large_steps.step_height);
  WindowedDrainage coarse = drainage_of(grains, large_steps, coarse_relaxation(), 0.02);
  coarse.advance_to(8.0);
  EXPECT_NEAR(static_cast<double>(coarse.counters().drained) / drained, 1.0, 0.05);
}

/// The same spots, another algorithm. Without relaxation, which makes the two packings differently dense, the ratio is
/// 0.9997 +- 0.0006 over seeds 1-6; with it 0.980 +- 0.001. The bounds are the mean and some four standard deviations.
TEST(WindowedDrainageStatistical, SpotsLeaveAsMuchVolumeAsWithTheTimeOrderedDriver) {
  SpotParameters spots = coarse_spots();
  spots.profile = spot::InfluenceProfile::parabolic;
  spots.influence = 0.01;
  spots.injection_rate = 60.0;
  spots.fixed_volume = 40.0;
  spots.critical_fraction = 0.5;
  spots.exchange_length = 1.0;
  spots.dilatancy = 0.5;
  spots.seed = 1;
  const auto grains = filling(24.0);
  for (const bool relaxed : {false, true}) {
    RelaxationParameters by_moves, by_windows = coarse_relaxation();
    if (!relaxed) {
      by_moves.every = 0;
      by_windows.tolerance = 1e6;
    }
    spot::TimeOrderedDrainage reference(spots, by_moves, DrainageLimits{-1.0, 0.03, 1.0}, scenes::small_silo(6.0, 4.0),
                                        spot::Packing(1.0, 100.0, grains));
    WindowedDrainage windowed = drainage_of(grains, spots, by_windows, 0.02, 1, 1.0);
    reference.advance_to(10.0);
    windowed.advance_to(10.0);
    const auto left = [](spot::Drainage& drainage) {
      return static_cast<double>(drainage.total().volume_left) / spot::CriticalState::volume_parts;
    };
    EXPECT_GT(left(reference), 200.0) << "of 600 spots";
    EXPECT_NEAR(left(windowed) / left(reference), relaxed ? 0.98 : 0.9997, relaxed ? 0.004 : 0.0025);
  }
}

}  // namespace
