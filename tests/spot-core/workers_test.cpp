// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "scenes.hpp"

namespace {

using spot::InvalidParameter;
using spot::Workers;
using testing::AllOf;
using testing::HasSubstr;

TEST(WorkersUnit, EachJobRunsOnceOnItsOwnThread) {
  for (const int threads : {1, 2, 3, 4, 7}) {
    Workers workers(threads);
    EXPECT_EQ(workers.size(), threads);
    std::vector<int> runs(static_cast<std::size_t>(threads));
    std::vector<std::thread::id> on(runs.size());
    workers.run([&](int worker) {
      ++runs[static_cast<std::size_t>(worker)];
      on[static_cast<std::size_t>(worker)] = std::this_thread::get_id();
    });
    for (const int n : runs) EXPECT_EQ(n, 1);
    EXPECT_EQ(on[0], std::this_thread::get_id());
    EXPECT_EQ(std::set<std::thread::id>(on.begin(), on.end()).size(), runs.size());
  }
}

/// What one round writes, on any thread, the next round reads on all: rounds follow each other without a gap.
TEST(WorkersUnit, RoundsSeeWhatTheRoundBeforeDid) {
  for (const int threads : {1, 2, 3, 4}) {
    Workers workers(threads);
    const auto n = static_cast<std::size_t>(threads);
    std::vector<long> now(n, 1), next(n);
    for (int round = 0; round < 3000; ++round) {
      workers.run([&](int worker) {
        long sum = round;
        for (const long value : now) sum += value;
        next[static_cast<std::size_t>(worker)] = sum % 1000003 + worker;
      });
      now.swap(next);
    }
    std::vector<long> expected(n, 1);
    for (int round = 0; round < 3000; ++round) {
      long sum = round;
      for (const long value : expected) sum += value;
      for (std::size_t k = 0; k < n; ++k) expected[k] = sum % 1000003 + static_cast<long>(k);
    }
    EXPECT_EQ(now, expected) << threads << " threads";
  }
}

/// Long enough apart that the threads have gone to sleep.
TEST(WorkersUnit, SleepersWakeUp) {
  Workers workers(3);
  for (int round = 1; round <= 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::atomic<int> runs{0};
    workers.run([&](int) { ++runs; });
    EXPECT_EQ(runs, 3);
  }
}

TEST(WorkersUnit, CanBeMadeAndDroppedWithoutWork) {
  for (int k = 0; k < 200; ++k) Workers(1 + k % 4);
}

TEST(WorkersUnit, NumbersOutOfRangeAreNamed) {
  for (const int bad : {0, -1, Workers::most + 1, 1 << 30})
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { Workers workers(bad); }),
                AllOf(HasSubstr("number of threads is " + std::to_string(bad) + " "),
                      HasSubstr("from 1 to " + std::to_string(Workers::most))));
}

}  // namespace
