// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/workers.hpp"

#include "spot/errors.hpp"

namespace spot {

namespace {

/// Rounds of looking for the next job before a thread goes to sleep, some milliseconds: longer than what one thread
/// does alone between two jobs, since waking up takes longer than most jobs.
constexpr int rounds_awake = 200000;

/// Between two looks, so that the look costs the other threads of the same core, and the bus, little; now and then
/// other programs have their turn, in case there are more threads than processors.
void rest(int round) {
#ifdef __x86_64__
  __builtin_ia32_pause();
#endif
  if (round % 64 == 63) std::this_thread::yield();
}

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
  for (int k = 0; busy_ != 0; ++k) rest(k);
}

void Workers::help(int worker) {
  for (int seen = 0;; ++seen) {
    for (int k = 0; k < rounds_awake && round_ == seen; ++k) rest(k);
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
