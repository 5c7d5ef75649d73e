// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/parallel/communicator.hpp"

namespace spot {

/// Sends the same to all ranks, this one included; returns what each has sent.
inline std::vector<Bytes> to_all_ranks(const Bytes& own, Communicator& communicator) {
  return communicator.exchange(std::vector<Bytes>(static_cast<std::size_t>(communicator.size()), own));
}

}  // namespace spot
