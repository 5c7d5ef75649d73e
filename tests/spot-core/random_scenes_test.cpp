// SPDX-License-Identifier: GPL-2.0-or-later
// Properties that hold of every scene, whatever its silo, packing, spots and driver. A scene that fails is named by its
// seed; SPOT_SCENE=seed runs that one alone.
#include <gtest/gtest.h>

#include <cstdlib>
#include <exception>
#include <string>

#include "invariants.hpp"
#include "random_scene.hpp"
#include "sanitized.hpp"

namespace {

/// Largest overlap, in diameters, in a scene that relaxes.
const double overlap_bound = spot::DrainageLimits{}.largest_overlap_in_flow;

/// The number in an environment variable, if it is set.
std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Every invariant, after every window.
void follow(const scenes::RandomScene& scene, spot::Drainage& drainage) {
  invariants::Ledger ledger(scene.grains(), scene.diameter(), scene.limits(), scene.silo());
  if (!scene.relaxes()) ledger.leave_base_open();
  for (int k = 1; k <= scene.windows(); ++k) {
    drainage.advance_to(k * scene.window());
    ASSERT_EQ(ledger.check(drainage), "") << "window " << k;
    if (scene.relaxes()) {
      ASSERT_LT(ledger.overlaps().largest, overlap_bound) << "window " << k;
    }
  }
}

/// Once more, in one go and with other threads.
void rerun(const scenes::RandomScene& scene, std::uint64_t seed, const spot::Drainage& first) {
  const auto again = scene.start(2 + static_cast<int>(seed % 2));
  again->advance_to(scene.windows() * scene.window());
  ASSERT_NO_FATAL_FAILURE(scenes::expect_identical(again->grains(), first.grains()));
  EXPECT_EQ(again->counters().moves, first.counters().moves);
  EXPECT_EQ(again->counters().grains_swept, first.counters().grains_swept);
}

/// Did it run to its end? A packing that collapses is found out; anything else is a failure.
bool check_scene(std::uint64_t seed) {
  const scenes::RandomScene scene(seed);
  SCOPED_TRACE(scene.description());
  const auto drainage = scene.start(1);
  try {
    follow(scene, *drainage);
    if (!testing::Test::HasFatalFailure()) rerun(scene, seed, *drainage);
  } catch (const spot::CollapsedPacking&) {
    return false;
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  return true;
}

void check_scenes(std::uint64_t scenes) {
  const std::uint64_t alone = number_from("SPOT_SCENE", 0);
  std::uint64_t collapsed = 0;
  for (std::uint64_t seed = alone == 0 ? 1 : alone; seed <= (alone == 0 ? scenes : alone); ++seed)
    if (!check_scene(seed)) ++collapsed;
  EXPECT_LE(collapsed, 1 + scenes / 500) << "scenes collapsed";
}

TEST(RandomScenesInvariance, HoldWhatEveryDrainageHolds) { check_scenes(scenes::sanitized() ? 30 : 300); }

/// SPOT_SCENES: how many.
TEST(RandomScenesSlow, HoldWhatEveryDrainageHolds) { check_scenes(number_from("SPOT_SCENES", 10000)); }

}  // namespace
