// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/bytes.hpp"

namespace spot {

/// FNV-1a of eight bytes at a time, the upper half of every product mixed into the lower. Each step can be undone, so
/// that one that differs is never made good by those that follow.
std::uint64_t checksum(const char* bytes, std::size_t n) {
  std::uint64_t hash = 14695981039346656037u ^ n;
  while (n > 0) {
    std::uint64_t word = 0;
    const std::size_t part = n < sizeof word ? n : sizeof word;
    std::memcpy(&word, bytes, part);
    hash = (hash ^ word) * 1099511628211u;
    hash ^= hash >> 32;
    bytes += part;
    n -= part;
  }
  return hash;
}

void seal(Bytes& bytes) { append(bytes, checksum(bytes.data(), bytes.size())); }

ByteReader unseal(const char* bytes, std::size_t n) {
  std::uint64_t expected;
  if (n < sizeof expected) throw InvalidState("the saved state ends early");
  n -= sizeof expected;
  std::memcpy(&expected, bytes + n, sizeof expected);
  if (checksum(bytes, n) != expected) throw InvalidState("the saved state is damaged: its checksum is wrong");
  return {bytes, n};
}

}  // namespace spot
