// SPDX-License-Identifier: GPL-2.0-only
#include "grain_delivery.h"

#include <unordered_map>
#include <unordered_set>

#include "spot/base/errors.hpp"

using spot::ByteReader;
using spot::Bytes;

namespace {

/// Where all that concerns a grain comes together.
int meeting_rank(std::int64_t id, int ranks) { return static_cast<int>(id % ranks); }

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
  const auto meeting = [ranks](std::int64_t id) { return meeting_rank(id, ranks); };
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

namespace {

/// A grain, as messages carry it.
struct Whereabouts {
  std::int64_t id;
  double position[3];
  bool held;
  double radius;

  explicit Whereabouts(const spot::Grain &grain)
      : id(grain.id),
        position{grain.position[0], grain.position[1], grain.position[2]},
        held(grain.held),
        radius(grain.radius) {}
  Whereabouts() = default;
  spot::Grain grain() const { return {id, {position[0], position[1], position[2]}, held, radius}; }
};

std::vector<Bytes> sort_by_meeting(const std::vector<spot::Grain> &grains, int ranks) {
  std::vector<Whereabouts> all(grains.begin(), grains.end());
  return sort_by_rank(all, ranks, [ranks](const Whereabouts &grain) { return meeting_rank(grain.id, ranks); });
}

/// Another grain may have the number of one that is gone, at another place.
void require_same_radius(const spot::Grain &was, const spot::Grain &is) {
  if (was.position == is.position && was.radius != is.radius)
    throw spot::InvalidPacking(spot::message("grain ", is.id, " was ", 2.0 * was.radius, " wide and is ",
                                             2.0 * is.radius, " wide now: grains must keep their size"));
}

}  // namespace

spot::GrainChanges find_changes(const std::vector<spot::Grain> &packing, const std::vector<spot::Grain> &lammps,
                                spot::Communicator &communicator) {
  const int ranks = communicator.size();
  std::unordered_map<std::int64_t, spot::Grain> known;
  for (const Bytes &bytes : communicator.exchange(sort_by_meeting(packing, ranks)))
    for (const auto &place : ByteReader(bytes).take_all<Whereabouts>()) known.emplace(place.id, place.grain());
  spot::GrainChanges changes;
  std::unordered_set<std::int64_t> seen;
  for (const Bytes &bytes : communicator.exchange(sort_by_meeting(lammps, ranks)))
    for (const auto &place : ByteReader(bytes).take_all<Whereabouts>()) {
      if (!seen.insert(place.id).second) throw spot::InvalidPacking(spot::message("grain ", place.id, " occurs twice"));
      const auto found = known.find(place.id);
      if (found != known.end()) require_same_radius(found->second, place.grain());
      if (found != known.end() && found->second == place.grain())
        known.erase(found);
      else
        changes.come.push_back(place.grain());
    }
  for (const auto &[id, last] : known) changes.gone.push_back(id);
  return changes;
}
