// SPDX-License-Identifier: GPL-2.0-or-later
// Space that repeats and grains of unequal size, against all pairs and all images.
#include "spot/geometry/periodic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "general_scene.hpp"
#include "scenes.hpp"
#include "spot/packing/cell_grid.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/relaxation/relaxation.hpp"
#include "spot/walk/dilation_field.hpp"

namespace {

using spot::Grain;
using spot::InvalidContainer;
using spot::InvalidPacking;
using spot::Packing;
using spot::Periodic;
using spot::Vector3;
using testing::AllOf;
using testing::HasSubstr;
using Pairs = std::set<std::pair<std::int64_t, std::int64_t>>;

constexpr double skin = 0.2;  // of the neighbour lists, in diameters

/// None, x, y, both; lengths and ends that are no multiples of a quantum.
const std::vector<Periodic> all_periods = {
    {}, {spot::Interval{-3.1, 2.7}, {}}, {{}, spot::Interval{-2.3, 2.1}}, {{{-3.1, 2.7}}, {{-2.3, 2.1}}}};
const Vector3 low(-3.1, -2.3, 0.0), high(2.7, 2.1, 6.0);

/// The shortest of the differences to all images of `to`, five periods around.
Vector3 slow_nearest(const Periodic& periodic, const Vector3& from, const Vector3& to) {
  Vector3 nearest = Vector3::Constant(1e300);
  for (int ix = -5; ix <= 5; ++ix)
    for (int iy = -5; iy <= 5; ++iy) {
      if ((ix != 0 && !periodic.along(0)) || (iy != 0 && !periodic.along(1))) continue;
      Vector3 difference = to - from;
      if (ix != 0) difference.x() += ix * periodic.length(0);
      if (iy != 0) difference.y() += iy * periodic.length(1);
      if (difference.squaredNorm() < nearest.squaredNorm()) nearest = difference;
    }
  return nearest;
}

double distance(const Packing& packing, std::size_t i, std::size_t j) {
  return slow_nearest(packing.periodic(), packing.position(i), packing.position(j)).norm();
}

TEST(PeriodicBruteForce, WrapsIntoTheCellAndFindsTheNearestImage) {
  scenes::Draws draws(1);
  for (const Periodic& periodic : all_periods)
    for (int k = 0; k < 2000; ++k) {
      const Vector3 a = draws.in_box({-9, -9, -9}, {9, 9, 9}), b = draws.in_box({-9, -9, -9}, {9, 9, 9});
      const Vector3 wrapped = periodic.wrap(a), nearest = periodic.nearest(Vector3(b - a));
      EXPECT_LT((nearest - slow_nearest(periodic, a, b)).norm(), 1e-12);
      EXPECT_EQ(periodic.nearest(Vector3(a - b)), -nearest);
      EXPECT_EQ(periodic.wrap(wrapped), wrapped);
      for (int axis = 0; axis < 3; ++axis) {
        if (!periodic.along(axis)) {
          EXPECT_EQ(wrapped[axis], a[axis]);
          continue;
        }
        EXPECT_GE(wrapped[axis], periodic.low(axis));
        EXPECT_LT(wrapped[axis], periodic.high(axis));
        const double periods = (wrapped[axis] - a[axis]) / periodic.length(axis);
        EXPECT_NEAR(periods, std::nearbyint(periods), 1e-12);
      }
    }
}

TEST(PeriodicUnit, MultiplesOfTheQuantumWrapExactly) {
  const spot::Quantum quantum(1.0, 100.0);
  const Periodic periodic = all_periods[3].on(quantum);
  const double q = quantum.length();
  for (const double at : {-3.1, 2.7, 2.7 - q, -3.1 - q, 17.3, -40.0}) {
    const double wrapped = periodic.wrap(quantum.snap(at), 0);
    EXPECT_EQ(quantum.snap(wrapped), wrapped);
    EXPECT_EQ(periodic.wrap(wrapped + periodic.length(0), 0), wrapped);
    EXPECT_EQ(periodic.wrap(wrapped - 3.0 * periodic.length(0), 0), wrapped);
  }
  EXPECT_EQ(periodic.wrap(periodic.high(0), 0), periodic.low(0));
}

TEST(PeriodicUnit, RefusesBadEnds) {
  for (const auto& [bad_low, bad_high] : std::vector<std::pair<double, double>>{
           {1.0, 1.0}, {2.0, 1.0}, {std::nan(""), 1.0}, {0.0, std::numeric_limits<double>::infinity()}})
    EXPECT_THAT(scenes::text_of<InvalidContainer>([&, a = bad_low, b = bad_high] {
                  Periodic(std::nullopt, spot::Interval{a, b});
                }),
                AllOf(HasSubstr("along y"), HasSubstr("increasing order")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] { Packing(2.0, 100.0, {}, all_periods[1]); }),
              AllOf(HasSubstr("along x"), HasSubstr("5.8"), HasSubstr("at least 8")));
  EXPECT_THAT(scenes::text_of<InvalidContainer>([] { Packing(1.0, 3.0, {}, all_periods[1]); }),
              HasSubstr("farther from the origin than 3"));
}

TEST(CellGridBruteForce, VisitsImagesOnce) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const Periodic& periodic : all_periods) {
      scenes::Draws draws(seed);
      spot::CellGrid grid(low, high, draws.uniform(0.3, 7.0), periodic);
      std::vector<Vector3> points;
      for (std::uint32_t i = 0; i < 90; ++i) {
        points.push_back(periodic.wrap(draws.in_box({-6, -6, -2}, {6, 6, 8})));
        grid.insert(grid.cell_of(points[i].x(), points[i].y(), points[i].z()), i);
      }
      for (int k = 0; k < 200; ++k) {
        const Vector3 centre = draws.in_box({-8, -8, -3}, {8, 8, 9});
        const double reach = draws.uniform(0.0, 4.0);
        std::vector<int> visits(points.size());
        grid.visit_near(centre, reach, [&](std::uint32_t i) { ++visits[i]; });
        for (std::size_t i = 0; i < points.size(); ++i) {
          ASSERT_LE(visits[i], 1) << "visited twice";
          if (slow_nearest(periodic, centre, points[i]).norm() <= reach) {
            ASSERT_EQ(visits[i], 1) << "point " << points[i].transpose() << ", centre " << centre.transpose();
          }
        }
      }
    }
}

std::vector<Grain> unequal(const Periodic& periodic, std::uint64_t seed, double squeeze = 1.0) {
  std::vector<Grain> grains = scenes::unequal_grains(200, low, high, periodic, seed);
  for (Grain& grain : grains) grain.position *= squeeze;
  return grains;
}

Pairs listed_pairs(const Packing& packing) {
  Pairs pairs;
  for (std::size_t i = 0; i < packing.slots(); ++i) {
    const auto [first, last] = packing.neighbours(i);
    for (const std::uint32_t* j = first; j != last; ++j)
      EXPECT_TRUE(pairs.emplace(packing.id(i), packing.id(*j)).second) << "a neighbour is listed twice";
  }
  return pairs;
}

/// Pairs of grains that are there, closer than `apart` and, if that is asked for, than they touch.
Pairs slow_pairs(const Packing& packing, double apart, bool touching = false) {
  Pairs pairs;
  for (std::size_t i = 0; i < packing.slots(); ++i)
    for (std::size_t j = 0; j < packing.slots(); ++j)
      if (i != j && packing.present(i) && packing.present(j) &&
          distance(packing, i, j) < (touching ? packing.radius(i) + packing.radius(j) : apart))
        pairs.emplace(packing.id(i), packing.id(j));
  return pairs;
}

/// Many rounds of moves, small and large, and removals; grains leave the cell on all sides.
TEST(PackingBruteForce, ListsAndOverlapsOfUnequalGrainsAcrossTheEndsOfTheCell) {
  const auto container = scenes::empty_space();
  for (const Periodic& periodic : all_periods)
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      scenes::Draws draws(seed);
      Packing packing(1.0, 100.0, unequal(periodic, seed), periodic);
      packing.refresh(*container);
      ASSERT_EQ(listed_pairs(packing), slow_pairs(packing, 1.0 + skin));
      ASSERT_EQ(packing.largest_overlap().depth, 0.0);
      for (int round = 0; round < 8; ++round) {
        const double reach = round % 3 == 0 ? 0.8 : 0.03;
        for (std::uint32_t i = 0; i < packing.slots(); ++i) {
          if (!packing.present(i)) continue;
          const auto shift = [&] { return packing.quantum().round(draws.uniform(-reach, reach)); };
          const double dx = shift(), dy = shift(), dz = shift();
          packing.move(i, dx, dy, dz);
        }
        round % 2 == 0 ? packing.refresh(*container) : packing.update_lists(*container);
        packing.remove(scenes::all_movable(packing)[draws.below(packing.size())]);

        const Pairs listed = listed_pairs(packing), touching = slow_pairs(packing, 0.0, true);
        ASSERT_TRUE(std::includes(listed.begin(), listed.end(), touching.begin(), touching.end()));
        double deepest = 0.0;
        for (const auto& [a, b] : touching) {
          const auto i = scenes::index_of(packing, a), j = scenes::index_of(packing, b);
          deepest = std::max(deepest, 1.0 - distance(packing, i, j) / (packing.radius(i) + packing.radius(j)));
        }
        ASSERT_NEAR(packing.largest_overlap().depth, deepest, 1e-12);
        for (const Grain& grain : packing.grains()) {
          ASSERT_EQ(periodic.on(packing.quantum()).wrap(grain.position), grain.position);
          ASSERT_EQ(packing.quantum().snap(grain.position.x()), grain.position.x());
        }
        std::vector<std::uint32_t> found;
        for (int k = 0; k < 20; ++k) {
          const Vector3 point = draws.in_box({-6, -5, -2}, {6, 5, 8});
          const double radius = draws.uniform(0.0, 4.0);
          packing.find_movable(point, radius, found);
          std::set<std::uint32_t> all(found.begin(), found.end());
          ASSERT_EQ(all.size(), found.size()) << "found twice";
          for (std::uint32_t i = 0; i < packing.slots(); ++i) {
            if (!packing.present(i)) continue;
            ASSERT_EQ(all.count(i) == 1, slow_nearest(packing.periodic(), point, packing.position(i)).norm() <= radius);
          }
        }
      }
    }
}

/// One sweep over all of a squeezed packing, pair by pair: alpha delta / 2 each, delta = r_i + r_j - distance.
TEST(RelaxationBruteForce, PushesUnequalGrainsApartAcrossTheEndsOfTheCell) {
  const auto container = scenes::empty_space();
  for (const Periodic& periodic : all_periods)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      std::vector<Grain> grains = unequal(periodic, seed, 0.9);
      for (std::size_t k = 0; k < grains.size(); k += 9) grains[k].held = true;
      Packing packing(1.0, 100.0, grains, periodic);
      packing.refresh(*container);
      std::map<std::int64_t, Vector3> expected;
      double deepest = 0.0;
      int pushes = 0;
      for (std::size_t i = 0; i < packing.slots(); ++i) {
        Vector3& at = expected[packing.id(i)] = packing.position(i);
        for (std::size_t j = 0; j < packing.slots(); ++j) {
          if (i == j || packing.held(i)) continue;
          const Vector3 off = -slow_nearest(packing.periodic(), packing.position(i), packing.position(j));
          const double delta = packing.radius(i) + packing.radius(j) - off.norm();
          if (delta <= 0.0) continue;
          deepest = std::max(deepest, delta / (packing.radius(i) + packing.radius(j)));
          at += (packing.held(j) ? 0.8 : 0.4) * delta * off.normalized();
          ++pushes;
        }
      }
      ASSERT_GT(pushes, 20);
      const double found =
          spot::Relaxation{spot::RelaxationParameters()}.sweep(packing, *container, scenes::all_movable(packing));
      EXPECT_NEAR(found, deepest, 1e-12);
      for (const Grain& grain : packing.grains())
        EXPECT_LT(slow_nearest(periodic, grain.position, expected[grain.id]).norm(), 1e-10) << grain.id;
    }
}

TEST(RelaxationUnit, WallsPushEachGrainByItsRadius) {
  const auto silo = scenes::small_silo(8.0, 4.0);
  Packing packing(1.0, 100.0, {{1, {6.0, 0.0, 0.2}, false, 0.25}, {2, {-7.7, 0.0, 5.0}, false, 0.375}, {3, {3, 0, 9}}});
  packing.refresh(*silo);
  spot::Relaxation{spot::RelaxationParameters()}.sweep(packing, *silo, scenes::all_movable(packing));
  EXPECT_NEAR(packing.grains()[0].position.z(), 0.2 + 0.8 * 0.05, 1e-11);
  EXPECT_NEAR(packing.grains()[1].position.x(), -7.7 + 0.8 * 0.075, 1e-11);
  EXPECT_EQ(packing.grains()[2].position, Vector3(3, 0, 9));
}

/// What a move encloses, grain by grain and image by image; it counts grains by volume and moves them by share.
TEST(DisplacementBruteForce, UnequalGrainsAcrossTheEndsOfTheCell) {
  const auto container = scenes::empty_space();
  for (const Periodic& periodic : all_periods)
    for (const auto* profile : {spot::InfluenceProfile::uniform, spot::InfluenceProfile::parabolic}) {
      scenes::Draws draws(5);
      Packing packing(1.0, 100.0, unequal(periodic, 3), periodic);
      spot::SpotParameters spots{1.9, 0.02};
      spots.profile = profile;
      std::vector<std::uint32_t> near;
      for (int k = 0; k < 100; ++k) {
        const spot::Move move{0.0, k, draws.in_box({-4.0, -3.0, 0.0}, {4.0, 3.0, 6.0}),
                              draws.in_box({-0.7, -0.7, 0.1}, {0.7, 0.7, 0.1})};
        std::vector<Grain> expected = packing.grains();
        double volume = 0.0;
        int enclosed = 0;
        for (Grain& grain : expected) {
          const double r = slow_nearest(periodic, move.middle, grain.position).norm() / spots.radius;
          if (r > 1.0) continue;
          const double share = profile == spot::InfluenceProfile::uniform ? 1.0 : 1.0 - r * r;
          grain.position -= share * 0.02 * move.step;
          volume += share * std::pow(2.0 * grain.radius, 3);
          ++enclosed;
        }
        packing.refresh(*container);
        packing.find_movable(move.middle, 2.5, near);
        const int shares = spot::enclosed_volume(packing, near, move, spots);
        EXPECT_NEAR(shares, volume * spot::grain_volume, 1.5 * enclosed);  // whole parts of each
        EXPECT_EQ(spot::displace(packing, near, move, spots), shares);
        const std::vector<Grain> grains = packing.grains();
        for (std::size_t i = 0; i < grains.size(); ++i)
          ASSERT_LT(slow_nearest(periodic, grains[i].position, expected[i].position).norm(), 1e-10);
      }
    }
}

TEST(PackingUnit, RadiiAreKeptAndBadOnesNamed) {
  Packing packing(2.0, 10.0, {{1, {0, 0, 0}}, {2, {3, 0, 0}, false, 0.5}, {3, {6, 0, 0}, true, 0.75}});
  packing.refresh(*scenes::empty_space());
  const auto grains = packing.grains();
  EXPECT_EQ(grains[0].radius, 1.0);
  EXPECT_EQ(grains[1].radius, 0.5);
  EXPECT_EQ(grains[2].radius, 0.75);
  EXPECT_EQ(packing.volume(scenes::index_of(packing, 1)), spot::grain_volume);
  EXPECT_EQ(packing.volume(scenes::index_of(packing, 2)), spot::grain_volume / 8);
  EXPECT_EQ(packing.volume(scenes::index_of(packing, 3)), spot::grain_volume * 27 / 64);
  EXPECT_EQ(packing.remove(scenes::index_of(packing, 2)).radius, 0.5);
  for (const double bad : {0.49, 1.01, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THAT(scenes::text_of<InvalidPacking>([&] {
                  Packing(2.0, 10.0, {{4711, {0, 0, 0}, false, bad}});
                }),
                AllOf(HasSubstr("radius of grain 4711"), HasSubstr("0.5"), HasSubstr("to 1")));
}

TEST(ContainerBruteForce, RepeatedWallsAreTheSameInEveryCell) {
  const spot::Orifice orifice{{-1.0, 0.4, 0.0}, 1.5};
  const auto silo = scenes::repeated_silo(low, high, true, false, orifice, {0.4, 0.7});
  const double period = high.x() - low.x();
  scenes::Draws draws(4);
  int blocked = 0, through = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector3 at = draws.in_box({low.x(), low.y(), 0.0}, high);
    const Vector3 image = at + Vector3(period * (static_cast<int>(draws.below(5)) - 2), 0, 0);
    EXPECT_EQ(silo->contains(image), silo->contains(at));
    spot::WallContacts here, there;
    silo->contacts(at, 0.9, here);
    silo->contacts(image, 0.9, there);
    ASSERT_EQ(here.end() - here.begin(), there.end() - there.begin());
    for (auto a = here.begin(), b = there.begin(); a != here.end(); ++a, ++b)
      EXPECT_NEAR(a->distance, b->distance, 1e-12);

    // Through the base, from above, by a path that may cross several cells and stays between the walls.
    const Vector3 below(image.x() + draws.uniform(-9.0, 9.0), draws.uniform(low.y(), high.y()),
                        -draws.uniform(0.1, 3.0));
    const Vector3 passed = image + image.z() / (image.z() - below.z()) * (below - image);
    const bool hole = slow_nearest(silo->periodic(), orifice.centre, passed).head<2>().norm() <= orifice.radius;
    const auto wall = silo->first_wall(image, below);
    ASSERT_EQ(!wall, hole) << image.transpose() << " to " << below.transpose();
    if (wall) {
      EXPECT_NEAR(wall->share, image.z() / (image.z() - below.z()), 1e-9);
    }
    hole ? ++through : ++blocked;

    const Vector3 target = at + draws.in_box({-0.6, -0.6, 0.1}, {0.6, 0.6, 0.1});
    EXPECT_LT((silo->keep_spot_inside(image, image + (target - at)) - image - (silo->keep_spot_inside(at, target) - at))
                  .norm(),
              1e-11);
  }
  EXPECT_GT(blocked, 100);
  EXPECT_GT(through, 100);
}

TEST(ContainerUnit, RefusesWallsAcrossAPeriodAndOrificesBeyondIt) {
  spot::WalledContainer silo(spot::Orifice{{0, 0, 0}, 2.0});
  EXPECT_THAT(scenes::text_of<InvalidContainer>([&] {
                silo.repeat({spot::Interval{-1.9, 5.0}, {}});
              }),
              AllOf(HasSubstr("orifice of radius 2"), HasSubstr("along x"), HasSubstr("-1.9")));
  silo.repeat({spot::Interval{-5.0, 5.0}, {}});
  EXPECT_THAT(scenes::text_of<InvalidContainer>(
                  [&] { silo.add(std::make_unique<spot::PlaneWall>(Vector3(4, 0, 0), Vector3(-1, 0, 0)), 1.0); }),
              AllOf(HasSubstr("across x at 4"), HasSubstr("repeats")));
}

/// The same as without a period, but with images of all spots around.
TEST(DilationFieldBruteForce, ImagesOfSpotsDilate) {
  spot::SpotParameters spots = scenes::paper_spots();
  spots.radius = 2.0;
  spots.dilation = 0.03;
  const spot::Orifice orifice{{0.5, -0.25, 0.0}, 2.0};
  spot::WalledContainer space(orifice), repeated(orifice);
  const Periodic periodic(spot::Interval{-6.0, 6.0}, spot::Interval{-4.0, 6.0});
  repeated.repeat(periodic);
  scenes::Draws draws(9);
  std::vector<Vector3> places, images;
  for (int k = 0; k < 50; ++k) {
    places.push_back(draws.in_box({-6, -4, 1}, {6, 6, 9}));
    for (int ix = -2; ix <= 2; ++ix)
      for (int iy = -2; iy <= 2; ++iy) images.push_back(places.back() + Vector3(12.0 * ix, 10.0 * iy, 0.0));
  }
  spot::Alone alone;
  spot::Workers workers(1);
  spot::DilationField wide(spots, space, 1.0), narrow(spots, repeated, 1.0);
  wide.count(images, alone, workers);
  narrow.count(places, alone, workers);
  for (int k = 0; k < 200; ++k) {
    const Vector3 at = draws.in_box({-8, -6, 0}, {8, 8, 10});
    EXPECT_NEAR(narrow.at(at), wide.at(at), 1e-4 * wide.at(at) + 1e-12) << at.transpose();
  }
}

}  // namespace
