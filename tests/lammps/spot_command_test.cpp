// SPDX-License-Identifier: GPL-2.0-or-later
// The parser of `fix spot`, without LAMMPS, and whether doc/fix_spot.rst says what it does.
#include "spot_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "spot/base/errors.hpp"

namespace {

using spot::InvalidParameter;
using testing::AllOf;
using testing::HasSubstr;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

SpotCommand parse(const std::string& text) { return parse_spot_command(words_of(text)); }

const std::string complete = "box -5 5 -4 4 orifice 1 2 3 3.5 speed 3.2 injection 388 ";

std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error: " << text;
  return {};
}

std::set<std::string> known_keywords() {
  const std::string error = error_of("?");
  const auto words = words_of(error.substr(error.find("known are:") + 10));
  return {words.begin(), words.end()};
}

TEST(SpotCommand, ReadsEveryKeyword) {
  const SpotCommand c = parse(
      "region silo orifice 1 -2 +3 4e0 radius 2.5 influence 1e-3 diffusion 1.5 dz 0.2 speed 2 injection 300 seed 17 "
      "outlet -1.5 buffer 0.5 0 window 0.25 relax every 10 strength full alpha 0.7 shell 2 overlap 0.1 average 5 "
      "accuracy fast momentum 0.3 contact 2e-3 volume 77.5 persistence 0.4 dilation 0.03 steps together threads 4 "
      "critical 0.58 1.5 dilatancy 0.1 full_strain 0.3 spread 0.6 0.7 surface 3 nonaffine 0.14 0.5 peratom yes");
  EXPECT_TRUE(c.uses_region());
  EXPECT_EQ(std::get<RegionWalls>(c.walls).id, "silo");
  EXPECT_EQ(c.outlets.single_orifice()->centre, spot::Vector3(1, -2, 3));
  EXPECT_EQ(c.outlets.single_orifice()->radius, 4.0);
  EXPECT_EQ(c.spots.radius, 2.5);
  EXPECT_EQ(c.spots.influence, 1e-3);
  EXPECT_EQ(c.diffusion_length, 1.5);
  EXPECT_EQ(c.spots.step_height, 0.2);
  EXPECT_EQ(c.spots.persistence, 0.4);
  EXPECT_EQ(c.spots.dilation, 0.03);
  EXPECT_EQ(c.spots.critical_fraction, 0.58);
  EXPECT_EQ(c.spots.exchange_length, 1.5);
  EXPECT_EQ(c.spots.dilatancy, 0.1);
  EXPECT_EQ(c.spots.full_strain, 0.3);
  EXPECT_EQ(c.spots.spread, 0.6);
  EXPECT_EQ(c.spots.wall_shear, 0.7);
  EXPECT_EQ(c.spots.surface_exponent, 3.0);
  EXPECT_EQ(c.spots.nonaffine, 0.14);
  EXPECT_EQ(c.spots.nonaffine_length, 0.5);
  EXPECT_EQ(c.spots.speed, 2.0);
  EXPECT_EQ(c.outlets.injection(c.spots, 1.0).largest(), 300.0);
  EXPECT_EQ(c.spots.seed, 17U);
  EXPECT_EQ(c.outlet, -1.5);
  EXPECT_EQ(c.side_buffer, 0.5);
  EXPECT_EQ(c.base_buffer, 0.0);
  EXPECT_EQ(c.window, 0.25);
  EXPECT_EQ(c.relaxation.every, 10);
  EXPECT_EQ(c.relaxation.strength, spot::RelaxationStrength::full_each);
  EXPECT_EQ(c.alpha, 0.7);
  EXPECT_EQ(c.relaxation.shell, 2.0);
  EXPECT_EQ(c.largest_overlap, 0.1);
  EXPECT_EQ(c.average, 5);
  EXPECT_EQ(c.accuracy, spot::Accuracy::fast);
  EXPECT_EQ(c.momentum, 0.3);
  EXPECT_EQ(c.contact_overlap, 2e-3);
  EXPECT_EQ(c.spots.fixed_volume, 77.5);
  EXPECT_TRUE(c.spots.together);
  EXPECT_EQ(c.threads, 4);
  EXPECT_TRUE(c.per_atom);
}

/// What a command means once the diameter is known.
SpotCommand resolved(const std::string& more, double diameter = 1.0) {
  SpotCommand command = parse(complete + more);
  command.resolve(diameter);
  return command;
}

TEST(SpotCommand, ReadsWhatRelaxes) {
  using spot::RelaxationSchedule;
  const std::map<std::string, RelaxationSchedule> schedules = {{"every", RelaxationSchedule::moves},
                                                               {"chance", RelaxationSchedule::chance},
                                                               {"spot", RelaxationSchedule::spot},
                                                               {"global", RelaxationSchedule::global}};
  for (const auto& [word, schedule] : schedules) {
    const SpotCommand c = resolved("relax " + word + " 7");
    EXPECT_TRUE(*c.time_ordered) << word;
    EXPECT_EQ(c.relaxation.schedule, schedule) << word;
    EXPECT_EQ(c.relaxation.every, 7) << word;
  }
  const SpotCommand never = resolved("relax never");
  EXPECT_TRUE(*never.time_ordered);
  EXPECT_EQ(never.relaxation.every, 0);
  const SpotCommand tol = resolved("relax tol 0.002");
  EXPECT_FALSE(*tol.time_ordered);
  EXPECT_EQ(tol.relaxation.tolerance, 0.002);
  EXPECT_EQ(resolved("relax every 99999999999").relaxation.every, 1 << 30) << "more than an int holds";
}

TEST(SpotCommand, AccuracyDecidesWhatIsLeftOpen) {
  EXPECT_EQ(parse(complete).accuracy, spot::Accuracy::normal);
  const std::map<std::string, spot::Accuracy> words = {
      {"fast", spot::Accuracy::fast}, {"normal", spot::Accuracy::normal}, {"exact", spot::Accuracy::exact}};
  for (const auto& [word, accuracy] : words) {
    const SpotCommand c = resolved("accuracy " + word, 2.0);
    const spot::RelaxationParameters chosen = spot::relaxation_of(accuracy, *spot::InfluenceProfile::parabolic);
    EXPECT_EQ(*c.time_ordered, accuracy == spot::Accuracy::exact) << word;
    EXPECT_EQ(c.relaxation.tolerance, chosen.tolerance) << word;
    EXPECT_EQ(c.relaxation.alpha, chosen.alpha) << word;
    EXPECT_EQ(c.relaxation.momentum, chosen.momentum) << word;
    EXPECT_EQ(c.relaxation.contact_overlap, chosen.contact_overlap) << word;
    EXPECT_EQ(c.spots.step_height, 2.0 * spot::step_height_in_diameters(accuracy)) << word;
    EXPECT_NO_THROW(c.spots.validate()) << word;
    EXPECT_NO_THROW(c.relaxation.validate()) << word;
    // What is given stays.
    const SpotCommand given =
        resolved("accuracy " + word + " relax tol 0.01 dz 0.3 alpha 0.9 momentum 0.1 contact 0.003");
    EXPECT_FALSE(*given.time_ordered) << word;
    EXPECT_EQ(given.relaxation.tolerance, 0.01) << word;
    EXPECT_EQ(given.relaxation.alpha, 0.9) << word;
    EXPECT_EQ(given.relaxation.momentum, 0.1) << word;
    EXPECT_EQ(given.relaxation.contact_overlap, 0.003) << word;
    EXPECT_EQ(given.spots.step_height, 0.3) << word;
  }
  EXPECT_LT(resolved("accuracy normal").relaxation.tolerance, resolved("accuracy fast").relaxation.tolerance);
}

TEST(SpotCommand, RadiusAndMomentumGoWithTheProfile) {
  EXPECT_EQ(parse(complete).spots.profile, spot::InfluenceProfile::parabolic);
  const SpotCommand uniform = resolved("profile uniform", 2.0), parabolic = resolved("profile parabolic", 2.0);
  EXPECT_EQ(uniform.spots.radius, 5.2);
  EXPECT_NEAR(parabolic.spots.equivalent_radius(), 5.2, 0.002) << "the same volume";
  EXPECT_LT(uniform.relaxation.momentum, parabolic.relaxation.momentum);
}

TEST(SpotCommand, SchedulesOf2006And2010GoWithTheirAlphaAndNoMomentum) {
  for (const std::string how : {"every 1", "chance 3", "never"}) {
    const SpotCommand c = resolved("relax " + how);
    EXPECT_EQ(c.relaxation.alpha, 0.8) << how;
    EXPECT_EQ(c.relaxation.momentum, 0.0) << how;
    EXPECT_EQ(c.relaxation.contact_overlap, 0.0) << how;
    EXPECT_EQ(resolved("contact 1e-3 relax " + how).relaxation.contact_overlap, 1e-3) << how;
    EXPECT_EQ(resolved("alpha 0.5 relax " + how).relaxation.alpha, 0.5) << how;
  }
}

TEST(SpotCommand, ReadsWalls) {
  const auto box = std::get<BoxWalls>(parse(complete).walls);
  EXPECT_EQ(box.x->low, -5.0);
  EXPECT_EQ(box.x->high, 5.0);
  EXPECT_EQ(box.y->low, -4.0);
  EXPECT_EQ(box.y->high, 4.0);
  const auto open = std::get<BoxWalls>(parse("box -5 5 NULL NULL orifice 0 0 0 3 speed 1 injection 1").walls);
  EXPECT_EQ(open.x->high, 5.0);
  EXPECT_FALSE(open.y.has_value());
  const auto cylinder = std::get<CylinderWalls>(parse("cylinder 1 2 7 orifice 1 2 3 3 speed 1 injection 1").walls);
  EXPECT_EQ(cylinder.x, 1.0);
  EXPECT_EQ(cylinder.y, 2.0);
  EXPECT_EQ(cylinder.radius, 7.0);
}

TEST(SpotCommand, ResolveKeepsWhatWasGiven) {
  SpotCommand c = parse(complete + "radius 2 diffusion 0.9 dz 0.4 outlet 2.5 buffer 0.25 0.75");
  c.resolve(10.0);
  EXPECT_EQ(c.spots.radius, 2.0);
  EXPECT_EQ(c.spots.step_height, 0.4);
  EXPECT_NEAR(c.spots.diffusion_length(), 0.9, 1e-12);
  EXPECT_EQ(c.outlet, 2.5);
  EXPECT_EQ(c.side_buffer, 0.25);
  EXPECT_EQ(c.base_buffer, 0.75);
  c.resolve(20.0);  // as before a second run
  EXPECT_EQ(c.spots.radius, 2.0);
}

TEST(SpotCommand, ResolvingTwiceChangesNothing) {
  for (const std::string more : {"", "accuracy fast", "accuracy exact", "relax chance 2", "relax tol 1e-3"}) {
    SpotCommand once = resolved(more, 3.0), twice = resolved(more, 3.0);
    twice.resolve(3.0);
    EXPECT_EQ(*once.time_ordered, *twice.time_ordered) << more;
    EXPECT_EQ(once.relaxation.alpha, twice.relaxation.alpha) << more;
    EXPECT_EQ(once.relaxation.momentum, twice.relaxation.momentum) << more;
    EXPECT_EQ(once.relaxation.contact_overlap, twice.relaxation.contact_overlap) << more;
    EXPECT_EQ(once.relaxation.tolerance, twice.relaxation.tolerance) << more;
    EXPECT_EQ(once.spots.step_height, twice.spots.step_height) << more;
    EXPECT_EQ(once.spots.step_width, twice.spots.step_width) << more;
    EXPECT_EQ(*once.outlet, *twice.outlet) << more;
  }
}

TEST(SpotCommand, TheLastOfTwoCounts) { EXPECT_EQ(parse(complete + "seed 2 seed 3").spots.seed, 3U); }

TEST(SpotCommand, ErrorsNameTheWord) {
  EXPECT_THAT(error_of(""), HasSubstr("'box' is missing"));
  EXPECT_THAT(error_of(complete + "Radius 2"), AllOf(HasSubstr("'Radius'"), HasSubstr(" radius ")));
  EXPECT_THAT(error_of(complete + "orifice 1 2 3"), HasSubstr("'orifice' ends before its value"));
  EXPECT_THAT(error_of(complete + "box 1 2 3 4"), HasSubstr("only one of"));
  for (const std::string word : {"1.5x", "x", "nan", "-inf", "+-1", "++1", "+", "-", "0x10", "1,5", "1e999", "1.5.2"})
    EXPECT_THAT(error_of(complete + "outlet " + word), HasSubstr("'" + word + "' is not a finite number"));
  for (const std::string word : {"1.0", "0", "-3", "99999999999999999999", "1e3", "+2"})
    EXPECT_THAT(error_of(complete + "seed " + word), HasSubstr("'" + word + "' after keyword 'seed'"));
}

TEST(SpotCommand, ErrorsOfWordsSayWhichAreKnown) {
  EXPECT_THAT(error_of(complete + "accuracy best"),
              AllOf(HasSubstr("'accuracy best' is not known"), HasSubstr("'exact' or 'fast' or 'normal'")));
  EXPECT_THAT(error_of(complete + "steps alone"),
              AllOf(HasSubstr("'steps alone' is not known"), HasSubstr("'poisson' or 'together'")));
  EXPECT_THAT(error_of(complete + "strength 0.5"),
              AllOf(HasSubstr("'strength 0.5' is not known"), HasSubstr("'full' or 'half'")));
  EXPECT_THAT(error_of(complete + "peratom on"),
              AllOf(HasSubstr("'peratom on' is not known"), HasSubstr("'no' or 'yes'")));
  EXPECT_THAT(error_of(complete + "relax often"),
              AllOf(HasSubstr("'relax often' is not known"), HasSubstr("'relax tol delta'"), HasSubstr("'relax never'"),
                    HasSubstr("'every', 'chance', 'spot' and 'global'")));
  for (const std::string keyword :
       {"accuracy",  "steps",   "strength",   "relax",         "relax tol", "relax chance", "threads",
        "momentum",  "contact", "closing",    "closing 0.004", "volume",    "critical",     "critical 0.58",
        "dilatancy", "spread",  "spread 0.6", "surface",       "fade", "nonaffine", "nonaffine 0.1",
        "mobility",  "mobility 0.4", "mobility 0.4 1", "full_strain"})
    EXPECT_THAT(error_of(complete + keyword), HasSubstr("ends before its value")) << keyword;
}

TEST(SpotCommand, ErrorsOfNumbersSayTheirBounds) {
  for (const std::string word : {"0", "-2", "1.5", "two", "1e3", "99999999999999999999"}) {
    EXPECT_THAT(error_of(complete + "threads " + word),
                AllOf(HasSubstr("'" + word + "' after keyword 'threads'"), HasSubstr("1 or more")));
    for (const std::string how : {"every", "chance", "spot", "global"})
      EXPECT_THAT(error_of(complete + "relax " + how + " " + word),
                  AllOf(HasSubstr("'" + word + "' after keyword 'relax'"), HasSubstr("1 or more")));
  }
  EXPECT_THAT(error_of(complete + "relax tol 0"), AllOf(HasSubstr("'relax' is 0"), HasSubstr("must be positive")));
  EXPECT_THAT(error_of(complete + "relax tol -1e-3"), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(complete + "relax tol x"), HasSubstr("'x' is not a finite number"));
  EXPECT_THAT(error_of(complete + "momentum -0.1"), AllOf(HasSubstr("'momentum' is -0.1"), HasSubstr("zero or")));
  EXPECT_THAT(error_of(complete + "contact -1e-3"),
              AllOf(HasSubstr("'contact' is -0.001"), HasSubstr("zero or positive")));
  EXPECT_THROW(resolved("contact 0.1").relaxation.validate(), InvalidParameter);
  EXPECT_THAT(error_of(complete + "closing -4e-3 0.1"),
              AllOf(HasSubstr("'closing' is -0.004"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "closing 4e-3 -1"), AllOf(HasSubstr("'closing' is -1"), HasSubstr("the share")));
  EXPECT_THAT(error_of(complete + "closing 4e-3 surface 2"), HasSubstr("'surface' is not a finite number"));
  EXPECT_THROW(resolved("closing 0.06 0.1").relaxation.validate(), InvalidParameter);
  EXPECT_THROW(resolved("closing 0.004 1.1").relaxation.validate(), InvalidParameter);
  EXPECT_THAT(error_of(complete + "volume -1"), AllOf(HasSubstr("'volume' is -1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "critical -0.58 1"),
              AllOf(HasSubstr("'critical' is -0.58"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "critical 0.58 0"), AllOf(HasSubstr("'critical' is 0"), HasSubstr("be positive")));
  EXPECT_THAT(error_of(complete + "critical 0.58 surface 2"), HasSubstr("'surface' is not a finite number"));
  EXPECT_THAT(error_of(complete + "dilatancy -1"),
              AllOf(HasSubstr("'dilatancy' is -1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "full_strain -1"),
              AllOf(HasSubstr("'full_strain' is -1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "spread -1 0.7"), AllOf(HasSubstr("'spread' is -1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "spread 0.6 -1"), AllOf(HasSubstr("'spread' is -1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "spread 0.6 surface 2"), HasSubstr("'surface' is not a finite number"));
  EXPECT_THAT(error_of(complete + "surface -1"), AllOf(HasSubstr("'surface' is -1"), HasSubstr("zero or positive")));
  EXPECT_THROW(resolved("surface 33").spots.validate(), InvalidParameter);
  EXPECT_THAT(error_of(complete + "nonaffine -0.1 1"),
              AllOf(HasSubstr("'nonaffine' is -0.1"), HasSubstr("zero or positive")));
  EXPECT_THAT(error_of(complete + "nonaffine 0.1 0"), AllOf(HasSubstr("'nonaffine' is 0"), HasSubstr("be positive")));
  EXPECT_THROW(resolved("nonaffine 0.6 1").spots.validate(), InvalidParameter);
  EXPECT_THAT(error_of(complete + "alpha 0"), HasSubstr("must be positive"));
  EXPECT_THAT(error_of(complete + "volume inf"), HasSubstr("'inf' is not a finite number"));
  // What the parser cannot know is refused by who uses it.
  EXPECT_EQ(parse(complete + "threads 99999999999").threads, 1 << 30);
  EXPECT_THROW(resolved("momentum 1").relaxation.validate(), InvalidParameter);
  for (const std::string more :
       {"volume 0 critical 0.58 1", "volume 77 critical 0.4 1", "volume 77 critical 0.58 0.01",
        "volume 77 dilatancy 0.1", "volume 77 critical 0 1 dilatancy 0.1", "volume 77 critical 0.58 1 dilatancy 1.2",
        "volume 77 critical 0.58 1 dilatancy 1e300", "volume 77 full_strain 0.2",
        "volume 77 critical 0.58 1 full_strain 3", "volume 77 spread 3 0.7", "volume 77 spread 0.6 5",
        "spread 0.6 0.7", "volume 77 persistence 0.1 spread 0.6 0.7"})
    EXPECT_THROW(resolved(more).spots.validate(), InvalidParameter) << more;
  EXPECT_NO_THROW(resolved("volume 77 critical 0.58 1 dilatancy 0.1 full_strain 0.2").spots.validate());
}

TEST(SpotCommand, SettingsTellWhatSpotsLeave) {
  const auto settings = [](const std::string& more) {
    std::map<std::string, std::string> all;
    for (const auto& [name, value] : resolved(more).settings()) all[name] = value;
    return all;
  };
  auto found = settings("volume 77 critical 0.625 1.5 dilatancy 0.125 full_strain 0.25 spread 0.5 0.75");
  EXPECT_EQ(found["spread"], "0.5 0.75");
  EXPECT_EQ(found["critical"], "0.625 1.5");
  EXPECT_EQ(found["dilatancy"], "0.125");
  EXPECT_EQ(found["full_strain"], "0.25");
  found = settings("");
  EXPECT_EQ(found["critical"], "0 0");
  EXPECT_EQ(found["dilatancy"], "0");
}

TEST(SpotCommand, DrainedGrainsGoRoundOnlyIfAskedTo) {
  const auto setting = [](const std::string& more) {
    std::string text;
    for (const auto& [name, value] : resolved(more).settings())
      if (name == "recirculate") text = value;
    return text;
  };
  EXPECT_EQ(setting(""), "no");
  EXPECT_EQ(setting("recirculate 15 recirculate no"), "no");
  EXPECT_EQ(setting("recirculate yes"), "yes");
  EXPECT_EQ(setting("recirculate -2.5"), "-2.5");
  EXPECT_EQ(setting("recirculate region top"), "region top");
  EXPECT_EQ(parse(complete + "recirculate 15").recirculation->height, 15.0);
  EXPECT_THAT(error_of(complete + "recirculate maybe"),
              AllOf(HasSubstr("'recirculate maybe' is not known"), HasSubstr("'recirculate region'")));
  EXPECT_THAT(error_of(complete + "recirculate"), HasSubstr("ends before its value"));
  EXPECT_THAT(error_of(complete + "recirculate inf"), HasSubstr("'inf' is not a finite number"));
}

TEST(SpotCommand, GapsAreClosedOnlyIfAskedFor) {
  for (const std::string more : {"", "accuracy fast", "accuracy exact", "relax every 1"}) {
    EXPECT_EQ(resolved(more).relaxation.closing_gap, 0.0) << more;
    const SpotCommand closing = resolved("closing 4e-3 0.125 " + more, 3.0);
    EXPECT_EQ(closing.relaxation.closing_gap, 4e-3) << more << ": in diameters, whatever their length";
    EXPECT_EQ(closing.relaxation.closing_share, 0.125) << more;
    EXPECT_NO_THROW(closing.relaxation.validate()) << more;
    const auto settings = closing.settings();
    EXPECT_THAT(settings, testing::Contains(testing::Pair("closing", "0.0040000000000000001 0.125")));
  }
}

TEST(SpotCommand, OnlyThreadsMayBeModified) {
  SpotCommand command = parse(complete);
  EXPECT_EQ(modify_spot_command(command, words_of("threads 3 energy yes")), 2U);
  EXPECT_EQ(command.threads, 3);
  const auto error = [&](const std::string& words) {
    try {
      modify_spot_command(command, words_of(words));
    } catch (const InvalidParameter& refused) {
      return std::string(refused.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("threads"), HasSubstr("'threads' ends before its value"));
  EXPECT_THAT(error("threads 0"), HasSubstr("1 or more"));
  for (const std::string& keyword : known_keywords()) {
    if (keyword == "threads") continue;
    EXPECT_THAT(error(keyword + " 1"), HasSubstr("unknown keyword '" + keyword + "'; only 'threads'"));
  }
  EXPECT_EQ(command.threads, 3);
}

/// Random commands: either they are read, and then what was read is in range, or the error is InvalidParameter.
TEST(SpotCommand, RandomWordsGiveNoOtherError) {
  const std::vector<std::string> vocabulary = {"box",       "cylinder",    "region",
                                               "orifice",   "radius",      "influence",
                                               "diffusion", "dz",          "speed",
                                               "injection", "seed",        "outlet",
                                               "buffer",    "window",      "relax",
                                               "strength",  "alpha",       "shell",
                                               "every",     "never",       "half",
                                               "full",      "1",           "-1",
                                               "0",         "2.5",         "1e308",
                                               "-0",        "nan",         "inf",
                                               "1e-320",    "overlap",     "average",
                                               "",          " ",           "\xff\xfe",
                                               "%s",        "+",           "18446744073709551616",
                                               "accuracy",  "fast",        "normal",
                                               "exact",     "momentum",    "contact",
                                               "volume",    "steps",       "poisson",
                                               "together",  "persistence", "dilation",
                                               "threads",   "tol",         "chance",
                                               "spot",      "global",      "silo",
                                               "peratom",   "yes",         "no",
                                               "critical",  "dilatancy",   "surface",
                                               "nonaffine", "closing",     "slot",
                                               "spread",    "beverloo",    "schedule",
                                               "walls",     "add",         "cut",
                                               "block",     "cone",        "z",
                                               "plane",     "sphere",      "NULL",
                                               "recirculate", "hopper", "v_open", "scene", "fade", "mobility",
                                               "full_strain"};
  std::mt19937 random(2006);
  int read = 0;
  for (int attempt = 0; attempt < 100000; ++attempt) {
    std::vector<std::string> words = words_of(attempt % 2 ? complete : "");
    for (auto more = random() % 8; more > 0; --more) {
      const auto at = static_cast<std::ptrdiff_t>(random() % (words.size() + 1));
      words.insert(words.begin() + at, vocabulary[random() % vocabulary.size()]);
    }
    try {
      SpotCommand command = parse_spot_command(words);
      ++read;
      EXPECT_GT(command.spots.speed, 0.0);
      EXPECT_GE(command.average, 1);
      EXPECT_GE(command.threads, 1);
      EXPECT_GE(command.relaxation.every, 0);
      EXPECT_GE(command.spots.fixed_volume, 0.0);
      EXPECT_GE(command.spots.critical_fraction, 0.0);
      EXPECT_GE(command.spots.dilatancy, 0.0);
      command.resolve(1.0);
      EXPECT_GE(command.spots.injection_rate.largest(), 0.0);
      EXPECT_GT(command.relaxation.tolerance, 0.0);
    } catch (const spot::Error& error) {
      EXPECT_STRNE(error.what(), "");
    }
  }
  EXPECT_GT(read, 5000);
}

// ---------------------------------------------------------------------------------------------------------
// The documentation

std::string documentation() {
  std::ifstream in(SPOT_DOCUMENTATION);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The text from one heading to another.
std::string section(const std::string& from, const std::string& to) {
  const std::string text = documentation();
  const auto first = text.find("\n" + from + "\n\""), last = text.find("\n" + to);
  EXPECT_LT(first, last) << from;
  return first < last ? text.substr(first, last - first) : std::string();
}

/// The groups of every place that the pattern matches.
std::vector<std::vector<std::string>> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::vector<std::string>> all;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
    all.emplace_back(match->begin(), match->end());
  return all;
}

TEST(SpotDocumentation, ListsTheKeywords) {
  const std::string syntax = section("Syntax", "Examples");
  std::set<std::string> explained, listed;
  for (const auto& match : matches(syntax, "\n +\\*(\\w+)\\* values? =")) explained.insert(match[1]);
  const auto list = matches(syntax, "\n\\* keyword = ([^\n]*(?:\n  [^\n]+)*)");
  ASSERT_EQ(list.size(), 1U);
  const std::string keywords = list[0][1];
  for (const auto& match : matches(keywords, "\\*(\\w+)\\*")) listed.insert(match[1]);
  EXPECT_EQ(explained, known_keywords());
  EXPECT_EQ(listed, known_keywords());
}

TEST(SpotDocumentation, ExamplesAreValid) {
  const std::string examples = std::regex_replace(section("Examples", "Description"), std::regex("&\n"), " ");
  const auto commands = matches(examples, "\n +fix \\w+ \\w+ spot ([^\n]*)");
  EXPECT_GE(commands.size(), 3U);
  for (const auto& command : commands) EXPECT_NO_THROW(parse(command[1])) << command[1];
}

TEST(SpotDocumentation, SaysWhichKeywordsAreRequired) {
  EXPECT_THAT(section("Syntax", "Examples"),
              HasSubstr("*speed*, one of *orifice* and *slot*, one of *outflow*, *injection* and *beverloo*, and one "
                        "of *box*,\n  *cylinder*, *region* and *walls* are required"));
  for (const std::string required : {"box -5 5 -4 4", "orifice 1 2 3 3.5", "speed 3.2", "injection 388"}) {
    std::string without = complete;
    without.erase(without.find(required), required.size());
    EXPECT_THAT(error_of(without), HasSubstr("is missing"));
  }
}

std::string in(double value, const std::string& unit) {
  std::ostringstream out;
  out << value << unit;
  return out.str();
}

TEST(SpotDocumentation, GivesTheDefaults) {
  const double d = 2.0;
  SpotCommand c = parse(complete);
  EXPECT_FALSE(c.window.has_value());
  c.resolve(d);
  const std::map<std::string, std::string> defaults = {
      {"radius", in(c.spots.radius / d, " d")},
      {"profile", c.spots.profile->name()},
      {"influence", in(c.spots.influence, "")},
      {"diffusion", in(c.spots.diffusion_length() / d, " d")},
      {"seed", std::to_string(c.spots.seed)},
      {"volume", in(c.spots.fixed_volume, "")},
      {"persistence", in(c.spots.persistence, "")},
      {"dilation", in(c.spots.dilation, "")},
      {"critical", in(c.spots.critical_fraction, "")},
      {"dilatancy", in(c.spots.dilatancy, "")},
      {"full_strain", in(c.spots.full_strain, "")},
      {"spread", in(c.spots.spread, "")},
      {"mobility", in(c.spots.mobility.at_rest, "")},
      {"surface", in(c.spots.surface_exponent, "")},
      {"fade", in(c.spots.fade, "")},
      {"nonaffine", in(c.spots.nonaffine, "")},
      {"steps", c.spots.together ? "together" : "poisson"},
      {"threads", std::to_string(c.threads)},
      {"outlet", *c.outlet == c.outlets.outlets().height() ? "the height of the orifice" : "elsewhere"},
      {"buffer", in(*c.side_buffer / d, " d ") + in(*c.base_buffer / d, " d")},
      {"window", "see above"},
      {"accuracy", std::string(c.accuracy == spot::Accuracy::normal ? "normal" : "another") +
                       ", which sets dz, relax, alpha, momentum and contact"},
      {"strength", c.relaxation.strength == spot::RelaxationStrength::half_each ? "half" : "full"},
      {"closing", in(c.relaxation.closing_gap, "")},
      {"shell", in(c.relaxation.shell, "")},
      {"overlap", in(c.largest_overlap, "")},
      {"average", std::to_string(c.average)},
      {"peratom", c.per_atom ? "yes" : "no"},
      {"recirculate", c.recirculation ? "yes" : "no"}};
  std::map<std::string, std::string> documented;
  const std::string text = section("Default", ".. _Rycroft2006:");
  for (const auto& match : matches(text, "\n\\* (\\w+) = ([^\n]*)")) documented[match[1]] = match[2];
  EXPECT_EQ(documented, defaults);
  const std::set<std::string> set_by_accuracy = {"dz", "relax", "alpha", "momentum", "contact"};
  // Every keyword has a default or is said to have none.
  for (const std::string& keyword : known_keywords()) {
    if (defaults.count(keyword) > 0 || set_by_accuracy.count(keyword) > 0) continue;
    EXPECT_THAT(text.substr(0, text.find("have none")), HasSubstr("*" + keyword + "*"));
  }
}

TEST(SpotDocumentation, SaysWhatEachAccuracySets) {
  const std::vector<std::string> words = {"fast", "normal", "exact"};
  std::map<std::string, std::vector<std::string>> documented, expected = {{"accuracy", words}};
  for (const std::string& word : words) {
    const SpotCommand c = resolved("accuracy " + word);
    const bool ordered = *c.time_ordered;
    expected["dz"].push_back(in(c.spots.step_height, " d"));
    expected["relax"].push_back(ordered ? "every " + std::to_string(c.relaxation.every)
                                        : in(c.relaxation.tolerance, "").insert(0, "tol "));
    expected["alpha"].push_back(in(c.relaxation.alpha, ""));
    expected["momentum"].push_back(ordered ? "--" : in(c.relaxation.momentum, ""));
    expected["contact"].push_back(in(c.relaxation.contact_overlap, ""));
  }
  for (const auto& match :
       matches(documentation(), "\n(\\w+)  +(\\S+(?: \\S+)?)  +(\\S+(?: \\S+)?)  +(\\S+(?: \\S+)?)(?=\n)"))
    documented[match[1]] = {match[2], match[3], match[4]};
  EXPECT_EQ(documented, expected);
}

TEST(SpotDocumentation, HasTheSectionsOfLammps) {
  for (const char* heading :
       {"Syntax", "Examples", "Description", "Output info", "Restart, fix_modify, run start/stop, minimize info",
        "Restrictions", "Related commands", "Default"}) {
    const std::string underlined =
        std::string("\n") + heading + "\n" + std::string(std::string(heading).size(), '"') + "\n";
    EXPECT_THAT(documentation(), HasSubstr(underlined));
  }
}

}  // namespace
