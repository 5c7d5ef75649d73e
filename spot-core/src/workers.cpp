// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/workers.hpp"

#include "spot/errors.hpp"

namespace spot {

namespace {

/// Rounds of looking for the next job before a thread goes to sleep; jobs mostly follow each other within microseconds.
constexpr int rounds_awake = 20000;

}  // namespace

Workers::Workers(int threads) {
  if (threads < 1 || threads > most)
    throw InvalidParameter(message("number of threads is ", threads, " but must be from 1 to ", most));
  for (int k = 1; k < threads; ++k) helpers_.emplace_back([this, k] { help(k); });
}

Workers::~Workers() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
    ++round_;
  }
  wake_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void Workers::run(const std::function<void(int)>& job) {
  if (helpers_.empty()) {
    job(0);
    return;
  }
  job_ = &job;
  busy_ = static_cast<int>(helpers_.size());
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++round_;
  }
  wake_.notify_all();
  job(0);
  while (busy_ != 0) std::this_thread::yield();
}

void Workers::help(int worker) {
  for (int seen = 0;; ++seen) {
    for (int k = 0; k < rounds_awake && round_ == seen; ++k)
      if (k % 64 == 63) std::this_thread::yield();
    if (round_ == seen) {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return round_ != seen; });
    }
    if (stop_) return;
    (*job_)(worker);
    --busy_;
  }
}

}  // namespace spot
