// SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels.hpp"

#include <cstdlib>
#include <cstring>

#include "spot/errors.hpp"

namespace spot::kernels {

extern const Kernels base;
#ifdef SPOT_X86_KERNELS
extern const Kernels v3, v4;
#endif

namespace {

const Kernels& choose() {
  const char* wanted = std::getenv("SPOT_INSTRUCTION_SET");
  const auto is_wanted = [&](const Kernels& kernels) {
    return wanted == nullptr || std::strcmp(wanted, kernels.instruction_set) == 0;
  };
#ifdef SPOT_X86_KERNELS
  if (is_wanted(v4) && __builtin_cpu_supports("x86-64-v4")) return v4;
  if (is_wanted(v3) && __builtin_cpu_supports("x86-64-v3")) return v3;
#endif
  if (is_wanted(base)) return base;
  throw InvalidParameter(message("SPOT_INSTRUCTION_SET is '", wanted, "', which this processor cannot run"));
}

}  // namespace

const Kernels& best() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace spot::kernels
