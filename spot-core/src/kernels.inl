// SPDX-License-Identifier: GPL-2.0-or-later
// The kernels, compiled once an instruction set: plain loops for the base, packs of four or eight numbers above it.
// Everything here has internal linkage and no inline library function is used, so that no code built for one processor
// can be linked into what another one runs. Every number goes through the same operations in the same order in all.
#include "kernels.hpp"

namespace {

using spot::Point;
using spot::kernels::Lists;

#ifndef __AVX2__

double square_distance(const Point& a, const Point& b) {
  const double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

int displace(Point* points, std::size_t n, const Point& middle, double radius, const Point& by) {
  int moved = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (square_distance(points[i], middle) > radius * radius) continue;
    points[i] = {points[i].x + by.x, points[i].y + by.y, points[i].z + by.z, 0.0};
    ++moved;
  }
  return moved;
}

bool any_beyond(const Point* points, const Point* references, std::size_t n, double reach) {
  for (std::size_t i = 0; i < n; ++i)
    if (square_distance(points[i], references[i]) > reach * reach) return true;
  return false;
}

void push_off_neighbours(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                         const spot::kernels::Push& push, Point* pushes) {
  const double per_square = 1.0 / (push.diameter * push.diameter);
  for (std::size_t i = 0; i < n; ++i) {
    const Point& own = points[grains[i]];
    const std::uint32_t* list = lists.neighbours + static_cast<std::size_t>(grains[i]) * lists.capacity;
    Point sum = {};
    for (std::uint32_t k = 0; k < lists.size[grains[i]]; ++k) {
      const Point& other = points[list[k]];
      const double s = 1.0 - square_distance(own, other) * per_square;
      if (!(s > 0.0)) continue;
      const double scale = push.share * s * (0.5 + s * (0.375 + s * (0.3125 + s * 0.2734375)));
      sum.x += (scale * (own.x - other.x) + push.shift) - push.shift;
      sum.y += (scale * (own.y - other.y) + push.shift) - push.shift;
      sum.z += (scale * (own.z - other.z) + push.shift) - push.shift;
      if (s > sum.depth) sum.depth = s;
    }
    pushes[i] = sum;
  }
}

#else

typedef double Four __attribute__((vector_size(4 * sizeof(double))));

inline Four load(const Point& point) { return *reinterpret_cast<const Four*>(&point); }
inline void store(Four values, Point& point) { *reinterpret_cast<Four*>(&point) = values; }

#ifdef __AVX512F__

constexpr std::uint32_t width = 8;
typedef double Pack __attribute__((vector_size(8 * sizeof(double))));
typedef std::int64_t Mask __attribute__((vector_size(8 * sizeof(std::int64_t))));

inline Pack join(Four low, Four high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7); }
inline Four low_half(Pack p) { return __builtin_shufflevector(p, p, 0, 1, 2, 3); }
inline Four high_half(Pack p) { return __builtin_shufflevector(p, p, 4, 5, 6, 7); }
inline Pack load_points(const Point* points) { return join(load(points[0]), load(points[1])); }
inline Pack repeat(const Point& point) { return join(load(point), load(point)); }
inline void store_points(Pack p, Point* points) {
  store(low_half(p), points[0]);
  store(high_half(p), points[1]);
}
inline Pack load_for_transpose(const Point* points, const std::uint32_t* list, int k) {
  return join(load(points[list[k]]), load(points[list[k + 4]]));
}
inline Pack even(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14); }
inline Pack odd(Pack a, Pack b) { return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15); }
inline Pack low(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13); }
inline Pack high(Pack a, Pack b) { return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15); }
inline Four add_halves(Pack p) { return low_half(p) + high_half(p); }
inline Four greater_half(Pack p) { return low_half(p) > high_half(p) ? low_half(p) : high_half(p); }
inline std::int64_t count(Mask m) { return -(m[0] + m[4]); }

#else

constexpr std::uint32_t width = 4;
typedef Four Pack;
typedef std::int64_t Mask __attribute__((vector_size(4 * sizeof(std::int64_t))));

inline Pack load_points(const Point* points) { return load(points[0]); }
inline Pack repeat(const Point& point) { return load(point); }
inline void store_points(Pack p, Point* points) { store(p, points[0]); }
inline Pack load_for_transpose(const Point* points, const std::uint32_t* list, int k) { return load(points[list[k]]); }
inline Pack even(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 4, 2, 6); }
inline Pack odd(Pack a, Pack b) { return __builtin_shufflevector(a, b, 1, 5, 3, 7); }
inline Pack low(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 1, 4, 5); }
inline Pack high(Pack a, Pack b) { return __builtin_shufflevector(a, b, 2, 3, 6, 7); }
inline Four add_halves(Pack p) { return p; }
inline Four greater_half(Pack p) { return p; }
inline std::int64_t count(Mask m) { return -m[0]; }

#endif

/// Points that one pack holds.
constexpr std::uint32_t points_in_pack = width / 4;

inline Pack all(double value) { return Pack{} + value; }

/// x^2 + y^2 + z^2 of each point, in all four places of it.
inline Pack squares(Pack points) {
  const Pack q = points * points;
  const Pack pairs = even(q, q) + odd(q, q);
  return low(pairs, pairs) + high(pairs, pairs);
}

int displace(Point* points, std::size_t n, const Point& middle, double radius, const Point& by) {
  const Pack centre = repeat(middle), step = repeat(by), radius_squared = all(radius * radius);
  Mask moved = {};
  for (std::size_t i = 0; i < n; i += points_in_pack) {
    const Pack p = load_points(points + i);
    const Mask inside = squares(p - centre) <= radius_squared;  // all ones or all zeros
    store_points(p + (Pack)(inside & (Mask)step), points + i);
    moved += inside;
  }
  return static_cast<int>(count(moved));
}

bool any_beyond(const Point* points, const Point* references, std::size_t n, double reach) {
  const Pack reach_squared = all(reach * reach);
  Mask beyond = {};
  for (std::size_t i = 0; i < n; i += points_in_pack)
    beyond += squares(load_points(points + i) - load_points(references + i)) > reach_squared;
  return count(beyond) != 0;
}

/// Sums over x, y and z, and the largest of s.
inline Four reduce(Pack x, Pack y, Pack z, Pack s) {
  const Pack xy = even(x, y) + odd(x, y);
  const Pack zz = even(z, z) + odd(z, z);
  const Four sums = add_halves(low(xy, zz) + high(xy, zz));
  const Four largest = greater_half(s);
  double depth = largest[0];
  for (int l = 1; l < 4; ++l) depth = largest[l] > depth ? largest[l] : depth;
  return Four{sums[0], sums[1], sums[2], depth};
}

void push_off_neighbours(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                         const spot::kernels::Push& push, Point* pushes) {
  const Pack per_square = all(1.0 / (push.diameter * push.diameter)), share = all(push.share), shift = all(push.shift);
  const Pack zero = all(0.0), one = all(1.0);
  for (std::size_t i = 0; i < n; ++i) {
    const Point& own = points[grains[i]];
    const Pack x = all(own.x), y = all(own.y), z = all(own.z);
    Pack push_x = zero, push_y = zero, push_z = zero, depth = zero;
    const std::uint32_t* list = lists.neighbours + static_cast<std::size_t>(grains[i]) * lists.capacity;
    const std::uint32_t* last = list + lists.size[grains[i]];
    for (; list < last; list += width) {
      // As many points as numbers fit in a pack, turned into their x, y and z.
      const Pack a = load_for_transpose(points, list, 0), b = load_for_transpose(points, list, 1);
      const Pack c = load_for_transpose(points, list, 2), d = load_for_transpose(points, list, 3);
      const Pack ab = even(a, b), cd = even(c, d);
      const Pack dx = x - low(ab, cd), dy = y - low(odd(a, b), odd(c, d)), dz = z - high(ab, cd);
      const Pack apart = one - (dx * dx + dy * dy + dz * dz) * per_square;
      const Pack s = apart > zero ? apart : zero;
      const Pack scale = share * s * (0.5 + s * (0.375 + s * (0.3125 + s * 0.2734375)));
      push_x += (scale * dx + shift) - shift;
      push_y += (scale * dy + shift) - shift;
      push_z += (scale * dz + shift) - shift;
      depth = s > depth ? s : depth;
    }
    store(reduce(push_x, push_y, push_z, depth), pushes[i]);
  }
}

#endif

}  // namespace

namespace spot::kernels {

extern const Kernels SPOT_KERNELS;
const Kernels SPOT_KERNELS = {SPOT_INSTRUCTION_SET, &displace, &push_off_neighbours, &any_beyond};

}  // namespace spot::kernels
