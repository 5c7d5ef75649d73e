// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace spot {

/// Threads that wait for work: jobs of some microseconds, thousands a second.
class Workers {
 public:
  static constexpr int most = 256;

  /// The calling thread is one of them. Throws InvalidParameter unless 1 <= threads <= most.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int size() const { return static_cast<int>(helpers_.size()) + 1; }

  /// Calls job(0), ..., job(size() - 1), each on its own thread, and returns when all have returned. Jobs must not
  /// throw.
  void run(const std::function<void(int)>& job);

 private:
  void help(int worker);

  std::vector<std::thread> helpers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  const std::function<void(int)>* job_ = nullptr;
  std::atomic<int> round_{0}, busy_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace spot
