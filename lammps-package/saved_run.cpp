// SPDX-License-Identifier: GPL-2.0-only
#include "saved_run.h"

#include <cstring>
#include <limits>

#include "spot/errors.hpp"

using spot::ByteReader;
using spot::Bytes;
using spot::InvalidState;
using spot::message;

namespace {

constexpr char magic[8] = {'s', 'p', 'o', 't', ' ', 'r', 'u', 'n'};
constexpr std::int32_t version = 5;

/// FNV-1a, of eight bytes at a time: enough to find what was cut off or overwritten.
class Checksum {
 public:
  void add(const char *bytes, std::size_t n) {
    for (; n >= 8; bytes += 8, n -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    for (; n > 0; ++bytes, --n) mix(static_cast<unsigned char>(*bytes));
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) { hash_ = (hash_ ^ word) * 1099511628211u; }
  std::uint64_t hash_ = 14695981039346656037u;
};

void append_text(Bytes &bytes, const std::string &text) {
  spot::append(bytes, std::vector<char>(text.begin(), text.end()));
}

std::string take_text(ByteReader &reader) {
  const auto text = reader.take_all<char>();
  return {text.begin(), text.end()};
}

Bytes head_of(const SavedRun &run, int ranks) {
  Bytes head;
  spot::append(head, static_cast<std::uint64_t>(run.settings.size()));
  for (const auto &[name, value] : run.settings) {
    append_text(head, name);
    append_text(head, value);
  }
  spot::append(head, run.window);
  spot::append(head, run.windows);
  spot::append(head, run.drained_mass);
  spot::append(head, run.windows_after_step);
  spot::append(head, run.drained_after_step);
  spot::append(head, static_cast<std::uint64_t>(ranks));
  return head;
}

/// Adds to a file, and to the checksum of what has been added.
class Writer {
 public:
  explicit Writer(std::FILE *file) : file_(file) {}
  void add(const void *bytes, std::size_t n) {
    if (std::fwrite(bytes, 1, n, file_) != n)
      throw InvalidState("the restart file cannot be written: is the disk full?");
    checksum_.add(static_cast<const char *>(bytes), n);
  }
  std::uint64_t checksum() const { return checksum_.value(); }

 private:
  std::FILE *file_;
  Checksum checksum_;
};

}  // namespace

/// Length of all that follows; magic, version, length of head and parts; head; length and bytes of each part; checksum.
void write_run(const SavedRun &run, const Bytes &own_part, std::FILE *file, spot::Communicator &communicator) {
  const int ranks = communicator.size();
  const Bytes head = head_of(run, ranks);
  std::uint64_t body = head.size() + 8u * static_cast<std::uint64_t>(ranks);
  body += static_cast<std::uint64_t>(communicator.sum(static_cast<std::int64_t>(own_part.size())));
  const std::uint64_t all = sizeof magic + sizeof version + sizeof body + body + sizeof(std::uint64_t);
  if (all > std::numeric_limits<std::int32_t>::max())
    throw InvalidState(message("the state of the run has ", all, " bytes; restart files of LAMMPS hold up to ",
                               std::numeric_limits<std::int32_t>::max(), " of a fix"));
  if (communicator.rank() == 0) {
    const auto length = static_cast<std::int32_t>(all);
    if (std::fwrite(&length, sizeof length, 1, file) != 1)
      throw InvalidState("the restart file cannot be written: is the disk full?");
  }
  Writer writer(file);
  for (int rank = 0; rank < ranks; ++rank) {
    std::vector<Bytes> outgoing(static_cast<std::size_t>(ranks));
    if (communicator.rank() == rank) outgoing[0] = own_part;
    const Bytes part = communicator.exchange(std::move(outgoing))[static_cast<std::size_t>(rank)];
    if (communicator.rank() != 0) continue;
    if (rank == 0) {
      writer.add(magic, sizeof magic);
      writer.add(&version, sizeof version);
      writer.add(&body, sizeof body);
      writer.add(head.data(), head.size());
    }
    const std::uint64_t size = part.size();
    writer.add(&size, sizeof size);
    writer.add(part.data(), part.size());
  }
  if (communicator.rank() != 0) return;
  const std::uint64_t checksum = writer.checksum();
  writer.add(&checksum, sizeof checksum);
}

SavedRun read_run(const char *bytes) {
  constexpr std::size_t fixed = sizeof magic + sizeof version + sizeof(std::uint64_t);
  std::int32_t found;
  std::uint64_t body;
  std::memcpy(&found, bytes + sizeof magic, sizeof found);
  std::memcpy(&body, bytes + sizeof magic + sizeof found, sizeof body);
  if (std::memcmp(bytes, magic, sizeof magic) != 0) throw InvalidState("the restart file holds no state of fix spot");
  if (found != version)
    throw InvalidState(message("the restart file is of version ", found, " of fix spot, which is not ", version));
  if (body > std::numeric_limits<std::int32_t>::max()) throw InvalidState("the restart file is damaged");
  Checksum checksum;
  // In the pieces in which it was written: the remainders of eight bytes count one by one.
  checksum.add(bytes, sizeof magic);
  checksum.add(bytes + sizeof magic, sizeof version);
  checksum.add(bytes + sizeof magic + sizeof version, sizeof body);
  ByteReader reader(bytes + fixed, body);
  SavedRun run;
  for (auto n = reader.take<std::uint64_t>(); n > 0; --n) {
    const std::string name = take_text(reader);
    run.settings.emplace_back(name, take_text(reader));
  }
  run.window = reader.take<double>();
  run.windows = reader.take<std::int64_t>();
  run.drained_mass = reader.take<double>();
  run.windows_after_step = reader.take_all<std::int64_t>();
  run.drained_after_step = reader.take_all<std::int64_t>();
  if (run.windows_after_step.size() != run.drained_after_step.size() || run.drained_after_step.empty())
    throw InvalidState("the restart file is damaged: the counts of drained grains do not fit together");
  const auto parts = reader.take<std::uint64_t>();
  const Bytes head = head_of(run, static_cast<int>(parts));
  checksum.add(head.data(), head.size());
  for (std::uint64_t k = 0; k < parts; ++k) {
    run.parts.push_back(reader.take_all<char>());
    const std::uint64_t size = run.parts.back().size();
    checksum.add(reinterpret_cast<const char *>(&size), sizeof size);
    checksum.add(run.parts.back().data(), run.parts.back().size());
  }
  std::uint64_t expected;
  std::memcpy(&expected, bytes + fixed + body, sizeof expected);
  if (checksum.value() != expected)
    throw InvalidState("the restart file is damaged: the checksum of fix spot is wrong");
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
