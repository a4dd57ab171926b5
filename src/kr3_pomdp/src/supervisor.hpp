#pragma once

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
  std::size_t num_vectors;
  std::size_t memory_bytes;
};

/// Decides when a run stops, and reports its progress. Not thread-safe.
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
  void countBackup() { ++backups_; }

  /// Reports, and says whether work may go on.
  bool mayGoOn(const SearchState& state);
  /// Before there are bounds: time and the callback count.
  bool mayPrepare();

private:
  using Clock = std::chrono::steady_clock;
  void stop(StopReason reason);

  const SolverLimits* limits_;
  const ProgressCallback* keep_going_;
  Clock::time_point start_;
  double cpu_start_s_;
  std::uint64_t backups_ = 0;
  double lower_ = -std::numeric_limits<double>::infinity();
  double upper_ = std::numeric_limits<double>::infinity();
  bool stopped_ = false;
  StopReason reason_ = StopReason::kPrecision;
};

}  // namespace kr3::pomdp
