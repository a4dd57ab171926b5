#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// When to stop; whichever comes first. With counted work alone a run repeats exactly.
struct SolverLimits
{
  double precision = 1e-3;           ///< gap between the bounds at the initial belief, >= 0
  double time_s = 0.0;               ///< wall time; 0 = no limit
  std::uint64_t max_backups = 0;     ///< point-based backups; 0 = no limit
  std::size_t max_memory_bytes = 0;  ///< held by the search, without the model; 0 = no limit
  int num_threads = 1;               ///< >= 1
};

struct SolverProgress
{
  double lower;  ///< at the initial belief; never falls; -infinity before there is a bound
  double upper;  ///< at the initial belief; never rises; infinity before there is a bound
  std::uint64_t backups;
  std::size_t num_alpha_vectors;
  double elapsed_s;
  std::size_t memory_bytes;  ///< held by the search: beliefs, their outcomes, vectors, points
};

enum class StopReason
{
  kPrecision,
  kTimeLimit,
  kBackupLimit,
  kCancelled,  ///< `keep_going` said no
  kMemoryLimit,
};

/// "precision", "time limit", "backup limit", "cancelled", "memory limit".
[[nodiscard]] const char* toString(StopReason reason);

struct SolveResult
{
  Policy policy;
  double lower;  ///< what the policy earns at least: policy.valueAt(initial belief), or its
                 ///< expectation over the model's initial outcomes
  double upper;  ///< no policy earns more
  std::uint64_t backups;
  StopReason reason;
  double elapsed_s;          ///< wall time
  double cpu_s;              ///< CPU time of the calling thread and of those it started
  std::size_t memory_bytes;  ///< held by the search at its end, as in SolverProgress
};

/// Called often (at least once per trial, never more than every few microseconds); false cancels.
using ProgressCallback = std::function<bool(const SolverProgress&)>;

/// Solves a model from its initial belief with lower and upper bounds, anytime: a cancelled run
/// gives the best policy so far.
///
/// With discount 1 the model has to be one whose runs end (in states from which nothing is earned
/// any more) or cost something at each step as long as they go on, with an end in reach of each
/// state. For others, overHorizon() cuts runs off after some steps.
///
/// @param keep_going  may be empty
/// @param first  a policy to begin with, each of whose vectors is the value of a plan supported by
///               others of them, as Policy says; null: plans of one action each alone. Restricted
///               to what the robot always knows; the run only improves on it.
/// @throws InvalidArgument    a policy of another model, a limit that is negative or not finite, no
/// thread, or no limit at all
///                            can end the run (precision 0 without time, backups or callback); a
///                            discount of 1 with runs that need not end (the message says where)
/// @throws ResourceExhausted  a discount of 1 with runs of more than about 1e5 steps
/// Sources: Smith and Simmons (2004, 2005), HSVI; Kurniawati, Hsu and Lee (2008), SARSOP;
/// Hauskrecht (2000), fast informed bound and sawtooth.
[[nodiscard]] SolveResult solve(const Model& model, const SolverLimits& limits,
                                const ProgressCallback& keep_going = {},
                                const Policy* first = nullptr);

}  // namespace kr3::pomdp
