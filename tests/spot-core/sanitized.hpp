// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

extern "C" {
void __asan_init() __attribute__((weak));
void __tsan_init() __attribute__((weak));
}

namespace scenes {

/// Is what this program tests built with a sanitizer, and so several times slower? Told by what is linked, since the
/// same compiled tests are linked to builds with and without.
inline bool sanitized() { return __asan_init || __tsan_init; }

}  // namespace scenes
