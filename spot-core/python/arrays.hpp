// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <vector>

#include "spot/base/vector.hpp"

namespace spotcore {

namespace py = pybind11;

using Doubles = py::array_t<double, py::array::c_style>;
using Integers = py::array_t<std::int64_t, py::array::c_style>;
using Booleans = py::array_t<bool, py::array::c_style>;

// Copies of what a caller gave, whatever can be made an array of it. All throw spot::InvalidPacking, naming the
// argument, unless it has real numbers (integers, booleans) and the shape that is asked for.
Doubles copy_of_positions(const py::handle& given, const char* name);                  // (N, 3)
Doubles copy_of_numbers(const py::handle& given, const char* name, py::ssize_t size);  // (size,)
Integers copy_of_integers(const py::handle& given, const char* name, py::ssize_t size);
Booleans copy_of_booleans(const py::handle& given, const char* name, py::ssize_t size);

/// Arrays that are handed out are not to be written: nobody would take notice.
template <typename Array>
Array read_only(Array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

inline spot::Vector3 vector_of(const std::array<double, 3>& place) { return {place[0], place[1], place[2]}; }

}  // namespace spotcore
