// SPDX-License-Identifier: GPL-2.0-or-later
// How spots and moves go into messages and saved states.
#pragma once

#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/walk/spot_walk.hpp"

namespace spot {

inline void append(Bytes& bytes, const Spot& spot) {
  append(bytes, spot.id);
  append(bytes, spot.steps);
  append(bytes, spot.position);
  append(bytes, spot.next_step);
  append(bytes, spot.direction);
  append(bytes, spot.chance);
  append(bytes, spot.relative_speed);
  append(bytes, spot.volume);
  append(bytes, spot.outlet);
}

inline Spot take_spot(ByteReader& reader) {
  Spot spot;
  spot.id = reader.take<std::int64_t>();
  spot.steps = reader.take<std::int64_t>();
  spot.position = reader.take<Vector3>();
  spot.next_step = reader.take<double>();
  spot.direction = reader.take<double>();
  spot.chance = reader.take<double>();
  spot.relative_speed = reader.take<double>();
  spot.volume = reader.take<double>();
  spot.outlet = reader.take<std::int64_t>();
  return spot;
}

inline void append(Bytes& bytes, const std::vector<Spot>& spots) {
  append(bytes, static_cast<std::uint64_t>(spots.size()));
  for (const Spot& spot : spots) append(bytes, spot);
}

inline std::vector<Spot> take_spots(ByteReader& reader) {
  std::vector<Spot> spots;
  for (auto n = reader.take<std::uint64_t>(); n > 0; --n) spots.push_back(take_spot(reader));
  return spots;
}

inline void append(Bytes& bytes, const Move& move) {
  append(bytes, move.time);
  append(bytes, move.spot);
  append(bytes, move.middle);
  append(bytes, move.step);
  append(bytes, move.weight);
  append(bytes, move.number);
  append(bytes, move.chance);
}

inline Move take_move(ByteReader& reader) {
  Move move;
  move.time = reader.take<double>();
  move.spot = reader.take<std::int64_t>();
  move.middle = reader.take<Vector3>();
  move.step = reader.take<Vector3>();
  move.weight = reader.take<double>();
  move.number = reader.take<std::int64_t>();
  move.chance = reader.take<double>();
  return move;
}

}  // namespace spot
