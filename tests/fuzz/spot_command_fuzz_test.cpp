// SPDX-License-Identifier: GPL-2.0-or-later
// Damaged commands: each is either read, and what was read is in range, or refused by a spot::Error that says why.
// SPOT_COMMANDS=n tries n of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "spot/base/errors.hpp"
#include "spot_command.h"

namespace {

using Words = std::vector<std::string>;

Words words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Each of the keywords stands in at least one of them.
const std::vector<std::string> valid = {
    "box -5 5 NULL NULL slot 0 0 0 8 12 speed 3.2 injection 388",
    "box -5 5 -4 4 orifice 0 0 0 3.5 speed 3.2 injection 388",
    "box -5 5 -4 4 orifice 0 0 0 3.5 speed 3.2 outflow 40 fade 0.25",
    "box -25 25 -4 4 orifice 0 0 0 4 speed 3.2 injection 380 volume 77 threads 2 steps together accuracy fast "
    "critical 0.58 1.5 dilatancy 0.1 full_strain 0.2 spread 0.6 0.7 mobility 0.4 1 1.5 surface 3 nonaffine 0.1 0.5",
    "cylinder 0 0 10 orifice 1 -2 0 4 speed 3.2 injection 388 seed 7 accuracy exact overlap 0.1 average 10",
    "region hopper orifice 0 0 0 4 profile uniform radius 2.6 influence 2.5e-3 diffusion 1.25 dz 0.1 speed 3.2 "
    "injection 388 outlet -1 relax every 10 strength full alpha 0.7 shell 2",
    "box -5 5 -4 4 orifice 0 0 0 3.5 speed 3.2 injection 388 relax tol 2e-3 momentum 0.5 contact 1e-3 closing 4e-3 0.1 "
    "window 0.02 "
    "buffer 0.5 0",
    "walls add cone z 0 0 4 12 0 14 walls add cylinder z 0 0 12 14 60 walls cut sphere 0 0 20 3 orifice 0 0 0 4 "
    "speed 2.5 beverloo 1 0.58 1.4 1.03 hopper 24 30 scene scene.json 9.81 peratom yes recirculate region inlet",
    "walls add block -12 12 -16 16 0 60 walls cut plane 4 0 0 14 0 -8 slot -6 0 0 8 32 slot 6 0 0 8 8 speed 2.5 "
    "outflow 30 10 schedule 1 0 1 5 0.5 10 0 schedule 2 v_open persistence 0.4 dilation 0.03 recirculate 40"};

const Words numbers = {"NULL",
                       "nan",
                       "-nan",
                       "inf",
                       "-inf",
                       "-0",
                       "0",
                       "1e308",
                       "-1e308",
                       "1e-320",
                       "5e-324",
                       "1e999",
                       "0x1p3",
                       "0x10",
                       "1e",
                       "+",
                       "-",
                       ".",
                       "1.5.2",
                       "1,5",
                       "++1",
                       "+-1",
                       "1e+-3",
                       "1d3",
                       "1 2",
                       " 1",
                       "1 ",
                       "1\t",
                       "\n",
                       "%n%s",
                       "-1",
                       "4294967296",
                       "9223372036854775808",
                       "18446744073709551616",
                       "-9223372036854775809",
                       "0.000000000000000000000000000000000000000000001",
                       "1e-5",
                       "2",
                       "0.5"};

/// One command, damaged in one to four ways.
class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  Words damaged_command() {
    Words words = words_of(valid[below(valid.size())]);
    for (std::size_t ways = 1 + below(4); ways > 0; --ways) damage(words);
    return words;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  void damage(Words& words) {
    if (words.empty()) return words.push_back(numbers[below(numbers.size())]);
    const std::size_t at = below(words.size());
    const auto place = words.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(9)) {
      case 0:
        words.erase(place);
        break;
      case 1:
        std::swap(words[at], words[below(words.size())]);
        break;
      case 2:
        words.insert(place, std::string(words[below(words.size())]));
        break;
      case 3:
        words.resize(at);
        break;
      case 4:
        corrupt(words[at]);
        break;
      case 5:
        words[at] = below(20) == 0 ? std::string(100000, 'x') : "";
        break;
      case 6: {
        const Words other = words_of(valid[below(valid.size())]);
        words.insert(words.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())), other.end());
        break;
      }
      default:
        words[at] = numbers[below(numbers.size())];
    }
  }

  void corrupt(std::string& word) {
    const auto byte = static_cast<char>(below(256));
    if (word.empty() || below(3) == 0)
      word.insert(word.begin() + static_cast<std::ptrdiff_t>(below(word.size() + 1)), byte);
    else if (below(2) == 0)
      word[below(word.size())] = byte;
    else
      word.erase(below(word.size()), 1);
  }

  std::mt19937 random_;
};

/// What the fix takes for granted of a command that was read.
void expect_in_range(const SpotCommand& command) {
  for (const spot::Outlet& outlet : command.outlets.outlets()) {
    EXPECT_TRUE(outlet.centre.allFinite());
    EXPECT_TRUE(outlet.hole->widest_radius() > 0.0 && std::isfinite(outlet.hole->widest_radius()));
  }
  EXPECT_FALSE(std::holds_alternative<std::monostate>(command.walls));
  EXPECT_TRUE(std::isfinite(*command.outlet));
  EXPECT_TRUE(*command.side_buffer >= 0.0 && *command.base_buffer >= 0.0);
  EXPECT_TRUE(!command.window || (*command.window > 0.0 && std::isfinite(*command.window)));
  EXPECT_TRUE(command.largest_overlap > 0.0 && std::isfinite(command.largest_overlap));
  EXPECT_TRUE(command.relaxation.tolerance > 0.0 && std::isfinite(command.relaxation.tolerance));
  EXPECT_GE(command.threads, 1);
  EXPECT_GE(command.average, 1);
}

/// As the parser names them.
Words known_keywords() {
  try {
    parse_spot_command({"?"});
  } catch (const spot::InvalidParameter& error) {
    const std::string text = error.what(), before = "known are:";
    if (text.find(before) != std::string::npos) return words_of(text.substr(text.find(before) + before.size()));
  }
  return {};
}

TEST(SpotCommandFuzz, EachKeywordStandsInAValidCommand) {
  Words all;
  for (const std::string& text : valid) {
    SCOPED_TRACE(text);
    EXPECT_NO_THROW(parse_spot_command(words_of(text)));
    const Words words = words_of(text);
    all.insert(all.end(), words.begin(), words.end());
  }
  const Words known = known_keywords();
  EXPECT_GT(known.size(), 30u);
  for (const std::string& keyword : known)
    EXPECT_TRUE(std::find(all.begin(), all.end(), keyword) != all.end()) << "no command has '" << keyword << "'";
}

struct Counts {
  int read = 0, refused = 0;
};

void try_command(const Words& words, Counts& counts) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "'" : " '") + word.substr(0, 100) + "'";
  SCOPED_TRACE(text);
  try {
    SpotCommand command = parse_spot_command(words);
    command.resolve(1.0);
    command.spots.validate();
    command.relaxation.validate();
    expect_in_range(command);
    ++counts.read;
  } catch (const spot::Error& error) {
    EXPECT_STRNE(error.what(), "");
    ++counts.refused;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "no spot::Error: " << error.what();
  }
}

int commands_to_try() {
  const char* text = std::getenv("SPOT_COMMANDS");
  return text == nullptr ? 50000 : std::atoi(text);
}

TEST(SpotCommandFuzz, DamagedCommandsAreReadOrRefused) {
  Damage damage(2006);
  Counts counts;
  for (int k = 0; k < commands_to_try() && !HasFailure(); ++k) try_command(damage.damaged_command(), counts);
  // Both happen all the time.
  EXPECT_GT(counts.read, commands_to_try() / 50);
  EXPECT_GT(counts.refused, commands_to_try() / 2);
}

TEST(SpotCommandFuzz, EveryBeginningOfAValidCommandIsReadOrRefused) {
  Counts counts;
  for (const std::string& text : valid) {
    const Words words = words_of(text);
    for (std::size_t n = 0; n <= words.size(); ++n)
      try_command({words.begin(), words.begin() + static_cast<std::ptrdiff_t>(n)}, counts);
  }
  EXPECT_GE(counts.read, static_cast<int>(valid.size()));
}

}  // namespace
