// SPDX-License-Identifier: GPL-2.0-or-later
// What `scene FILE g` tells the analysis of walls and outlets, and of which it says nothing.
#include "scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <optional>
#include <sstream>

#include "spot/base/errors.hpp"

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Of a silo of grains 1 wide, at a timestep of 0.5; where it repeats along x and y.
std::string scene_of(const std::string& walls, double opening_time = 0.0,
                     const std::optional<spot::Interval>& x = std::nullopt,
                     const std::optional<spot::Interval>& y = std::nullopt) {
  std::istringstream in("speed 3.2 volume 77 " + walls);
  SpotCommand command = parse_spot_command({std::istream_iterator<std::string>(in), {}});
  command.periodic = spot::Periodic(x, y);
  command.outlets.repeat(command.periodic);
  command.resolve(1.0);
  return describe({command, 1.0, 9.75, 0.5, opening_time, 1000});
}

const std::string units =
    R"({"format": 1, "program": "LAMMPS fix spot", "diameter": 1, "gravity": 9.75, "timestep": 0.5, "grains": 1000, )";

TEST(SceneFile, TellsABoxWithAnOrificeInItsMiddle) {
  EXPECT_EQ(scene_of("box -20 20 -4 4 orifice 0 0 0 3.5 outflow 50"),
            units + R"("half_width_x": 20, "half_depth_y": 4, "orifice_radius": 3.5, "axis_x": 0, "axis_y": 0, )"
                    R"("base_z": 0})"
                    "\n");
  EXPECT_THAT(scene_of("box 10 50 1 9 orifice 30 5 2 3.5 outflow 50"),
              HasSubstr(R"("orifice_radius": 3.5, "axis_x": 30, "axis_y": 5, "base_z": 2})"));
}

TEST(SceneFile, TellsOutletsThatShareTheBase) {
  const std::string two = R"("half_width_x": 20, "half_depth_y": 4, "orifice_radius": 3, "axis_x": 0, "axis_y": 0, )"
                          R"("orifices": 2, "base_z": 0})";
  EXPECT_THAT(scene_of("box -20 20 -4 4 orifice -10 0 0 3 orifice 10 0 0 3 outflow 50 40"), HasSubstr(two));
  EXPECT_THAT(scene_of("box -20 20 -4 4 orifice 10 0 0 3 orifice -10 0 0 3 outflow 50 40"), HasSubstr(two));
}

TEST(SceneFile, TellsSlotsFromSideToSide) {
  EXPECT_THAT(scene_of("box -20 20 -4 4 slot 0 0 0 6 8 outflow 50"),
              HasSubstr(R"("half_depth_y": 4, "orifice_radius": 3, "axis_x": 0, "axis_y": 0, "slot": true, )"));
  EXPECT_THAT(scene_of("box -20 20 NULL NULL slot 0 1 0 6 16 outflow 50", 0.0, std::nullopt, spot::Interval{-7.0, 9.0}),
              HasSubstr(R"("half_period_y": 8, "orifice_radius": 3, "axis_x": 0, "axis_y": 1, "slot": true, )"));
}

TEST(SceneFile, TellsWhereARoundOutletIsInAPeriod) {
  EXPECT_THAT(
      scene_of("box -20 20 NULL NULL orifice 0 3 0 3.5 outflow 50", 0.0, std::nullopt, spot::Interval{-8.0, 8.0}),
      HasSubstr(R"("half_period_y": 8, "orifice_radius": 3.5, "axis_x": 0, "axis_y": 3, "base_z": 0})"));
}

TEST(SceneFile, TellsUnitsAndOutletOfAnyOtherBox) {
  const std::string off = R"("axis_x": 5, "axis_y": 0, "base_z": 0})";
  for (const char* outlets : {
           "orifice 5 0 0 3 outflow 50",                       // beside the middle
           "slot 5 0 0 6 8 outflow 50",                        // the same
           "orifice 5 0 0 3 orifice -10 0 0 3 outflow 50 50",  // one of them is
           "orifice 5 0 0 3 orifice 15 0 0 2 outflow 50 50",   // of unlike widths
           "slot 5 0 0 3 8 orifice -10 0 0 3 outflow 50 50",   // of unlike shapes
       })
    EXPECT_EQ(scene_of(std::string("box -20 20 -4 4 ") + outlets), units + off + "\n") << outlets;
}

TEST(SceneFile, TellsAHopper) {
  const std::string cone = "walls add cone z 0 0 4 12 0 14 ", cylinder = "walls add cylinder z 0 0 12 14 60 ";
  const std::string outlet = "orifice 0 0 0 4 outflow 50";
  EXPECT_EQ(scene_of(cone + cylinder + outlet),
            units + R"("orifice_radius": 4, "cylinder_radius": 12, "cone_height": 14, "base_z": 0})" + "\n");
  const auto is_none = AllOf(Not(HasSubstr("cone_height")), Not(HasSubstr("orifice_radius")), HasSubstr("axis_x"));
  EXPECT_THAT(scene_of(cone + cylinder + "orifice 0 0 0 3 outflow 50"), is_none);
  EXPECT_THAT(scene_of(cone + "walls add cylinder z 0 0 11 14 60 " + outlet), is_none);
  EXPECT_THAT(scene_of(cone + cylinder + "walls cut sphere 0 0 30 5 " + outlet), is_none);
  EXPECT_THAT(scene_of("walls add cone z 1 0 4 12 0 14 walls add cylinder z 1 0 12 14 60 orifice 1 0 0 4 outflow 50"),
              is_none);
}

TEST(SceneFile, TellsWhenTheClockOfSpotsBegan) {
  const std::string silo = "cylinder 0 0 10 orifice 0 0 0 4 outflow 50";
  EXPECT_THAT(scene_of(silo, 12.5), HasSubstr(R"("opening_time": 12.5, )"));
  EXPECT_THAT(scene_of(silo, 1e-12), Not(HasSubstr("opening_time")));
}

TEST(SceneFile, NeedsGravity) {
  const auto error_of = [](const std::string& words) {
    try {
      scene_of("box -20 20 -4 4 orifice 0 0 0 3.5 outflow 50 " + words);
    } catch (const spot::InvalidParameter& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of("scene"), HasSubstr("keyword 'scene' ends before its value the name of a file"));
  EXPECT_THAT(error_of("scene a.json"), HasSubstr("keyword 'scene' ends before its value the acceleration of gravity"));
  EXPECT_THAT(error_of("scene a.json -9.81"),
              HasSubstr("'scene' is -9.81 but the acceleration of gravity must be pos"));
}

}  // namespace
