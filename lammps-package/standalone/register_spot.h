// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_REGISTER_SPOT_H
#define SPOT_REGISTER_SPOT_H

/// Why fix spot can't be used in the LAMMPS instance at this address: it is of another version than the one this was
/// built for. A null pointer if it can.
const char *why_not_for(void *lammps);

/// Makes the style `spot` known to `fix` in the LAMMPS instance at this address. Can be called again, and has to
/// be after `clear`, which forgets styles. Returns what why_not_for() does.
extern "C" const char *register_spot(void *lammps);

#endif
