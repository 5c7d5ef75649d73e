// SPDX-License-Identifier: GPL-2.0-or-later
#include "packing/kernel_builds.hpp"

#include <cstdlib>
#include <cstring>

#include "spot/base/errors.hpp"

namespace spot::kernels {

extern const Kernels base;
#ifdef SPOT_X86_KERNELS
extern const Kernels v3, v4;
#endif

namespace {

const Kernels& choose() {
  const std::vector<const Kernels*> builds = runnable();
  const char* wanted = std::getenv("SPOT_INSTRUCTION_SET");
  if (wanted == nullptr) return *builds.back();
  for (const Kernels* build : builds)
    if (std::strcmp(wanted, build->instruction_set) == 0) return *build;
  throw InvalidParameter(message("SPOT_INSTRUCTION_SET is '", wanted, "', which this processor cannot run"));
}

}  // namespace

std::vector<const Kernels*> runnable() {
  std::vector<const Kernels*> builds = {&base};
#ifdef SPOT_X86_KERNELS
  if (__builtin_cpu_supports("x86-64-v3")) builds.push_back(&v3);
  if (__builtin_cpu_supports("x86-64-v4")) builds.push_back(&v4);
#endif
  return builds;
}

const Kernels& best() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace spot::kernels
