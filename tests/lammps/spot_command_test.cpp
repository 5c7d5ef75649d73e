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

#include "spot/errors.hpp"

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

TEST(SpotCommand, ReadsEveryKeyword) {
  const SpotCommand c = parse(
      "region silo orifice 1 -2 +3 4e0 radius 2.5 influence 1e-3 diffusion 1.5 dz 0.2 speed 2 injection 300 seed 17 "
      "outlet -1.5 buffer 0.5 0 window 0.25 relax every 10 strength full alpha 0.7 shell 2 overlap 0.1 average 5");
  EXPECT_TRUE(c.uses_region());
  EXPECT_EQ(std::get<RegionWalls>(c.walls).id, "silo");
  EXPECT_EQ(c.orifice->centre, spot::Vector3(1, -2, 3));
  EXPECT_EQ(c.orifice->radius, 4.0);
  EXPECT_EQ(c.spots.radius, 2.5);
  EXPECT_EQ(c.spots.influence, 1e-3);
  EXPECT_EQ(c.diffusion_length, 1.5);
  EXPECT_EQ(c.spots.step_height, 0.2);
  EXPECT_EQ(c.spots.speed, 2.0);
  EXPECT_EQ(c.spots.injection_rate, 300.0);
  EXPECT_EQ(c.spots.seed, 17U);
  EXPECT_EQ(c.outlet, -1.5);
  EXPECT_EQ(c.side_buffer, 0.5);
  EXPECT_EQ(c.base_buffer, 0.0);
  EXPECT_EQ(c.window, 0.25);
  EXPECT_EQ(c.relaxation.every, 10);
  EXPECT_EQ(c.relaxation.strength, spot::RelaxationStrength::full_each);
  EXPECT_EQ(c.relaxation.alpha, 0.7);
  EXPECT_EQ(c.relaxation.shell, 2.0);
  EXPECT_EQ(c.largest_overlap, 0.1);
  EXPECT_EQ(c.average, 5);
}

TEST(SpotCommand, ReadsWalls) {
  const auto box = std::get<BoxWalls>(parse(complete).walls);
  EXPECT_EQ(box.x_low, -5.0);
  EXPECT_EQ(box.x_high, 5.0);
  EXPECT_EQ(box.y_low, -4.0);
  EXPECT_EQ(box.y_high, 4.0);
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

/// Random commands: either they are read, and then what was read is in range, or the error is InvalidParameter.
TEST(SpotCommand, RandomWordsGiveNoOtherError) {
  const std::vector<std::string> vocabulary = {"box",       "cylinder", "region",
                                               "orifice",   "radius",   "influence",
                                               "diffusion", "dz",       "speed",
                                               "injection", "seed",     "outlet",
                                               "buffer",    "window",   "relax",
                                               "strength",  "alpha",    "shell",
                                               "every",     "never",    "half",
                                               "full",      "1",        "-1",
                                               "0",         "2.5",      "1e308",
                                               "-0",        "nan",      "inf",
                                               "1e-320",    "overlap",  "average",
                                               "",          " ",        "\xff\xfe",
                                               "%s",        "+",        "18446744073709551616",
                                               "silo"};
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
      EXPECT_GT(command.spots.injection_rate, 0.0);
      EXPECT_GE(command.average, 1);
      EXPECT_TRUE(command.orifice.has_value());
      command.resolve(1.0);
    } catch (const InvalidParameter& error) {
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

std::set<std::string> known_keywords() {
  const std::string error = error_of("?");
  const auto words = words_of(error.substr(error.find("known are:") + 10));
  return {words.begin(), words.end()};
}

TEST(SpotDocumentation, ListsTheKeywords) {
  const std::string syntax = section("Syntax", "Examples");
  std::set<std::string> explained, listed;
  for (const auto& match : matches(syntax, "\n +\\*(\\w+)\\* values? =")) explained.insert(match[1]);
  const auto list = matches(syntax, "\n\\* keyword = ([^\n]*)");
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
              HasSubstr("*orifice*, *speed*, *injection* and one of *box*, *cylinder*, *region* are required"));
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
      {"influence", in(c.spots.influence, "")},
      {"diffusion", in(c.spots.diffusion_length() / d, " d")},
      {"dz", in(c.spots.step_height / d, " d")},
      {"seed", std::to_string(c.spots.seed)},
      {"outlet", in((c.orifice->centre.z() - *c.outlet) / d, " d below the orifice")},
      {"buffer", in(*c.side_buffer / d, " d ") + in(*c.base_buffer / d, " d")},
      {"window", "the timestep"},
      {"relax", "every " + std::to_string(c.relaxation.every)},
      {"strength", c.relaxation.strength == spot::RelaxationStrength::half_each ? "half" : "full"},
      {"alpha", in(c.relaxation.alpha, "")},
      {"shell", in(c.relaxation.shell, "")},
      {"overlap", in(c.largest_overlap, "")},
      {"average", std::to_string(c.average)}};
  std::map<std::string, std::string> documented;
  const std::string text = section("Default", ".. _Rycroft2006:");
  for (const auto& match : matches(text, "\n\\* (\\w+) = ([^\n]*)")) documented[match[1]] = match[2];
  EXPECT_EQ(documented, defaults);
  // Every keyword has a default or is said to have none.
  for (const std::string& keyword : known_keywords()) {
    if (defaults.count(keyword) > 0) continue;
    EXPECT_THAT(text.substr(0, text.find("have none")), HasSubstr("*" + keyword + "*"));
  }
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
