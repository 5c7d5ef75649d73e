// SPDX-License-Identifier: GPL-2.0-or-later
#define SPOT_KERNELS v4
#define SPOT_INSTRUCTION_SET "x86-64-v4"
#include "packing/kernels.inl"
