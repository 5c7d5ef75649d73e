// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/bytes.hpp"
#include "spot/spot_walk.hpp"

namespace spot {

inline void append(Bytes& bytes, const Spot& spot) {
  append(bytes, spot.id);
  append(bytes, spot.steps);
  append(bytes, spot.position);
  append(bytes, spot.next_step);
  append(bytes, spot.turn);
  append(bytes, spot.chance);
}

inline Spot take_spot(ByteReader& reader) {
  Spot spot;
  spot.id = reader.take<std::int64_t>();
  spot.steps = reader.take<std::int64_t>();
  spot.position = reader.take<Vector3>();
  spot.next_step = reader.take<double>();
  spot.turn = reader.take<double>();
  spot.chance = reader.take<double>();
  return spot;
}

}  // namespace spot
