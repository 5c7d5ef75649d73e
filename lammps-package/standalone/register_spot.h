// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_REGISTER_SPOT_H
#define SPOT_REGISTER_SPOT_H

/// Makes the style `spot` known to `fix` in the LAMMPS instance at this address. Can be called again, and has to
/// be after `clear`, which forgets styles. Returns a null pointer, or what went wrong: a LAMMPS of another version
/// than the one this was built for cannot be used.
extern "C" const char *register_spot(void *lammps);

#endif
