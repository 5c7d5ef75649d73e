// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "spot/base/bytes.hpp"

namespace spot {

/// How the ranks that share one packing talk to each other. All functions are collective: every rank calls the same
/// ones, in the same order.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends outgoing[k] to rank k; returns what each rank has sent here.
  virtual std::vector<Bytes> exchange(std::vector<Bytes> outgoing) = 0;

  /// Sends to the rank before (first) and after (second) this one; returns what these have sent here. Where there is no
  /// such rank, nothing is sent and nothing comes.
  virtual std::array<Bytes, 2> exchange_with_neighbours(std::array<Bytes, 2> outgoing) = 0;

  /// Sums over all ranks.
  virtual std::vector<std::int64_t> sum(std::vector<std::int64_t> values) = 0;

  /// Least values of all ranks.
  virtual std::vector<double> least(std::vector<double> values) = 0;

  /// The pair of any rank that is first in order: by its first number, then by its second.
  using Pair = std::array<std::int64_t, 2>;
  virtual Pair first(Pair pair) = 0;

  /// The same bytes go to all ranks; returns those of each.
  std::vector<Bytes> share_with_all(const Bytes& own) {
    return exchange(std::vector<Bytes>(static_cast<std::size_t>(size()), own));
  }

  std::int64_t sum(std::int64_t value) { return sum(std::vector<std::int64_t>{value})[0]; }
};

/// One rank, which has nobody to talk to.
class Alone : public Communicator {
 public:
  using Communicator::sum;
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<Bytes> exchange(std::vector<Bytes> outgoing) override { return outgoing; }
  std::array<Bytes, 2> exchange_with_neighbours(std::array<Bytes, 2>) override { return {}; }
  std::vector<std::int64_t> sum(std::vector<std::int64_t> values) override { return values; }
  std::vector<double> least(std::vector<double> values) override { return values; }
  Pair first(Pair pair) override { return pair; }
};

}  // namespace spot
