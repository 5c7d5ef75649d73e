// SPDX-License-Identifier: GPL-2.0-only
#include "saved_run.h"

#include <cstddef>
#include <cstring>
#include <limits>

#include "spot/base/errors.hpp"

using spot::ByteReader;
using spot::Bytes;
using spot::InvalidState;
using spot::message;

namespace {

constexpr char magic[8] = {'s', 'p', 'o', 't', ' ', 'r', 'u', 'n'};
constexpr std::int32_t version = saved_run_version;

/// What the state of a run begins with. Magic and version stand where they stood in version 1 and always will.
struct Header {
  char magic[8];
  std::int32_t version, complement;  // of all bits of the version; new in version 5
  std::uint64_t head, parts;         // bytes that follow: of the head, then of all parts
  std::uint64_t checksum;            // of all before

  std::uint64_t expected_checksum() const {
    return spot::checksum(reinterpret_cast<const char *>(this), sizeof *this - sizeof checksum);
  }
};
static_assert(sizeof(Header) == 40, "no gaps");

void append_text(Bytes &bytes, const std::string &text) {
  spot::append(bytes, std::vector<char>(text.begin(), text.end()));
}

std::string take_text(ByteReader &reader) {
  const auto text = reader.take_all<char>();
  return {text.begin(), text.end()};
}

Bytes head_of(const SavedRun &run, const std::vector<std::int64_t> &sizes) {
  Bytes head;
  spot::append(head, static_cast<std::uint64_t>(run.settings.size()));
  for (const auto &[name, value] : run.settings) {
    append_text(head, name);
    append_text(head, value);
  }
  spot::append(head, run.sizes.largest);
  spot::append(head, run.sizes.mean_volume);
  spot::append(head, run.window);
  spot::append(head, run.windows);
  spot::append(head, run.drained_mass);
  spot::append(head, run.drained_at);
  spot::append(head, run.windows_after_step);
  spot::append(head, run.drained_after_step);
  spot::append(head, sizes);
  spot::seal(head);
  return head;
}

/// All but the parts, of whose sizes it returns.
std::vector<std::int64_t> take_head(ByteReader reader, SavedRun &run) {
  for (auto n = reader.take<std::uint64_t>(); n > 0; --n) {
    const std::string name = take_text(reader);
    run.settings.emplace_back(name, take_text(reader));
  }
  run.sizes.largest = reader.take<double>();
  run.sizes.mean_volume = reader.take<double>();
  run.window = reader.take<double>();
  run.windows = reader.take<std::int64_t>();
  run.drained_mass = reader.take<double>();
  run.drained_at = reader.take_all<std::int64_t>();
  run.windows_after_step = reader.take_all<std::int64_t>();
  run.drained_after_step = reader.take_all<std::int64_t>();
  if (run.windows_after_step.size() != run.drained_after_step.size() || run.drained_after_step.empty())
    throw InvalidState("the restart file is damaged: the counts of drained grains do not fit together");
  return reader.take_all<std::int64_t>();
}

/// Throws spot::InvalidState unless the header is one of ours, of this version, and as it was written.
Header take_header(const char *bytes) {
  Header header;
  // Older files may end sooner than a header of today.
  std::memcpy(&header, bytes, offsetof(Header, complement));
  if (std::memcmp(header.magic, magic, sizeof magic) != 0)
    throw InvalidState("the restart file holds no state of fix spot, or is damaged");
  std::memcpy(&header.complement, bytes + offsetof(Header, complement), sizeof header.complement);
  const bool newer = header.version != version && header.complement == ~header.version;
  const bool older = header.version > 0 && header.version < 5 && header.complement != ~version;
  if (newer || older)
    throw InvalidState(message("the restart file is of format ", header.version, " of fix spot, but this one knows ",
                               version,
                               " only: go on with the fix spot that wrote it, or give the fix another ID to "
                               "start anew from its grains, without spots"));
  std::memcpy(&header, bytes, sizeof header);
  if (header.version != version || header.complement != ~version || header.checksum != header.expected_checksum())
    throw InvalidState("the restart file is damaged: the header of fix spot is not as it was written");
  return header;
}

void write(const void *bytes, std::size_t n, std::FILE *file) {
  if (std::fwrite(bytes, 1, n, file) != n) throw InvalidState("the restart file cannot be written: is the disk full?");
}

}  // namespace

/// The length of all that follows, for LAMMPS; header; head, which has the sizes of the parts; parts, one a rank. Head
/// and parts are sealed, each by whom made it.
void write_run(const SavedRun &run, const Bytes &own_part, std::FILE *file, spot::Communicator &communicator) {
  const auto ranks = static_cast<std::size_t>(communicator.size());
  std::vector<std::int64_t> sizes(ranks, 0);
  sizes[static_cast<std::size_t>(communicator.rank())] = static_cast<std::int64_t>(own_part.size());
  sizes = communicator.sum(sizes);
  const Bytes head = head_of(run, sizes);
  Header header{};
  std::memcpy(header.magic, magic, sizeof magic);
  header.version = version;
  header.complement = ~version;
  header.head = head.size();
  for (const std::int64_t size : sizes) header.parts += static_cast<std::uint64_t>(size);
  header.checksum = header.expected_checksum();
  const std::uint64_t all = sizeof header + header.head + header.parts;
  if (all > std::numeric_limits<std::int32_t>::max())
    throw InvalidState(message("the state of the run has ", all, " bytes; restart files of LAMMPS hold up to ",
                               std::numeric_limits<std::int32_t>::max(), " of a fix"));
  if (communicator.rank() == 0) {
    const auto length = static_cast<std::int32_t>(all);
    write(&length, sizeof length, file);
    write(&header, sizeof header, file);
    write(head.data(), head.size(), file);
  }
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    std::vector<Bytes> outgoing(ranks);
    if (communicator.rank() == static_cast<int>(rank)) outgoing[0] = own_part;
    const Bytes part = communicator.exchange(std::move(outgoing))[rank];
    if (communicator.rank() == 0) write(part.data(), part.size(), file);
  }
}

SavedRun read_run(const char *bytes) {
  const Header header = take_header(bytes);
  const char *next = bytes + sizeof header, *const parts = next + header.head, *const end = parts + header.parts;
  SavedRun run;
  const std::vector<std::int64_t> sizes = take_head(spot::unseal(next, header.head), run);
  next = parts;
  for (const std::int64_t size : sizes) {
    if (size < 0 || size > end - next) throw InvalidState("the restart file is damaged: parts are longer than all");
    run.parts.emplace_back(next, next + size);
    next += size;
    spot::unseal(run.parts.back());  // whoever uses a part looks at it, but may find it damaged too late for others
  }
  return run;
}

void require_same_settings(const SavedRun &run, const std::vector<std::pair<std::string, std::string>> &settings) {
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const auto &[name, value] = settings[k];
    if (k >= run.settings.size() || run.settings[k].first != name)
      throw InvalidState(message("the restart file knows no '", name, "'"));
    if (run.settings[k].second != value)
      throw InvalidState(message(name, " was ", run.settings[k].second,
                                 " in the run that the restart file is of, but is ", value,
                                 " now; to start anew, give the fix another ID"));
  }
}
