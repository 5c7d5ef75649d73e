// SPDX-License-Identifier: GPL-2.0-or-later
#include "arrays.hpp"

#include <string>

#include "spot/base/errors.hpp"

namespace spotcore {

namespace {

std::string text_of(const py::handle& value) { return py::str(value); }

/// `kinds`: letters of numpy's dtype.kind that are taken; no number is longer than 64 bits.
py::array array_of(const py::handle& given, const char* name, const std::string& kinds, const char* what) {
  const py::array array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    throw spot::InvalidPacking(spot::message(name, " cannot be made an array"));
  }
  if (kinds.find(array.dtype().kind()) == std::string::npos || array.dtype().itemsize() > 8)
    throw spot::InvalidPacking(
        spot::message(name, " is an array of ", text_of(array.dtype()), " but must be one of ", what));
  return array;
}

void require_shape(const py::array& array, const char* name, bool fits, const std::string& shape) {
  if (!fits)
    throw spot::InvalidPacking(
        spot::message(name, " has shape ", text_of(array.attr("shape")), " but must have shape ", shape));
}

/// Of its own, also where the array had this type before.
template <typename Array>
Array copy(const py::array& array, const char* dtype) {
  return array.attr("astype")(dtype, py::arg("order") = "C", py::arg("copy") = true).template cast<Array>();
}

py::array one_per_grain(const py::handle& given, const char* name, py::ssize_t size, const char* kinds,
                        const char* what) {
  const py::array array = array_of(given, name, kinds, what);
  require_shape(array, name, array.ndim() == 1 && array.shape(0) == size,
                spot::message('(', size, ",), one for each grain"));
  return array;
}

}  // namespace

Doubles copy_of_positions(const py::handle& given, const char* name) {
  const py::array array = array_of(given, name, "fiu", "real numbers");
  require_shape(array, name, array.ndim() == 2 && array.shape(1) == 3, "(N, 3)");
  return copy<Doubles>(array, "float64");
}

Doubles copy_of_numbers(const py::handle& given, const char* name, py::ssize_t size) {
  return copy<Doubles>(one_per_grain(given, name, size, "fiu", "real numbers"), "float64");
}

Integers copy_of_integers(const py::handle& given, const char* name, py::ssize_t size) {
  return copy<Integers>(one_per_grain(given, name, size, "iu", "integers"), "int64");
}

Booleans copy_of_booleans(const py::handle& given, const char* name, py::ssize_t size) {
  return copy<Booleans>(one_per_grain(given, name, size, "b", "booleans"), "bool");
}

}  // namespace spotcore
