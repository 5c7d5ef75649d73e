// SPDX-License-Identifier: GPL-2.0-or-later
// How large grains are, on any ranks, and which are refused.
#include "grain_sizes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ranks_of_threads.hpp"
#include "spot/base/errors.hpp"

namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Of grains that are dealt out to so many ranks, as rank 0 finds them.
GrainSizes measured(const std::vector<double> &radii, const std::vector<bool> &moves, int ranks) {
  GrainSizes found;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    std::vector<double> own;
    std::vector<bool> own_moves;
    for (std::size_t k = static_cast<std::size_t>(communicator->rank()); k < radii.size();
         k += static_cast<std::size_t>(ranks)) {
      own.push_back(radii[k]);
      own_moves.push_back(moves[k]);
    }
    const GrainSizes sizes = measure_sizes(own, own_moves, *communicator);
    if (communicator->rank() == 0) found = sizes;
  });
  return found;
}

TEST(GrainSizes, OfEqualGrainsAreExact) {
  const GrainSizes sizes = measured(std::vector<double>(7, 0.0015), std::vector<bool>(7, true), 3);
  EXPECT_EQ(sizes.largest, 0.003);
  EXPECT_TRUE(sizes.equal());
  EXPECT_EQ(sizes.mean(), 0.003);
  EXPECT_EQ(sizes.radius(0.0015 * (1 - 1e-7)), 0.0015);
}

/// Eight small ones to a large one that is twice as wide: the mean volume is 2/9 of the large one's.
TEST(GrainSizes, OfAMixtureAnalytic) {
  std::vector<double> radii(9, 0.5);
  radii[4] = 1.0;
  for (const int ranks : {1, 2, 3, 12}) {
    const GrainSizes sizes = measured(radii, std::vector<bool>(9, true), ranks);
    EXPECT_EQ(sizes.largest, 2.0);
    EXPECT_NEAR(sizes.mean_volume, 2.0 / 9.0, 1e-9);
    EXPECT_NEAR(sizes.mean(), 2.0 * std::cbrt(2.0 / 9.0), 1e-9);
  }
}

TEST(GrainSizes, SumsDoNotDependOnRanks) {
  std::vector<double> radii;
  for (int k = 0; k < 1000; ++k) radii.push_back(0.5 + 0.4 * std::abs(std::sin(k)));
  const GrainSizes one = measured(radii, std::vector<bool>(1000, true), 1);
  for (const int ranks : {2, 7})
    EXPECT_EQ(measured(radii, std::vector<bool>(1000, true), ranks).mean_volume, one.mean_volume);
}

TEST(GrainSizes, HeldGrainsDoNotCountForTheMean) {
  EXPECT_EQ(measured({1.0, 1.0, 0.5}, {true, true, false}, 2).mean_volume, 1.0);
  EXPECT_NEAR(measured({1.0, 0.5, 0.5}, {false, true, true}, 2).mean_volume, 0.125, 1e-9);
  EXPECT_NEAR(measured({1.0, 0.5}, {false, false}, 2).mean_volume, 0.5625, 1e-9) << "all, if none moves";
}

TEST(GrainSizes, WithoutAnyAreUnknown) {
  EXPECT_FALSE(measured({}, {}, 2).known());
  EXPECT_FALSE(measured({0.0, 0.0}, {true, true}, 1).known());
}

TEST(GrainSizes, RefuseWhatIsMoreThanTwiceAsWide) {
  const GrainSizes sizes = measured({1.0, 0.5}, {true, true}, 1);
  for (const double radius : {0.5, 0.5 * (1 - 1e-7), 0.7, 1.0, 1 + 1e-7})
    EXPECT_NO_THROW(sizes.require(3, radius)) << radius;
  EXPECT_EQ(sizes.radius(0.5 * (1 - 1e-7)), 0.5);
  for (const double radius : {0.49, 1.01, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) try {
      sizes.require(3, radius);
      ADD_FAILURE() << radius;
    } catch (const spot::InvalidPacking &e) {
      EXPECT_THAT(e.what(), AllOf(HasSubstr("from 1 to 2"), HasSubstr("grain 3 has")));
    }
}

}  // namespace
