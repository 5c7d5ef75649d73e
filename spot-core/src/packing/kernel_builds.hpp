// SPDX-License-Identifier: GPL-2.0-or-later
// Apart from kernels.hpp, which the builds include: they must not see inline library functions.
#pragma once

#include <vector>

#include "packing/kernels.hpp"

namespace spot::kernels {

/// The builds that this processor can run, the plain one first and the best last.
std::vector<const Kernels*> runnable();

/// The best build that this processor can run, or the one that the environment variable SPOT_INSTRUCTION_SET names
/// (base, x86-64-v3, x86-64-v4; for tests). Throws InvalidParameter if that one cannot run here.
const Kernels& best();

}  // namespace spot::kernels
