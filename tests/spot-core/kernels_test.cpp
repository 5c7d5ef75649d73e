// SPDX-License-Identifier: GPL-2.0-or-later
// Every build of the kernels gives the bits of the plain one, and the plain one what its description says.
#include "packing/kernel_builds.hpp"
#include "spot/packing/coordinates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "scenes.hpp"

namespace {

using spot::NonaffineMotion;
using spot::Point;
using spot::kernels::Kernels;

const Kernels& base = *spot::kernels::runnable().front();

/// Quanta in a diameter, the most that there are.
constexpr double diameter = 0x1p+25 - 1.0;
constexpr float per_square = static_cast<float>(1.0 / (diameter * diameter));
constexpr Point nobody = {0, 0, 0, Point::empty};

std::int32_t wrapped(std::int64_t place) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(place)));
}

/// The lowest corner of the boxes below: some of their places are beyond the largest number of 32 bits, and wrap.
constexpr std::int64_t corner = std::numeric_limits<std::int32_t>::max() - (std::int64_t{5} << 24);

/// So many diameters from the corner.
Point point_at(const spot::Vector3& place) {
  return {wrapped(corner + std::llrint(place.x() * diameter)), wrapped(corner + std::llrint(place.y() * diameter)),
          wrapped(corner + std::llrint(place.z() * diameter)), Point::free};
}

/// Random points in a box: every fifth place is empty, every seventh grain held, one of eleven where another is.
std::vector<Point> points_in_box(std::size_t n, double edge, std::uint64_t seed) {
  scenes::Draws draws(seed);
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) {
    Point point = point_at(draws.in_box({0, 0, 0}, {edge, edge, edge}));
    if (i % 11 == 10) point = points[i - 6];
    if (i % 7 == 6) point.state = Point::held;
    points.push_back(i % 5 == 4 ? nobody : point);
  }
  return points;
}

double squared_distance(const Point& a, const Point& b) {
  const double x = wrapped(std::int64_t{a.x} - b.x), y = wrapped(std::int64_t{a.y} - b.y),
               z = wrapped(std::int64_t{a.z} - b.z);
  return x * x + y * y + z * z;
}

void expect_same(const std::vector<Point>& a, const std::vector<Point>& b, const Kernels& build) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x, b[i].x) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].y, b[i].y) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].z, b[i].z) << build.instruction_set << ", point " << i;
    ASSERT_EQ(a[i].state, b[i].state) << build.instruction_set << ", point " << i;
  }
}

float depth_of(const Point& push) {
  float depth;
  std::memcpy(&depth, &push.state, sizeof depth);
  return depth;
}

/// Points as moves take them, all of them or none within reach.
struct Places {
  spot::Coordinates at;
  spot::Tilts tilts;
  std::vector<std::uint32_t> blocks;

  explicit Places(const std::vector<Point>& points, const std::vector<NonaffineMotion::Tilt>& of_points = {}) {
    EXPECT_EQ(points.size() % spot::kernels::lanes, 0u);
    for (auto* values : {&at.x, &at.y, &at.z}) values->resize(points.size());
    at.state_squared.resize(points.size());
    for (auto* values : {&tilts.x, &tilts.y, &tilts.z, &tilts.level}) values->resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) at.set(i, points[i]);
    for (std::size_t i = 0; i < of_points.size(); ++i) tilts.set(i, of_points[i]);
    for (std::size_t i = 0; i < points.size(); i += spot::kernels::lanes)
      blocks.push_back(static_cast<std::uint32_t>(i / spot::kernels::lanes));
  }

  spot::kernels::Places all() { return some(blocks.size()); }
  spot::kernels::Places none() { return some(0); }
  spot::kernels::Places some(std::size_t count) {
    return {at.x.data(), at.y.data(), at.z.data(), at.state_squared.data(), blocks.data(), count};
  }
  spot::kernels::TiltsOfPlaces own() const { return {tilts.x.data(), tilts.y.data(), tilts.z.data()}; }

  /// With the states that the points had.
  std::vector<Point> points(const std::vector<Point>& before) const {
    std::vector<Point> now;
    for (std::size_t i = 0; i < before.size(); ++i) now.push_back(at.at(i, before[i].state));
    return now;
  }
};

constexpr double radius = 2.6 * diameter;

constexpr auto radius_squared = static_cast<float>(radius * radius);
constexpr spot::Reach uniform = {radius_squared, 1.0f}, parabolic = {radius_squared, 1.0f / radius_squared};

TEST(KernelsInvariance, DisplacementIsTheSameInEveryBuild) {
  const Point by = {57012345, -8400321, 1003, 0};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto start = points_in_box(400, 6.0, seed);
    const Point middle = point_at({3, 3, 3});
    const spot::Reach reach = seed % 2 == 0 ? uniform : parabolic;
    Places plain(start);
    const int shares = base.enclosed_volume(plain.all(), middle, reach);
    EXPECT_GT(shares, 10 * spot::grain_volume);
    base.displace(plain.all(), middle, reach, by);
    for (const Kernels* build : spot::kernels::runnable()) {
      Places places(start);
      EXPECT_EQ(build->enclosed_volume(places.all(), middle, reach), shares);
      EXPECT_EQ(build->enclosed_volume(places.none(), middle, reach), 0);
      build->displace(places.none(), middle, reach, by);
      expect_same(places.points(start), start, *build);
      build->displace(places.all(), middle, reach, by);
      expect_same(places.points(start), plain.points(start), *build);
    }
  }
}

std::vector<NonaffineMotion::Tilt> tilts_of(std::size_t n, std::uint64_t seed) {
  scenes::Draws draws(seed);
  const auto draw = [&] { return static_cast<std::int16_t>(static_cast<int>(draws.below(65535)) - 32767); };
  std::vector<NonaffineMotion::Tilt> tilts;
  for (std::size_t i = 0; i < n; ++i) tilts.push_back({draw(), draw(), draw(), draw()});
  return tilts;
}

TEST(KernelsInvariance, TiltedDisplacementIsTheSameInEveryBuild) {
  const Point by = {5701234, -840032, 1003, 0};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto start = points_in_box(400, 6.0, seed);
    const auto tilts = tilts_of(start.size(), seed);
    const Point middle = point_at({3, 3, 3});
    const spot::Reach reach = seed % 2 == 0 ? uniform : parabolic;
    Places plain(start, tilts);
    base.displace_tilted(plain.all(), plain.own(), middle, reach, by, 3.7f);
    for (const Kernels* build : spot::kernels::runnable()) {
      Places places(start, tilts);
      build->displace_tilted(places.none(), places.own(), middle, reach, by, 3.7f);
      expect_same(places.points(start), start, *build);
      build->displace_tilted(places.all(), places.own(), middle, reach, by, 3.7f);
      expect_same(places.points(start), plain.points(start), *build);
    }
    // Nobody's own way: as without.
    Places tilted(start, tilts), straight(start);
    base.displace_tilted(tilted.all(), tilted.own(), middle, reach, by, 0.0f);
    base.displace(straight.all(), middle, reach, by);
    expect_same(tilted.points(start), straight.points(start), base);
  }
}

TEST(KernelsInvariance, MovesAreCountedForWhatIsInReach) {
  const auto start = points_in_box(400, 6.0, 3);
  const Point middle = point_at({3, 3, 3});
  std::vector<std::uint32_t> expected;
  for (const Point& point : start)
    expected.push_back(point.state == Point::free && squared_distance(point, middle) <= radius * radius ? 2 : 0);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 2u), 20);
  for (const Kernels* build : spot::kernels::runnable()) {
    Places places(start);
    std::vector<std::uint32_t> received(start.size(), 0);
    for (int twice = 0; twice < 2; ++twice) {
      build->count_received(places.all(), middle, uniform, received.data());
      build->count_received(places.none(), middle, uniform, received.data());
    }
    EXPECT_EQ(received, expected) << build->instruction_set;
  }
}

/// A grain in the middle of a uniform move has all of it and of what its tilt adds.
TEST(KernelsAnalytic, ATiltAddsToTheMove) {
  for (const Kernels* build : spot::kernels::runnable()) {
    const std::vector<Point> start(spot::kernels::lanes, Point{0, 0, 0, Point::free});
    Places places(start, std::vector<NonaffineMotion::Tilt>(start.size(), {100, -200, 400, 77}));
    build->displace_tilted(places.all(), places.own(), {0, 0, 0, Point::free}, uniform, {10, 20, -3000, 0}, 0.5f);
    for (const Point& point : places.points(start)) {
      EXPECT_EQ(point.x, 10 + 50);
      EXPECT_EQ(point.y, 20 - 100);
      EXPECT_EQ(point.z, -3000 + 200);
      EXPECT_EQ(point.state, Point::free);
    }
  }
}

/// Single precision decides who is inside only where it is as good as undecided.
TEST(KernelsUnit, DisplacementMovesFreePointsInsideTheSphere) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto start = points_in_box(400, 6.0, seed);
    Places places(start);
    const Point middle = point_at({3, 3, 3});
    base.displace(places.all(), middle, uniform, {17, -5, 3, 0});
    const auto points = places.points(start);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double part = squared_distance(start[i], middle) / (radius * radius);
      if (std::abs(part - 1.0) < 1e-6) continue;
      const bool moves = start[i].state == Point::free && part < 1.0;
      EXPECT_EQ(points[i].x, wrapped(std::int64_t{start[i].x} + (moves ? 17 : 0))) << i;
      EXPECT_EQ(points[i].y, wrapped(std::int64_t{start[i].y} - (moves ? 5 : 0))) << i;
      EXPECT_EQ(points[i].z, wrapped(std::int64_t{start[i].z} + (moves ? 3 : 0))) << i;
    }
  }
}

TEST(KernelsAnalytic, ParabolicSharesFallWithTheSquareOfTheDistance) {
  const auto start = points_in_box(400, 6.0, 3);
  Places places(start);
  const Point middle = point_at({3, 3, 3});
  const int enclosed = base.enclosed_volume(places.all(), middle, parabolic);
  base.displace(places.all(), middle, parabolic, {0, 0, -1000000, 0});
  const auto points = places.points(start);
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double part = squared_distance(start[i], middle) / (radius * radius);
    const double share = start[i].state == Point::free ? std::max(0.0, 1.0 - part) : 0.0;
    EXPECT_NEAR(static_cast<double>(points[i].z) - start[i].z, -1e6 * share, 1.5) << i;
    sum += share;
  }
  EXPECT_NEAR(enclosed, sum * spot::grain_volume, 0.5 * sum + 200.0);
}

/// Neither empty places nor held grains are ever in reach, wherever they are and however small a diameter is.
TEST(KernelsUnit, DisplacementLeavesHeldAndEmptyPlacesAlone) {
  const auto largest = static_cast<float>(8.0 * diameter * 8.0 * diameter);
  for (const Kernels* build : spot::kernels::runnable()) {
    std::vector<Point> points(spot::kernels::lanes, {0, 0, 0, Point::held});
    points[3] = points[6] = nobody;
    Places places(points);
    EXPECT_EQ(build->enclosed_volume(places.all(), {0, 0, 0, Point::free}, {largest, 1.0f}), 0);
    build->displace(places.all(), {0, 0, 0, Point::free}, {largest, 1.0f}, {1, 1, 1, 0});
    expect_same(places.points(points), points, *build);
  }
}

/// Random lists, and who has them.
struct Listed {
  std::vector<Point> points;
  std::vector<std::uint32_t> neighbours, blocks, grains;
  std::vector<std::uint8_t> sizes;
  std::uint32_t capacity;

  Listed(std::uint64_t seed, std::uint32_t list_capacity)
      : points(points_in_box(200, 4.0, seed)), capacity(list_capacity) {
    scenes::Draws draws(seed);
    neighbours.resize(points.size() * capacity);
    for (auto& unused : neighbours) unused = static_cast<std::uint32_t>(draws.below(points.size()));
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      std::uint32_t n = 0;
      for (std::uint32_t wanted = static_cast<std::uint32_t>(draws.below(capacity + 1)); n < wanted;) {
        const auto other = static_cast<std::uint32_t>(draws.below(points.size()));
        if (other != i && points[other].state != Point::empty) neighbours[i * capacity + n++] = other;
      }
      blocks.push_back(i * capacity / spot::kernels::lanes);
      sizes.push_back(static_cast<std::uint8_t>(n));
      if (points[i].state == Point::free) grains.push_back(i);
    }
  }

  spot::kernels::Lists lists() const { return {neighbours.data(), blocks.data(), sizes.data()}; }

  /// Half of the free grains are swept.
  std::vector<Point> pushes(const Kernels& build, const spot::kernels::Gaps& gaps = {}) const {
    auto marked = points;
    for (std::size_t i = 0; i < marked.size(); i += 2)
      if (marked[i].state == Point::free) marked[i].state = Point::swept;
    std::vector<Point> all(grains.size());
    auto padded = grains;
    padded.resize(grains.size() + spot::kernels::ahead, 0);
    build.push_off_neighbours(marked.data(), padded.data(), grains.size(), lists(), {per_square, 0.4f, 0.8f, gaps},
                              all.data());
    return all;
  }
};

TEST(KernelsInvariance, PushesAreTheSameInEveryBuild) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Listed listed(seed, seed % 2 == 0 ? 16 : 32);
    const auto plain = listed.pushes(base);
    int pushed = 0, coincident = 0;
    for (const Point& push : plain) {
      pushed += depth_of(push) > 0.0f;
      coincident += depth_of(push) == 1.0f;
    }
    EXPECT_GT(pushed, 20);
    EXPECT_LT(coincident, pushed);
    const auto closing = listed.pushes(base, {0.5f, 0.3f});
    int drawn = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      drawn += closing[i].x != plain[i].x;
      EXPECT_EQ(closing[i].state, plain[i].state) << "the depth is that of overlaps";
    }
    EXPECT_GT(drawn, 10);
    for (const Kernels* build : spot::kernels::runnable()) {
      expect_same(listed.pushes(*build), plain, *build);
      expect_same(listed.pushes(*build, {0.5f, 0.3f}), closing, *build);
      expect_same(listed.pushes(*build, {0.5f, 0.0f}), plain, *build);
    }
  }
}

/// Points 0 and 1, each the other's only neighbour.
struct ListedPair {
  std::vector<std::uint32_t> neighbours = std::vector<std::uint32_t>(32, 0), blocks = {0, 1};
  std::vector<std::uint8_t> sizes = {1, 1};
  std::vector<std::uint32_t> grains = {0, 1, 0, 0, 0, 0, 0, 0, 0, 0};  // and those fetched ahead

  ListedPair() { neighbours[0] = 1; }
  spot::kernels::Lists lists() const { return {neighbours.data(), blocks.data(), sizes.data()}; }
};

TEST(KernelsAnalytic, PushesAreSharesOfTheOverlapAlongTheLineOfCentres) {
  scenes::Draws draws(3);
  const ListedPair pair;
  for (int k = 0; k < 1000; ++k) {
    const double overlap = 0.05 * draws.uniform(0.0, 1.0);
    spot::Vector3 along = draws.in_box({-1, -1, -1}, {1, 1, 1});
    along.normalize();
    std::vector<Point> points = {point_at({1, 1, 1}), point_at(spot::Vector3(1, 1, 1) + (1.0 - overlap) * along)};
    std::vector<Point> pushes(2);
    base.push_off_neighbours(points.data(), pair.grains.data(), 2, pair.lists(), {per_square, 0.2f, 0.4f},
                             pushes.data());
    const spot::Vector3 push(pushes[0].x, pushes[0].y, pushes[0].z);
    // To 1e-4 of itself, and what single precision leaves of 1 - r^2/d^2, and one quantum along each axis.
    const double error = 1e-4 * 0.4 * overlap + 1e-6;
    EXPECT_LT((push / diameter + 0.4 * overlap * along).norm(), error) << overlap;
    EXPECT_NEAR(depth_of(pushes[0]), 1.0 - (1.0 - overlap) * (1.0 - overlap), 1e-6);
    EXPECT_EQ(pushes[0].x, -pushes[1].x) << "action is reaction";
    EXPECT_EQ(pushes[0].y, -pushes[1].y);
    EXPECT_EQ(pushes[0].z, -pushes[1].z);
    points[1].state = Point::swept;
    std::vector<Point> half(2);
    base.push_off_neighbours(points.data(), pair.grains.data(), 2, pair.lists(), {per_square, 0.2f, 0.4f}, half.data());
    EXPECT_NEAR(half[0].x, 0.5 * pushes[0].x, 1.0) << "the pair's share";
    expect_same({half[1]}, {pushes[1]}, base);
  }
}

/// Both kernels, against double precision: gaps below the widest are closed by their share of (r - d), along the line
/// of centres, all others left alone.
TEST(KernelsAnalytic, GapsAreClosedByTheirShareOfWhatOverlapsArePushedApartBy) {
  scenes::Draws draws(4);
  const ListedPair pair;
  const double widest = 0.02, share = 0.1;
  const spot::kernels::Gaps gaps = {static_cast<float>((1.0 + widest) * (1.0 + widest) - 1.0),
                                    static_cast<float>(share)};
  const double radii[] = {0.3, 0.45};
  const std::vector<spot::GrainSize> unequal = {{0, static_cast<float>(radii[0] * diameter), 0},
                                                {0, static_cast<float>(radii[1] * diameter), 0}};
  for (int k = 0; k < 1000; ++k) {
    const double gap = draws.uniform(1e-4, 2.0 * widest);
    if (std::abs(gap - widest) < 1e-6) continue;
    spot::Vector3 along = draws.in_box({-1, -1, -1}, {1, 1, 1});
    along.normalize();
    for (const Kernels* build : spot::kernels::runnable())
      for (const double touching : {1.0, radii[0] + radii[1]}) {
        std::vector<Point> points = {point_at({1, 1, 1}),
                                     point_at(spot::Vector3(1, 1, 1) + (1.0 + gap) * touching * along)};
        points[1].state = k % 2 == 0 ? Point::swept : Point::free;
        std::vector<Point> pushes(2);
        if (touching == 1.0)
          build->push_off_neighbours(points.data(), pair.grains.data(), 2, pair.lists(), {per_square, 0.2f, 0.4f, gaps},
                                     pushes.data());
        else
          build->push_off_unequal_neighbours(points.data(), unequal.data(), pair.grains.data(), 2, pair.lists(),
                                             {1.0f, 0.2f, 0.4f, gaps}, pushes.data());
        const double part = gap < widest ? share * (k % 2 == 0 ? 0.2 : 0.4) : 0.0;
        const spot::Vector3 push(pushes[0].x, pushes[0].y, pushes[0].z);
        EXPECT_LT((push / diameter - part * gap * touching * along).norm(), 1e-4 * part * gap + 1e-6) << gap;
        EXPECT_EQ(depth_of(pushes[0]), 0.0f);
        EXPECT_EQ(push.dot(along) > 0.0, gap < widest) << gap;
      }
  }
}

/// The last corrections of as many grains as there are pushes, the same kind of thing.
struct Correcting {
  std::vector<Point> points, last, pushes;
  std::vector<std::uint32_t> grains;
  std::vector<std::uint8_t> in_cell;
  std::vector<spot::Corrections> at_most;

  Correcting(std::uint64_t seed, std::size_t n) : points(points_in_box(3 * n, 4.0, seed)), last(3 * n, {0, 0, 0, 0}) {
    scenes::Draws draws(seed);
    const auto whole = [&draws](double most) { return static_cast<std::int32_t>(draws.uniform(-most, most)); };
    for (std::uint32_t i = 0; i < n; ++i) {
      grains.push_back(3 * i + 1);
      points[grains[i]].state = Point::swept;
      last[grains[i]] = {whole(1e5), whole(1e5), whole(1e5), 0};
      const auto depth = static_cast<float>(draws.uniform(0.0, 0.1));
      pushes.push_back({whole(1e6), whole(1e6), whole(1e6), 0});
      std::memcpy(&pushes[i].state, &depth, sizeof depth);
    }
    for (std::size_t left = n; left > 0; left -= in_cell.back())
      in_cell.push_back(static_cast<std::uint8_t>(std::min<std::size_t>(left, 1 + in_cell.size() % 5)));
    in_cell.push_back(0);
    grains.resize(n + spot::kernels::ahead, 0);
    at_most.resize(in_cell.size());
  }

  void run(const Kernels& build) {
    build.correct(points.data(), last.data(), grains.data(), in_cell.data(), in_cell.size(), pushes.data(), 0.6f,
                  at_most.data());
  }
};

TEST(KernelsAnalytic, CorrectionsAreThePushAndAPartOfTheLast) {
  const Correcting before(1, 7);
  Correcting after = before;
  after.run(base);
  std::size_t cell = 0, left = before.in_cell[0];
  double longest = 0.0, deepest = 0.0;
  for (std::size_t i = 0; i < before.pushes.size(); ++i) {
    const std::uint32_t grain = before.grains[i];
    const auto expected = [](std::int32_t push, std::int32_t last) {
      return push + static_cast<std::int32_t>(0.6f * static_cast<float>(last));
    };
    const Point by = {expected(before.pushes[i].x, before.last[grain].x),
                      expected(before.pushes[i].y, before.last[grain].y),
                      expected(before.pushes[i].z, before.last[grain].z), 0};
    expect_same({after.last[grain]}, {by}, base);
    EXPECT_EQ(after.points[grain].y, wrapped(std::int64_t{before.points[grain].y} + by.y));
    EXPECT_EQ(after.points[grain].state, Point::free);
    longest = std::max(longest, squared_distance(by, {0, 0, 0, 0}));
    deepest = std::max<double>(deepest, depth_of(before.pushes[i]));
    expect_same({after.points[grain - 1]}, {before.points[grain - 1]}, base);
    if (--left > 0) continue;
    EXPECT_NEAR(after.at_most[cell].longest_squared, longest, 1e-6 * longest);
    EXPECT_EQ(after.at_most[cell].depth, deepest);
    left = before.in_cell[++cell];
    longest = deepest = 0.0;
  }
  EXPECT_EQ(cell + 1, before.in_cell.size());
  EXPECT_EQ(after.at_most[cell].longest_squared, 0.0f) << "nobody is in the last cell";
}

TEST(KernelsInvariance, CorrectionsAreTheSameInEveryBuild) {
  for (std::size_t n = 0; n <= 40; ++n) {
    Correcting plain(n + 1, n);
    plain.run(base);
    for (const Kernels* build : spot::kernels::runnable()) {
      Correcting other(n + 1, n);
      other.run(*build);
      expect_same(other.points, plain.points, *build);
      expect_same(other.last, plain.last, *build);
      for (std::size_t cell = 0; cell < plain.in_cell.size(); ++cell) {
        EXPECT_EQ(other.at_most[cell].longest_squared, plain.at_most[cell].longest_squared) << build->instruction_set;
        EXPECT_EQ(other.at_most[cell].depth, plain.at_most[cell].depth) << build->instruction_set;
      }
    }
  }
}

TEST(KernelsInvariance, FindWithinIsTheSameInEveryBuild) {
  const double reach = 1.5 * diameter;
  const auto squared = static_cast<float>(reach * reach);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto points = points_in_box(200, 4.0, seed);
    const Point centre = point_at({2, 2, 2});
    std::vector<std::uint32_t> plain(points.size());
    plain.resize(base.find_within(points.data(), points.size(), centre, squared, 1000, plain.data()));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < points.size(); ++i)
      if (points[i].state != Point::empty && squared_distance(points[i], centre) <= reach * reach)
        expected.push_back(1000 + i);
    EXPECT_GT(expected.size(), 10u);
    EXPECT_EQ(plain, expected) << "held grains are found, empty places are not";
    for (const Kernels* build : spot::kernels::runnable()) {
      std::vector<std::uint32_t> found(points.size());
      found.resize(build->find_within(points.data(), points.size(), centre, squared, 1000, found.data()));
      EXPECT_EQ(found, plain) << build->instruction_set;
    }
  }
}

TEST(KernelsInvariance, FarthestIsTheSameInEveryBuild) {
  const auto references = points_in_box(64, 4.0, 1);
  scenes::Draws draws(1);
  for (int k = 0; k < 200; ++k) {
    auto points = references;
    double farthest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].state != Point::free || draws.uniform(0.0, 1.0) < 0.5) continue;
      points[i].x = wrapped(std::int64_t{points[i].x} + static_cast<std::int64_t>(draws.uniform(-1e7, 1e7)));
      points[i].z = wrapped(std::int64_t{points[i].z} + static_cast<std::int64_t>(draws.uniform(-1e7, 1e7)));
      farthest = std::max(farthest, squared_distance(points[i], references[i]));
    }
    const float plain = base.farthest(points.data(), references.data(), points.size());
    EXPECT_NEAR(plain, farthest, 1e-6 * farthest);
    for (const Kernels* build : spot::kernels::runnable()) {
      EXPECT_EQ(build->farthest(points.data(), references.data(), points.size()), plain);
      EXPECT_EQ(build->farthest(references.data(), references.data(), references.size()), 0.0f);
    }
  }
}

TEST(KernelsInvariance, FindReachedIsTheSameInEveryBuild) {
  scenes::Draws draws(2);
  for (std::size_t n = 0; n <= 70; ++n) {
    std::vector<std::int32_t> values(n);
    for (auto& value : values) value = static_cast<std::int32_t>(draws.below(7)) - 3;
    if (n > 2) values[n / 2] = std::numeric_limits<std::int32_t>::max();
    if (n > 3) values[n / 3] = std::numeric_limits<std::int32_t>::min();
    for (const std::int32_t least : {-4, -3, 0, 1, 3, 4, 1 << 30}) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < n; ++i)
        if (values[i] >= least) expected.push_back(i);
      for (const Kernels* build : spot::kernels::runnable()) {
        std::vector<std::uint32_t> found(n);
        found.resize(build->find_reached(values.data(), n, least, found.data()));
        EXPECT_EQ(found, expected) << build->instruction_set << ", " << n << " values";
      }
    }
  }
}

}  // namespace
