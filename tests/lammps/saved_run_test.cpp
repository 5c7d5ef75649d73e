// SPDX-License-Identifier: GPL-2.0-or-later
// What goes into a restart file comes back, or its damage is named. Bytes are read from memory that ends where they do,
// so that a sanitizer sees whoever reads on.
#include "saved_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <random>

#include "ranks_of_threads.hpp"
#include "scenes.hpp"
#include "spot/base/errors.hpp"

namespace {

using spot::Bytes;
using spot::InvalidState;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t header = 40;

struct Closing {
  void operator()(std::FILE *file) const { std::fclose(file); }
};

SavedRun some_run() {
  SavedRun run;
  run.settings = {{"seed", "1"}, {"influence", "0.0025"}};
  run.sizes = {0.003, 0.5};
  run.windows = std::int64_t{1} << 40;
  run.drained_mass = 1.25;
  run.drained_at = {3, 4};
  run.window = 0.05;
  run.windows_after_step = {0, 2, 4};
  run.drained_after_step = {0, 3, 7};
  return run;
}

Bytes part_of(int rank) {
  Bytes part;
  spot::append(part, std::vector<double>(static_cast<std::size_t>(200 * rank), 0.1 * rank));
  spot::seal(part);
  return part;
}

/// What so many ranks write, without the length before it, which must be right.
Bytes written(const SavedRun &run, int ranks) {
  const std::unique_ptr<std::FILE, Closing> file(std::tmpfile());
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    write_run(run, part_of(communicator->rank()), communicator->rank() == 0 ? file.get() : nullptr, *communicator);
  });
  std::rewind(file.get());
  std::int32_t length = 0;
  EXPECT_EQ(std::fread(&length, sizeof length, 1, file.get()), 1u);
  Bytes bytes(static_cast<std::size_t>(length));
  EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file.get()), bytes.size());
  EXPECT_EQ(std::fgetc(file.get()), EOF);
  return bytes;
}

/// As LAMMPS hands them to a fix: in memory of their own, of just this size.
SavedRun read(const Bytes &bytes) {
  const std::unique_ptr<char[]> exact(new char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  return read_run(exact.get());
}

std::string error_of(const Bytes &bytes) {
  return scenes::text_of<InvalidState>([&] { read(bytes); });
}

Bytes with_flipped_bit(Bytes bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
  return bytes;
}

TEST(SavedRun, ComesBackFromAnyNumberOfRanks) {
  for (const int ranks : {1, 2, 5}) {
    const SavedRun run = some_run(), back = read(written(run, ranks));
    EXPECT_EQ(back.settings, run.settings);
    EXPECT_EQ(back.sizes.largest, run.sizes.largest);
    EXPECT_EQ(back.sizes.mean_volume, run.sizes.mean_volume);
    EXPECT_EQ(back.windows, run.windows);
    EXPECT_EQ(back.drained_mass, run.drained_mass);
    EXPECT_EQ(back.drained_at, run.drained_at);
    EXPECT_EQ(back.window, run.window);
    EXPECT_EQ(back.windows_after_step, run.windows_after_step);
    EXPECT_EQ(back.drained_after_step, run.drained_after_step);
    ASSERT_EQ(back.parts.size(), static_cast<std::size_t>(ranks));
    for (int rank = 0; rank < ranks; ++rank) EXPECT_EQ(back.parts[static_cast<std::size_t>(rank)], part_of(rank));
  }
}

TEST(SavedRun, EveryBitOfTheHeaderCounts) {
  const Bytes bytes = written(some_run(), 2);
  for (std::size_t bit = 0; bit < 8 * header; ++bit)
    EXPECT_THAT(error_of(with_flipped_bit(bytes, bit)), HasSubstr("damaged")) << bit;
}

TEST(SavedRun, SoDoBitsElsewhere) {
  const Bytes bytes = written(some_run(), 3);
  std::mt19937_64 draw(1);
  for (int k = 0; k < 1000; ++k) {
    const std::size_t bit = 8 * header + draw() % (8 * (bytes.size() - header));
    EXPECT_THAT(error_of(with_flipped_bit(bytes, bit)), HasSubstr("damaged")) << bit;
  }
}

/// What is left when a disk was full or a program killed: nothing or zeros from somewhere on, or another's bytes.
TEST(SavedRun, WhatIsOnlyThereInPartIsRefused) {
  const Bytes bytes = written(some_run(), 2);
  std::mt19937_64 draw(2);
  for (std::size_t kept = 0; kept < bytes.size(); kept += kept < 200 ? 1 : 97) {
    Bytes damaged = bytes;
    std::fill(damaged.begin() + static_cast<std::ptrdiff_t>(kept), damaged.end(), '\0');
    if (damaged != bytes) {
      EXPECT_THAT(error_of(damaged), HasSubstr("damaged")) << kept;
    }
    for (std::size_t k = kept; k < bytes.size(); ++k) damaged[k] = static_cast<char>(draw());
    EXPECT_THAT(error_of(damaged), HasSubstr("damaged")) << kept;
  }
  // Of less than a header that was written, no more is looked at than it takes to see that.
  EXPECT_THAT(error_of(Bytes(header, '\0')), HasSubstr("damaged"));
}

/// Sizes that a sound checksum covers, but that do not fit together.
TEST(SavedRun, PartsOfTheWrongSizeAreRefused) {
  Bytes bytes = written(some_run(), 2);
  const std::uint64_t shorter = part_of(0).size() + part_of(1).size() - 1;
  std::memcpy(bytes.data() + 24, &shorter, sizeof shorter);
  const std::uint64_t checksum = spot::checksum(bytes.data(), 32);
  std::memcpy(bytes.data() + 32, &checksum, sizeof checksum);
  bytes.pop_back();
  EXPECT_THAT(error_of(bytes), HasSubstr("parts are longer than all"));
}

/// The beginning of files of versions before and after, of which those up to 4 had no checksum of their header.
TEST(SavedRun, OtherVersionsAreRefusedWithAdvice) {
  for (const std::int32_t version : {1, 4, 5, 7, 10, saved_run_version - 1, saved_run_version + 1, 1000}) {
    Bytes bytes = {'s', 'p', 'o', 't', ' ', 'r', 'u', 'n'};
    spot::append(bytes, version);
    if (version >= 5)
      spot::append(bytes, std::int64_t{~version});
    else
      spot::append(bytes, std::uint64_t{12345});
    EXPECT_THAT(error_of(bytes), AllOf(HasSubstr("of format " + std::to_string(version) + " of fix spot"),
                                       HasSubstr("knows " + std::to_string(saved_run_version) + " only"),
                                       HasSubstr("give the fix another ID")));
  }
}

TEST(SavedRun, FilesThatCannotBeWrittenAreNamed) {
  const std::unique_ptr<std::FILE, Closing> file(std::fopen("/dev/full", "wb"));
  if (!file) GTEST_SKIP() << "needs /dev/full";
  std::setvbuf(file.get(), nullptr, _IONBF, 0);
  spot::Alone alone;
  EXPECT_THAT(scenes::text_of<InvalidState>([&] { write_run(some_run(), part_of(1), file.get(), alone); }),
              HasSubstr("disk full"));
}

}  // namespace
