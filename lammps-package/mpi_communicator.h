// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_MPI_COMMUNICATOR_H
#define SPOT_MPI_COMMUNICATOR_H

#include <mpi.h>

#include "spot/parallel/communicator.hpp"

/// The ranks of an MPI communicator.
class MpiCommunicator : public spot::Communicator {
 public:
  using spot::Communicator::sum;
  explicit MpiCommunicator(MPI_Comm world);
  ~MpiCommunicator() override;
  MpiCommunicator(const MpiCommunicator &) = delete;
  MpiCommunicator &operator=(const MpiCommunicator &) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<spot::Bytes> exchange(std::vector<spot::Bytes> outgoing) override;
  std::array<spot::Bytes, 2> exchange_with_neighbours(std::array<spot::Bytes, 2> outgoing) override;
  std::vector<std::int64_t> sum(std::vector<std::int64_t> values) override;
  std::vector<double> least(std::vector<double> values) override;
  Pair first(Pair pair) override;

 private:
  spot::Bytes receive(int from) const;

  MPI_Comm ranks_;
  MPI_Datatype pair_;
  MPI_Op first_of_pairs_;
  int rank_, size_;
};

#endif
