// SPDX-License-Identifier: GPL-2.0-or-later
// The kernels, compiled once an instruction set. Everything here has internal linkage and no inline library function is
// used, so that no code built for one processor can be linked into what another one runs.
#include "kernels.hpp"

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace {

using spot::kernels::lanes;
using spot::kernels::Slots;

int displace(double* __restrict x, double* __restrict y, double* __restrict z, std::uint32_t n, const double* middle,
             double radius_squared, const double* by) {
  const double mx = middle[0], my = middle[1], mz = middle[2];
  const double dx = by[0], dy = by[1], dz = by[2];
  int moved = 0;
#pragma omp simd reduction(+ : moved)
  for (std::uint32_t i = 0; i < n; ++i) {
    const double rx = x[i] - mx, ry = y[i] - my, rz = z[i] - mz;
    const bool inside = rx * rx + ry * ry + rz * rz <= radius_squared;
    x[i] += inside ? dx : 0.0;
    y[i] += inside ? dy : 0.0;
    z[i] += inside ? dz : 0.0;
    moved += inside ? 1 : 0;
  }
  return moved;
}

/// `lanes` numbers at a time; the compiler splits them where registers are shorter.
typedef double Doubles __attribute__((vector_size(lanes * sizeof(double))));
typedef std::int64_t Integers __attribute__((vector_size(lanes * sizeof(std::int64_t))));

inline Doubles all(double value) { return Doubles{} + value; }

template <typename T>
inline Doubles gather(const T* from, Integers index) {
#ifdef __AVX512F__
  return (Doubles)_mm512_i64gather_pd((__m512i)index, from, sizeof(T));
#else
  Doubles values;
  for (int l = 0; l < lanes; ++l) values[l] = from[index[l]];
  return values;
#endif
}

inline Integers gather(const std::uint32_t* from, Integers index) {
  Integers values;
#ifdef __AVX512F__
  values = (Integers)_mm512_cvtepu32_epi64(_mm512_i64gather_epi32((__m512i)index, from, sizeof(std::uint32_t)));
#else
  for (int l = 0; l < lanes; ++l) values[l] = from[index[l]];
#endif
  return values;
}

void push_off_neighbours(const Slots& slots, const std::uint32_t* group, std::uint32_t longest_list, double* push_x,
                         double* push_y, double* push_z) {
  const double *ax = slots.x, *ay = slots.y, *az = slots.z;
  const Doubles per_square = all(1.0 / slots.diameter_squared), share = all(slots.share), shift = all(slots.shift);
  const Doubles zero = all(0.0), one = all(1.0);
  Integers own;
  for (int l = 0; l < lanes; ++l) own[l] = group[l];
  const Doubles x = gather(ax, own), y = gather(ay, own), z = gather(az, own);
  Doubles px = zero, py = zero, pz = zero;
  Integers place = own * static_cast<std::int64_t>(slots.list_capacity);
  for (std::uint32_t k = 0; k < longest_list; ++k, place += 1) {
    const Integers j = gather(slots.lists, place);
    const Doubles dx = x - gather(ax, j), dy = y - gather(ay, j), dz = z - gather(az, j);
    const Doubles apart = one - (dx * dx + dy * dy + dz * dz) * per_square;
    const Doubles s = apart > zero ? apart : zero;
    const Doubles scale = share * s * (0.5 + s * (0.375 + s * (0.3125 + s * 0.2734375)));
    px += (scale * dx + shift) - shift;
    py += (scale * dy + shift) - shift;
    pz += (scale * dz + shift) - shift;
  }
  for (int l = 0; l < lanes; ++l) {
    push_x[l] = px[l];
    push_y[l] = py[l];
    push_z[l] = pz[l];
  }
}

bool any_beyond(const double* x, const double* y, const double* z, const double* reference_x,
                const double* reference_y, const double* reference_z, std::uint32_t n, double reach_squared) {
  int beyond = 0;
#pragma omp simd reduction(+ : beyond)
  for (std::uint32_t i = 0; i < n; ++i) {
    const double dx = x[i] - reference_x[i], dy = y[i] - reference_y[i], dz = z[i] - reference_z[i];
    beyond += dx * dx + dy * dy + dz * dz > reach_squared ? 1 : 0;
  }
  return beyond != 0;
}

}  // namespace

namespace spot::kernels {

extern const Kernels SPOT_KERNELS;
const Kernels SPOT_KERNELS = {SPOT_INSTRUCTION_SET, &displace, &push_off_neighbours, &any_beyond};

}  // namespace spot::kernels
