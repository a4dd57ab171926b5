#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <kr3_refinement/state_space.hpp>

#include "baseline_cache.hpp"
#include "controller.hpp"
#include "kr3_executive/method.hpp"
#include "option_model.hpp"
#include "shortest_route.hpp"

namespace kr3::executive
{

/// What a low-level policy is to maximise.
struct LowerObjective
{
  double success = 0.0;  ///< ending otherwise is worth nothing
  double discount = 1.0;
};

/// What an action of the high level costs, in a state.
struct ActionCost
{
  double base_s = 0.0;
  double per_metre_s = 0.0;
  std::string fluent;  ///< of the low level, whose value it begins at; empty: no distance counts
  std::vector<std::string> from;  ///< components that the state leaves open
  std::vector<std::string> to;
};

/// The upper level of the hierarchy: the high-level description, each of its actions with what its
/// low-level policy was simulated to take and to find out. Kept between missions.
class CoarsePlan
{
public:
  /// @param policies  must outlive the plan
  CoarsePlan(const DomainBelief& start, reasoner::Formula goal, PolicyServer& policies,
             const SolveBudget& budget, double threshold, std::size_t samples);

  [[nodiscard]] refinement::StateSpace& space() { return space_; }

  /// The belief over states of the high level that a belief over the low level amounts to.
  [[nodiscard]] std::map<refinement::StateId, double> coarse(const DomainBelief& belief);

  /// The way to the goal if the state is so.
  const std::optional<Route>& goalFrom(refinement::StateId state);
  /// The way to the first action that is possible only if what is hidden is as in the state: on the
  /// way to the goal if there is one, else the nearest.
  const std::optional<Route>& testFrom(refinement::StateId state);
  const OptionModel& option(refinement::StateId state, std::size_t action);
  /// The state itself where the action is possible; else the same with what is hidden otherwise, so
  /// that it is.
  /// @return nothing when it is impossible whatever is hidden
  [[nodiscard]] std::optional<refinement::StateId> supposedFor(refinement::StateId state,
                                                               std::size_t action);
  /// The state that an action leads to when it succeeds.
  /// @return nothing when it is impossible or changes nothing
  [[nodiscard]] std::optional<refinement::StateId> resultOf(refinement::StateId state,
                                                            std::size_t action);
  [[nodiscard]] bool holdsGoal(refinement::StateId state) const { return holds(goal_, state); }
  [[nodiscard]] std::optional<refinement::StateId> combined(refinement::StateId state,
                                                            refinement::StateId hidden_from);

  [[nodiscard]] const std::vector<std::size_t>& hidden() const { return hidden_; }
  /// The states of the high level that the mission may start in.
  [[nodiscard]] const std::vector<refinement::StateId>& start() const { return start_; }
  [[nodiscard]] const refinement::LowLevelDomain& domain() const { return domain_; }
  /// That the hidden values of a state have a probability, and nothing else is known.
  [[nodiscard]] refinement::InitialKnowledge knowledgeAt(refinement::StateId state,
                                                         double probability) const;
  /// What an action costs in a state, from where the robot is to the nearest that will do.
  /// @param where  of a fluent of the low level, by name: its value; empty where it is not known,
  ///               and all that the state leaves open count alike
  [[nodiscard]] double costFrom(
      refinement::StateId state, std::size_t action,
      const std::function<std::string(const std::string& fluent)>& where) const;
  /// The least and the greatest of these over all places that the state leaves open.
  [[nodiscard]] std::pair<double, double> costRange(refinement::StateId state,
                                                    std::size_t action) const;
  /// A state as literals of the high level.
  [[nodiscard]] std::vector<reasoner::Literal> literals(refinement::StateId state) const;
  [[nodiscard]] const std::string& actionText(std::size_t action) const
  {
    return space_.actions()[action].text;
  }

  /// The task of an action begun in a state.
  /// @param knowledge  of its fluents
  /// @param objective  nothing: the models' rewards count
  [[nodiscard]] refinement::PomdpTask task(refinement::StateId state, std::size_t action,
                                           const refinement::InitialKnowledge& knowledge,
                                           const std::optional<LowerObjective>& objective) const;
  /// That success is worth so many seconds and giving up nothing, so that the policy goes on as
  /// long as it finds more a second than looking elsewhere would.
  [[nodiscard]] LowerObjective worthSeconds(double found_s) const;

private:
  void addConstants(const reasoner::Formula& formula);
  [[nodiscard]] bool holds(const reasoner::Formula& formula, refinement::StateId state) const;
  [[nodiscard]] std::vector<std::size_t> actionsAbout(refinement::StateId state) const;
  [[nodiscard]] std::optional<RouteStep> stepOf(refinement::StateId state, std::size_t action);
  [[nodiscard]] std::optional<Route> route(refinement::StateId state, bool to_test);
  [[nodiscard]] bool dependsOnHidden(refinement::StateId state, std::size_t action);
  [[nodiscard]] double meanCost(refinement::StateId state, std::size_t action) const;
  [[nodiscard]] double distanceOf(const std::string& from, const std::string& to) const;
  [[nodiscard]] ActionCost actionCost(refinement::StateId state, std::size_t action) const;
  /// @param probability  of the state's hidden values at the start
  void simulate(refinement::StateId state, std::size_t action, double probability,
                const std::optional<LowerObjective>& objective, OptionModel& model);

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  refinement::StateSpace space_;
  reasoner::Formula goal_;
  PolicyServer& policies_;
  SolveBudget budget_;
  double threshold_;
  std::size_t samples_;
  std::set<std::string> always_;  ///< constants that every state's routes may use
  std::vector<std::size_t> hidden_;
  std::vector<refinement::StateId> start_;
  std::unordered_map<refinement::StateId, std::optional<refinement::StateId>> coarse_of_;
  std::unordered_map<std::uint64_t, OptionModel> options_;
  std::unordered_map<refinement::StateId, std::optional<Route>> tests_;
  std::unordered_map<refinement::StateId, std::optional<Route>> goals_;
  std::unordered_map<std::uint64_t, std::optional<refinement::StateId>> combined_;
};

}  // namespace kr3::executive
