// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace spot {

/// Base of everything spot-core throws; the text names the value and its bound.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A number given by the user is outside the range the model allows.
class InvalidParameter : public Error {
 public:
  using Error::Error;
};

/// Walls, orifice and spots do not fit together.
class InvalidContainer : public Error {
 public:
  using Error::Error;
};

/// The grains of a running drainage went where relaxation cannot bring them back from: too deep into each other, or
/// through the base.
class CollapsedPacking : public Error {
 public:
  using Error::Error;
};

/// The grains are no valid starting packing: not finite, outside, overlapping, repeated ids.
class InvalidPacking : public Error {
 public:
  using Error::Error;
};

/// A saved state is damaged, incomplete, or that of another run.
class InvalidState : public Error {
 public:
  using Error::Error;
};

/// Puts the parts of a message together, numbers with enough digits to recognise them.
template <typename... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream out;
  out.precision(9);
  (out << ... << parts);
  return out.str();
}

}  // namespace spot
