// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_LAMMPS_HEADERS_H
#define SPOT_LAMMPS_HEADERS_H

// To be included before any header of LAMMPS. In a source tree of LAMMPS, and with an installed one that brings its own
// fmt, it does nothing (cmake/installed_lammps.cmake).
//
// Headers that Debian 12 installs ask for <fmt/...> but bring none, and use a function that fmt 9 no longer has.
// It is declared here only to make templates parse that are never instantiated: LAMMPS exports its own, older fmt, so
// every message goes to it as a finished std::string.

#ifdef SPOT_LAMMPS_LACKS_FMT
#include <fmt/format.h>

#if FMT_VERSION >= 90000
namespace fmt {
template <typename... Args>
format_args make_args_checked(...);
}
#endif
#endif

#endif
