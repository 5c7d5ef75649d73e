// SPDX-License-Identifier: GPL-2.0-or-later
// Outlets, their rates and schedules, and walls made of shapes: what the words of `fix spot` make of them.
#include "outlet_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <sstream>

#include "spot/base/errors.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/silos.hpp"
#include "spot_command.h"

namespace {

using spot::InvalidParameter;
using testing::AllOf;
using testing::HasSubstr;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// A command with these walls and outlets, resolved for grains of a diameter.
SpotCommand command_of(const std::string& walls, const std::string& outlets, double diameter = 1.0) {
  SpotCommand command = parse_spot_command(words_of("speed 3.2 volume 77 " + walls + " " + outlets));
  command.resolve(diameter);
  return command;
}

const std::string box = "box -20 20 -4 4";

std::string error_of(const std::string& walls, const std::string& outlets) {
  try {
    command_of(walls, outlets);
  } catch (const spot::Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error: " << walls << ' ' << outlets;
  return {};
}

TEST(OutletCommand, OutletsKeepTheirOrder) {
  const SpotCommand c = command_of(box, "slot 5 0 0 6 8 injection 300 100 orifice -5 0 0 3");
  const spot::Outlets outlets = c.outlets.outlets();
  ASSERT_EQ(outlets.size(), 2u);
  EXPECT_EQ(outlets[0].name(), "slot of 6 by 8 at (5, 0, 0)");
  EXPECT_EQ(outlets[1].name(), "orifice of radius 3 at (-5, 0, 0)");
  EXPECT_EQ(c.spots.injection_rate.largest(0), 300.0);
  EXPECT_EQ(c.spots.injection_rate.largest(1), 100.0);
  EXPECT_FALSE(c.outlets.single_orifice().has_value());
  EXPECT_EQ(c.outlets.text_of_outlets(), "slot 5 0 0 6 8; -5 0 0 3");
}

TEST(OutletCommand, SchedulesOpenAndCloseAnOutlet) {
  const SpotCommand c =
      command_of(box, "orifice -5 0 0 3 orifice 5 0 0 3 injection 300 100 schedule 2 0 0 1.5 1 4 0.5 schedule 1 2 0");
  const spot::Injection& rates = c.spots.injection_rate;
  // 300 per time up to 1.5, 400 up to 2, 100 up to 4, then 50.
  EXPECT_EQ(rates.largest(), 400.0);
  EXPECT_DOUBLE_EQ(rates.next_birth(0.0, 300.0), 1.0);
  EXPECT_DOUBLE_EQ(rates.next_birth(0.0, 450.0 + 200.0), 2.0);
  EXPECT_DOUBLE_EQ(rates.next_birth(0.0, 450.0 + 200.0 + 200.0 + 50.0), 5.0);
  EXPECT_EQ(rates.outlet_of_birth(1.0, 0.99), 0u);
  EXPECT_EQ(rates.outlet_of_birth(3.0, 0.01), 1u);
}

TEST(OutletCommand, SchedulesMayNameVariables) {
  const SpotCommand c =
      command_of(box, "orifice -5 0 0 3 orifice 5 0 0 3 injection 300 100 schedule 2 v_gate schedule 1 2 0 threads 2");
  EXPECT_THAT(c.outlets.variables(), testing::ElementsAre(testing::Pair(1u, "gate")));
  EXPECT_EQ(c.spots.injection_rate.largest(1), 100.0) << "as for a factor of 1";
  EXPECT_EQ(c.outlets.text_of_rates(), "300 100; schedule 1 2 0; schedule 2 v_gate");
  EXPECT_TRUE(command_of(box, "orifice 0 0 0 4 injection 300 schedule 1 0 1").outlets.variables().empty());
}

TEST(OutletCommand, BirthsFollowTheOutflowThatIsGiven) {
  const SpotCommand c = command_of(box, "orifice -8 0 0 4 orifice 8 0 0 4 outflow 30 10 schedule 2 5 0");
  EXPECT_TRUE(c.spots.holds_outflow);
  EXPECT_EQ(c.spots.fade, 0.0);
  EXPECT_NEAR(c.spots.injection_rate.at(0, 0.0), 30.0 / (c.spots.influence * 77), 1e-9);
  EXPECT_NEAR(c.spots.injection_rate.at(1, 4.0), 10.0 / (c.spots.influence * 77), 1e-9);
  EXPECT_EQ(c.spots.injection_rate.at(1, 6.0), 0.0);
  EXPECT_EQ(c.outlets.text_of_rates(), "outflow 30 10; schedule 2 5 0");
  EXPECT_FALSE(command_of(box, "orifice 0 0 0 4 injection 300").spots.holds_outflow);
}

TEST(OutletCommand, RatesFollowFromBeverloosLaw) {
  // F = C (6 phi / pi) (D/d - k)^2.5 for round holes, with phi = 0.58; C (6 phi / pi) (L/d - k) (W/d - k)^1.5 for
  // slots.
  const double per_volume = 6.0 * 0.58 / 3.14159265358979;
  const SpotCommand c = command_of(box, "orifice -8 0 0 4 slot 8 0 0 6 8 beverloo 1");
  const std::vector<double> outflow = c.outlets.predicted_outflow(1.0);
  ASSERT_EQ(outflow.size(), 2u);
  EXPECT_NEAR(outflow[0], 0.58 * per_volume * std::pow(6.6, 2.5), 1e-9);
  EXPECT_NEAR(outflow[1], 1.03 * per_volume * 6.6 * std::pow(4.6, 1.5), 1e-9);
  // Each spot carries w N grains.
  EXPECT_NEAR(c.spots.injection_rate.largest(0), outflow[0] / (c.spots.influence * 77), 1e-6);
  // In other units: d = 0.003, g = 9.81, by the unit of time sqrt(d / g).
  const std::vector<double> in_metres =
      command_of("box -0.06 0.06 -0.012 0.012", "orifice 0 0 0 0.012 beverloo 9.81", 0.003)
          .outlets.predicted_outflow(0.003);
  EXPECT_NEAR(in_metres[0] * std::sqrt(0.003 / 9.81), outflow[0], 1e-9);
  // Its constants.
  EXPECT_NEAR(command_of(box, "orifice 0 0 0 4 beverloo 1 0.5 2").outlets.predicted_outflow(1.0)[0],
              0.5 * per_volume * std::pow(6.0, 2.5), 1e-9);
  EXPECT_NEAR(command_of(box, "slot 0 0 0 8 8 beverloo 1 0.5 2 2").outlets.predicted_outflow(1.0)[0],
              2.0 * per_volume * std::pow(6.0, 2.5), 1e-9);
  EXPECT_TRUE(command_of(box, "orifice 0 0 0 4 injection 300").outlets.predicted_outflow(1.0).empty());
}

TEST(OutletCommand, SaysWhereBeverloosLawIsBeyondItsRange) {
  EXPECT_TRUE(command_of(box, "orifice 0 0 0 4 beverloo 1").outlets.doubts(1.0).empty());
  const auto doubts = command_of(box, "orifice 0 0 0 2.8 beverloo 1").outlets.doubts(1.0);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_THAT(doubts[0], AllOf(HasSubstr("orifice of radius 2.8"), HasSubstr("5.6 diameters"), HasSubstr("clog")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 beverloo 1 0.58 8"),
              AllOf(HasSubstr("no outflow"), HasSubstr("not wider than 8")));
}

/// Of a box between x and y of -x, x and -y, y.
std::vector<std::string> doubts_in_a_box(double x, double y, const std::string& outlets, std::vector<double> depths) {
  OutletCommand command = command_of(box, outlets + " beverloo 1").outlets;
  command.look_at_walls(*spot::box_silo(-x, x, -y, y, command.outlets(), {0.25, 2.0}));
  return command.doubts(1.0, depths);
}

TEST(OutletCommand, SaysWhereWallsAreNearForBeverloosLawAndBedsShallow) {
  // 8 d wide: the silo must be 38 d wide, the bed 16 d deep, or 1.2 times as deep as the silo is wide.
  EXPECT_TRUE(doubts_in_a_box(19.1, 19.1, "orifice 0 0 0 4", {46.0}).empty());
  EXPECT_TRUE(doubts_in_a_box(200.0, 200.0, "orifice 0 0 0 4", {16.1}).empty()) << "no wall near";
  const auto near = doubts_in_a_box(25.0, 6.0, "orifice 0 0 0 4", {16.1});
  ASSERT_EQ(near.size(), 1u);
  EXPECT_THAT(near[0], AllOf(HasSubstr("nearest wall is 6 diameters"), HasSubstr("orifice of radius 4"),
                             HasSubstr("is for 19 or more")));
  const auto shallow = doubts_in_a_box(25.0, 25.0, "orifice 0 0 0 4", {59.0});
  ASSERT_EQ(shallow.size(), 1u);
  EXPECT_THAT(shallow[0], AllOf(HasSubstr("is 59 diameters deep"), HasSubstr("is for 60 or more")));
  // A wide outlet: 2.5 of its widths. Of two each has its own.
  const auto wide = doubts_in_a_box(70.0, 70.0, "orifice 0 0 0 30 slot 60 0 0 8 8", {1e3, 15.0});
  ASSERT_EQ(wide.size(), 3u);
  EXPECT_THAT(wide[0], AllOf(HasSubstr("nearest wall is 70 "), HasSubstr("radius 30"), HasSubstr("is for 75 or more")));
  EXPECT_THAT(wide[1], AllOf(HasSubstr("nearest wall is 10 "), HasSubstr("slot of 8 by 8")));
  EXPECT_THAT(wide[2], AllOf(HasSubstr("slot of 8 by 8"), HasSubstr("is for 24 or more")));
  EXPECT_THAT(OutletCommand::range_of_law(), AllOf(HasSubstr("of 6 diameters or more"), HasSubstr("2.5 outlets"),
                                                   HasSubstr("30 diameters"), HasSubstr("1.2 widths")));
}

TEST(OutletCommand, BirthsThatAreToldAreThoseOfTheOutflowThatIsTold) {
  const SpotCommand c = command_of(box, "orifice -8 0 0 4 slot 8 0 0 6 8 beverloo 1 schedule 1 0 0 5 3");
  const std::vector<double> outflow = c.outlets.predicted_outflow(1.0), births = c.births(1.0);
  ASSERT_EQ(births.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(births[k], outflow[k] / (c.spots.influence * 77), 1e-6);
  EXPECT_NEAR(c.spots.injection_rate.largest(0), 3.0 * births[0], 1e-6);
  EXPECT_TRUE(c.outlets.has_schedule(0));
  EXPECT_FALSE(c.outlets.has_schedule(1));
}

TEST(OutletCommand, SpotsLeaveGrainsBetweenThem) {
  // In each height of 1 there are 0.58 * 6 / pi * 100 grains; spots take F / 3.2.
  const double most = 0.58 * 6.0 / 3.14159265358979 * 100.0 * 3.2;
  const auto require = [&](const std::string& rates) {
    command_of(box, "orifice 0 0 0 4 " + rates).require_grains_between_spots(100.0, 1.0);
  };
  EXPECT_NO_THROW(require(spot::message("outflow ", 0.999 * most)));
  EXPECT_NO_THROW(require(spot::message("dilation 0.03 outflow ", 3.99 * most))) << "they climb faster";
  const auto refusal = [&](const std::string& rates) {
    try {
      require(rates);
    } catch (const InvalidParameter& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal("outflow 1e7"), AllOf(HasSubstr("'outflow' has 10000000 grains per time"),
                                            HasSubstr(spot::message("at most ", std::floor(most)).substr(0, 11))));
  EXPECT_THAT(refusal(spot::message("outflow ", 0.6 * most, " schedule 1 1 2")), HasSubstr("'outflow' has"));
  EXPECT_THAT(refusal("injection 1e6"), HasSubstr("'injection' has 1000000 births of spots per time"));
  EXPECT_THAT(refusal("beverloo 1e9"), HasSubstr("'beverloo' has"));
}

/// A cone whose half-angle has the tangent 0.8, 38.66 degrees, below a cylinder; looked at by 'hopper'.
OutletCommand over_a_cone(const std::string& rates) {
  const SpotCommand c =
      command_of("walls add cone z 0 0 4 12 0 10 walls add cylinder z 0 0 12 10 60", "orifice 0 0 0 4 " + rates);
  OutletCommand outlets = c.outlets;
  outlets.look_at_walls(
      spot::ShapedContainer(std::get<ShapedWalls>(c.walls).solid({}), outlets.outlets(), {0.25, 2.0}));
  return outlets;
}

TEST(OutletCommand, HoppersMultiplyBeverloosLaw) {
  const double flat = over_a_cone("beverloo 1").predicted_outflow(1.0)[0];
  const OutletCommand seen = over_a_cone("beverloo 1 hopper 24");
  const double tan_24 = std::tan(24.0 * 3.14159265358979 / 180.0);
  EXPECT_NEAR(seen.predicted_outflow(1.0)[0], flat * std::pow(0.8 * tan_24, -0.35), 1e-6);
  EXPECT_THAT(seen.text_of_hopper(0), AllOf(HasSubstr("half-angle of 38.6598"), HasSubstr("less than 66")));
  EXPECT_TRUE(seen.doubts(1.0).empty());
  // A half-angle that is given counts, whatever the walls are.
  const double tan_30 = std::tan(30.0 * 3.14159265358979 / 180.0);
  EXPECT_NEAR(command_of(box, "orifice 0 0 0 4 beverloo 1 hopper 24 30").outlets.predicted_outflow(1.0)[0],
              flat * std::pow(tan_30 * tan_24, -0.35), 1e-6);
  EXPECT_THAT(over_a_cone("beverloo 1 hopper 24").text_of_rates(), HasSubstr("hopper 24"));
}

TEST(OutletCommand, SaysWhereTheFactorOfHoppersIsBeyondItsRange) {
  EXPECT_THAT(over_a_cone("beverloo 1").doubts(1.0).at(0),
              AllOf(HasSubstr("38.6598083 degrees"), HasSubstr("flat bases")));
  EXPECT_THAT(over_a_cone("beverloo 1 hopper 55").doubts(1.0).at(0), HasSubstr("from 35 on"));
  EXPECT_EQ(over_a_cone("beverloo 1 hopper 55").predicted_outflow(1.0),
            over_a_cone("beverloo 1").predicted_outflow(1.0));
  EXPECT_THAT(over_a_cone("beverloo 1 hopper 24 5").doubts(1.0).at(0), HasSubstr("below 10"));
  EXPECT_THAT(command_of(box, "slot 0 0 0 6 8 beverloo 1 hopper 24 30").outlets.doubts(1.0).at(0), HasSubstr("wedges"));
  EXPECT_TRUE(over_a_cone("injection 300").doubts(1.0).empty());
}

TEST(OutletCommand, MistakesAreNamed) {
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 injection 300 hopper 24"), HasSubstr("'hopper' goes with 'beverloo'"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 beverloo 1 hopper 90"), HasSubstr("angle of repose must be below 90"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 beverloo 1 hopper 24 0"), HasSubstr("half-angle must be positive"));
  OutletCommand flat = command_of(box, "orifice 0 0 0 4 beverloo 1 hopper 24").outlets;
  EXPECT_THROW(flat.look_at_walls(*spot::box_silo(-20, 20, -5, 5, flat.outlets(), {0.25, 2.0})),
               spot::InvalidParameter);
  EXPECT_THAT(error_of(box, "injection 300"), AllOf(HasSubstr("'orifice' is missing"), HasSubstr("'slot")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4"),
              AllOf(HasSubstr("'outflow' is missing"), HasSubstr("'injection'"), HasSubstr("'beverloo g'")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 injection 300 outflow 30"), HasSubstr("only one of"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 outflow 30 beverloo 1"), HasSubstr("only one of"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 outflow 30 2"),
              HasSubstr("'outflow' has 2 rates but there is 1 outlet: give one"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 outflow -1"), HasSubstr("zero or positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 outflow 0"), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 4 injection 300 beverloo 1"), HasSubstr("only one of"));
  EXPECT_THAT(error_of(box, "orifice -5 0 0 3 orifice 5 0 0 3 injection 300"), HasSubstr("1 rate but there are 2"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 300 20"), HasSubstr("2 rates but there is 1"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection -1"), HasSubstr("zero or positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 0"), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 orifice 4 0 0 3 injection 1 1"), HasSubstr("overlap"));
  EXPECT_THAT(error_of(box, "orifice -5 0 0 3 orifice 5 0 1 3 injection 1 1"), HasSubstr("height"));
  EXPECT_THAT(error_of(box, "slot 0 0 0 6 injection 1"), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of(box, "slot 0 0 0 6 0 injection 1"), HasSubstr("must be positive"));
  const std::string two = "orifice -5 0 0 3 orifice 5 0 0 3 ";
  EXPECT_THAT(error_of(box, two + "outflow 0 0"), HasSubstr("'outflow' is 0 at all outlets but must be positive"));
  EXPECT_THAT(error_of(box, two + "injection 0 0"), HasSubstr("'injection' is 0 at all outlets"));
  for (const std::string rate : {"injection 300", "outflow 30", "beverloo 1"})
    EXPECT_THAT(error_of(box, "orifice 0 0 0 4 " + rate + " schedule 1 0 0 3 0"),
                AllOf(HasSubstr("'schedule 1' is 0 from time 0 on"), HasSubstr("must be positive")));
  EXPECT_THAT(error_of(box, two + "outflow 0 3 schedule 2 0 0"), HasSubstr("'schedule 2' is 0 "));
  EXPECT_THAT(error_of(box, two + "outflow 2 3 schedule 1 0 0 schedule 2 0 0"),
              HasSubstr("'schedule 1', 'schedule 2' is 0 "));
  for (const std::string opens :
       {"schedule 1 0 0", "schedule 1 0 0 schedule 2 1 0", "schedule 2 0 0 1 2", "schedule 1 0 0 schedule 2 v_open"})
    EXPECT_NO_THROW(command_of(box, two + "outflow 2 3 " + opens)) << opens;
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 2 0 1"),
              AllOf(HasSubstr("schedule 2"), HasSubstr("1 to 1")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 1 0 0.5 1"),
              AllOf(HasSubstr("from time 1 to 0.5"), HasSubstr("must increase")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 -1 0"), HasSubstr("zero or positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 1 -2"), HasSubstr("zero or positive"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 1 0 schedule 1 2 0"), HasSubstr("given twice"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 1 0 schedule 1 v_a"), HasSubstr("given twice"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 v_a schedule 1 v_b"), HasSubstr("given twice"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 2 v_a"), HasSubstr("1 to 1"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 v_"), HasSubstr("'schedule 1 v_' has no name"));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 v_a 1 0"),
              AllOf(HasSubstr("'schedule 1 v_a' goes on"), HasSubstr("either a variable, or")));
  EXPECT_THAT(error_of(box, "orifice 0 0 0 3 injection 1 schedule 1 gate"),
              AllOf(HasSubstr("'gate' is not a finite number"), HasSubstr("'schedule'")));
  EXPECT_THAT(error_of("region silo", "slot 0 0 0 6 8 injection 1"), HasSubstr("'region' takes one round orifice"));
  EXPECT_THAT(error_of("region silo", "orifice -5 0 0 3 orifice 5 0 0 3 injection 1 1"),
              HasSubstr("one round orifice"));
}

spot::Solid solid_of(const std::string& walls) {
  return std::get<ShapedWalls>(command_of(walls, "orifice 0 0 0 4 injection 300").walls).solid({});
}

TEST(ShapedWalls, ShapesAreAddedAndCutInTheirOrder) {
  const std::string hopper = "walls add cone z 0 0 4 12 0 14 walls add cylinder z 0 0 12 14 40";
  const spot::Solid silo = solid_of(hopper);
  EXPECT_TRUE(silo.contains({0, 0, 1}));
  EXPECT_FALSE(silo.contains({6, 0, 1})) << "beside the cone";
  EXPECT_TRUE(silo.contains({11, 0, 20}));
  const spot::Solid with_insert = solid_of(hopper + " walls cut sphere 0 0 20 3");
  EXPECT_FALSE(with_insert.contains({0, 0, 18}));
  EXPECT_TRUE(with_insert.contains({0, 0, 24}));
  EXPECT_TRUE(solid_of(hopper + " walls cut sphere 0 0 20 3 walls add block -1 1 -1 1 19 21").contains({0, 0, 20}));
}

TEST(ShapedWalls, AxesLieAsInRegionsOfLammps) {
  const spot::Solid along_x = solid_of("walls add cylinder x 1 20 6 -30 30 walls add block -20 20 -4 4 0 20");
  EXPECT_TRUE(along_x.contains({25, 1, 20}));
  EXPECT_FALSE(along_x.contains({25, 20, 1}));
  const spot::Solid along_y = solid_of("walls add cylinder y 1 20 6 -30 30 walls add block -20 20 -4 4 0 20");
  EXPECT_TRUE(along_y.contains({1, 25, 20}));
  const spot::Solid wedge =
      solid_of("walls add block -10 10 -4 4 0 12 walls cut plane 4 0 0 2 0 -1 walls cut plane -4 0 0 -2 0 -1");
  EXPECT_FALSE(wedge.contains({9, 0, 1}));
  EXPECT_TRUE(wedge.contains({9, 0, 11}));
}

TEST(ShapedWalls, BoundsAndTextAreOfAllShapes) {
  const SpotCommand c =
      command_of("walls add cone z 0 1 4 12 0 14 walls add block -20 5 -4 4 14 40 walls cut sphere 0 0 20 1",
                 "orifice 0 1 0 4 injection 300");
  const ShapedWalls& walls = std::get<ShapedWalls>(c.walls);
  EXPECT_EQ(walls.low(), spot::Vector3(-20, -11, 0));
  EXPECT_EQ(walls.high(), spot::Vector3(12, 13, 40));
  EXPECT_EQ(walls.text(), "add cone z 0 1 4 12 0 14 add block -20 5 -4 4 14 40 cut sphere 0 0 20 1");
  EXPECT_EQ(c.settings().front().second, walls.text());
}

TEST(ShapedWalls, MistakesAreNamed) {
  const std::string outlet = "orifice 0 0 0 4 injection 300";
  EXPECT_THAT(error_of("walls", outlet), HasSubstr("'walls orifice' is not known"));
  EXPECT_THAT(error_of("walls add", outlet), AllOf(HasSubstr("'walls add orifice'"), HasSubstr("'block'")));
  EXPECT_THAT(error_of("walls add mesh silo.stl", outlet),
              AllOf(HasSubstr("'walls add mesh'"), HasSubstr("no walls of triangles"), HasSubstr("'cone'")));
  EXPECT_THAT(error_of("walls add stl silo.stl", outlet), HasSubstr("no walls of triangles"));
  EXPECT_THAT(error_of("walls add sphere 0 0 0 9 walls cut mesh", outlet), HasSubstr("'walls cut mesh'"));
  EXPECT_THAT(error_of("walls add tube", outlet), AllOf(HasSubstr("'walls add tube'"), HasSubstr("'cone'")));
  EXPECT_THAT(error_of("walls add cone w", outlet), HasSubstr("'x' or 'y' or 'z'"));
  EXPECT_THAT(error_of("walls add cone z 0 0 4 -1 0 9", outlet), HasSubstr("zero or positive"));
  EXPECT_THAT(error_of("walls add cone z 0 0 4 9 9 0", outlet), HasSubstr("lo < hi"));
  EXPECT_THAT(error_of("walls add cylinder z 0 0 0 0 9", outlet), HasSubstr("must be positive"));
  EXPECT_THAT(error_of("walls add block 0 1 0 1 1 0", outlet), HasSubstr("each coordinate must increase"));
  EXPECT_THAT(error_of("walls add plane 0 0 0 0 0 0", outlet), HasSubstr("not zero"));
  EXPECT_THAT(error_of("walls cut sphere 0 0 0 1", outlet), HasSubstr("nothing to cut from"));
  EXPECT_THAT(error_of("walls add sphere 0 0 0 9 box 0 1 0 1", outlet), HasSubstr("only one of"));
  EXPECT_THAT(error_of("cylinder 0 0 5 walls add sphere 0 0 0 9", outlet), HasSubstr("only one of"));
}

}  // namespace
