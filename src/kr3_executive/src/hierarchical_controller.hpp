#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "baseline_cache.hpp"
#include "coarse_plan.hpp"
#include "coarse_policy.hpp"
#include "controller.hpp"
#include "kr3_executive/driver.hpp"
#include "kr3_executive/method.hpp"
#include "search_order.hpp"

namespace kr3::executive
{

/// Two levels of POMDPs: above, which high-level action to begin, over the coarse belief; below,
/// the POMDP of that action's zoom, which a point-based policy carries out. Beliefs are propagated
/// both ways exactly: the belief over the whole domain gives the coarse one and the first one of
/// each zoom, and takes in every observation.
///
/// Above, a point-based policy ranks the actions (CoarsePolicy). A lower task whose action may turn
/// out impossible ends where the rest of the mission, as that policy values it, is worth more than
/// going on (CoarsePolicy::paid). docs/baselines.md has the equations.
///
/// Where the upper level is too large to be solved, or its bounds stay far apart, the likeliest
/// coarse state is acted on above the threshold; below it the hypothesis is tested that is expected
/// to end the search soonest (orderOfTests), by the durations and detection probabilities that the
/// lower policies were simulated to have.
///
/// There a lower task that tests a hypothesis is paid for success as much as the best other test
/// would need seconds to find as much probability, and nothing for giving up: it looks on where it
/// is as long as that finds more a second than going elsewhere (the price of a restless bandit's
/// index, Whittle 1988). Sources: Zhang, Sridharan and Washington (2013); Sridharan, Wyatt and
/// Dearden (2010); Sutton, Precup and Singh (1999), interrupted options.
class HierarchicalController : public Controller
{
public:
  HierarchicalController(const DomainBelief& start, const reasoner::Formula& goal,
                         PolicyServer& policies, const DriverConfig& config,
                         const BaselineOptions& options,
                         const std::shared_ptr<BaselineCache>& cache,
                         const std::atomic<bool>& cancel);

  std::optional<std::size_t> next(const DomainBelief& belief,
                                  const std::atomic<bool>& cancel) override;
  void observed(const std::vector<std::string>& observation) override;
  void disturbed() override { active_.reset(); }
  [[nodiscard]] std::uint32_t numHighLevelActions() const override { return num_begun_; }
  [[nodiscard]] std::string highLevelAction() const override;
  [[nodiscard]] std::string description() const override;

private:
  /// A high-level action that is being carried out.
  struct Active
  {
    std::string text;
    LowLevelTask task;
    std::string policy_id;
    std::size_t chosen = 0;  ///< by the policy
    std::uint32_t done = 0;  ///< low-level actions
    /// By number, where it is only begun to find out whether it is possible.
    std::optional<std::size_t> looking;
  };
  using Begun = std::set<std::pair<refinement::StateId, std::size_t>>;
  using Counts = std::map<std::pair<refinement::StateId, std::size_t>, int>;

  struct Choice
  {
    refinement::StateId state;  ///< that is supposed
    std::size_t action;
    std::optional<LowerObjective> objective;  ///< nothing: as the models say
    bool is_look = false;
    bool is_paid = false;  ///< by the solved upper level's values
  };

  [[nodiscard]] std::optional<Choice> choose(const DomainBelief& belief);
  /// As the solved upper level says; nothing where it says nothing that can be begun.
  [[nodiscard]] std::optional<Choice> solvedChoice(const CoarseBelief& belief) const;
  /// Whether the upper level was solved well enough to be trusted.
  [[nodiscard]] bool isSolved() const;
  [[nodiscard]] std::optional<Choice> choiceByOrder(const CoarseBelief& belief);
  /// What testing hypotheses takes, with the options' durations. @param states  must outlive it
  [[nodiscard]] ProspectOf prospectsOf(const std::vector<refinement::StateId>& states) const;
  /// Whether the route begins with something that was just begun, or has a step that is not worth
  /// it.
  [[nodiscard]] bool isIdle(refinement::StateId from, const Route& route) const;
  [[nodiscard]] static bool isSpent(const Counts& counts, refinement::StateId from,
                                    std::size_t action);
  /// Forget what was not worth it once the belief about what is hidden has changed.
  void noticeNews(const CoarseBelief& belief);
  /// Seconds that confirming a hypothesis is worth: what the best other one needs for as much.
  [[nodiscard]] double worthOfFinding(const Hypotheses& all, refinement::StateId from,
                                      std::size_t hypothesis) const;
  /// Whether searching on until the goal is certain is worth more than ending now.
  [[nodiscard]] bool isWorthSearching(const CoarseBelief& belief, double achieved) const;
  /// Whether the mission should end; what is under way is ended when it should not go on.
  [[nodiscard]] bool isOver(const DomainBelief& belief);
  [[nodiscard]] bool begin(const Choice& choice, const DomainBelief& belief,
                           const std::atomic<bool>& cancel);
  [[nodiscard]] refinement::InitialKnowledge knowledgeFor(const Choice& choice,
                                                          const DomainBelief& belief,
                                                          bool representative) const;

  PolicyServer& policies_;
  DriverConfig config_;
  reasoner::Formula goal_;
  Objective objective_;
  std::shared_ptr<CoarsePlan> plan_;
  std::shared_ptr<CoarsePolicy> policy_;  ///< null: the upper level is too large
  std::optional<Active> active_;
  Begun idle_;  ///< begun, and nothing was done since
  // Until more is known of what is hidden, the solved policy, which may be poor at beliefs that the
  // solver did not meet, gets each choice a few times only, and what ended before anything was done
  // is tried as often: nothing is repeated for ever.
  Counts tries_;
  Counts fruitless_;
  std::pair<refinement::StateId, std::size_t> begun_from_;  ///< of the active one
  std::map<std::vector<std::string>, double> known_;  ///< probabilities of the hidden values then
  std::uint32_t num_begun_ = 0;
};

}  // namespace kr3::executive
