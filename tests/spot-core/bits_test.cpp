// SPDX-License-Identifier: GPL-2.0-or-later
// The bits of whole drainages, as they have been on every system, pinned by checksums in bits.txt: with any number of
// threads and ranks, with any instruction set (SPOT_INSTRUCTION_SET), and over saved states.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <map>
#include <mutex>
#include <sstream>
#include <tuple>

#include "bits_scenes.hpp"
#include "packing/kernel_builds.hpp"
#include "ranks_of_threads.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"

namespace {

using scenes::Change;
using scenes::NamedScene;
using scenes::PinnedScene;
using spot::Bytes;
using spot::Counters;
using spot::Grain;
using spot::Spot;

constexpr const char* columns = "grains           drained          spots            counters";

/// All that there is to know in the end, in order of ids.
struct Outcome {
  std::map<std::int64_t, Grain> grains, drained;
  std::map<std::int64_t, Spot> spots;
  std::map<std::int64_t, std::int64_t> received;  // moves
  Counters counters;
  std::vector<Bytes> saved;  // of each rank
};

Bytes bytes_of(const std::map<std::int64_t, Grain>& grains) {
  Bytes bytes;
  for (const auto& [id, grain] : grains) {
    spot::append(bytes, id);
    spot::append(bytes, grain.position);
    spot::append(bytes, grain.held);
  }
  return bytes;
}

Bytes bytes_of(const std::map<std::int64_t, Spot>& spots) {
  Bytes bytes;
  for (const auto& [id, spot] : spots) {
    spot::append(bytes, id);
    spot::append(bytes, spot.steps);
    spot::append(bytes, spot.position);
    for (const double number : {spot.next_step, spot.direction, spot.chance, spot.relative_speed})
      spot::append(bytes, number);
    if (spot.volume != 1.0)
      spot::append(bytes, spot.volume);  // scenes from before there were others keep their checksums
  }
  return bytes;
}

Bytes bytes_of(const Counters& counters, const std::map<std::int64_t, std::int64_t>& received) {
  Bytes bytes;
  for (const std::int64_t count :
       {counters.moves, counters.volume_moved, counters.sweeps, counters.grains_swept, counters.drained})
    spot::append(bytes, count);
  if (counters.volume_left != 0) spot::append(bytes, counters.volume_left);  // as with volumes of spots
  for (const auto& [id, moves] : received) {
    spot::append(bytes, id);
    spot::append(bytes, moves);
  }
  return bytes;
}

/// In the order of the columns of bits.txt, in hexadecimal digits.
std::string checksums(const Outcome& outcome) {
  std::ostringstream text;
  const char* separator = "";
  for (const Bytes& bytes : {bytes_of(outcome.grains), bytes_of(outcome.drained), bytes_of(outcome.spots),
                             bytes_of(outcome.counters, outcome.received)}) {
    text << separator << std::hex << std::setfill('0') << std::setw(16) << spot::checksum(bytes.data(), bytes.size());
    separator = " ";
  }
  return text.str();
}

std::shared_ptr<const spot::Container> container_at(const PinnedScene& scene, double time) {
  auto container = scene.container;
  for (const Change& change : scene.changes)
    if (change.time <= time && change.container) container = change.container;
  return container;
}

/// Those that this rank brings, of what is the same on all.
template <typename T>
std::vector<T> part_of(const std::vector<T>& all, const spot::Communicator& ranks) {
  std::vector<T> part;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (static_cast<int>(k) % ranks.size() == ranks.rank()) part.push_back(all[k]);
  return part;
}

/// From grains, or from what is saved.
std::unique_ptr<spot::Drainage> start(const PinnedScene& scene, double time, const std::vector<Bytes>& saved,
                                      int threads, const std::shared_ptr<spot::Communicator>& ranks) {
  const auto& [spots, relaxation, limits] = std::tie(scene.spots, scene.relaxation, scene.limits);
  const auto container = container_at(scene, time);
  if (scene.time_ordered) {
    if (saved.empty())
      return std::make_unique<spot::TimeOrderedDrainage>(spots, relaxation, limits, container,
                                                         spot::Packing(scene.diameter, scene.extent, scene.grains));
    return std::make_unique<spot::TimeOrderedDrainage>(spots, relaxation, limits, container, scene.diameter,
                                                       scene.extent, saved[0]);
  }
  const auto windowed = [&](const auto& from) {
    return std::make_unique<spot::WindowedDrainage>(spots, relaxation, limits, scene.window, threads, container,
                                                    scene.diameter, scene.extent, from, ranks);
  };
  return saved.empty() ? windowed(part_of(scene.grains, *ranks)) : windowed(saved);
}

void advance(spot::Drainage& drainage, const PinnedScene& scene, double from, double until,
             const spot::Communicator& ranks) {
  for (const Change& change : scene.changes) {
    if (change.time <= from || change.time > until) continue;
    drainage.advance_to(change.time);
    if (change.container) drainage.replace_container(change.container);
    drainage.change_grains({part_of(change.grains.gone, ranks), part_of(change.grains.come, ranks)});
  }
  drainage.advance_to(until);
}

/// Goes on from `outcome`, of time `from`, or starts.
void go_on(Outcome& outcome, const PinnedScene& scene, double from, double until, int ranks, int threads) {
  const std::vector<Bytes> before = std::move(outcome.saved);
  outcome.grains.clear();
  outcome.spots.clear();
  outcome.saved.assign(static_cast<std::size_t>(ranks), {});
  std::mutex mutex;
  scenes::on_ranks(ranks, [&](std::shared_ptr<spot::Communicator> communicator) {
    const auto drainage = start(scene, from, before, threads, communicator);
    if (scene.counts_moves) drainage->count_moves_received();
    advance(*drainage, scene, from, until, *communicator);
    const Counters counters = drainage->total();
    const std::lock_guard<std::mutex> lock(mutex);
    drainage->visit_grains([&](const Grain& grain) {
      EXPECT_TRUE(outcome.grains.emplace(grain.id, grain).second) << "grain on two ranks: " << grain.id;
    });
    for (const Spot& spot : drainage->spots())
      EXPECT_TRUE(outcome.spots.emplace(spot.id, spot).second) << "spot on two ranks: " << spot.id;
    for (const Grain& grain : drainage->take_drained()) outcome.drained.emplace(grain.id, grain);
    if (scene.counts_moves)
      for (const auto& [id, moves] : drainage->take_moves_received()) outcome.received[id] += moves;
    outcome.counters = counters;
    outcome.saved[static_cast<std::size_t>(communicator->rank())] = drainage->save();
  });
}

Outcome drain(const PinnedScene& scene, int ranks, int threads) {
  Outcome outcome;
  go_on(outcome, scene, 0.0, scene.end, ranks, threads);
  return outcome;
}

/// In three thirds, each from what so many ranks have saved of the one before.
Outcome chain(const PinnedScene& scene, const std::array<int, 3>& ranks, int threads) {
  Outcome outcome;
  for (int k = 0; k < 3; ++k)
    go_on(outcome, scene, k * scene.end / 3, (k + 1) * scene.end / 3, ranks[static_cast<std::size_t>(k)], threads);
  return outcome;
}

const std::vector<NamedScene>& all_scenes() {
  static const scenes::PinnedScenes pinned;
  return pinned.all();
}

/// bits.txt: checksums by scene.
std::map<std::string, std::string> recorded() {
  std::map<std::string, std::string> table;
  std::ifstream file(SPOT_BITS);
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find(' ');
    if (line.empty() || line[0] == '#') continue;
    table[line.substr(0, end)] = line.substr(line.find_first_not_of(' ', end));
  }
  return table;
}

void record(const std::map<std::string, std::string>& table) {
  std::ofstream file(SPOT_BITS);
  file << "# Checksums of the scenes of bits_scenes.hpp, made by bits_test.cpp (tests/README.md says how). All of "
          "these\n"
          "# give the same: 1 and 3 ranks, 1 and 3 threads, every instruction set, and three runs, of which each goes "
          "on\n"
          "# from what that before has saved on another number of ranks (1, 3, 1 and 3, 1, 3; time-ordered: 1, 1, 1).\n"
       << std::left << std::setw(46) << "# scene" << columns << '\n';
  for (const NamedScene& scene : all_scenes())
    if (const auto line = table.find(scene.name); line != table.end())
      file << std::left << std::setw(46) << scene.name << line->second << '\n';
}

class BitsInvariance : public testing::TestWithParam<NamedScene> {};

TEST_P(BitsInvariance, AreAsRecorded) {
  const char* wanted = std::getenv("SPOT_INSTRUCTION_SET");
  const auto runnable = spot::kernels::runnable();
  if (wanted && std::none_of(runnable.begin(), runnable.end(),
                             [&](const auto* build) { return std::string(build->instruction_set) == wanted; }))
    GTEST_SKIP() << "this processor cannot run " << wanted;
  const auto& [name, make] = GetParam();
  const PinnedScene scene = make();
  const Outcome outcome = drain(scene, 1, 1);
  EXPECT_GT(outcome.counters.moves, 100) << "or it shows little";
  EXPECT_FALSE(outcome.grains.empty());
  EXPECT_FALSE(outcome.spots.empty());
  EXPECT_EQ(outcome.counters.volume_left != 0, scene.spots.critical_fraction > 0.0);
  const std::string found = checksums(outcome);
  auto table = recorded();
  if (std::getenv("SPOT_RECORD_BITS")) {
    table[name] = found;
    record(table);
  }
  EXPECT_EQ(found, table[name]) << columns;
  if (scene.time_ordered) {
    EXPECT_EQ(checksums(chain(scene, {1, 1, 1}, 1)), found) << "over saved states; " << columns;
    return;
  }
  EXPECT_EQ(checksums(chain(scene, {1, 3, 1}, 1)), found) << "over states of 1 and 3 ranks; " << columns;
  if (wanted) return;  // by itself, all is tried
  EXPECT_EQ(checksums(drain(scene, 1, 3)), found) << "3 threads; " << columns;
  EXPECT_EQ(checksums(drain(scene, 3, 1)), found) << "3 ranks; " << columns;
  EXPECT_EQ(checksums(chain(scene, {3, 1, 3}, 3)), found) << "over states of 3 and 1 ranks, 3 threads; " << columns;
}

INSTANTIATE_TEST_SUITE_P(Scenes, BitsInvariance, testing::ValuesIn(all_scenes()), [](const auto& test) {
  std::string name = test.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

/// Every line of bits.txt is that of a scene, and no two scenes are the same in the end.
TEST(BitsInvariance, OfAllScenesAndNoOthersAreRecorded) {
  if (std::getenv("SPOT_RECORD_BITS")) GTEST_SKIP() << "they are made anew";
  std::map<std::string, std::string> scene_with;
  const auto table = recorded();
  EXPECT_EQ(table.size(), all_scenes().size());
  for (const NamedScene& scene : all_scenes()) {
    ASSERT_TRUE(table.count(scene.name)) << scene.name;
    const auto [other, is_new] = scene_with.emplace(table.at(scene.name), scene.name);
    EXPECT_TRUE(is_new) << scene.name << " is the same as " << other->second;
  }
}

}  // namespace
