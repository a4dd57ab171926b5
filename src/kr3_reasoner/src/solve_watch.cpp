#include "solve_watch.hpp"

#include <kr3_common/error.hpp>

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

void SolveWatch::check(const std::string& what) const
{
  if (limit_.cancel != nullptr && limit_.cancel->load())
  {
    throw Cancelled("planning was cancelled");
  }
  if (std::chrono::steady_clock::now() > limit_.deadline)
  {
    throw DeadlineExceeded("planning took longer than its time limit, " + what);
  }
}

void SolveWatch::run()
{
  constexpr std::chrono::milliseconds kPeriod{10};
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopped_.wait_for(lock, kPeriod, [this] { return stop_; }))
  {
    const bool cancelled = limit_.cancel != nullptr && limit_.cancel->load();
    if (cancelled || std::chrono::steady_clock::now() > limit_.deadline)
    {
      control_.interrupt();  // again and again: the next call may not have begun
    }
  }
}

}  // namespace kr3::reasoner
