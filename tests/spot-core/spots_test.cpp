// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/spots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "scenes.hpp"
#include "spot/geometry/base_plate.hpp"
#include "spot/walk/calibration.hpp"
#include "spot/walk/grain_volume.hpp"

namespace {

using scenes::bound;
using spot::Container;
using spot::Move;
using spot::Orifice;
using spot::Spot;
using spot::SpotParameters;
using spot::Spots;
using spot::Vector3;

const Orifice orifice{{0.5, -0.25, 2.0}, 4.0};

std::unique_ptr<spot::WalledContainer> space_above_orifice() {
  return std::make_unique<spot::WalledContainer>(orifice);
}

/// Where a spot was before its move.
Vector3 start_of(const Move& move) { return move.middle - 0.5 * move.step; }
Vector3 end_of(const Move& move) { return move.middle + 0.5 * move.step; }

/// Lets `number` spots take `steps` steps each, and calls visit(move, steps taken) after each of them.
template <typename Visit>
void walk(const SpotParameters& parameters, const Container& container, int number, int steps, Visit&& visit) {
  Spots population(parameters, container, 1.0);
  std::map<std::int64_t, int> taken;
  int done = 0;
  while (done < number) {
    const auto move = population.next_step(1e9, container);
    const int n = ++taken[move->spot];
    if (move->spot < number) visit(*move, n);
    if (n < steps) continue;
    population.remove(move->spot);
    taken.erase(move->spot);
    if (move->spot < number) ++done;
  }
}

TEST(SpotsUnit, StepsAreThoseOf2006) {
  const auto space = space_above_orifice();
  std::set<std::pair<double, double>> seen;
  walk(scenes::paper_spots(), *space, 100, 20, [&](const Move& move, int) {
    EXPECT_NEAR(move.step.z(), 0.1, 1e-12);
    const double along = std::abs(move.step.x()) + std::abs(move.step.y());
    EXPECT_NEAR(along, 0.68, 1e-12);
    EXPECT_NEAR(std::min(std::abs(move.step.x()), std::abs(move.step.y())), 0.0, 1e-12) << "diagonals spread too fast";
    seen.emplace(std::round(10.0 * move.step.x()), std::round(10.0 * move.step.y()));
  });
  EXPECT_EQ(seen.size(), 4u);
}

TEST(SpotsUnit, MovesComeInOrderOfTimeAndUpToTheGivenTime) {
  const auto space = space_above_orifice();
  Spots population(scenes::paper_spots(), *space, 1.0);
  double last = 0.0;
  for (const double until : {0.0, 0.1, 0.1, 0.35, 0.5})
    while (const auto move = population.next_step(until, *space)) {
      EXPECT_GE(move->time, last);
      EXPECT_LE(move->time, until);
      last = move->time;
    }
  EXPECT_GT(last, 0.49);
}

TEST(SpotsUnit, EachMoveStartsWhereTheSpotsLastEnded) {
  const auto space = space_above_orifice();
  Spots population(scenes::paper_spots(), *space, 1.0);
  std::map<std::int64_t, Vector3> at;
  while (const auto move = population.next_step(1.0, *space)) {
    if (at.count(move->spot)) {
      EXPECT_LT((at[move->spot] - start_of(*move)).norm(), 1e-12);
    }
    at[move->spot] = end_of(*move);
  }
  ASSERT_GE(population.live().size(), at.size());
  for (const Spot& spot : population.live())
    if (spot.steps > 0) {
      EXPECT_LT((spot.position - at.at(spot.id)).norm(), 1e-12);
    }
}

TEST(SpotsUnit, StepsAreCounted) {
  const auto space = space_above_orifice();
  walk(scenes::paper_spots(), *space, 100, 20, [&](const Move& move, int n) {
    EXPECT_EQ(move.number, n);
    EXPECT_EQ(move.weight, 1.0);
  });
}

/// All at the multiples of dz / v_s, each spot at all of them from the first after its birth on (2010).
TEST(SpotsUnit, SpotsStepTogether) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.together = true;
  const double interval = parameters.mean_waiting_time();
  Spots population(parameters, *space, 1.0);
  std::map<std::int64_t, std::int64_t> last;
  std::int64_t now = 0, stepped = 0, born = 0;
  while (const auto move = population.next_step(3.0, *space)) {
    const auto multiple = static_cast<std::int64_t>(std::nearbyint(move->time / interval));
    EXPECT_EQ(move->time, static_cast<double>(multiple) * interval);
    if (multiple != now) {
      EXPECT_EQ(stepped, born) << "every live spot";
      now = multiple;
      stepped = 0;
      born = population.born();
    }
    ++stepped;
    if (last.count(move->spot) > 0) {
      EXPECT_EQ(multiple, last[move->spot] + 1);
    }
    last[move->spot] = multiple;
    EXPECT_NEAR(move->step.z(), 0.1, 1e-12);
  }
  EXPECT_EQ(now, 96);
  EXPECT_EQ(static_cast<std::int64_t>(last.size()), population.born());
  EXPECT_NEAR(static_cast<double>(population.born()), 3.0 * parameters.injection_rate.largest(),
              bound * std::sqrt(3.0 * parameters.injection_rate.largest()));
}

/// Births and directions are the same as of spots that step by themselves.
TEST(SpotsInvariance, SteppingTogetherChangesOnlyTheTimes) {
  const auto space = space_above_orifice();
  const auto middles = [&](bool together) {
    SpotParameters parameters = scenes::paper_spots();
    parameters.together = together;
    std::map<std::pair<std::int64_t, std::int64_t>, double> all;
    walk(parameters, *space, 50, 20, [&](const Move& move, int) {
      all[{move.spot, move.number}] = move.middle.x() + 100.0 * move.middle.y();
    });
    return all;
  };
  EXPECT_EQ(middles(true), middles(false));
}

TEST(SpotsStatistical, ChancesAreUniformAndDoNotDependOnTheDirection) {
  const auto space = space_above_orifice();
  std::vector<int> counts(40);
  walk(scenes::paper_spots(), *space, 500, 80, [&](const Move& move, int) {
    ASSERT_GE(move.chance, 0.0);
    ASSERT_LT(move.chance, 1.0);
    const auto part = static_cast<std::size_t>(10.0 * move.chance);
    const bool along_x = std::abs(move.step.x()) > std::abs(move.step.y());
    const bool forward = move.step.x() + move.step.y() > 0.0;
    ++counts[4 * part + (along_x ? 2 : 0) + (forward ? 1 : 0)];
  });
  EXPECT_LT(scenes::deviation_from_equal_counts(counts), bound);
}

TEST(SpotsUnit, RemovedSpotsStepNoMore) {
  const auto space = space_above_orifice();
  Spots population(scenes::paper_spots(), *space, 1.0);
  std::set<std::int64_t> removed;
  while (const auto move = population.next_step(1.0, *space)) {
    EXPECT_EQ(removed.count(move->spot), 0u);
    if (move->spot % 3 != 0) continue;
    population.remove(move->spot);
    removed.insert(move->spot);
  }
  EXPECT_GT(removed.size(), 50u);
  EXPECT_EQ(population.live().size() + removed.size(), static_cast<std::size_t>(population.born()));
}

TEST(SpotsUnit, RefusesBadParametersAndNarrowOrifices) {
  const auto space = space_above_orifice();
  EXPECT_THROW(Spots(SpotParameters(), *space, 1.0), spot::InvalidParameter);
  SpotParameters wide = scenes::paper_spots();
  wide.radius = 4.1;
  EXPECT_THROW(Spots(wide, *space, 1.0), spot::InvalidContainer);
}

/// Id, birth and walk of a spot depend on the seed and its id alone: neither on what time is asked for nor on the
/// fate of other spots.
TEST(SpotsInvariance, WalksDependOnSeedAndIdAlone) {
  const auto space = space_above_orifice();
  const auto record = [&](std::uint64_t seed, double piece, bool remove_odd) {
    SpotParameters parameters = scenes::paper_spots();
    parameters.seed = seed;
    Spots population(parameters, *space, 1.0);
    std::map<std::int64_t, std::vector<double>> walks;
    for (double until = piece; until <= 1.0; until += piece)
      while (const auto move = population.next_step(until, *space)) {
        if (move->spot % 2 == 0)
          walks[move->spot].insert(walks[move->spot].end(), {move->time, move->middle.x(), move->middle.y()});
        else if (remove_odd)
          population.remove(move->spot);
      }
    return walks;
  };
  const auto walks = record(1, 1.0, false);
  EXPECT_EQ(record(1, 1.0, false), walks) << "rerun";
  EXPECT_EQ(record(1, 1.0 / 64.0, false), walks) << "in pieces";
  EXPECT_EQ(record(1, 1.0, true), walks) << "others removed";
  EXPECT_NE(record(2, 1.0, false), walks) << "another seed";
}

using Walks = std::map<std::int64_t, std::vector<double>>;

void record(Walks& walks, const Move& move) {
  walks[move.spot].insert(walks[move.spot].end(), {move.time, move.middle.x(), move.middle.y(), move.middle.z()});
}

/// Every third spot goes after its tenth step; one in seven after its first.
bool is_last(const Move& move) {
  return (move.spot % 3 == 0 && move.number == 10) || (move.spot % 7 == 0 && move.number == 1);
}

/// Windows of several ranks, saved and read again by others between any two of them, against one step after the other.
TEST(SpotsInvariance, WindowsOfRanksAreThoseInTheOrderOfTime) {
  const auto space = space_above_orifice();
  const SpotParameters parameters = scenes::paper_spots();
  const double window = 1.0 / 64.0;
  spot::Workers workers(3);
  Walks expected;
  Spots in_order(parameters, *space, 1.0);
  while (const auto move = in_order.next_step(1.0, *space)) {
    record(expected, *move);
    if (is_last(*move)) in_order.remove(move->spot);
  }
  for (const std::int64_t ranks : {1, 3}) {
    Walks walks;
    std::vector<spot::Bytes> saved;
    for (int k = 1; k <= 64; ++k) {
      std::vector<spot::Bytes> next;
      for (std::int64_t rank = 0; rank < ranks; ++rank) {
        const auto here = [&](const Spot& spot) { return (spot.id + k) % ranks == rank; };
        Spots spots(parameters, *space, 1.0);
        for (const spot::Bytes& bytes : saved) {
          spot::ByteReader reader(bytes);
          spots.restore(reader);
        }
        spots.take_out_others(here);
        spots.give_birth(k * window, *space, here);
        std::set<std::int64_t> gone;
        spots.step_until(k * window, *space, workers, [&](const Spot&, const std::vector<Move>& moves) {
          for (const Move& move : moves) {
            // A window's steps are made before it is known which was the last.
            if (gone.count(move.spot) == 0) record(walks, move);
            if (is_last(move)) gone.insert(move.spot);
          }
        });
        for (const std::int64_t spot : gone) {
          spots.remove(spot);
          spots.remove(spot);
        }
        for (const Spot& spot : spots.live()) EXPECT_EQ(gone.count(spot.id), 0u);
        next.emplace_back();
        spots.save(next.back());
      }
      saved = next;
    }
    EXPECT_EQ(walks, expected) << ranks;
  }
}

TEST(SpotsAnalytic, SpotsAreBornBelowTheOrificeInsideItsDisc) {
  const auto space = space_above_orifice();
  walk(scenes::paper_spots(), *space, 2000, 1, [&](const Move& move, int) {
    const Vector3 birth = start_of(move) - orifice.centre;
    EXPECT_NEAR(birth.z(), -2.6, 1e-12);
    EXPECT_LE(std::hypot(birth.x(), birth.y()), 1.4 + 1e-12);
  });
}

TEST(SpotsAnalytic, AnOrificeAsWideAsTheSpotsBearsThemOnItsAxis) {
  const spot::WalledContainer space(Orifice{{0.0, 0.0, 0.0}, 2.6});
  walk(scenes::paper_spots(), space, 100, 1,
       [&](const Move& move, int) { EXPECT_NEAR(start_of(move).head<2>().norm(), 0.0, 1e-12); });
}

TEST(SpotsStatistical, BirthsAreUniformOnTheDisc) {
  const auto space = space_above_orifice();
  std::vector<int> rings(20), sectors(20);
  walk(scenes::paper_spots(), *space, 20000, 1, [&](const Move& move, int) {
    const Vector3 birth = start_of(move) - orifice.centre;
    const double area = birth.head<2>().squaredNorm() / (1.4 * 1.4);
    const double turn = std::atan2(birth.y(), birth.x()) / (2.0 * scenes::pi) + 0.5;
    ++rings[std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * area))];
    ++sectors[std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * turn))];
  });
  EXPECT_LT(scenes::deviation_from_equal_counts(rings), bound);
  EXPECT_LT(scenes::deviation_from_equal_counts(sectors), bound);
}

TEST(SpotsStatistical, BirthsAreAPoissonProcess) {
  const auto space = space_above_orifice();
  const SpotParameters parameters = scenes::paper_spots();
  Spots population(parameters, *space, 1.0);
  const int intervals = 4000;
  const double length = 10.0 / parameters.injection_rate.largest();  // ten births expected in each
  double sum = 0.0, sum_of_squares = 0.0;
  std::int64_t before = 0;
  for (int k = 1; k <= intervals; ++k) {
    while (const auto move = population.next_step(k * length, *space)) population.remove(move->spot);
    const double births = static_cast<double>(population.born() - before);
    before = population.born();
    sum += births;
    sum_of_squares += births * births;
  }
  const double mean = sum / intervals;
  EXPECT_LT(std::abs(mean - 10.0) / std::sqrt(10.0 / intervals), bound);
  // Variance over mean is one: (n - 1) variance / mean follows chi-square.
  const double dispersion = (sum_of_squares - sum * mean) / mean;
  EXPECT_LT(std::abs(scenes::chi_square_deviation(dispersion, intervals - 1)), bound);
}

TEST(SpotsStatistical, WaitingTimesAreExponentialAndGiveTheDriftSpeed) {
  const auto space = space_above_orifice();
  const SpotParameters parameters = scenes::paper_spots();
  std::map<std::int64_t, double> last;
  std::vector<int> counts(50);
  double total = 0.0;
  int waits = 0;
  walk(parameters, *space, 1000, 101, [&](const Move& move, int n) {
    if (n > 1) {
      const double wait = move.time - last[move.spot];
      total += wait;
      ++waits;
      const double below = 1.0 - std::exp(-parameters.move_rate() * wait);
      ++counts[std::min<std::size_t>(49, static_cast<std::size_t>(50.0 * below))];
    }
    last[move.spot] = move.time;
  });
  ASSERT_EQ(waits, 100000);
  EXPECT_LT(scenes::deviation_from_equal_counts(counts), bound);
  const double speed = waits * parameters.step_height / total;
  EXPECT_LT(std::abs(speed / parameters.speed - 1.0) * std::sqrt(waits), bound) << "v_s = " << speed;
}

/// The four directions are equally frequent and successive ones independent: Var(x) = 2 b z along both axes.
TEST(SpotsStatistical, FreeSpotsDiffuse) {
  const auto space = space_above_orifice();
  const SpotParameters parameters = scenes::paper_spots();
  const int number = 4000, steps = 64;
  std::map<std::int64_t, Vector3> birth;
  std::vector<int> directions(4);
  double xx = 0.0, yy = 0.0, xy = 0.0;
  walk(parameters, *space, number, steps, [&](const Move& move, int n) {
    if (n == 1) birth[move.spot] = start_of(move);
    ++directions[(std::abs(move.step.x()) > std::abs(move.step.y()) ? 0 : 2) + (move.step.x() + move.step.y() > 0)];
    if (n < steps) return;
    const Vector3 path = end_of(move) - birth[move.spot];
    xx += path.x() * path.x();
    yy += path.y() * path.y();
    xy += path.x() * path.y();
  });
  EXPECT_LT(scenes::deviation_from_equal_counts(directions), bound);
  const double variance = 2.0 * parameters.diffusion_length() * steps * parameters.step_height;
  // The mean square of n nearly normal numbers has a relative standard error of sqrt(2 / n).
  EXPECT_LT(std::abs(xx / number / variance - 1.0) / std::sqrt(2.0 / number), bound) << xx / number / variance;
  EXPECT_LT(std::abs(yy / number / variance - 1.0) / std::sqrt(2.0 / number), bound) << yy / number / variance;
  EXPECT_LT(std::abs(xy / number / variance) * std::sqrt(number), bound);
}

/// Successive steps go the same way with the chance p, or else any way: Var(x) grows to (1 + p) / (1 - p) of a free
/// walk's.
TEST(SpotsStatistical, PersistentSpotsDiffuse) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  const double p = parameters.persistence = 0.7;
  const int number = 4000, steps = 64;
  std::map<std::int64_t, Vector3> birth, last;
  double xx = 0.0, same = 0.0;
  walk(parameters, *space, number, steps, [&](const Move& move, int n) {
    if (n == 1) birth[move.spot] = start_of(move);
    if (n > 1 && (move.step - last[move.spot]).norm() < 1e-9) ++same;
    last[move.spot] = move.step;
    if (n == steps) xx += std::pow(end_of(move).x() - birth[move.spot].x(), 2);
  });
  const double pairs = static_cast<double>(number) * (steps - 1), chance = p + (1.0 - p) / 4.0;
  EXPECT_LT(std::abs(same / pairs - chance) / std::sqrt(chance * (1.0 - chance) / pairs), bound) << same / pairs;
  // What the first steps lack of the sum over all correlations.
  const double start = 2.0 * p * (1.0 - std::pow(p, steps)) / (steps * (1.0 - p) * (1.0 - p)) / ((1.0 + p) / (1.0 - p));
  const double variance = 2.0 * parameters.diffusion_length() * steps * parameters.step_height * (1.0 - start);
  EXPECT_LT(std::abs(xx / number / variance - 1.0) / std::sqrt(2.0 / number), bound) << xx / number / variance;
}

/// In a shaft that they fill evenly, all but the lowest spots take c of the volume where F spots a time and area climb
/// at v_s (c / c_0)^2: c^3 = F V_s c_0^2 / v_s. Without dilation it is F V_s / v_s.
TEST(SpotsStatistical, DilatedPackingsCarrySpotsFaster) {
  const double half = 5.0, low = 20.0, high = 40.0;
  const auto shaft =
      spot::box_silo(-half, half, -half, half, Orifice{{0.0, 0.0, 0.0}, 4.0}, spot::SpotBuffers{0.0, 0.0});
  SpotParameters parameters = scenes::paper_spots();
  parameters.step_height = 0.5;
  parameters.step_width = spot::step_width_for(1.25, parameters.step_height);
  parameters.fixed_volume = 40.0;
  for (const double c_0 : {0.0, 0.03, 0.06}) {
    parameters.dilation = c_0;
    Spots population(parameters, *shaft, 1.0);
    double sum = 0.0, samples = 0.0;
    for (double time = 1.0; time <= 60.0; time += 1.0) {
      while (const auto move = population.next_step(time, *shaft))
        if (end_of(*move).z() > 60.0) population.remove(move->spot);
      if (time < 40.0) continue;
      for (const Spot& spot : population.live()) sum += spot.position.z() >= low && spot.position.z() < high;
      ++samples;
    }
    const double volume = parameters.missing_volume(1.0), area = 4.0 * half * half;
    const double c = sum / samples * volume / (area * (high - low));
    const double flux = parameters.injection_rate.largest() * volume / area;
    const double expected = c_0 > 0.0 ? std::cbrt(flux * c_0 * c_0 / parameters.speed) : flux / parameters.speed;
    // Half a per cent is what the births of 20 tau scatter by; counting noise makes spots a little faster.
    EXPECT_NEAR(c / expected, 1.0, 0.04) << c_0;
  }
}

/// Part of the sphere of radius R around a spot that lies between plane walls at y = +-wall.
double uncut_part(double y, double wall, double radius) {
  double cut = 0.0;
  for (const double to_wall : {wall - y, wall + y}) {
    const double cap = std::max(0.0, radius - to_wall);
    cut += scenes::pi * cap * cap * (3.0 * radius - cap) / 3.0;
  }
  return 1.0 - cut / (4.0 / 3.0 * scenes::pi * radius * radius * radius);
}

/// Between walls 8 d apart: spots that keep one diameter from them spread evenly, and the walls leave them 0.957 of
/// their sphere on average.
class SpotsBetweenWallsStatistical : public testing::TestWithParam<double> {};  // persistence

TEST_P(SpotsBetweenWallsStatistical, StayUniform) {
  const auto silo = scenes::small_silo(25.0, 4.0);
  const int number = 3000, steps = 326;  // 30 d above the orifice, ten times what evening out takes
  std::vector<int> layers(12);
  double sum = 0.0, sum_of_squares = 0.0;
  SpotParameters spots = scenes::paper_spots();
  spots.persistence = GetParam();
  walk(spots, *silo, number, steps, [&](const Move& move, int n) {
    const Vector3 end = end_of(move);
    ASSERT_LE(std::abs(end.y()), 3.0 + 1e-12);
    ASSERT_LE(std::abs(end.x()), 24.0 + 1e-12);
    if (n < steps) return;
    ++layers[std::min<std::size_t>(11, static_cast<std::size_t>(2.0 * (end.y() + 3.0)))];
    const double part = uncut_part(end.y(), 4.0, 2.6);
    sum += part;
    sum_of_squares += part * part;
  });
  EXPECT_LT(scenes::deviation_from_equal_counts(layers), bound);
  const double mean = sum / number;
  const double error = std::sqrt((sum_of_squares / number - mean * mean) / number);
  EXPECT_LT(std::abs(mean - 0.9573) / error, bound) << mean;
  EXPECT_LT(error, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Persistence, SpotsBetweenWallsStatistical, testing::Values(0.0, 0.8));

TEST(SpotsAnalytic, RisingSpotsKeepTheirRadiusFromBaseAndRim) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  const spot::BasePlate plate(silo->outlets());
  walk(scenes::paper_spots(), *silo, 500, 80, [&](const Move& move, int) {
    const Vector3 end = end_of(move);
    if (end.z() <= 0.0) {
      EXPECT_LE(end.head<2>().norm(), 1.4 + 1e-12);
    } else {
      EXPECT_GE(plate.nearest(end).distance, 2.6 - 1e-12);
    }
  });
}

/// Once in each interval, however the calls lie, and over a saved state.
TEST(SpotsUnit, TheSurfaceIsFoundWheneverASpotHasClimbedAPartOfItsRadius) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.surface_exponent = 3.0;
  const double interval = spot::calibration::climb_between_surfaces * parameters.radius / parameters.speed;
  spot::Alone alone;
  for (const double window : {0.013 * interval, 0.1 * interval, 0.7 * interval, interval, 2.5 * interval}) {
    Spots population(parameters, *space, 1.0), again(parameters, *space, 1.0);
    for (int k = 0; k < 200; ++k) {
      Spots& spots = k < 77 ? population : again;
      bool asked = false;
      spots.update_surface(
          k * window, [&](const auto&, const auto&) { asked = true; }, alone);
      const double last = std::floor((k - 1) * window / interval + 1e-9),
                   now = std::floor(k * window / interval + 1e-9);
      EXPECT_EQ(asked, now > last) << "window " << k << " of " << window / interval;
      if (k != 76) continue;
      spot::Bytes bytes;
      population.save(bytes);
      spot::ByteReader reader(bytes);
      again.restore(reader);
    }
  }
  parameters.surface_exponent = 0.0;
  Spots blind(parameters, *space, 1.0);
  blind.update_surface(
      0.0, [](const auto&, const auto&) { ADD_FAILURE() << "nobody asks"; }, alone);
}

/// In the order of time, too, where five settings of relative speeds are an interval.
TEST(SpotsUnit, InTheOrderOfTimeTheSurfaceIsFoundAsOften) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.surface_exponent = 3.0;
  parameters.injection_rate = 20.0;
  const double interval = spot::calibration::climb_between_surfaces * parameters.radius / parameters.speed;
  Spots population(parameters, *space, 1.0);
  int asked = 0;
  while (population.next_step(20.5 * interval, *space, [&](const auto&, const auto&) { ++asked; })) {
  }
  EXPECT_EQ(asked, 21);
}

/// Its moves in their order: each in turn carries what that before has left over.
TEST(SpotsUnit, ASpotCarriesWhatItHasNotLeft) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.fixed_volume = 77.0;
  parameters.critical_fraction = 0.6;
  parameters.exchange_length = 1.0;
  Spots population(parameters, *space, 1.0);
  while (population.next_step(0.1, *space)) {
  }
  ASSERT_GT(population.live().size(), 20u);
  const std::int64_t spot = population.live()[7].id;
  const spot::CriticalState critical(parameters, 1.0);
  const Move move{0.0, spot, {0.0, 0.0, 30.0}, {0.68, 0.0, 0.1}};
  const double enclosed = critical.enclosed(move.middle, 0.0, *space) * spot::grain_volume;
  double volume = 1.0;
  std::int64_t left = 0;
  for (const double times : {1.2, 1.1, 0.9, 1.3, 1.0}) {
    const int grains = static_cast<int>(times * enclosed);
    const Spots::Carried carried = population.carry(move, grains, *space);
    EXPECT_EQ(carried.volume, volume);
    volume = critical.volume_after(volume, move, grains, spot::Strain(), *space);
    EXPECT_EQ(carried.left > 0, times > 1.0);
    left += carried.left;
  }
  EXPECT_LT(volume, 0.97);
  EXPECT_EQ(static_cast<double>(left), (1.0 - volume) * spot::CriticalState::volume_parts);
  for (const Spot& live : population.live()) EXPECT_EQ(live.volume, live.id == spot ? volume : 1.0);

  spot::Bytes bytes;
  population.save(bytes);
  Spots again(parameters, *space, 1.0);
  spot::ByteReader reader(bytes);
  again.restore(reader);
  for (const Spot& live : again.live()) EXPECT_EQ(live.volume, live.id == spot ? volume : 1.0);

  population.remove(spot);
  const Spots::Carried gone = population.carry(move, static_cast<int>(1.2 * enclosed), *space);
  EXPECT_EQ(gone.volume, 1.0);
  EXPECT_EQ(gone.left, 0);
}

TEST(SpotsUnit, WithoutACriticalStateTheyCarryAsMuchAllTheWay) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.fixed_volume = 77.0;
  Spots population(parameters, *space, 1.0);
  Move move = *population.next_step(1e9, *space);
  move.middle.z() = 30.0;
  for (const int grains : {0, 50 * spot::grain_volume, 500 * spot::grain_volume}) {
    const Spots::Carried carried = population.carry(move, grains, *space);
    EXPECT_EQ(carried.volume, 1.0);
    EXPECT_EQ(carried.left, 0);
  }
}

/// In the order of time, spots learn how the flow is sheared at the times when a spot at v_s has climbed a tenth of R_s
/// once more; so do those of windows of that length, to the last bit.
TEST(SpotsInvariance, SpotsOfWindowsLeaveWhatThoseInTheOrderOfTimeDo) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.fixed_volume = 77.0;
  parameters.critical_fraction = 0.6;
  parameters.exchange_length = 1.0;
  parameters.dilatancy = 0.5;
  parameters.full_strain = 1.0;
  const double interval = spot::calibration::climb_between_settings * parameters.radius / parameters.speed;
  const int windows = 60, grains = 85 * spot::grain_volume;
  using Volumes = std::map<std::int64_t, std::vector<double>>;  // of a spot, move by move
  const auto carry = [&](Spots& population, const Move& move, Volumes& volumes) {
    volumes[move.spot].push_back(population.carry(move, grains, *space).volume);
  };
  const auto in_the_order_of_time = [&] {
    Volumes volumes;
    Spots population(parameters, *space, 1.0);
    while (const auto move = population.next_step(windows * interval, *space)) carry(population, *move, volumes);
    return volumes;
  };
  Volumes in_windows;
  Spots windowed(parameters, *space, 1.0);
  spot::Alone alone;
  spot::Workers workers(2);
  for (int k = 1; k <= windows; ++k) {
    std::vector<Move> all;
    windowed.give_birth(k * interval, *space, [](const Spot&) { return true; });
    windowed.step_until(k * interval, *space, workers, [&](const Spot&, const std::vector<Move>& moves) {
      all.insert(all.end(), moves.begin(), moves.end());
    });
    for (const Move& move : all) carry(windowed, move, in_windows);
    windowed.update_flow(interval, alone);
  }
  const Volumes in_order = in_the_order_of_time();
  EXPECT_EQ(in_order, in_windows);
  parameters.dilatancy = 0.0;
  EXPECT_NE(in_order, in_the_order_of_time());
  parameters.dilatancy = 0.5;
  parameters.full_strain = 0.0;
  EXPECT_NE(in_order, in_the_order_of_time());
}

/// A flow that goes as e^(-x / 10) makes spots drift by (B / s - b_s) / 10 for each length that they climb; near the
/// surface, where s is larger by kappa over the depth, by less. Where not all is mobile, they drift towards what is,
/// too.
TEST(SpotWalkStatistical, SpotsDriftAsTheFlowIsSheared) {
  const auto space = space_above_orifice();
  SpotParameters parameters = scenes::paper_spots();
  parameters.radius = 3.0;
  parameters.fixed_volume = 77.0;
  parameters.spread = 0.6;
  const spot::Mobility none, mobility{0.3, 0.05, 8.0};
  parameters.mobility = mobility;
  spot::FlowField flow(parameters, *space, 1.0);
  for (double x = -30.0; x <= 30.0; x += 0.75)
    for (double y = -9.0; y <= 9.0; y += 0.75)
      for (double z = 1.0; z <= 19.0; z += 0.75)
        flow.add({0.0, 0, {x, y, z}, {0.0, 0.0, parameters.step_height}}, std::exp(-0.1 * x));
  spot::Alone alone;
  flow.update(0.1, alone);
  const double slope = 2.0 / 3.0 * std::tanh(0.15);
  const Vector3 start(0.0, 0.0, 8.0);
  ASSERT_NEAR(flow.slope(start).x(), -slope, 0.002);
  const double towards = mobility.drift * flow.slope_of_mobility(start).x();
  ASSERT_LT(towards, -0.2) << "it can be told from none";
  struct Case {
    double wall_shear;
    spot::Mobility mobility;
    double shear, more;
  };
  // As deep as on the lattice, 4 below the surface, and as deep as before with a mobility.
  for (const auto& [wall_shear, mobile, shear, more] :
       {Case{0.0, none, slope, 0.0}, Case{0.5, none, slope + 0.5 / 4.0, 0.0}, Case{0.0, mobility, slope, towards}}) {
    parameters.wall_shear = wall_shear;
    parameters.mobility = mobile;
    spot::FreeSurface surface(parameters, *space, 1.0);
    for (double x = -20.0; x <= 20.0; x += 0.5)
      for (double y = -20.0; y <= 20.0; y += 0.5) surface.add({x, y, 12.0});
    surface.gather(alone);
    const spot::SpotWalk walk(parameters, *space);
    const int number = 40000;
    Vector3 mean = Vector3::Zero();
    for (std::int64_t id = 0; id < number; ++id) {
      Spot spot = walk.birth(id, 0.0, *space);
      spot.position = start;
      mean += walk.step(spot, *space, surface, flow).step / (number * parameters.step_height);
    }
    // Half of the steps go along each axis, by dx.
    const double error = parameters.step_width / parameters.step_height / std::sqrt(2.0 * number);
    const double drift = (parameters.spread / shear - parameters.diffusion_length()) * slope + more;
    EXPECT_NEAR(mean.x(), drift, 4.0 * error + 0.002) << "4 standard errors, and the lattice's";
    EXPECT_NEAR(mean.y(), 0.0, 4.0 * error + 0.002);
    const double deep = (parameters.spread / slope - parameters.diffusion_length()) * slope;
    EXPECT_GT(std::abs(drift - (shear != slope || more != 0.0 ? deep : 0.0)), 5.0 * error)
        << "it can be told from none, and from that without the surface and the mobility";
  }
}

}  // namespace
