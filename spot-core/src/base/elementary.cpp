// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/elementary.hpp"

#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace spot {

namespace {

static_assert(std::numeric_limits<double>::is_iec559 && FLT_EVAL_METHOD == 0, "bits rest on IEEE's double");

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

/// The sum of two doubles, the second no larger than half a unit in the last place of the first: some 106 bits. Not for
/// numbers so small or large that their products leave the range of a double.
struct Wide {
  double high, low;
};

// Dekker, Numer. Math. 18, 224 (1971): what +, - and * of doubles leave behind, exactly.

/// Where |a| >= |b|, or nearly.
constexpr Wide sum_of_ordered(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

constexpr Wide sum_of(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  return {sum, (a - (sum - of_b)) + (b - of_b)};
}

/// The upper 26 bits and the rest.
constexpr Wide halves_of(double a) {
  const double shifted = 134217729.0 * a;  // 2^27 + 1
  const double high = shifted - (shifted - a);
  return {high, a - high};
}

constexpr Wide product_of(double a, double b) {
  const double product = a * b;
  const Wide x = halves_of(a), y = halves_of(b);
  return {product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

constexpr Wide operator+(const Wide& a, const Wide& b) {
  const Wide sum = sum_of(a.high, b.high);
  return sum_of_ordered(sum.high, sum.low + (a.low + b.low));
}

constexpr Wide operator-(const Wide& a) { return {-a.high, -a.low}; }
constexpr Wide operator-(const Wide& a, const Wide& b) { return a + -b; }

constexpr Wide operator*(const Wide& a, const Wide& b) {
  const Wide product = product_of(a.high, b.high);
  return sum_of_ordered(product.high, product.low + (a.high * b.low + a.low * b.high));
}

/// Long division, two digits of it.
constexpr Wide operator/(const Wide& a, const Wide& b) {
  const double first = a.high / b.high;
  const Wide rest = a - b * Wide{first, 0.0};
  return sum_of_ordered(first, (rest.high + rest.low) / b.high);
}

constexpr Wide wide(double a) { return {a, 0.0}; }

constexpr Wide ln_2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
constexpr Wide two_pi = {0x1.921fb54442d18p+2, 0x1.1a62633145c07p-52};

/// 1/n!
constexpr std::size_t factorials = 20;
constexpr std::array<Wide, factorials> inverse_factorials = [] {
  std::array<Wide, factorials> all{wide(1.0)};
  for (std::size_t n = 1; n < factorials; ++n) all[n] = all[n - 1] / wide(static_cast<double>(n));
  return all;
}();

/// 1/(2 n + 1)
constexpr std::size_t odds = 14;
constexpr std::array<Wide, odds> inverse_odds = [] {
  std::array<Wide, odds> all{};
  for (std::size_t n = 0; n < odds; ++n) all[n] = wide(1.0) / wide(static_cast<double>(2 * n + 1));
  return all;
}();

/// The sum of coefficients[first + k * step] x^k for k < terms. From `few` on terms are below 2^-18 of the first, and
/// those bits of a double are enough.
Wide series(const Wide* coefficients, std::size_t first, std::size_t step, std::size_t few, std::size_t terms,
            const Wide& x) {
  std::size_t k = terms - 1;
  double rest = coefficients[first + k * step].high;
  while (k > few) rest = rest * x.high + coefficients[first + --k * step].high;
  Wide sum = wide(rest);
  while (k > 0) sum = sum * x + coefficients[first + --k * step];
  return sum;
}

// A double is a sign, 11 bits of exponent, and 52 of what follows its first binary place.
constexpr int places = 52, bias = 1023;

std::uint64_t bits_of(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

double of_bits(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// x 2^k, for k no larger than twice what a double has; rounded once, if at all.
double scaled(double x, int k) {
  const auto power = [](int n) { return of_bits(static_cast<std::uint64_t>(n + bias) << places); };
  return x * power(k / 2) * power(k - k / 2);
}

/// Of a finite x above 0: k log 2 + 2 artanh((m - 1) / (m + 1)), where x = 2^k m and m is from 0.71 to 1.41.
Wide log_of(const Wide& x) {
  constexpr double least_normal = 0x1p-1022, sqrt_2 = 1.4142135623730951;
  const int more = x.high < least_normal ? places : 0;
  const std::uint64_t bits = bits_of(x.high * (more > 0 ? 0x1p52 : 1.0));
  constexpr std::uint64_t fraction = (std::uint64_t{1} << places) - 1;
  double high = of_bits((bits & fraction) | static_cast<std::uint64_t>(bias) << places);
  int k = static_cast<int>(bits >> places) - bias - more;
  if (high > sqrt_2) {
    high *= 0.5;
    ++k;
  }
  const Wide m = {high, scaled(x.low, -k)};
  const Wide s = (m - wide(1.0)) / (m + wide(1.0));
  return ln_2 * wide(k) + wide(2.0) * s * series(inverse_odds.data(), 0, 1, 3, odds, s * s);
}

/// 2^k e^r, where r is near 0.
double exp_of(const Wide& x) {
  constexpr double beyond = 800.0;  // all range of a double
  if (x.high > beyond) return infinity;
  if (x.high < -beyond) return 0.0;
  const double k = std::floor(x.high / ln_2.high + 0.5);
  return scaled(series(inverse_factorials.data(), 0, 1, 6, 18, x - ln_2 * wide(k)).high, static_cast<int>(k));
}

/// Cosine, or sine, of so many turns, which are found in a quarter turn that begins at an eighth.
double of_turns(double turns, bool sine) {
  if (!std::isfinite(turns)) return nan;
  if (std::abs(turns) >= 0x1p53) return sine ? 0.0 : 1.0;
  const double quarter = std::nearbyint(4.0 * turns);
  const double rest = turns - 0.25 * quarter;  // exact
  // The sine is the cosine three quarters farther on.
  const double number = quarter - 4.0 * std::floor(0.25 * quarter) + (sine ? 3.0 : 0.0);
  const bool odd = number == 1.0 || number == 3.0 || number == 5.0;
  if (odd && rest == 0.0) return 0.0;
  const Wide angle = two_pi * wide(rest), minus_square = -(angle * angle);
  // The series of the sine has 1/n! for odd n, with alternating signs.
  const Wide value = odd ? angle * series(inverse_factorials.data(), 1, 2, 4, 10, minus_square)
                         : series(inverse_factorials.data(), 0, 2, 4, 10, minus_square);
  return number == 1.0 || number == 2.0 || number == 5.0 || number == 6.0 ? -value.high : value.high;
}

}  // namespace

double exp(double x) { return std::isnan(x) ? x : exp_of(wide(x)); }

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -infinity : nan;
  return std::isinf(x) ? x : log_of(wide(x)).high;
}

double log1p(double x) {
  constexpr double x_itself_below = 0x1p-60;
  if (std::abs(x) < x_itself_below) return x;
  if (!(x > -1.0)) return x == -1.0 ? -infinity : nan;
  return std::isinf(x) ? x : log_of(sum_of(1.0, x)).high;
}

double pow(double base, double exponent) {
  if (exponent == 0.0 || base == 1.0) return 1.0;
  if (std::isnan(exponent) || !(base >= 0.0)) return nan;
  const bool grows = (base > 1.0) == (exponent > 0.0);
  if (base == 0.0 || std::isinf(base) || std::isinf(exponent)) return grows ? infinity : 0.0;
  const Wide log_of_base = log_of(wide(base));
  constexpr double beyond = 800.0;  // all range of a double
  if (std::abs(log_of_base.high * exponent) > beyond) return grows ? infinity : 0.0;
  return exp_of(log_of_base * wide(exponent));
}

double cbrt(double x) {
  if (x == 0.0 || !std::isfinite(x)) return x;
  const double root = exp_of(log_of(wide(std::abs(x))) / wide(3.0));
  return x < 0.0 ? -root : root;
}

double cos_of_turns(double turns) { return of_turns(turns, false); }

double sin_of_turns(double turns) { return turns == 0.0 ? turns : of_turns(turns, true); }

}  // namespace spot
