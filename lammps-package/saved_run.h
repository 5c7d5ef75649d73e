// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_SAVED_RUN_H
#define SPOT_SAVED_RUN_H

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "grain_sizes.h"
#include "spot/parallel/communicator.hpp"

/// Of the format of what the fix puts into a restart file, which no other version reads.
inline constexpr std::int32_t saved_run_version = 15;

/// What the fix puts into a restart file of LAMMPS.
struct SavedRun {
  std::vector<std::pair<std::string, std::string>> settings;  // what must be the same when the run goes on
  GrainSizes sizes;                                           // as they were; no grain may be left
  double window = 0.0;                                        // 0: not chosen yet
  std::int64_t windows = 0;
  double drained_mass = 0.0;
  std::vector<std::int64_t> drained_at;                              // grains that have left through each outlet
  std::vector<std::int64_t> windows_after_step, drained_after_step;  // of which the outflow is a mean
  std::vector<spot::Bytes> parts;                                    // what spot::Drainage::save() gave on every rank
};

/// Collective. Writes a run, of whose parts every rank has one; `file` is open on rank 0. The parts of other ranks come
/// to rank 0 one after the other. Throws spot::InvalidState if they are too many bytes for a restart file of LAMMPS, or
/// cannot be written.
void write_run(const SavedRun &run, const spot::Bytes &own_part, std::FILE *file, spot::Communicator &communicator);

/// Reads what write_run() wrote after its length, which LAMMPS reads by itself and does not tell: of bytes that do not
/// begin with the header that was written, no more than its size is looked at. Throws spot::InvalidState if they are
/// damaged, before it uses any, or of another version.
SavedRun read_run(const char *bytes);

/// Throws spot::InvalidState that names the first setting which is not what it was.
void require_same_settings(const SavedRun &run, const std::vector<std::pair<std::string, std::string>> &settings);

#endif
