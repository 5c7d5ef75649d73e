// SPDX-License-Identifier: GPL-2.0-or-later
#define SPOT_KERNELS v3
#define SPOT_INSTRUCTION_SET "x86-64-v3"
#include "packing/kernels.inl"
