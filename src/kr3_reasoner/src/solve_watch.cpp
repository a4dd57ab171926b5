#include "solve_watch.hpp"

#include <algorithm>
#include <chrono>

namespace kr3::reasoner
{

SolveWatch::SolveWatch(Clingo::Control& control, const SearchLimit& limit)
  : control_(control), limit_(limit), thread_([this] { run(); })
{
}

SolveWatch::~SolveWatch()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  stopped_.notify_all();
  thread_.join();
}

void SolveWatch::run()
{
  constexpr std::chrono::milliseconds kPeriod{10};
  std::unique_lock<std::mutex> lock(mutex_);
  // without a flag to look at, there is nothing to do before the deadline
  const auto start = std::chrono::steady_clock::now();
  auto next = limit_.cancel == nullptr ? std::max(start, limit_.deadline) : start + kPeriod;
  while (!stopped_.wait_until(lock, next, [this] { return stop_; }))
  {
    next = std::chrono::steady_clock::now() + kPeriod;
    if (limit_.isReached())
    {
      control_.interrupt();  // again and again: the next call may not have begun
    }
  }
}

}  // namespace kr3::reasoner
