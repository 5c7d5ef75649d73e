// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// Elementary functions whose bits are the same wherever double is IEEE's: C libraries differ in the last one, from
/// version to version and from processor to processor. Made of +, -, *, / alone, with twice the digits of a double
/// where they count, and rounded once: within 0.501 units in the last place (pow: 0.51; results below 2^-1022: one). A
/// call takes 0.1 us. All that enters a walk or a decision of spot-core goes through these; sqrt, floor and rounding
/// are exact everywhere.

/// Infinity above 709.78, 0 below -745.13.
double exp(double x);

/// Natural logarithm. NaN below 0.
double log(double x);

/// log(1 + x), with all digits also where x is small. NaN below -1.
double log1p(double x);

/// `base` to the power of `exponent`. pow(x, 0) and pow(1, y) are 1 for any x and y; NaN if the base is below 0.
double pow(double base, double exponent);

/// Cube root.
double cbrt(double x);

/// Cosine and sine of so many whole turns: of 2 pi times the argument. Exact where they are 0 or 1. NaN of infinity.
double cos_of_turns(double turns);
double sin_of_turns(double turns);

}  // namespace spot
