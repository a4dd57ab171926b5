#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/state_space.hpp"

namespace kr3::refinement
{

/// States with their probabilities, by ascending number; those with none are left out.
using SparseBelief = std::map<StateId, double>;

/// The low level of a whole domain as a POMDP without a goal, computed where it is asked for:
/// nothing is zoomed away. T, O and costs follow from the laws and the models as in
/// generatePomdp(), but there are no state `boundary`, no `done` and no action `finish`. Not
/// thread-safe.
class DomainTask
{
public:
  struct Next
  {
    StateId state;
    double probability;
  };
  struct Transition
  {
    bool executable = false;  ///< otherwise nothing changes, and it costs what trying it costs
    double cost_s = 0.0;
    std::vector<Next> next;
  };

  /// @param domain, models  must outlive the task
  /// @param constants       that are kept, of both levels
  DomainTask(const LowLevelDomain& domain, const Models& models,
             const std::set<std::string>& constants);

  [[nodiscard]] const LowLevelDomain& domain() const { return *domain_; }
  [[nodiscard]] const Models& models() const { return *models_; }
  [[nodiscard]] StateSpace& space() { return space_; }
  [[nodiscard]] const StateSpace& space() const { return space_; }
  [[nodiscard]] std::size_t numActions() const { return space_.actions().size(); }

  /// Valid until the next call. An outcome beyond the constants kept changes nothing.
  const Transition& transition(StateId state, std::size_t action);

  /// Pr(value | the action led to `next`) for one of the action's observation laws.
  /// @param executed  whether the action was possible: otherwise nothing was sensed
  /// @param value     "true", "false" or a value's name
  [[nodiscard]] double likelihood(std::size_t action, std::size_t law, StateId next, bool executed,
                                  const std::string& value) const;
  /// Everything that the laws can tell there, one name for all laws joined by ",", with its
  /// probability; {"none", 1} without a law.
  [[nodiscard]] std::vector<std::pair<std::string, double>> told(std::size_t action, StateId next,
                                                                 bool executed) const;

  /// The value of a fluent of the high level; "several" when components disagree.
  /// @throws NotFound  no such fluent among the constants kept
  [[nodiscard]] std::string coarseValue(StateId state, const std::string& fluent) const;
  /// The coarse fluents, each with the fine ones that it stands for.
  [[nodiscard]] const std::map<std::string, std::vector<std::size_t>>& coarseFluents() const
  {
    return coarse_fluents_;
  }
  [[nodiscard]] bool holds(const reasoner::Formula& goal, StateId state) const;

  /// The belief that independent knowledge of fluents gives, each value of a coarse fluent spread
  /// uniformly over its refinements, and what constraints forbid left out.
  ///
  /// @param knowledge  `fine` over low-level values, `coarse` over high-level ones; a boolean
  /// fluent
  ///                   in neither is false, any other takes all its values
  /// @throws FailedPrecondition  no state fits
  /// @throws ResourceExhausted   more than `max_states` fit
  [[nodiscard]] SparseBelief initialBelief(const InitialKnowledge& knowledge,
                                           std::size_t max_states);

  [[nodiscard]] Distribution fineMarginal(const SparseBelief& belief, std::size_t fluent) const;

private:
  struct Group;

  [[nodiscard]] std::optional<double> distance(StateId state, std::size_t action) const;
  [[nodiscard]] std::vector<Group> groupsOf(const InitialKnowledge& knowledge) const;

  const LowLevelDomain* domain_;
  const Models* models_;
  std::set<std::string> constants_;
  StateSpace space_;
  std::map<std::string, std::vector<std::size_t>> coarse_fluents_;
  std::vector<bool> boolean_;  ///< of each fluent
  std::vector<const ActionModel*> action_models_;
  std::vector<const OutcomeModel*> outcomes_;              // of each ground action
  std::vector<const CostModel*> costs_;                    // of each ground action
  std::vector<std::optional<std::size_t>> start_fluents_;  ///< where each action's way begins
  std::vector<std::optional<std::size_t>> ends_;           ///< component where it ends
  std::unordered_map<std::uint64_t, Transition> transitions_;
};

}  // namespace kr3::refinement
