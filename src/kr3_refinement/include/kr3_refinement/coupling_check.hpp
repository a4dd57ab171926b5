#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"

namespace kr3::refinement
{

struct CouplingCheckOptions
{
  /// Only one of each set of constants that no law tells apart is tried; otherwise all are.
  bool up_to_symmetry = true;
  /// Coarse states on the way must be s1 or s2 (REBA's refinement); the paper of 2014 asks for a
  /// path only.
  bool direct = false;
  /// Ground action, or name of an action, to check; empty: all.
  std::string action;
  /// Of one description, high-level or zoomed.
  std::size_t max_states = 200000;
  /// Counterexamples to keep; the others are only counted.
  std::size_t max_counterexamples = 10;
};

/// A high-level transition that the low level cannot always carry out.
struct CouplingCounterexample
{
  std::string action;
  std::vector<std::string> before;  ///< s1: the literals over what the zoom keeps
  std::vector<std::string> after;   ///< s2, likewise
  /// A low-level state that s1 allows; empty when there is none.
  std::vector<std::string> low_level_state;
  /// The coarse states that low-level actions lead to from there, s1 included.
  std::vector<std::vector<std::string>> reachable;
  std::size_t num_failing = 0;     ///< low-level states that s1 allows and that fail
  std::size_t num_compatible = 0;  ///< low-level states that s1 allows
};

struct CouplingReport
{
  std::size_t num_ground_actions = 0;    ///< of the high level
  std::size_t num_checked_actions = 0;   ///< representatives among them
  std::size_t num_transitions = 0;       ///< <s1, a, s2>, different in what the zoom keeps
  std::size_t num_low_level_states = 0;  ///< that were shown to have a path
  std::size_t num_failures = 0;
  std::vector<CouplingCounterexample> counterexamples;
  /// Actions that no state allows: the low level was never asked.
  std::vector<std::string> never_executable;
  /// The inertial fluents that each low-level action was seen to change; actions that change
  /// different fluents are independent.
  std::map<std::string, std::set<std::string>> changes;

  [[nodiscard]] bool passed() const { return num_failures == 0; }
};

/// Checks the coupling of the two levels: for every transition <s1, a, s2> of the high level and
/// every low-level state of its zoom that is compatible with s1, some outcomes of some low-level
/// actions lead to a low-level state that is compatible with s2.
///
/// High-level states are those over the action's constants and enough others: two of each kind of
/// value, one of each kind of argument (all, when not up to symmetry). Constants are of one kind
/// when they are in the same sorts, no law or fact names them, and the neighbour relation among
/// their components looks alike.
///
/// @throws InvalidArgument    the action asked for is unknown
/// @throws ResourceExhausted  a description has more states than the limit
/// Sources: Zhang et al. (2014), "LL domain representation"; Sridharan et al. (JAIR 65, 2019), the
/// definitions of refinement, from every low-level state (observability is not checked here).
[[nodiscard]] CouplingReport checkCoupling(const LowLevelDomain& domain,
                                           const CouplingCheckOptions& options = {});

/// The report for people: a summary, then each counterexample.
[[nodiscard]] std::string toString(const CouplingReport& report);

}  // namespace kr3::refinement
