// SPDX-License-Identifier: GPL-2.0-or-later
// How grains go into messages and saved states.
#pragma once

#include "spot/base/bytes.hpp"
#include "spot/packing/grain.hpp"

namespace spot {

inline void append(Bytes& bytes, const Grain& grain) {
  append(bytes, grain.id);
  append(bytes, grain.position);
  append(bytes, grain.held);
  append(bytes, grain.radius);
}

inline Grain take_grain(ByteReader& reader) {
  const auto id = reader.take<std::int64_t>();
  const auto position = reader.take<Vector3>();
  const auto held = reader.take<bool>();
  return {id, position, held, reader.take<double>()};
}

}  // namespace spot
