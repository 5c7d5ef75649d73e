// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/parallel/workers.hpp"

#include <system_error>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Rounds of looking for the next job before a thread goes to sleep, some milliseconds: longer than what one thread
/// does alone between two jobs, since waking up takes longer than most jobs.
constexpr int rounds_awake = 200000;

/// Between two checks, so that a check costs the other threads of the same core, and the bus, little; now and then
/// other programs have their turn, in case there are more threads than processors.
void rest(int round) {
#ifdef __x86_64__
  __builtin_ia32_pause();
#endif
  if (round % 64 == 63) std::this_thread::yield();
}

}  // namespace

Workers::Workers(int threads, std::uint64_t rounds) : first_round_(rounds), round_(rounds) {
  if (threads < 1 || threads > most)
    throw InvalidParameter(message("number of threads is ", threads, " but must be from 1 to ", most));
  thrown_.resize(static_cast<std::size_t>(threads));
  try {
    for (int k = 1; k < threads; ++k) helpers_.emplace_back([this, k] { help(k); });
  } catch (const std::system_error& error) {
    stop();
    throw InvalidParameter(
        message("number of threads is ", threads, " but the system starts no more than ", size(), ": ", error.what()));
  }
}

Workers::~Workers() { stop(); }

void Workers::stop() {
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
  attempt(job, 0);
  for (int k = 0; busy_ != 0; ++k) rest(k);
  std::exception_ptr first;
  for (std::exception_ptr& thrown : thrown_) {
    if (!first) first = thrown;
    thrown = nullptr;
  }
  if (first) std::rethrow_exception(first);
}

void Workers::share_out(std::size_t n, const std::function<void(int, std::size_t, std::size_t)>& job) {
  if (n == 0) return;
  const auto parts = static_cast<std::size_t>(size());
  run([&](int worker) {
    const auto part = static_cast<std::size_t>(worker);
    job(worker, n * part / parts, n * (part + 1) / parts);
  });
}

/// Whoever leaves a thread by an exception ends the program.
void Workers::attempt(const std::function<void(int)>& job, int worker) noexcept {
  try {
    job(worker);
  } catch (...) {
    thrown_[static_cast<std::size_t>(worker)] = std::current_exception();
  }
}

void Workers::help(int worker) {
  for (std::uint64_t seen = first_round_;; ++seen) {
    for (int k = 0; k < rounds_awake && round_ == seen; ++k) rest(k);
    if (round_ == seen) {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return round_ != seen; });
    }
    if (stop_) return;
    attempt(*job_, worker);
    --busy_;
  }
}

}  // namespace spot
