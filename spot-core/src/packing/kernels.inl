// SPDX-License-Identifier: GPL-2.0-or-later
// The kernels, compiled once an instruction set: plain loops for the base, packs of 8 or 16 numbers above it.
// Everything here has internal linkage and no inline library function is used, so that no code built for one processor
// can be linked into what another one runs. Every number goes through the same operations in the same order in all.
// Integers wrap around (-fwrapv).
#include "packing/kernels.hpp"

namespace {

using spot::Corrections;
using spot::Point;
using spot::Reach;
using spot::kernels::ahead;
using spot::kernels::Gaps;
using spot::kernels::Lists;
using spot::kernels::Places;
using spot::kernels::TiltsOfPlaces;

/// Of a whole share.
constexpr float parts = spot::grain_volume;

/// Differences of states are seen only where an empty place is on one side.
constexpr std::int32_t only_empty = Point::empty;

/// Here and not inline in a header: no code of one build may be linked into another.
inline const std::uint32_t* list_of(const Lists& lists, std::uint32_t point) {
  return lists.neighbours + static_cast<std::size_t>(lists.block[point]) * spot::kernels::lanes;
}

inline float square(std::int32_t difference) { return static_cast<float>(difference) * static_cast<float>(difference); }

inline float square_distance(const Point& a, const Point& b, std::int32_t states_seen) {
  return (square(a.x - b.x) + square(a.y - b.y)) + (square(a.z - b.z) + square((a.state - b.state) & states_seen));
}

inline void add(Point& point, std::int32_t x, std::int32_t y, std::int32_t z) {
  point.x += x;
  point.y += y;
  point.z += z;
}

inline float share(const Places& places, std::size_t i, const Point& middle, const Reach& reach) {
  const float squared = (square(places.x[i] - middle.x) + square(places.y[i] - middle.y)) +
                        (square(places.z[i] - middle.z) + places.state_squared[i]);
  const float linear = (reach.radius_squared - squared) * reach.per_square;
  return linear > 0.0f ? linear < 1.0f ? linear : 1.0f : 0.0f;
}

/// Which radii grains have decides how deep two of them overlap: 1 - r^2 / p^2, with p the distance at which they are
/// left alone.
struct EqualGrains {
  float per_square;  // 1 / p^2
  float overlap(float squared, std::uint32_t, std::uint32_t) const { return 1.0f - squared * per_square; }
};

struct UnequalGrains {
  const spot::GrainSize* sizes;
  float touch;
  float overlap(float squared, std::uint32_t a, std::uint32_t b) const {
    const float parted = (sizes[a].in_quanta + sizes[b].in_quanta) * touch;
    return 1.0f - squared / (parted * parted);
  }
};

/// Which pairs are pushed, and by what share, decides whether gaps between grains stay or are closed.
struct GapsStay {
  explicit GapsStay(const Gaps&) {}
  bool moves(float s) const { return s > 0.0f; }
  float share_at(float, float share) const { return share; }
};

struct GapsClose {
  float least, share;
  explicit GapsClose(const Gaps& gaps) : least(-gaps.widest), share(gaps.share) {}
  bool moves(float s) const { return s > least; }
  float share_at(float s, float of_overlap) const { return s < 0.0f ? of_overlap * share : of_overlap; }
};

template <typename Gap, typename Shares, typename Grains>
void push_off(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists, const Shares& shares,
              const Grains& radii, Point* pushes) {
  const Gap gap(shares.gaps);
  for (std::size_t i = 0; i < n; ++i) {
    const Point& own = points[grains[i]];
    const std::uint32_t* list = list_of(lists, grains[i]);
    Point sum = {0, 0, 0, 0};
    float depth = 0.0f;
    for (std::uint32_t k = 0; k < lists.size[grains[i]]; ++k) {
      const Point& other = points[list[k]];
      const float dx = static_cast<float>(own.x - other.x), dy = static_cast<float>(own.y - other.y),
                  dz = static_cast<float>(own.z - other.z);
      const float s = radii.overlap((dx * dx + dy * dy) + dz * dz, grains[i], list[k]);
      if (!gap.moves(s)) continue;
      const float share = gap.share_at(s, other.state == Point::swept ? shares.pair_share : shares.fixed_share);
      const float scale = (share * s) * (0.5f + s * (0.375f + s * (0.3125f + s * 0.2734375f)));
      add(sum, static_cast<std::int32_t>(scale * dx), static_cast<std::int32_t>(scale * dy),
          static_cast<std::int32_t>(scale * dz));
      if (s > depth) depth = s;
    }
    __builtin_memcpy(&sum.state, &depth, sizeof depth);
    pushes[i] = sum;
  }
}

void push_off_unequal_neighbours(const Point* points, const spot::GrainSize* sizes, const std::uint32_t* grains,
                                 std::size_t n, const Lists& lists, const spot::kernels::UnequalPush& push,
                                 Point* pushes) {
  const UnequalGrains radii = {sizes, push.touch};
  if (push.gaps.widest > 0.0f)
    push_off<GapsClose>(points, grains, n, lists, push, radii, pushes);
  else
    push_off<GapsStay>(points, grains, n, lists, push, radii, pushes);
}

/// Calls visit(slot) for all places.
template <typename Visit>
inline void visit_slots(const Places& places, const Visit& visit) {
  for (std::size_t k = 0; k < places.count; ++k) {
    const std::size_t first = static_cast<std::size_t>(places.blocks[k]) * spot::kernels::lanes;
    for (std::size_t slot = first; slot < first + spot::kernels::lanes; ++slot) visit(slot);
  }
}

int enclosed_volume_of_unequal(const Places& places, const spot::GrainSize* sizes, const Point& middle,
                               const Reach& reach) {
  int enclosed = 0;
  visit_slots(places, [&](std::size_t i) {
    enclosed += static_cast<int>(share(places, i, middle, reach) * sizes[i].volume);
  });
  return enclosed;
}

void count_received(const Places& places, const Point& middle, const Reach& reach, std::uint32_t* __restrict received) {
  const Places of = places;  // a copy, which no write to `received` can change
  const Point around = middle;
  const float limit = reach.radius_squared;
  visit_slots(of, [&](std::size_t i) {
    const float squared = (square(of.x[i] - around.x) + square(of.y[i] - around.y)) +
                          (square(of.z[i] - around.z) + of.state_squared[i]);
    received[i] += squared <= limit ? 1u : 0u;
  });
}

#ifndef __AVX2__

int enclosed_volume(const Places& places, const Point& middle, const Reach& reach) {
  int shares = 0;
  visit_slots(places, [&](std::size_t i) { shares += static_cast<int>(share(places, i, middle, reach) * parts); });
  return shares;
}

void displace(const Places& places, const Point& middle, const Reach& reach, const Point& by) {
  const float x = static_cast<float>(by.x), y = static_cast<float>(by.y), z = static_cast<float>(by.z);
  visit_slots(places, [&](std::size_t i) {
    const float part = share(places, i, middle, reach);
    places.x[i] += static_cast<std::int32_t>(part * x);
    places.y[i] += static_cast<std::int32_t>(part * y);
    places.z[i] += static_cast<std::int32_t>(part * z);
  });
}

void displace_tilted(const Places& places, const TiltsOfPlaces& tilts, const Point& middle, const Reach& reach,
                     const Point& by, float unit) {
  const float x = static_cast<float>(by.x), y = static_cast<float>(by.y), z = static_cast<float>(by.z);
  visit_slots(places, [&](std::size_t i) {
    const float part = share(places, i, middle, reach);
    places.x[i] += static_cast<std::int32_t>(part * (x + unit * tilts.x[i]));
    places.y[i] += static_cast<std::int32_t>(part * (y + unit * tilts.y[i]));
    places.z[i] += static_cast<std::int32_t>(part * (z + unit * tilts.z[i]));
  });
}

std::size_t find_within(const Point* points, std::size_t n, const Point& centre, float reach_squared,
                        std::uint32_t first, std::uint32_t* found) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (square_distance(points[i], centre, only_empty) <= reach_squared)
      found[count++] = first + static_cast<std::uint32_t>(i);
  return count;
}

float farthest(const Point* points, const Point* references, std::size_t n) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < n; ++i) {
    const float squared = square_distance(points[i], references[i], -1);
    if (squared > largest) largest = squared;
  }
  return largest;
}

template <typename Gap>
void push_off_equal(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                    const spot::kernels::Push& push, Point* pushes) {
  push_off<Gap>(points, grains, n, lists, push, EqualGrains{push.per_square}, pushes);
}

std::int32_t kept_of(std::int32_t last, float kept) {
  return static_cast<std::int32_t>(static_cast<float>(last) * kept);
}

void correct(Point* points, Point* last, const std::uint32_t* grains, const std::uint8_t* in_cell, std::size_t cells,
             const Point* pushes, float kept, Corrections* corrections) {
  for (std::size_t cell = 0; cell < cells; ++cell) {
    corrections[cell] = {0.0f, 0.0f};
    for (std::uint32_t k = 0; k < in_cell[cell]; ++k, ++grains, ++pushes) {
      Point& by = last[*grains];
      by = {pushes->x + kept_of(by.x, kept), pushes->y + kept_of(by.y, kept), pushes->z + kept_of(by.z, kept), 0};
      add(points[*grains], by.x, by.y, by.z);
      points[*grains].state = Point::free;
      const float squared = square_distance(by, {0, 0, 0, 0}, -1);
      if (squared > corrections[cell].longest_squared) corrections[cell].longest_squared = squared;
      float depth;
      __builtin_memcpy(&depth, &pushes->state, sizeof depth);
      if (depth > corrections[cell].depth) corrections[cell].depth = depth;
    }
  }
}

std::size_t find_reached(const std::int32_t* values, std::size_t n, std::int32_t least, std::uint32_t* found) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (values[i] >= least) found[count++] = static_cast<std::uint32_t>(i);
  return count;
}

#else

typedef std::int32_t Quarter __attribute__((vector_size(16), may_alias));  // one point
typedef float QuarterFloats __attribute__((vector_size(16)));
typedef std::int32_t Half __attribute__((vector_size(32)));  // two

inline Half join(Quarter a, Quarter b) { return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7); }
inline Quarter low_half(Half p) { return __builtin_shufflevector(p, p, 0, 1, 2, 3); }
inline Quarter high_half(Half p) { return __builtin_shufflevector(p, p, 4, 5, 6, 7); }
inline Quarter load_point(const Point& point) { return *reinterpret_cast<const Quarter*>(&point); }
inline void store_point(Quarter point, Point& to) { *reinterpret_cast<Quarter*>(&to) = point; }
inline Quarter greater(Quarter a, Quarter b) { return a > b ? a : b; }

inline float float_of(std::int32_t bits) {
  float value;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

void correct(Point* points, Point* last, const std::uint32_t* grains, const std::uint8_t* in_cell, std::size_t cells,
             const Point* pushes, float kept, Corrections* corrections) {
  constexpr Quarter coordinates = {-1, -1, -1, 0};
  for (std::size_t cell = 0; cell < cells; ++cell) {
    Quarter greatest = {};  // the bits of a squared length and, last, of a depth
    for (std::uint32_t k = 0; k < in_cell[cell]; ++k, ++grains, ++pushes) {
      __builtin_prefetch(last + grains[ahead], 1);
      Point &point = points[*grains], &by = last[*grains];
      const Quarter push = load_point(*pushes);
      const QuarterFloats carried = __builtin_convertvector(load_point(by), QuarterFloats) * kept;
      const Quarter step = (push + __builtin_convertvector(carried, Quarter)) & coordinates;
      store_point(step, by);
      store_point((load_point(point) + step) & coordinates, point);
      const QuarterFloats f = __builtin_convertvector(step, QuarterFloats), squares = f * f;
      const QuarterFloats pairs = squares + __builtin_shufflevector(squares, squares, 1, 0, 3, 2);
      const QuarterFloats squared = pairs + __builtin_shufflevector(pairs, pairs, 2, 3, 0, 1);
      // Floats that are not negative are in the order of their bits.
      greatest = greater(greatest, __builtin_shufflevector((Quarter)squared, push, 0, 0, 0, 7));
    }
    corrections[cell] = {float_of(greatest[0]), float_of(greatest[3])};
  }
}

#ifdef __AVX512F__

constexpr std::uint32_t width = 16;
typedef std::int32_t Pack __attribute__((vector_size(64)));
typedef std::int32_t Unaligned __attribute__((vector_size(64), aligned(4), may_alias));
typedef float Floats __attribute__((vector_size(64)));
typedef std::int16_t Shorts __attribute__((vector_size(32)));

inline Pack join(Half a, Half b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
inline Half low_part(Pack p) { return __builtin_shufflevector(p, p, 0, 1, 2, 3, 4, 5, 6, 7); }
inline Half high_part(Pack p) { return __builtin_shufflevector(p, p, 8, 9, 10, 11, 12, 13, 14, 15); }
inline Pack load_for_transpose(const Point* points, const std::uint32_t* list, int k) {
  return join(join(load_point(points[list[k]]), load_point(points[list[k + 4]])),
              join(load_point(points[list[k + 8]]), load_point(points[list[k + 12]])));
}
inline Pack repeat(Quarter q) { return join(join(q, q), join(q, q)); }
/// From each point of a and of b in turn: numbers 0, 0, 1, 1 or 2, 2, 3, 3.
inline Pack low(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
}
inline Pack high(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
}
/// The same by pairs of numbers.
inline Pack low_pairs(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
}
inline Pack high_pairs(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
}
inline Floats swap(Floats p) {
  return __builtin_shufflevector(p, p, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
}
inline Floats swap_pairs(Floats p) {
  return __builtin_shufflevector(p, p, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13);
}
inline Quarter add_parts(Pack p) {
  const Half h = low_part(p) + high_part(p);
  return low_half(h) + high_half(h);
}
inline Quarter greatest_part(Pack p) {
  const Half a = low_part(p), b = high_part(p), h = a > b ? a : b;
  return greater(low_half(h), high_half(h));
}
inline unsigned bits(Pack mask) { return __builtin_ia32_cvtd2mask512(mask); }
constexpr Pack numbers = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

#else

constexpr std::uint32_t width = 8;
typedef Half Pack;
typedef std::int32_t Unaligned __attribute__((vector_size(32), aligned(4), may_alias));
typedef float Floats __attribute__((vector_size(32)));
typedef std::int16_t Shorts __attribute__((vector_size(16)));

inline Pack load_for_transpose(const Point* points, const std::uint32_t* list, int k) {
  return join(load_point(points[list[k]]), load_point(points[list[k + 4]]));
}
inline Pack repeat(Quarter q) { return join(q, q); }
inline Pack low(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13); }
inline Pack high(Pack a, Pack b) { return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15); }
inline Pack low_pairs(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13); }
inline Pack high_pairs(Pack a, Pack b) { return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15); }
inline Floats swap(Floats p) { return __builtin_shufflevector(p, p, 1, 0, 3, 2, 5, 4, 7, 6); }
inline Floats swap_pairs(Floats p) { return __builtin_shufflevector(p, p, 2, 3, 0, 1, 6, 7, 4, 5); }
inline Quarter add_parts(Pack p) { return low_half(p) + high_half(p); }
inline Quarter greatest_part(Pack p) { return greater(low_half(p), high_half(p)); }
inline unsigned bits(Pack mask) { return static_cast<unsigned>(__builtin_ia32_movmskps256((Floats)mask)); }
constexpr Pack numbers = {0, 1, 2, 3, 4, 5, 6, 7};

#endif

/// Points that one pack holds.
constexpr std::uint32_t points_in_pack = width / 4;

inline Pack load(const void* from) { return *static_cast<const Unaligned*>(from); }
inline void store(Pack p, void* to) { *static_cast<Unaligned*>(to) = p; }
inline Pack all(std::int32_t value) { return Pack{} + value; }
inline Floats all(float value) { return Floats{} + value; }
inline Floats floats(Pack p) { return __builtin_convertvector(p, Floats); }
inline Pack whole(Floats f) { return __builtin_convertvector(f, Pack); }

/// The square of the four numbers of each point, in all four places of it.
inline Floats squares(Pack points) {
  const Floats p = floats(points), q = p * p, pairs = q + swap(q);
  return pairs + swap_pairs(pairs);
}

inline Floats load_floats(const float* from) { return (Floats)load(from); }
inline Floats load_floats(const std::int16_t* from) {
  Shorts shorts;
  __builtin_memcpy(&shorts, from, sizeof shorts);
  return floats(__builtin_convertvector(shorts, Pack));
}

/// What a move needs of every place, in registers.
struct MoveOfPlaces {
  const std::int32_t *x, *y, *z;
  const float* state_squared;
  Pack middle_x, middle_y, middle_z;
  Floats radius_squared, per_square;

  MoveOfPlaces(const Places& places, const Point& middle, const Reach& reach)
      : x(places.x),
        y(places.y),
        z(places.z),
        state_squared(places.state_squared),
        middle_x(all(middle.x)),
        middle_y(all(middle.y)),
        middle_z(all(middle.z)),
        radius_squared(all(reach.radius_squared)),
        per_square(all(reach.per_square)) {}

  static Floats square_of(Pack p) { return floats(p) * floats(p); }

  Floats shares(std::size_t i) const {
    const Floats squared = (square_of(load(x + i) - middle_x) + square_of(load(y + i) - middle_y)) +
                           (square_of(load(z + i) - middle_z) + load_floats(state_squared + i));
    const Floats zero = all(0.0f), one = all(1.0f), linear = (radius_squared - squared) * per_square;
    const Floats positive = linear > zero ? linear : zero;
    return positive < one ? positive : one;
  }
};

/// Calls visit(slot) for all packs of places.
template <typename Visit>
inline void visit_packs(const Places& places, const Visit& visit) {
  const std::uint32_t *block = places.blocks, *const end = block + places.count;
  for (; block != end; ++block) {
    const std::size_t first = static_cast<std::size_t>(*block) * spot::kernels::lanes;
    for (std::uint32_t k = 0; k < spot::kernels::lanes; k += width) visit(first + k);
  }
}

int enclosed_volume(const Places& places, const Point& middle, const Reach& reach) {
  const MoveOfPlaces move(places, middle, reach);
  Pack sum = {};
  visit_packs(places, [&](std::size_t i) { sum += whole(move.shares(i) * parts); });
  const Quarter four = add_parts(sum);
  return (four[0] + four[1]) + (four[2] + four[3]);
}

inline void add(Pack by, std::int32_t* to) { store(load(to) + by, to); }

void displace(const Places& places, const Point& middle, const Reach& reach, const Point& by) {
  const MoveOfPlaces move(places, middle, reach);
  const Floats by_x = floats(all(by.x)), by_y = floats(all(by.y)), by_z = floats(all(by.z));
  std::int32_t *const x = places.x, *const y = places.y, *const z = places.z;
  visit_packs(places, [&](std::size_t i) {
    const Floats share = move.shares(i);
    add(whole(share * by_x), x + i);
    add(whole(share * by_y), y + i);
    add(whole(share * by_z), z + i);
  });
}

void displace_tilted(const Places& places, const TiltsOfPlaces& tilts, const Point& middle, const Reach& reach,
                     const Point& by, float unit) {
  const MoveOfPlaces move(places, middle, reach);
  const Floats by_x = floats(all(by.x)), by_y = floats(all(by.y)), by_z = floats(all(by.z)), units = all(unit);
  std::int32_t *const x = places.x, *const y = places.y, *const z = places.z;
  const TiltsOfPlaces own = tilts;
  visit_packs(places, [&](std::size_t i) {
    const Floats share = move.shares(i);
    add(whole(share * (by_x + units * load_floats(own.x + i))), x + i);
    add(whole(share * (by_y + units * load_floats(own.y + i))), y + i);
    add(whole(share * (by_z + units * load_floats(own.z + i))), z + i);
  });
}

std::size_t find_within(const Point* points, std::size_t n, const Point& centre, float reach_squared,
                        std::uint32_t first, std::uint32_t* found) {
  const Pack from = repeat(load_point(centre)), seen = repeat(Quarter{-1, -1, -1, only_empty});
  const Floats limit = all(reach_squared);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; i += points_in_pack) {
    unsigned inside = bits(squares((load(points + i) - from) & seen) <= limit);
    for (std::uint32_t k = 0; inside != 0; ++k, inside >>= 4)
      if (inside & 1u) found[count++] = first + static_cast<std::uint32_t>(i) + k;
  }
  return count;
}

inline float greatest(Pack floats_as_integers) {
  // Floats that are not negative are in the order of their bits.
  const Quarter q = greatest_part(floats_as_integers);
  std::int32_t largest = q[0];
  for (int k = 1; k < 4; ++k) largest = q[k] > largest ? q[k] : largest;
  return float_of(largest);
}

float farthest(const Point* points, const Point* references, std::size_t n) {
  Floats largest = all(0.0f);
  for (std::size_t i = 0; i < n; i += points_in_pack) {
    const Floats s = squares(load(points + i) - load(references + i));
    largest = s > largest ? s : largest;
  }
  return greatest((Pack)largest);
}

/// Sums over x, y and z, and the greatest of s.
inline Quarter reduce(Pack x, Pack y, Pack z, Floats s) {
  const Pack xy = low(x, y) + high(x, y), zs = low(z, z) + high(z, z);
  Quarter sums = add_parts(low_pairs(xy, zs) + high_pairs(xy, zs));
  const float depth = greatest((Pack)s);
  __builtin_memcpy(&sums[3], &depth, sizeof depth);
  return sums;
}

/// Overlaps of pairs that stay where they are become 0.
inline Floats moving(const GapsStay&, Floats s) { return s > all(0.0f) ? s : all(0.0f); }
inline Floats moving(const GapsClose& gap, Floats s) { return s > all(gap.least) ? s : all(0.0f); }
inline Floats share_at(const GapsStay&, Floats, Floats share) { return share; }
inline Floats share_at(const GapsClose& gap, Floats s, Floats share) {
  return s < all(0.0f) ? share * gap.share : share;
}

template <typename Gap>
void push_off_equal(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                    const spot::kernels::Push& push, Point* pushes) {
  const Gap gap(push.gaps);
  const Floats per_square = all(push.per_square), zero = all(0.0f);
  const Pack pair_share = (Pack)all(push.pair_share), fixed_share = (Pack)all(push.fixed_share);
  for (std::size_t i = 0; i < n; ++i) {
    const Point& own = points[grains[i]];
    const Pack x = all(own.x), y = all(own.y), z = all(own.z);
    Pack push_x = {}, push_y = {}, push_z = {};
    Floats depth = zero;
    const std::uint32_t* list = list_of(lists, grains[i]);
    __builtin_prefetch(list_of(lists, grains[i + ahead]));
    const std::int32_t size = lists.size[grains[i]];
    for (std::int32_t k = 0; k < size; k += static_cast<std::int32_t>(width), list += width) {
      // As many points as a pack has numbers, turned into their x, y, z and states.
      const Pack a = load_for_transpose(points, list, 0), b = load_for_transpose(points, list, 1);
      const Pack c = load_for_transpose(points, list, 2), d = load_for_transpose(points, list, 3);
      const Pack ab = low(a, b), cd = low(c, d);
      const Floats dx = floats(x - low_pairs(ab, cd)), dy = floats(y - high_pairs(ab, cd)),
                   dz = floats(z - low_pairs(high(a, b), high(c, d)));
      const Pack is_swept = high_pairs(high(a, b), high(c, d)) == Point::swept;
      const Floats of_overlap = (Floats)((is_swept & pair_share) | (~is_swept & fixed_share));
      const Floats apart = 1.0f - ((dx * dx + dy * dy) + dz * dz) * per_square;
      const Pack listed = numbers < size - k;
      const Floats s = (Floats)((Pack)moving(gap, apart) & listed), share = share_at(gap, s, of_overlap);
      const Floats scale = (share * s) * (0.5f + s * (0.375f + s * (0.3125f + s * 0.2734375f)));
      push_x += whole(scale * dx);
      push_y += whole(scale * dy);
      push_z += whole(scale * dz);
      depth = s > depth ? s : depth;
    }
    *reinterpret_cast<Quarter*>(pushes + i) = reduce(push_x, push_y, push_z, depth);
  }
}

std::size_t find_reached(const std::int32_t* values, std::size_t n, std::int32_t least, std::uint32_t* found) {
  std::size_t count = 0, i = 0;
  for (; i + width <= n; i += width) {
    unsigned reached = bits(load(values + i) >= least);
    for (; reached != 0; reached &= reached - 1)
      found[count++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(__builtin_ctz(reached));
  }
  for (; i < n; ++i)
    if (values[i] >= least) found[count++] = static_cast<std::uint32_t>(i);
  return count;
}

#endif

void push_off_neighbours(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                         const spot::kernels::Push& push, Point* pushes) {
  if (push.gaps.widest > 0.0f)
    push_off_equal<GapsClose>(points, grains, n, lists, push, pushes);
  else
    push_off_equal<GapsStay>(points, grains, n, lists, push, pushes);
}

}  // namespace

namespace spot::kernels {

extern const Kernels SPOT_KERNELS;
const Kernels SPOT_KERNELS = {SPOT_INSTRUCTION_SET,
                              &enclosed_volume,
                              &displace,
                              &displace_tilted,
                              &count_received,
                              &push_off_neighbours,
                              &enclosed_volume_of_unequal,
                              &push_off_unequal_neighbours,
                              &correct,
                              &find_within,
                              &farthest,
                              &find_reached};

}  // namespace spot::kernels
