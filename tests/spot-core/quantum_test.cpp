// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/quantum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "scenes.hpp"

namespace {

using spot::InvalidParameter;
using spot::Quantum;
using testing::AllOf;
using testing::HasSubstr;

bool is_power_of_two(double value) {
  int exponent;
  return std::frexp(value, &exponent) == 0.5;
}

TEST(QuantumUnit, IsAPowerOfTwoNear2ToTheMinus40Diameters) {
  for (const double d : {1.0, 3e-3, 0.006, 1.7, 1024.0}) {
    const Quantum quantum(d, 300.0 * d);
    EXPECT_TRUE(is_power_of_two(quantum.length())) << d;
    EXPECT_LE(quantum.length(), std::ldexp(d, -40)) << d;
    EXPECT_GT(quantum.length(), std::ldexp(d, -41)) << d;
  }
}

TEST(QuantumUnit, HasAsManyBitsAsAskedFor) {
  for (const int bits : {20, 24, 30, 40})
    for (const double d : {1.0, 3e-3, 1.7, 1024.0}) {
      const Quantum quantum(d, 300.0 * d, bits);
      EXPECT_TRUE(is_power_of_two(quantum.length())) << d;
      EXPECT_LE(quantum.length(), std::ldexp(d, -bits)) << d;
      EXPECT_GT(quantum.length(), std::ldexp(d, -bits - 1)) << d;
    }
  EXPECT_EQ(Quantum(1.0, 1e9, 24).length(), Quantum(1.0, 1e9).length()) << "far away doubles are coarser";
  EXPECT_THROW(Quantum(1.0, 300.0, 19), InvalidParameter) << "2e-6 diameters";
}

TEST(QuantumUnit, IsAtLeastTheSpacingOfDoublesAtTheExtent) {
  for (const double extent : {1e4, 1e6, 1e8}) {
    const Quantum quantum(1.0, extent);
    EXPECT_TRUE(is_power_of_two(quantum.length()));
    EXPECT_GE(quantum.length(), std::nextafter(extent, 1e300) - extent) << extent;
    EXPECT_EQ(extent + quantum.length() - extent, quantum.length()) << extent;
  }
}

TEST(QuantumUnit, RoundsToTheNearestMultiple) {
  const Quantum quantum(3e-3, 1.0);
  const double q = quantum.length();
  scenes::Draws draws(1);
  for (int i = 0; i < 10000; ++i) {
    const double displacement = draws.uniform(-1e-4, 1e-4);
    const double rounded = quantum.round(displacement);
    EXPECT_EQ(rounded, std::nearbyint(displacement / q) * q);
    EXPECT_LE(std::abs(rounded - displacement), 0.5 * q);
  }
  EXPECT_EQ(quantum.round(0.0), 0.0);
  EXPECT_EQ(quantum.round(0.49 * q), 0.0);
  EXPECT_EQ(quantum.round(0.51 * q), q);
}

TEST(QuantumBruteForce, PositionsGoToTheNearestMultipleWhereverTheyAre) {
  scenes::Draws draws(3);
  for (const double extent : {1.0, 100.0, 1e9}) {
    const Quantum quantum(1.0, extent, 24);
    const double q = quantum.length();
    const auto expect_nearest = [&](double position) {
      const double nearest = std::nearbyint(position / q) * q, snapped = quantum.snap(position);
      EXPECT_EQ(snapped, nearest) << position;
      EXPECT_EQ(std::signbit(snapped), std::signbit(nearest)) << position;
    };
    for (int i = 0; i < 10000; ++i) expect_nearest(draws.uniform(-extent, extent));
    for (const double near : {0.0, 1.0, extent, std::ldexp(q, 51)})
      for (const double quanta : {-2.5, -1.5, -1.0, -0.5, -0.4, -0.0, 0.0, 0.4, 0.5, 1.0, 1.5, 2.5})
        for (const double sign : {-1.0, 1.0}) expect_nearest(sign * near + quanta * q);
  }
}

TEST(QuantumUnit, RoundingIsAntisymmetric) {
  const Quantum quantum(1.0, 100.0);
  scenes::Draws draws(2);
  for (int i = 0; i < 10000; ++i) {
    const double displacement = draws.uniform(-1.0, 1.0) * std::pow(10.0, -draws.uniform(0.0, 13.0));
    EXPECT_EQ(quantum.round(-displacement), -quantum.round(displacement)) << displacement;
  }
  for (const double halves : {0.5, 1.5, 2.5, 1000.5})
    EXPECT_EQ(quantum.round(-halves * quantum.length()), -quantum.round(halves * quantum.length())) << halves;
}

TEST(QuantumUnit, SumsAreExactInAnyOrder) {
  const double extent = 290.0;
  const Quantum quantum(1.0, extent);
  scenes::Draws draws(3);
  std::vector<double> terms = {quantum.snap(draws.uniform(-extent, extent))};
  for (int i = 0; i < 2000; ++i) terms.push_back(quantum.round(draws.uniform(-2e-3, 2e-3)));
  const double sum = std::accumulate(terms.begin(), terms.end(), 0.0);
  for (int order = 0; order < 100; ++order) {
    draws.shuffle(terms);
    EXPECT_EQ(std::accumulate(terms.begin(), terms.end(), 0.0), sum);
  }
}

TEST(QuantumUnit, SnapsPositionsUpToTheExtentToTheNearestMultiple) {
  for (const double extent : {1.0, 290.0, 1e8}) {
    const Quantum quantum(1.0, extent);
    scenes::Draws draws(4);
    for (int i = 0; i < 1000; ++i) {
      const double position = draws.uniform(-extent, extent);
      const double snapped = quantum.snap(position);
      EXPECT_EQ(std::fmod(snapped, quantum.length()), 0.0);
      EXPECT_LE(std::abs(snapped - position), 0.5 * quantum.length());
      EXPECT_EQ(quantum.snap(snapped), snapped);
    }
  }
}

TEST(QuantumUnit, RefusesCoordinatesFarFromTheOrigin) {
  EXPECT_NO_THROW(Quantum(1.0, 1e9));
  EXPECT_THAT(scenes::text_of<InvalidParameter>([] { Quantum(1.0, 1e11); }),
              AllOf(HasSubstr("1e+11"), HasSubstr("1e-6"), HasSubstr("origin")));
}

TEST(QuantumUnit, RefusesLengthsThatAreNotPositiveAndFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { Quantum(bad, 1.0); }),
                AllOf(HasSubstr("diameter"), HasSubstr("positive and finite")));
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { Quantum(1.0, bad); }),
                AllOf(HasSubstr("extent"), HasSubstr("positive and finite")));
  }
}

}  // namespace
