// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace spot {

/// Every use of random numbers in spot-core. A new use gets a new number, so that no two uses share draws.
enum class RandomPurpose : std::uint64_t {
  birth = 1,          ///< when and where spot `id` is born
  step = 2,           ///< when and where to step `step` of spot `id` goes
  settling = 3,       ///< to which side grain `id` rolls in sweep `step`
  fall = 4,           ///< how fast grain `id` falls
  nonaffine = 6,      ///< how grain `id` goes against its neighbours in level `step` of its fall
  recirculation = 7,  ///< where grain `id` comes in again, at time and attempt `step`
};

/// Four uniform numbers in [0, 1) that depend on the arguments alone (Philox4x64-10, Salmon et al., SC11).
/// There is no state: a restart, a thread count or a rank count cannot change what is drawn.
std::array<double, 4> uniform(std::uint64_t seed, RandomPurpose purpose, std::uint64_t id, std::uint64_t step);

/// An exponentially distributed waiting time with the given rate, from a uniform number in [0, 1).
double exponential(double uniform, double rate);

}  // namespace spot
