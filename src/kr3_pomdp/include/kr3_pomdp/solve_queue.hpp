#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "kr3_pomdp/policy_store.hpp"
#include "kr3_pomdp/read_options.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

struct SolveRequest
{
  ModelText model;
  SolverLimits limits;  ///< the time counts from the start of reading the model
  bool ignore_cache = false;
};

enum class SolvePhase : std::uint8_t
{
  kQueued,
  kReading,
  kSolving,
};

struct SolveReport
{
  SolvePhase phase;
  std::size_t num_ahead;    ///< requests that start before this one, when queued
  SolverProgress progress;  ///< bounds are infinite before there are any
};

/// How a request ended: with a policy or with an error.
struct SolveOutcome
{
  std::string id;                             ///< of the policy in the store
  std::shared_ptr<const SolvedModel> solved;  ///< null with an error
  bool cached = false;                        ///< it was known
  bool cancelled = false;                     ///< on request
  std::exception_ptr error;                   ///< null with a policy
};

/// Solves models one after the other, or some at a time, in threads of its own, and puts the
/// policies into a store. Requests wait in the order in which they come; one that the store answers
/// does not wait; one with the same content as another that is being solved waits for its answer.
///
/// Cancelling is prompt: a request that waits ends at once; one that is solved ends with the policy
/// so far; one that is reading or preparing for longer than the grace ends without one, and its
/// thread is free for others when that step is over.
///
/// Thread-safe. Callbacks come from several threads, never two at a time for one request, and
/// nothing is called after stop().
class SolveQueue
{
public:
  struct Options
  {
    int num_workers = 1;            ///< requests solved at a time, >= 1
    std::size_t max_waiting = 16;   ///< requests that wait, at most
    double report_period_s = 0.25;  ///< between reports of one request, > 0
    double grace_s = 1.0;           ///< from a cancellation to an answer without a policy, >= 0
    int niceness = 0;               ///< of the solving threads, in [0, 19]
    ReadOptions read;               ///< its callback is not used
  };
  struct Callbacks
  {
    std::function<void(const SolveReport&)> report;
    std::function<void(const SolveOutcome&)> done;  ///< exactly once for each request
  };

  /// @param store  outlives the queue and its threads
  /// @throws InvalidArgument  an option out of range
  SolveQueue(std::shared_ptr<PolicyStore> store, const Options& options);
  /// stop() with all patience.
  ~SolveQueue();
  SolveQueue(const SolveQueue&) = delete;
  SolveQueue& operator=(const SolveQueue&) = delete;

  /// @param key  of the request, for cancel(); unique among those that have not ended
  /// @throws ResourceExhausted   too many wait; FailedPrecondition  stopped
  void submit(const std::string& key, SolveRequest request, Callbacks callbacks);

  /// Cancels the requests whose key pleases `matches`.
  /// @return how many there were
  std::size_t cancelIf(const std::function<bool(const std::string&)>& matches);

  /// Cancels everything, calls nobody any more, and waits for the threads.
  ///
  /// @param patience_s  wall time to wait; infinity = as long as it takes
  /// @return false when a thread still reads or prepares a model: then the process should end
  /// without
  ///         destroying what is static
  bool stop(double patience_s);

  [[nodiscard]] std::size_t numWaiting() const;
  [[nodiscard]] std::size_t numRunning() const;
  /// Requests that were solved, and that the store answered.
  [[nodiscard]] std::uint64_t numSolved() const;
  [[nodiscard]] std::uint64_t numCached() const;

private:
  struct Job;
  class Impl;
  std::shared_ptr<Impl> impl_;  // shared with threads that stop() left behind
};

}  // namespace kr3::pomdp
