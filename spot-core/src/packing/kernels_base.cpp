// SPDX-License-Identifier: GPL-2.0-or-later
#define SPOT_KERNELS base
#define SPOT_INSTRUCTION_SET "base"
#include "packing/kernels.inl"
