// SPDX-License-Identifier: GPL-2.0-or-later
// Bits against recorded ones, values against the C library's long double, and what holds of the functions themselves.
#include "spot/base/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "scenes.hpp"

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

// ---- bits, rounded from 100 decimal places (Python's decimal)

using Known = std::vector<std::pair<double, double>>;  // argument and value

template <typename Function>
void expect_known(const Known& known, const Function& function) {
  for (const auto& [x, value] : known) EXPECT_EQ(function(x), value) << std::hexfloat << x;
}

TEST(ElementaryUnit, GivesTheKnownBits) {
  const Known of_exp = {
      {0x1p+0, 0x1.5bf0a8b145769p+1},
      {-0x1p+0, 0x1.78b56362cef38p-2},
      {0x1.3333333333333p-2, 0x1.599058c8c1a96p+0},
      {-0x1.999999999999ap-4, 0x1.cf46d99d52b3ap-1},
      {0x1.12e0be826d695p-30, 0x1.000000044b830p+0},
      {-0x1.5e20000000000p+9, 0x1.af5fe9a485c8ep-1011},
      {0x1.62d999999999ap+9, 0x1.d75ae7a50ee14p+1023},
      {0x1.29c145c0b7eaep+4, 0x1.ccd5545856ea3p+26},
      {-0x1.388a7eb64b6e2p+4, 0x1.c386b600c8723p-29},
      {0x1.2e11bbe5c9c98p+3, 0x1.890c003eb548dp+13},
      {-0x1.b5be63edeaf42p+3, 0x1.338c330698226p-20},
      {0x1.3741db131db20p+4, 0x1.0be7d176772ddp+28},
  };
  expect_known(of_exp, spot::exp);
  const Known of_log = {
      {0x1p+1, 0x1.62e42fefa39efp-1},
      {0x1.4000000000000p+3, 0x1.26bb1bbb55516p+1},
      {0x1p-1, -0x1.62e42fefa39efp-1},
      {0x1.000001ad7f29bp+0, 0x1.ad7f2847b6492p-24},
      {0x1.fffffca501acbp-1, -0x1.ad7f2b1049b9fp-24},
      {0x1p-1074, -0x1.74385446d71c3p+9},
      {0x1.e42d130773b76p+1023, 0x1.62dd08fdc6f88p+9},
      {0x1.4663cc850cadcp-39, -0x1.aca31f88189e2p+4},
      {0x1.4865e222e4e32p+30, 0x1.50b207858546bp+4},
      {0x1.6c10b2e72150bp+14, 0x1.41cc85c92b9dcp+3},
      {0x1.80a5967a39ac0p+28, 0x1.3d0b57b5913a3p+4},
      {0x1.facf23d06f6dcp+39, 0x1.bb737ec83fe6ap+4},
  };
  expect_known(of_log, spot::log);
  const Known of_log1p = {
      {-0x1p-53, -0x1p-53},
      {-0x1p-1, -0x1.62e42fefa39efp-1},
      {-0x1.fffffffffffffp-1, -0x1.25e4f7b2737fap+5},
      {0x1.70ef54646d497p-57, 0x1.70ef54646d497p-57},
      {-0x1.4f8b588e368f1p-17, -0x1.4f8bc681e6006p-17},
      {0x1.7e43c8800759cp+996, 0x1.5963447f87fb5p+9},
      {-0x1.eaefcb1dfc388p-3, -0x1.18a3bfed6ce68p-2},
      {-0x1.5a310e3bb0b1ap-2, -0x1.a6827faad43cbp-2},
      {-0x1.6a987296c46ecp-1, -0x1.3b4e8b06e1d5bp+0},
      {-0x1.1f50ce323616ap-2, -0x1.51373db77dd59p-2},
      {-0x1.0da240ac1354cp-2, -0x1.38ed9a02e2e81p-2},
      {-0x1.d43155ef5e7d4p-3, -0x1.09ca51284ffacp-2},
  };
  expect_known(of_log1p, spot::log1p);
  const Known of_cbrt = {
      {0x1p+1, 0x1.428a2f98d728bp+0},
      {0x1.999999999999ap-2, 0x1.793eace1a3426p-1},
      {0x0.012688b70e62bp-1022, 0x1.a9d1b0b5d7427p-344},
      {0x1.1ccf385ebc8a0p+1023, 0x1.09438d5a385e9p+341},
      {0x1.8000000000000p+1, 0x1.7137449123ef6p+0},
      {0x1.c7b14c1783f88p+5, 0x1.ec7f569cce303p+1},
      {0x1.7416422cb387ap+6, 0x1.21fc085a178f1p+2},
      {0x1.023a7efa87879p+6, 0x1.00bd9dbe88ff4p+2},
      {0x1.44149135b05a4p+5, 0x1.b79b4a0fe42adp+1},
      {0x1.596df9fc7b33fp+6, 0x1.1ae3199dc3974p+2},
  };
  expect_known(of_cbrt, spot::cbrt);
  const Known of_cos = {
      {0x1.999999999999ap-4, 0x1.9e3779b97f4a8p-1},  {0x1p-3, 0x1.6a09e667f3bcdp-1},
      {0x1.3333333333333p-2, -0x1.3c6ef372fe94ep-2}, {0x1.0a3d70a3d70a4p-2, -0x1.0130a1be0937dp-4},
      {0x1.fffffca501acbp-1, 0x1.ffffffffff90ep-1},  {-0x1.b333333333333p+0, -0x1.3c6ef372fe954p-2},
      {0x1.fd874dc436b4cp-1, 0x1.ffc3b82faad33p-1},  {0x1.f605ce7ac76cep-2, -0x1.ff0a7462acd65p-1},
      {0x1.e3da4ab5af221p-1, 0x1.e1c20b3019c11p-1},  {0x1.33336990d0b60p-6, 0x1.fc7376c16c9cap-1},
      {0x1.1f5f1b88b0208p-3, 0x1.4592677a60496p-1},  {0x1.60a7839d32460p-3, 0x1.e0e574e42426ep-2},
  };
  expect_known(of_cos, spot::cos_of_turns);
  const Known of_sin = {
      {0x1.999999999999ap-4, 0x1.2cf2304755a5ep-1},     {0x1p-3, 0x1.6a09e667f3bcdp-1},
      {0x1.3333333333333p-2, 0x1.e6f0e13445500p-1},     {0x1.051eb851eb852p-1, -0x1.0130a1be0937dp-4},
      {0x1.56e1fc2f8f359p-997, 0x1.0d4cab14b6bc0p-994}, {-0x1.b333333333333p+0, 0x1.e6f0e134454ffp-1},
      {0x1.e04a07323d03ap-1, -0x1.84821556777d2p-2},    {0x1.61873e7605a5cp-1, -0x1.dc9e1eea1bcbfp-1},
      {0x1.702b8f811cc62p-1, -0x1.f65e9aa02616dp-1},    {0x1.257ef6c3d691ep-2, 0x1.f2823dccea420p-1},
      {0x1.fadd5e136a916p-2, 0x1.0215b4126d922p-5},     {0x1.c62d5936c17b3p-1, -0x1.4d94b7090016dp-1},
  };
  expect_known(of_sin, spot::sin_of_turns);
  struct Power {
    double base, exponent, value;
  };
  const std::vector<Power> powers = {
      {0x1p+1, 0x1p-1, 0x1.6a09e667f3bcdp+0},
      {0x1.4000000000000p+3, -0x1.8000000000000p+1, 0x1.0624dd2f1a9fcp-10},
      {0x1.999999999999ap-4, 0x1.999999999999ap-4, 0x1.96b230bcdc434p-1},
      {0x1.000001ad7f29bp+0, 0x1.dcd6500000000p+29, 0x1.349445c228792p+144},
      {0x1.56e1fc2f8f359p-997, 0x1.07ae147ae147bp+0, 0x0.0b8157268fdabp-1022},
      {0x1.128da93786c35p+3, 0x1.1fa41b42189b8p+1, 0x1.f4ea82f0cd38ep+6},
      {0x1.fe9a9012cdf9ep+2, -0x1.a8df00c55141fp+0, 0x1.04f0e9732a2f2p-5},
      {0x1.27f8e8be79d27p+3, 0x1.176d850bacec0p-4, 0x1.29f3d8ced60f6p+0},
      {0x1.2928618321af6p+1, -0x1.112e8c7a5c270p-2, 0x1.98f78d9ecd3bcp-1},
      {0x1.0d176bd869192p+2, -0x1.435bf8d3bbd68p+1, 0x1.b3431be6a16b6p-6},
      {0x1.69ae63f86b511p+2, -0x1.ae3070574ed00p-1, 0x1.ddeed002df77cp-3},
  };
  for (const auto& [base, exponent, value] : powers)
    EXPECT_EQ(spot::pow(base, exponent), value) << std::hexfloat << base << ' ' << exponent;
}

// ---- accuracy

/// In units in the last place of the result.
long double error(double result, long double exact) {
  const double least = std::numeric_limits<double>::denorm_min();
  const double place = std::isinf(result) ? infinity : std::nextafter(std::abs(result), infinity) - std::abs(result);
  return std::abs(static_cast<long double>(result) - exact) / std::max(place, least);
}

/// Half a unit for the rounding, and what long double itself may be off by: two units of its 64 bits.
constexpr long double allowed = 0.502L;

/// The largest error over n draws of an argument.
template <typename Draw, typename Function, typename Exact>
void expect_accurate(const char* name, int n, const Draw& draw, const Function& function, const Exact& exact) {
  if (std::numeric_limits<long double>::digits < 64) GTEST_SKIP() << "long double has no more digits than double";
  long double largest = 0.0L;
  double where = 0.0;
  for (int k = 0; k < n; ++k) {
    const double x = draw();
    const long double here = error(function(x), exact(static_cast<long double>(x)));
    if (!(here <= largest)) {
      largest = here;
      where = x;
    }
  }
  EXPECT_LE(largest, allowed) << name << " at " << std::hexfloat << where;
}

constexpr int n_draws = 200000;
constexpr long double two_pi = 6.28318530717958647692528676655900577L;

/// Of 2 pi x: by the symmetries of the circle from an angle of at most a quarter turn, which is exact.
long double sine_of_turns(long double x) {
  long double rest = std::remainder(x, 1.0L);
  if (std::abs(rest) > 0.25L) rest = std::copysign(0.5L, rest) - rest;
  return std::abs(rest) > 0.125L ? std::copysign(std::cos(two_pi * (0.25L - std::abs(rest))), rest)
                                 : std::sin(two_pi * rest);
}

long double cosine_of_turns(long double x) {
  const long double rest = std::abs(std::remainder(x, 1.0L));
  return rest < 0.125L ? std::cos(two_pi * rest) : sine_of_turns(0.25L - rest);
}

TEST(ElementaryBruteForce, ExpIsRoundedWell) {
  scenes::Draws draws(1);
  const auto exact = [](long double x) { return std::exp(x); };
  expect_accurate(
      "exp", n_draws, [&] { return draws.uniform(-708.0, 709.0); }, spot::exp, exact);
  expect_accurate(
      "exp", n_draws, [&] { return draws.uniform(-1.0, 1.0); }, spot::exp, exact);
  expect_accurate(
      "exp", n_draws, [&] { return std::ldexp(draws.uniform(-1.0, 1.0), -40); }, spot::exp, exact);
}

TEST(ElementaryBruteForce, LogIsRoundedWell) {
  scenes::Draws draws(2);
  const auto exact = [](long double x) { return std::log(x); };
  const auto any = [&] { return std::ldexp(draws.uniform(0.5, 1.0), static_cast<int>(draws.below(2000)) - 1000); };
  expect_accurate("log", n_draws, any, spot::log, exact);
  expect_accurate(
      "log", n_draws, [&] { return draws.uniform(0.5, 1.5); }, spot::log, exact);
  expect_accurate(
      "log", n_draws, [&] { return 1.0 + std::ldexp(draws.uniform(-1.0, 1.0), -30); }, spot::log, exact);
}

/// What waiting times are made of: uniform numbers that are multiples of 2^-53, and small ones.
TEST(ElementaryBruteForce, Log1pIsRoundedWell) {
  scenes::Draws draws(3);
  const auto exact = [](long double x) { return std::log1p(x); };
  expect_accurate(
      "log1p", n_draws, [&] { return -draws.uniform(0.0, 1.0); }, spot::log1p, exact);
  expect_accurate(
      "log1p", n_draws, [&] { return std::ldexp(draws.uniform(-1.0, 1.0), -30); }, spot::log1p, exact);
  expect_accurate(
      "log1p", n_draws, [&] { return std::ldexp(draws.uniform(-1.0, 1.0), -59); }, spot::log1p, exact);
  expect_accurate(
      "log1p", n_draws, [&] { return draws.uniform(0.0, 1e6); }, spot::log1p, exact);
}

TEST(ElementaryBruteForce, PowIsRoundedWell) {
  scenes::Draws draws(4);
  // Long double's error grows with the logarithm, so exponents stay where it is small enough to judge by.
  for (const double exponent : {-3.0, -1.5, -0.25, 1e-3, 0.35, 0.5, 1.0, 1.7, 2.0, 4.0}) {
    const auto power = [&](double base) { return spot::pow(base, exponent); };
    const auto exact = [&](long double base) { return std::pow(base, static_cast<long double>(exponent)); };
    expect_accurate(
        "pow", n_draws / 10, [&] { return draws.uniform(1e-3, 2.0); }, power, exact);
    expect_accurate(
        "pow", n_draws / 10, [&] { return draws.uniform(1.0, 1e3); }, power, exact);
  }
}

TEST(ElementaryBruteForce, CbrtIsRoundedWell) {
  scenes::Draws draws(5);
  const auto any = [&] { return std::ldexp(draws.uniform(-1.0, 1.0), static_cast<int>(draws.below(2000)) - 1000); };
  expect_accurate("cbrt", n_draws, any, spot::cbrt, [](long double x) { return std::cbrt(x); });
}

TEST(ElementaryBruteForce, SineAndCosineAreRoundedWell) {
  scenes::Draws draws(6);
  for (const double range : {1e-9, 0.25, 1.0, 1000.0}) {
    const auto draw = [&] { return draws.uniform(-range, range); };
    expect_accurate("sine", n_draws / 2, draw, spot::sin_of_turns, sine_of_turns);
    expect_accurate("cosine", n_draws / 2, draw, spot::cos_of_turns, cosine_of_turns);
  }
}

// ---- what holds of them

/// Neighbouring arguments never change the order of the values: of two uniform numbers the larger waits longer.
TEST(ElementaryUnit, GrowWithTheirArguments) {
  scenes::Draws draws(7);
  for (int k = 0; k < 50000; ++k) {
    const double u = draws.uniform(0.0, 1.0), next = std::nextafter(u, 1.0);
    ASSERT_LE(-spot::log1p(-u), -spot::log1p(-next)) << u;
    const double x = draws.uniform(-700.0, 700.0);
    ASSERT_LE(spot::exp(x), spot::exp(std::nextafter(x, infinity))) << x;
    ASSERT_LE(spot::cbrt(x), spot::cbrt(std::nextafter(x, infinity))) << x;
    ASSERT_LE(spot::log(u), spot::log(next)) << u;
    ASSERT_LE(spot::pow(u, 1.7), spot::pow(next, 1.7)) << u;
    ASSERT_LE(spot::sin_of_turns(0.25 * u), spot::sin_of_turns(0.25 * next)) << u;
    ASSERT_GE(spot::cos_of_turns(0.25 * u), spot::cos_of_turns(0.25 * next)) << u;
  }
}

TEST(ElementaryUnit, ExpAtTheEndsOfItsRange) {
  EXPECT_EQ(spot::exp(0.0), 1.0);
  EXPECT_EQ(spot::exp(-0.0), 1.0);
  EXPECT_EQ(spot::exp(709.79), infinity);
  EXPECT_EQ(spot::exp(infinity), infinity);
  EXPECT_EQ(spot::exp(std::numeric_limits<double>::max()), infinity);
  EXPECT_EQ(spot::exp(-745.14), 0.0);
  EXPECT_EQ(spot::exp(-infinity), 0.0);
  EXPECT_EQ(spot::exp(-745.13), 0x1p-1074);
  EXPECT_TRUE(std::isnan(spot::exp(nan)));
}

TEST(ElementaryUnit, LogarithmsAtTheEndsOfTheirRange) {
  EXPECT_EQ(spot::log(1.0), 0.0);
  EXPECT_EQ(spot::log(0.0), -infinity);
  EXPECT_EQ(spot::log(infinity), infinity);
  EXPECT_EQ(spot::log1p(0.0), 0.0);
  EXPECT_TRUE(std::signbit(spot::log1p(-0.0)));
  EXPECT_EQ(spot::log1p(-1.0), -infinity);
  EXPECT_EQ(spot::log1p(infinity), infinity);
  EXPECT_EQ(spot::log1p(5e-324), 5e-324);
  EXPECT_EQ(spot::log1p(0x1p-60), 0x1p-60);
  for (const double bad : {-1.5, -infinity, nan}) {
    EXPECT_TRUE(std::isnan(spot::log(bad)));
    EXPECT_TRUE(std::isnan(spot::log1p(bad)));
  }
}

TEST(ElementaryUnit, PowersOfSpecialBases) {
  for (const double base : {0.0, 0.5, 1.0, 2.0, infinity}) EXPECT_EQ(spot::pow(base, 0.0), 1.0);
  for (const double exponent : {-infinity, -2.0, 3.0, infinity}) EXPECT_EQ(spot::pow(1.0, exponent), 1.0);
  for (const double zero : {0.0, -0.0}) {
    EXPECT_EQ(spot::pow(zero, 1e-9), 0.0);
    EXPECT_EQ(spot::pow(zero, -2.0), infinity);
  }
  EXPECT_EQ(spot::pow(infinity, 0.1), infinity);
  EXPECT_EQ(spot::pow(infinity, -0.1), 0.0);
  EXPECT_EQ(spot::pow(2.0, infinity), infinity);
  EXPECT_EQ(spot::pow(0.5, infinity), 0.0);
  EXPECT_EQ(spot::pow(0.5, -infinity), infinity);
  EXPECT_EQ(spot::pow(2.0, 1e300), infinity);
  EXPECT_EQ(spot::pow(std::nextafter(1.0, 0.0), 1e300), 0.0);
  EXPECT_EQ(spot::pow(3.0, 1e-320), 1.0);
  for (const double bad : {-1.0, -infinity, nan}) EXPECT_TRUE(std::isnan(spot::pow(bad, 2.0)));
  EXPECT_TRUE(std::isnan(spot::pow(2.0, nan)));
}

TEST(ElementaryUnit, WholePowersAndCubesAreExact) {
  for (int base = 2; base <= 100; ++base) {
    EXPECT_EQ(spot::cbrt(1.0 * base * base * base), base);
    EXPECT_EQ(spot::cbrt(-1.0 * base * base * base), -base);
    EXPECT_EQ(spot::pow(base, 1.0), base);
    EXPECT_EQ(spot::pow(base, 3.0), 1.0 * base * base * base);
    EXPECT_EQ(spot::pow(1.0 * base * base, 0.5), base);
  }
  for (int k = -1074; k < 1024; ++k) EXPECT_EQ(spot::pow(2.0, k), std::ldexp(1.0, k)) << k;
  EXPECT_EQ(spot::cbrt(0.0), 0.0);
  EXPECT_EQ(spot::cbrt(infinity), infinity);
  EXPECT_TRUE(std::isnan(spot::cbrt(nan)));
}

TEST(ElementaryUnit, QuarterTurnsAreExact) {
  for (const double whole : {0.0, 1.0, -3.0, 1e9, 0x1p50}) {
    EXPECT_EQ(spot::cos_of_turns(whole), 1.0);
    EXPECT_EQ(spot::sin_of_turns(whole), 0.0);
    EXPECT_EQ(spot::cos_of_turns(whole + 0.25), 0.0);
    EXPECT_EQ(spot::sin_of_turns(whole + 0.25), 1.0);
    EXPECT_EQ(spot::cos_of_turns(whole + 0.5), -1.0);
    EXPECT_EQ(spot::sin_of_turns(whole + 0.5), 0.0);
    EXPECT_EQ(spot::cos_of_turns(whole - 0.25), 0.0);
    EXPECT_EQ(spot::sin_of_turns(whole - 0.25), -1.0);
  }
  EXPECT_EQ(spot::cos_of_turns(0x1p1000), 1.0);
  EXPECT_EQ(spot::sin_of_turns(-0x1p1000), 0.0);
  for (const double bad : {infinity, -infinity, nan}) {
    EXPECT_TRUE(std::isnan(spot::cos_of_turns(bad)));
    EXPECT_TRUE(std::isnan(spot::sin_of_turns(bad)));
  }
}

}  // namespace
