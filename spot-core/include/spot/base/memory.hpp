// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>

namespace spot {

/// Bytes that vectors of plain values hold, in use or not.
template <typename... Vectors>
std::size_t bytes_in(const Vectors&... vectors) {
  return (... + (vectors.capacity() * sizeof(typename Vectors::value_type)));
}

}  // namespace spot
