#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"
#include "prior.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{

/// The value of each coarse fluent.
using CoarseState = std::map<std::string, std::string>;

/// All states and transitions of a zoomed low-level description, seen from the high level. An
/// outcome that leaves the zoom leads nowhere.
class CouplingGraph
{
public:
  /// @param constants  what the zoom keeps
  /// @param hidden     coarse fluents that may have a value outside it
  /// @throws ResourceExhausted  more than `max_states`
  CouplingGraph(const LowLevelDomain& domain, const std::set<std::string>& constants,
                const std::set<std::string>& hidden, std::size_t max_states);

  /// Names of the coarse fluents of the zoom.
  [[nodiscard]] const std::vector<std::string>& coarseFluents() const { return names_; }
  [[nodiscard]] bool keeps(const std::string& constant) const
  {
    return constants_.count(constant) > 0;
  }

  struct Paths
  {
    std::size_t num_compatible = 0;      ///< states compatible with the start
    std::vector<std::uint32_t> failing;  ///< those of them without a path to the goal
  };
  /// @param direct  only through states that are compatible with the start or the goal
  [[nodiscard]] Paths paths(const CoarseState& start, const CoarseState& goal, bool direct) const;

  /// The coarse states that are reachable from a state, its own first.
  [[nodiscard]] std::vector<CoarseState> reachable(std::uint32_t state) const;

  [[nodiscard]] std::vector<std::string> literals(std::uint32_t state) const;

  /// The names of the inertial fluents that each action changes in some state.
  [[nodiscard]] const std::map<std::string, std::set<std::string>>& changes() const
  {
    return changes_;
  }

private:
  [[nodiscard]] CoarseState coarse(const LowLevelDomain& domain, const CoarseFluents& fluents,
                                   const Values& state) const;
  void addTransitions();

  std::set<std::string> constants_;
  Semantics semantics_;
  std::vector<Values> states_;
  std::vector<std::string> names_;
  std::vector<CoarseState> views_;  // [state]
  std::map<CoarseState, std::vector<std::uint32_t>> by_view_;
  std::vector<std::vector<std::uint32_t>> successors_;    // [state]
  std::vector<std::vector<std::uint32_t>> predecessors_;  // [state]
  std::map<std::string, std::set<std::string>> changes_;
};

}  // namespace kr3::refinement
