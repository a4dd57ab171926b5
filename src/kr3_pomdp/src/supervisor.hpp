#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// How far a search is.
struct SearchState
{
  double lower;  ///< at the start
  double upper;  ///< at the start
  std::uint64_t backups;
  std::size_t num_vectors;
  std::size_t num_entries;  ///< of all vectors together
  std::size_t memory_bytes;
};

/// CPU time of the calling thread.
[[nodiscard]] double threadCpuSeconds();

/// Decides when a run stops, and reports its progress. Not thread-safe, but for isTimeUp().
class Supervisor
{
public:
  /// Time counts from here. Both arguments outlive this object.
  Supervisor(const SolverLimits& limits, const ProgressCallback& keep_going);

  [[nodiscard]] double elapsedSeconds() const;
  /// CPU time of this thread, and of those that were counted.
  [[nodiscard]] double cpuSeconds() const;
  [[nodiscard]] StopReason reason() const { return reason_; }
  [[nodiscard]] std::uint64_t backups() const { return backups_; }
  /// Of another thread.
  void countCpuSeconds(double cpu_s) { others_cpu_s_ += cpu_s; }
  /// Whether the time is up, but for what it takes to make the policy; safe to ask from any thread.
  [[nodiscard]] bool isTimeUp() const
  {
    return limits_->time_s > 0.0 && elapsedSeconds() + finish_s_ >= limits_->time_s;
  }
  /// Whether it stopped for what cannot wait: the time is up, or the caller said no.
  [[nodiscard]] bool isUrgent() const
  {
    return stopped_ && (reason_ == StopReason::kTimeLimit || reason_ == StopReason::kCancelled);
  }

  /// Reports, and says whether work may go on.
  bool mayGoOn(const SearchState& state);
  /// Before there are bounds, or within a piece of a search: time and the callback count. To be
  /// asked often: it looks about once a millisecond.
  bool mayPrepare();

private:
  using Clock = std::chrono::steady_clock;
  void stop(StopReason reason);

  const SolverLimits* limits_;
  const ProgressCallback* keep_going_;
  Clock::time_point start_;
  double cpu_start_s_;
  double others_cpu_s_ = 0.0;
  double next_look_s_ = 0.0;
  std::atomic<double> finish_s_{0.0};
  std::uint64_t backups_ = 0;
  std::size_t num_vectors_ = 0;
  std::size_t memory_bytes_ = 0;
  double lower_ = -std::numeric_limits<double>::infinity();
  double upper_ = std::numeric_limits<double>::infinity();
  bool stopped_ = false;
  StopReason reason_ = StopReason::kPrecision;
};

}  // namespace kr3::pomdp
