// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace spot {

/// Threads that wait for work: jobs of some microseconds, thousands a second.
class Workers {
 public:
  static constexpr int most = 256;

  /// The calling thread is one of them. Throws InvalidParameter unless 1 <= threads <= most, or if the system has no
  /// more threads. `rounds`: where their count begins.
  explicit Workers(int threads, std::uint64_t rounds = 0);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int size() const { return static_cast<int>(helpers_.size()) + 1; }

  /// Calls job(0), ..., job(size() - 1), each on its own thread, and returns when all have returned. If any
  /// have thrown, rethrows what the first of them, in this order, has: where they share work out in order, what one
  /// thread alone would have met. The threads are ready for more.
  void run(const std::function<void(int)>& job);

  /// Calls job(worker, first, last) for consecutive parts of 0 ... n, exclusive, as equal as can be: one for each
  /// worker, in order. If there are none, nobody is called.
  void share_out(std::size_t n, const std::function<void(int, std::size_t, std::size_t)>& job);

 private:
  void help(int worker);
  void attempt(const std::function<void(int)>& job, int worker) noexcept;
  void stop();

  std::vector<std::thread> helpers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  const std::function<void(int)>* job_ = nullptr;
  std::vector<std::exception_ptr> thrown_;  // by each worker in this round
  std::uint64_t first_round_;
  std::atomic<std::uint64_t> round_;  // 64 bits: a million rounds a second for half a million years
  std::atomic<int> busy_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace spot
