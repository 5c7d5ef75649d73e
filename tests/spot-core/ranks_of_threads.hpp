// SPDX-License-Identifier: GPL-2.0-or-later
// Ranks that are threads of one process, for tests of what is done on several ranks.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "spot/parallel/communicator.hpp"

namespace scenes {

/// Where the threads meet. When one of them has thrown, all others do.
class MeetingPoint {
 public:
  explicit MeetingPoint(int ranks) : ranks_(ranks), boxes(static_cast<std::size_t>(ranks)) {}

  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    const int round = round_;
    if (++waiting_ == ranks_) {
      waiting_ = 0;
      ++round_;
      all_here_.notify_all();
    }
    all_here_.wait(lock, [&] { return round_ != round || broken_; });
    if (broken_) throw std::runtime_error("another rank has thrown");
  }

  void give_up() {
    const std::lock_guard<std::mutex> lock(mutex_);
    broken_ = true;
    all_here_.notify_all();
  }

 private:
  const int ranks_;
  std::mutex mutex_;
  std::condition_variable all_here_;
  int waiting_ = 0, round_ = 0;
  bool broken_ = false;

 public:
  std::vector<std::vector<spot::Bytes>> boxes;  // of each rank: what it sends to each
};

class ThreadRank : public spot::Communicator {
 public:
  using spot::Communicator::sum;
  ThreadRank(int rank, int size, std::shared_ptr<MeetingPoint> point)
      : rank_(rank), size_(size), point_(std::move(point)) {}

  int rank() const override { return rank_; }
  int size() const override { return size_; }

  std::vector<spot::Bytes> exchange(std::vector<spot::Bytes> outgoing) override {
    point_->boxes[own()] = std::move(outgoing);
    point_->wait();
    std::vector<spot::Bytes> incoming;
    for (const auto& box : point_->boxes) incoming.push_back(box[own()]);
    point_->wait();
    return incoming;
  }

  std::array<spot::Bytes, 2> exchange_with_neighbours(std::array<spot::Bytes, 2> outgoing) override {
    std::vector<spot::Bytes> to(static_cast<std::size_t>(size_));
    if (rank_ > 0) to[own() - 1] = outgoing[0];
    if (rank_ + 1 < size_) to[own() + 1] = outgoing[1];
    const auto from = exchange(to);
    return {rank_ > 0 ? from[own() - 1] : spot::Bytes{}, rank_ + 1 < size_ ? from[own() + 1] : spot::Bytes{}};
  }

  std::vector<std::int64_t> sum(std::vector<std::int64_t> values) override {
    return combined(values, [](std::int64_t& a, std::int64_t b) { a += b; });
  }
  std::vector<double> least(std::vector<double> values) override {
    return combined(values, [](double& a, double b) { a = std::min(a, b); });
  }
  Pair first(Pair pair) override {
    return combined(std::vector<Pair>{pair}, [](Pair& a, const Pair& b) { a = std::min(a, b); })[0];
  }

 private:
  std::size_t own() const { return static_cast<std::size_t>(rank_); }

  template <typename T, typename Combine>
  std::vector<T> combined(const std::vector<T>& values, const Combine& combine) {
    spot::Bytes bytes;
    spot::append(bytes, values);
    std::vector<T> all;
    for (const auto& other : share_with_all(bytes)) {
      const auto theirs = spot::ByteReader(other).take_all<T>();
      if (all.empty())
        all = theirs;
      else
        for (std::size_t k = 0; k < all.size(); ++k) combine(all[k], theirs[k]);
    }
    return all;
  }

  int rank_, size_;
  std::shared_ptr<MeetingPoint> point_;
};

/// Calls job(communicator) on so many ranks; rethrows what the first of them has thrown.
inline void on_ranks(int ranks, const std::function<void(std::shared_ptr<spot::Communicator>)>& job) {
  const auto point = std::make_shared<MeetingPoint>(ranks);
  std::vector<std::thread> threads;
  std::exception_ptr first;
  std::mutex mutex;
  for (int rank = 0; rank < ranks; ++rank)
    threads.emplace_back([&, rank] {
      try {
        job(std::make_shared<ThreadRank>(rank, ranks, point));
      } catch (...) {
        {
          const std::lock_guard<std::mutex> lock(mutex);
          if (!first) first = std::current_exception();
        }
        point->give_up();
      }
    });
  for (std::thread& thread : threads) thread.join();
  if (first) std::rethrow_exception(first);
}

}  // namespace scenes
