// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "spot/base/errors.hpp"
#include "spot/base/vector.hpp"

namespace spot {

using Bytes = std::vector<char>;

/// Appends a number, or a structure of numbers, as it is in memory.
template <typename T>
void append(Bytes& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

inline void append(Bytes& bytes, const Vector3& vector) {
  for (int axis = 0; axis < 3; ++axis) append(bytes, vector[axis]);
}

template <typename T>
void append(Bytes& bytes, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  append(bytes, static_cast<std::uint64_t>(values.size()));
  const char* first = reinterpret_cast<const char*>(values.data());
  bytes.insert(bytes.end(), first, first + values.size() * sizeof(T));
}

/// Takes back what was appended, in the same order.
class ByteReader {
 public:
  ByteReader(const char* bytes, std::size_t n) : next_(bytes), end_(bytes + n) {}
  explicit ByteReader(const Bytes& bytes) : ByteReader(bytes.data(), bytes.size()) {}

  bool at_end() const { return next_ == end_; }

  /// Throws InvalidState if there are not so many bytes left.
  template <typename T>
  T take() {
    if constexpr (std::is_same_v<T, Vector3>) {
      const double x = take<double>(), y = take<double>();
      return {x, y, take<double>()};
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      require(1, sizeof(T));
      T value;
      std::memcpy(&value, next_, sizeof value);
      next_ += sizeof value;
      return value;
    }
  }

  template <typename T>
  std::vector<T> take_all() {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto n = take<std::uint64_t>();
    require(n, sizeof(T));
    std::vector<T> values(n);
    if (n > 0) std::memcpy(values.data(), next_, n * sizeof(T));
    next_ += n * sizeof(T);
    return values;
  }

 private:
  void require(std::uint64_t n, std::size_t size) const {
    if (static_cast<std::size_t>(end_ - next_) / size < n) throw InvalidState("the saved state ends early");
  }

  const char *next_, *end_;
};

/// Of the bytes and their number: another one for any single bit that changes, and for nearly all other damage.
std::uint64_t checksum(const char* bytes, std::size_t n);

/// Appends the checksum of all that is there.
void seal(Bytes& bytes);

/// Reads what was there before it was sealed. Throws InvalidState if it has changed since.
ByteReader unseal(const char* bytes, std::size_t n);
inline ByteReader unseal(const Bytes& bytes) { return unseal(bytes.data(), bytes.size()); }

}  // namespace spot
