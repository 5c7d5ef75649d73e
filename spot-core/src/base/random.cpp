// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/random.hpp"

#include <Random123/philox.h>

#include "spot/base/elementary.hpp"

namespace spot {

std::array<double, 4> uniform(std::uint64_t seed, RandomPurpose purpose, std::uint64_t id, std::uint64_t step) {
  const r123::Philox4x64 generator;
  const r123::Philox4x64::key_type key = {{seed, static_cast<std::uint64_t>(purpose)}};
  const r123::Philox4x64::ctr_type counter = {{id, step, 0, 0}};
  const auto bits = generator(counter, key);
  std::array<double, 4> numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(bits[i] >> 11) * 0x1p-53;
  return numbers;
}

double exponential(double uniform, double rate) { return -log1p(-uniform) / rate; }

}  // namespace spot
