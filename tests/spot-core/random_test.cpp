// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "scenes.hpp"

namespace {

using spot::RandomPurpose;
using Words = std::array<std::uint64_t, 4>;

/// Philox4x64-10 written from the paper (Salmon et al., SC11, section 4.3), for comparison.
Words philox(Words counter, std::uint64_t key0, std::uint64_t key1) {
  __extension__ using Wide = unsigned __int128;
  for (int round = 0; round < 10; ++round) {
    const Wide a = static_cast<Wide>(0xD2E7470EE14C6C93) * counter[0];
    const Wide b = static_cast<Wide>(0xCA5A826395121157) * counter[2];
    counter = {static_cast<std::uint64_t>(b >> 64) ^ counter[1] ^ key0, static_cast<std::uint64_t>(b),
               static_cast<std::uint64_t>(a >> 64) ^ counter[3] ^ key1, static_cast<std::uint64_t>(a)};
    key0 += 0x9E3779B97F4A7C15;
    key1 += 0xBB67AE8584CAA73B;
  }
  return counter;
}

/// Known answers that Random123 publishes for philox4x64-10: for all bits zero and all bits one.
const Words zeros_answer = {0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b};
const Words ones_answer = {0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0};

TEST(RandomUnit, ComparisonGivesTheKnownAnswers) {
  const std::uint64_t ones = ~std::uint64_t{0};
  EXPECT_EQ(philox({0, 0, 0, 0}, 0, 0), zeros_answer);
  EXPECT_EQ(philox({ones, ones, ones, ones}, ones, ones), ones_answer);
}

TEST(RandomUnit, GivesTheKnownAnswerOfPhilox) {
  const auto numbers = spot::uniform(0, static_cast<RandomPurpose>(0), 0, 0);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(numbers[i], std::ldexp(static_cast<double>(zeros_answer[i] >> 11), -53));
}

TEST(RandomUnit, EqualsPhiloxForAnyArguments) {
  std::mt19937_64 draw(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t seed = draw(), id = draw(), step = draw();
    for (const RandomPurpose purpose : {RandomPurpose::birth, RandomPurpose::step}) {
      const Words bits = philox({id, step, 0, 0}, seed, static_cast<std::uint64_t>(purpose));
      const auto numbers = spot::uniform(seed, purpose, id, step);
      for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(numbers[k], std::ldexp(static_cast<double>(bits[k] >> 11), -53));
    }
  }
}

TEST(RandomUnit, DependsOnEveryArgumentAndOnNothingElse) {
  const auto numbers = spot::uniform(7, RandomPurpose::step, 3, 5);
  spot::uniform(8, RandomPurpose::birth, 1, 1);
  EXPECT_EQ(spot::uniform(7, RandomPurpose::step, 3, 5), numbers);
  EXPECT_NE(spot::uniform(8, RandomPurpose::step, 3, 5), numbers);
  EXPECT_NE(spot::uniform(7, RandomPurpose::birth, 3, 5), numbers);
  EXPECT_NE(spot::uniform(7, RandomPurpose::step, 4, 5), numbers);
  EXPECT_NE(spot::uniform(7, RandomPurpose::step, 3, 6), numbers);
  EXPECT_NE(spot::uniform(7, RandomPurpose::step, 5, 3), numbers);
}

TEST(RandomUnit, NeverDrawsTheSameNumberTwiceAmongNeighbouringArguments) {
  std::set<double> seen;
  for (const RandomPurpose purpose : {RandomPurpose::birth, RandomPurpose::step})
    for (std::uint64_t id = 0; id < 50; ++id)
      for (std::uint64_t step = 0; step < 50; ++step)
        for (const double number : spot::uniform(1, purpose, id, step)) seen.insert(number);
  EXPECT_EQ(seen.size(), 2u * 50u * 50u * 4u);
}

TEST(RandomStatistical, NumbersAreUniformInEachOfTheFourPlaces) {
  for (std::size_t place = 0; place < 4; ++place) {
    std::vector<int> counts(100);
    for (std::uint64_t id = 0; id < 1000; ++id)
      for (std::uint64_t step = 0; step < 100; ++step) {
        const double number = spot::uniform(1, RandomPurpose::step, id, step)[place];
        ASSERT_GE(number, 0.0);
        ASSERT_LT(number, 1.0);
        ++counts[static_cast<std::size_t>(100.0 * number)];
      }
    EXPECT_LT(scenes::deviation_from_equal_counts(counts), scenes::bound) << "place " << place;
  }
}

/// Pairs that the spot walk puts together must not be correlated: neighbouring steps, spots, purposes and places.
TEST(RandomStatistical, NeighbouringArgumentsAreUncorrelated) {
  const int n = 50000;
  std::array<double, 4> sums{};
  for (std::uint64_t k = 0; k < n; ++k) {
    const auto here = spot::uniform(1, RandomPurpose::step, k / 250, k % 250);
    const double a = here[0] - 0.5;
    sums[0] += a * (spot::uniform(1, RandomPurpose::step, k / 250, k % 250 + 1)[0] - 0.5);
    sums[1] += a * (spot::uniform(1, RandomPurpose::step, k / 250 + 1, k % 250)[0] - 0.5);
    sums[2] += a * (spot::uniform(1, RandomPurpose::birth, k / 250, k % 250)[0] - 0.5);
    sums[3] += a * (here[1] - 0.5);
  }
  // The product of two independent uniform numbers about zero has the standard deviation 1/12.
  for (const double sum : sums) EXPECT_LT(std::abs(sum) * 12.0 / std::sqrt(n), scenes::bound);
}

TEST(RandomUnit, ExponentialInvertsItsDistribution) {
  EXPECT_EQ(spot::exponential(0.0, 3.0), 0.0);
  for (const double u : {0.1, 0.5, 0.9, 0.999}) EXPECT_NEAR(1.0 - std::exp(-3.0 * spot::exponential(u, 3.0)), u, 1e-14);
  EXPECT_TRUE(std::isfinite(spot::exponential(1.0 - 0x1p-53, 1.0))) << "the largest uniform number";
}

}  // namespace
