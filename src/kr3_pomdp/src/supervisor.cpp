#include "supervisor.hpp"

#include <algorithm>
#include <ctime>

namespace kr3::pomdp
{

namespace
{

constexpr double kLookPeriod_s = 1e-3;
// What making the policy takes: about so long, but at most a part of the limit.
constexpr double kFinish_s = 0.005;
constexpr double kFinishEntry_s = 1e-8;
constexpr double kMostToFinish = 0.1;

}  // namespace

double threadCpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Supervisor::Supervisor(const SolverLimits& limits, const ProgressCallback& keep_going)
  : limits_(&limits)
  , keep_going_(&keep_going)
  , start_(Clock::now())
  , cpu_start_s_(threadCpuSeconds())
{
}

double Supervisor::elapsedSeconds() const
{
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

double Supervisor::cpuSeconds() const
{
  return threadCpuSeconds() - cpu_start_s_ + others_cpu_s_;
}

void Supervisor::stop(StopReason reason)
{
  stopped_ = true;
  reason_ = reason;
}

bool Supervisor::mayGoOn(const SearchState& state)
{
  backups_ = state.backups;
  num_vectors_ = state.num_vectors;
  memory_bytes_ = state.memory_bytes;
  lower_ = std::max(lower_, state.lower);
  upper_ = std::max(lower_, std::min(upper_, state.upper));
  if (stopped_)
  {
    return false;
  }
  finish_s_ = std::min(kMostToFinish * limits_->time_s,
                       kFinish_s + kFinishEntry_s * static_cast<double>(state.num_entries));
  const double elapsed_s = elapsedSeconds();
  if (upper_ - lower_ <= limits_->precision)
  {
    stop(StopReason::kPrecision);
  }
  else if (limits_->max_backups != 0 && backups_ >= limits_->max_backups)
  {
    stop(StopReason::kBackupLimit);
  }
  else if (limits_->max_memory_bytes != 0 && state.memory_bytes >= limits_->max_memory_bytes)
  {
    stop(StopReason::kMemoryLimit);
  }
  else if (isTimeUp())
  {
    stop(StopReason::kTimeLimit);
  }
  else if (*keep_going_ && !(*keep_going_)({lower_, upper_, backups_, state.num_vectors, elapsed_s,
                                            state.memory_bytes}))
  {
    stop(StopReason::kCancelled);
  }
  return !stopped_;
}

bool Supervisor::mayPrepare()
{
  const double now_s = elapsedSeconds();
  if (stopped_ || now_s < next_look_s_)
  {
    return !stopped_;
  }
  next_look_s_ = now_s + kLookPeriod_s;
  if (isTimeUp())
  {
    stop(StopReason::kTimeLimit);
  }
  if (!stopped_ && *keep_going_ &&
      !(*keep_going_)({lower_, upper_, backups_, num_vectors_, now_s, memory_bytes_}))
  {
    stop(StopReason::kCancelled);
  }
  return !stopped_;
}

}  // namespace kr3::pomdp
