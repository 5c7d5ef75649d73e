// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/parallel/workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <set>

#include "sanitized.hpp"
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

/// More rounds than 32 bits count.
TEST(WorkersUnit, RoundsGoOnBeyondAnyCounter) {
  for (const std::uint64_t limit : {std::uint64_t{1} << 31, std::uint64_t{1} << 32, std::uint64_t{0}}) {
    Workers workers(3, limit - 5);
    for (int round = 1; round <= 10; ++round) {
      std::atomic<int> runs{0};
      workers.run([&](int) { ++runs; });
      ASSERT_EQ(runs, 3) << limit << ' ' << round;
    }
  }
}

/// Whichever thread is first by the clock: the lowest worker's, and the next round is as any other.
TEST(WorkersUnit, ExceptionsReachTheCaller) {
  for (const int threads : {1, 2, 4, 7}) {
    Workers workers(threads);
    for (int round = 0; round < 200; ++round) {
      const int first = round % threads;
      const auto job = [&](int worker) {
        if (worker == first && round % 5 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
        if (worker >= first) throw InvalidParameter("worker " + std::to_string(worker));
      };
      EXPECT_EQ(scenes::text_of<InvalidParameter>([&] { workers.run(job); }), "worker " + std::to_string(first));
      std::atomic<int> runs{0};
      workers.run([&](int) { ++runs; });
      EXPECT_EQ(runs, threads);
    }
  }
}

TEST(WorkersUnit, AllHaveReturnedWhenOneThrows) {
  Workers workers(4);
  std::atomic<int> runs{0};
  const auto job = [&](int worker) {
    if (worker == 0) throw std::bad_alloc();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++runs;
  };
  EXPECT_THROW(workers.run(job), std::bad_alloc);
  EXPECT_EQ(runs, 3);
}

TEST(WorkersUnit, CanBeMadeAndDroppedWithoutWork) {
  for (int k = 0; k < 200; ++k) Workers(1 + k % 4);
}

/// Where the system gives no room for so many stacks.
TEST(WorkersUnit, ThreadsThatCannotStartAreNamed) {
  if (scenes::sanitized()) GTEST_SKIP() << "sanitizers need memory for every thread, too";
  const auto in_little_room = [] {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t room = pages * 4096 + (rlim_t{100} << 20);
    const rlimit limit = {room, room};
    if (pages == 0 || setrlimit(RLIMIT_AS, &limit) != 0) std::exit(1);
    const std::string text = scenes::text_of<InvalidParameter>([] { Workers workers(Workers::most); });
    std::fprintf(stderr, "%s\n", text.c_str());
    std::exit(text.empty() ? 1 : 0);
  };
  EXPECT_EXIT(in_little_room(), testing::ExitedWithCode(0), "number of threads is 256 but the system starts no more");
}

TEST(WorkersUnit, NumbersOutOfRangeAreNamed) {
  for (const int bad : {0, -1, Workers::most + 1, 1 << 30})
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { Workers workers(bad); }),
                AllOf(HasSubstr("number of threads is " + std::to_string(bad) + " "),
                      HasSubstr("from 1 to " + std::to_string(Workers::most))));
}

}  // namespace
