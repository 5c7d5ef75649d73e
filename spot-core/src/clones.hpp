// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

/// Put before a kernel, builds it for several instruction sets; the best that the processor has is taken when the
/// program starts. Results are the same bits for all (-ffp-contract=off). GCC only; sanitizers cannot resolve it.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SPOT_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SPOT_CLONES
#endif
