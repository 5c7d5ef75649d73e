// SPDX-License-Identifier: GPL-2.0-only
#include "grain_delivery.h"

#include <unordered_map>

#include "spot/errors.hpp"

using spot::ByteReader;
using spot::Bytes;

namespace {

/// Messages for all ranks.
template <typename Record, typename RankOf>
std::vector<Bytes> sort_by_rank(const std::vector<Record> &records, int ranks, const RankOf &rank_of) {
  std::vector<std::vector<Record>> of_rank(static_cast<std::size_t>(ranks));
  for (const Record &record : records) of_rank[static_cast<std::size_t>(rank_of(record))].push_back(record);
  std::vector<Bytes> messages(of_rank.size());
  for (std::size_t rank = 0; rank < of_rank.size(); ++rank) spot::append(messages[rank], of_rank[rank]);
  return messages;
}

}  // namespace

template <typename Parcel>
std::vector<Parcel> deliver(const std::vector<Parcel> &parcels, const std::vector<std::int64_t> &held,
                            spot::Communicator &communicator) {
  const int ranks = communicator.size();
  const auto meeting = [ranks](std::int64_t id) { return static_cast<int>(id % ranks); };
  std::unordered_map<std::int64_t, int> holder;
  const auto claims = communicator.exchange(sort_by_rank(held, ranks, meeting));
  for (int rank = 0; rank < ranks; ++rank)
    for (const std::int64_t id : ByteReader(claims[static_cast<std::size_t>(rank)]).take_all<std::int64_t>())
      holder[id] = rank;
  std::vector<Parcel> in_transit;
  for (const Bytes &bytes :
       communicator.exchange(sort_by_rank(parcels, ranks, [&](const Parcel &parcel) { return meeting(parcel.id); })))
    for (const Parcel &parcel : ByteReader(bytes).take_all<Parcel>()) {
      if (holder.count(parcel.id) == 0)
        throw spot::InvalidPacking(
            spot::message("grain ", parcel.id, " was lost by LAMMPS: make the simulation box larger"));
      in_transit.push_back(parcel);
    }
  std::vector<Parcel> arrived;
  for (const Bytes &bytes : communicator.exchange(
           sort_by_rank(in_transit, ranks, [&](const Parcel &parcel) { return holder.at(parcel.id); })))
    for (const Parcel &parcel : ByteReader(bytes).take_all<Parcel>()) arrived.push_back(parcel);
  return arrived;
}

template std::vector<Delivery> deliver(const std::vector<Delivery> &, const std::vector<std::int64_t> &,
                                       spot::Communicator &);
template std::vector<DeliveredMoves> deliver(const std::vector<DeliveredMoves> &, const std::vector<std::int64_t> &,
                                             spot::Communicator &);
