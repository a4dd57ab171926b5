#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>

namespace kr3::pomdp
{

/// Where so many threads wait for each other, again and again.
class Barrier
{
public:
  explicit Barrier(std::size_t num_threads) : num_threads_(num_threads) {}

  /// Returns when all have come. What each did before is seen by all afterwards.
  void wait()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    const std::uint64_t round = round_;
    if (++num_waiting_ == num_threads_)
    {
      num_waiting_ = 0;
      ++round_;
      all_here_.notify_all();
      return;
    }
    all_here_.wait(lock, [&] { return round_ != round; });
  }

private:
  std::size_t num_threads_;
  std::size_t num_waiting_ = 0;
  std::uint64_t round_ = 0;
  std::mutex mutex_;
  std::condition_variable all_here_;
};

}  // namespace kr3::pomdp
