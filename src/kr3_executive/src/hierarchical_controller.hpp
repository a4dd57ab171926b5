#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "baseline_cache.hpp"
#include "coarse_plan.hpp"
#include "controller.hpp"
#include "kr3_executive/driver.hpp"
#include "kr3_executive/method.hpp"

namespace kr3::executive
{

/// Two levels of POMDPs: above, which high-level action to begin, over the coarse belief; below,
/// the POMDP of that action's zoom, which a point-based policy carries out. Beliefs are propagated
/// both ways exactly: the belief over the whole domain gives the coarse one and the first one of
/// each zoom, and takes in every observation.
///
/// Above the threshold the likeliest coarse state is acted on; below it the hypothesis is tested
/// that is expected to end the search soonest (firstToTest), by the durations and detection
/// probabilities that the lower policies were simulated to have. A lower task that tests a
/// hypothesis is paid for success as much as the best other test would need seconds to find as
/// much probability, and nothing for giving up: it looks on where it is as long as that finds more
/// a second than going elsewhere (the price of a restless bandit's index, Whittle 1988). Sources:
/// Zhang, Sridharan and Washington (2013); Sridharan, Wyatt and Dearden (2010).
class HierarchicalController : public Controller
{
public:
  HierarchicalController(const DomainBelief& start, const reasoner::Formula& goal,
                         PolicyServer& policies, const DriverConfig& config,
                         const BaselineOptions& options,
                         const std::shared_ptr<BaselineCache>& cache);

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
  };
  struct Choice
  {
    refinement::StateId state;  ///< that is supposed
    std::size_t action;
    std::optional<double>
        found_s;  ///< worth of carrying it out, where that depends on what is hidden
  };

  [[nodiscard]] std::optional<Choice> choose(const DomainBelief& belief);
  [[nodiscard]] bool begin(const Choice& choice, const DomainBelief& belief,
                           const std::atomic<bool>& cancel);
  [[nodiscard]] refinement::InitialKnowledge knowledgeFor(const Choice& choice,
                                                          const DomainBelief& belief,
                                                          bool representative) const;

  PolicyServer& policies_;
  DriverConfig config_;
  std::shared_ptr<CoarsePlan> plan_;
  std::optional<Active> active_;
  std::set<std::pair<refinement::StateId, std::size_t>> idle_;  ///< begun, and nothing was done
  std::uint32_t num_begun_ = 0;
};

}  // namespace kr3::executive
