#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "belief_graph.hpp"
#include "search.hpp"
#include "solver_parts.hpp"
#include "supervisor.hpp"

namespace kr3::pomdp
{

/// Searches of one model, each with a belief graph of its own and in a thread of its own. They work
/// in rounds of equal counted work and exchange the vectors and points that they found after each
/// round, in a fixed order: no graph is shared, so nothing is locked while they work, and a run of
/// counted work repeats exactly for a given number of threads.
///
/// One search alone works in the calling thread without rounds.
class SearchTeam
{
public:
  /// The model and the supervisor outlive this object.
  SearchTeam(const ObservedModel& model, InformedVectors informed, const InformedVectors& blind,
             const SolverLimits& limits, const SolverParts& parts, Supervisor& supervisor);
  ~SearchTeam();

  /// Before run(): what every search begins with.
  void take(const Findings& findings);

  /// Until the supervisor says stop. Rethrows what a search threw.
  void run();

  /// The graph that has all vectors, after run().
  [[nodiscard]] const BeliefGraph& graph() const;
  /// Least known upper bound of the value at the start.
  double upper();
  [[nodiscard]] std::size_t sizeInBytes() const;

private:
  struct Member;
  class Rounds;

  std::vector<std::unique_ptr<Member>> members_;
  const SolverLimits* limits_;
  Supervisor* supervisor_;
};

}  // namespace kr3::pomdp
