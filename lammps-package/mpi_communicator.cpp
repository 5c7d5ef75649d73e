// SPDX-License-Identifier: GPL-2.0-only
#include "mpi_communicator.h"

#include <algorithm>

using spot::Bytes;

namespace {

constexpr int tag = 1;

void put_first_of_pairs(void *in, void *in_out, int *n, MPI_Datatype *) {
  const auto *theirs = static_cast<const spot::Communicator::Pair *>(in);
  auto *ours = static_cast<spot::Communicator::Pair *>(in_out);
  for (int k = 0; k < *n; ++k) ours[k] = std::min(ours[k], theirs[k]);
}

}  // namespace

MpiCommunicator::MpiCommunicator(MPI_Comm world) {
  MPI_Comm_dup(world, &ranks_);  // so that nobody else's messages are taken for ours
  MPI_Comm_rank(ranks_, &rank_);
  MPI_Comm_size(ranks_, &size_);
  MPI_Type_contiguous(2, MPI_INT64_T, &pair_);
  MPI_Type_commit(&pair_);
  MPI_Op_create(put_first_of_pairs, 1, &first_of_pairs_);
}

MpiCommunicator::~MpiCommunicator() {
  MPI_Op_free(&first_of_pairs_);
  MPI_Type_free(&pair_);
  MPI_Comm_free(&ranks_);
}

/// The message that comes next from a rank.
Bytes MpiCommunicator::receive(int from) const {
  MPI_Status status;
  MPI_Probe(from, tag, ranks_, &status);
  int bytes = 0;
  MPI_Get_count(&status, MPI_CHAR, &bytes);
  Bytes message(static_cast<std::size_t>(bytes));
  MPI_Recv(message.data(), bytes, MPI_CHAR, from, tag, ranks_, MPI_STATUS_IGNORE);
  return message;
}

std::vector<Bytes> MpiCommunicator::exchange(std::vector<Bytes> outgoing) {
  std::vector<int> sent, coming(outgoing.size());
  for (const Bytes &bytes : outgoing) sent.push_back(static_cast<int>(bytes.size()));
  MPI_Alltoall(sent.data(), 1, MPI_INT, coming.data(), 1, MPI_INT, ranks_);
  std::vector<MPI_Request> requests;
  std::vector<Bytes> incoming(outgoing.size());
  for (int other = 0; other < size_; ++other) {
    const auto k = static_cast<std::size_t>(other);
    incoming[k].resize(static_cast<std::size_t>(coming[k]));
    if (other == rank_) incoming[k] = outgoing[k];
    if (other == rank_ || coming[k] == 0) continue;
    requests.emplace_back();
    MPI_Irecv(incoming[k].data(), coming[k], MPI_CHAR, other, tag, ranks_, &requests.back());
  }
  for (int other = 0; other < size_; ++other) {
    const auto k = static_cast<std::size_t>(other);
    if (other == rank_ || sent[k] == 0) continue;
    requests.emplace_back();
    MPI_Isend(outgoing[k].data(), sent[k], MPI_CHAR, other, tag, ranks_, &requests.back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

std::array<Bytes, 2> MpiCommunicator::exchange_with_neighbours(std::array<Bytes, 2> outgoing) {
  const std::array<int, 2> neighbours = {rank_ - 1, rank_ + 1};
  const auto exists = [this](int rank) { return rank >= 0 && rank < size_; };
  std::array<MPI_Request, 2> requests = {MPI_REQUEST_NULL, MPI_REQUEST_NULL};
  for (std::size_t side : {0, 1})
    if (exists(neighbours[side]))
      MPI_Isend(outgoing[side].data(), static_cast<int>(outgoing[side].size()), MPI_CHAR, neighbours[side], tag, ranks_,
                &requests[side]);
  std::array<Bytes, 2> incoming;
  for (std::size_t side : {0, 1})
    if (exists(neighbours[side])) incoming[side] = receive(neighbours[side]);
  MPI_Waitall(2, requests.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

std::vector<std::int64_t> MpiCommunicator::sum(std::vector<std::int64_t> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM, ranks_);
  return values;
}

std::vector<double> MpiCommunicator::least(std::vector<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MIN, ranks_);
  return values;
}

spot::Communicator::Pair MpiCommunicator::first(Pair pair) {
  MPI_Allreduce(MPI_IN_PLACE, &pair, 1, pair_, first_of_pairs_, ranks_);
  return pair;
}
