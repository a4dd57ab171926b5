#include "upper_level.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

/// Solving anew; values change little after the first.
constexpr int kRounds = 2;
/// How likely an action is taken to be possible where its outcomes are simulated; beside these, as
/// likely as one of all hypotheses.
constexpr double kVariants[] = {0.5, 0.9};
constexpr double kApart = 0.05;
// Of the policies that are simulated; the precision is a part of what a mission can win or lose.
constexpr double kPrecision = 0.01;
constexpr std::uint64_t kMostBackups = 3000;

std::vector<double> variantsFor(const CoarsePlan& plan)
{
  const auto hypotheses = static_cast<double>(std::max<std::size_t>(plan.start().size(), 2));
  std::vector<double> variants{1.0 / hypotheses};
  for (const double probability : kVariants)
  {
    if (probability > variants.front() + kApart)
      variants.push_back(probability);
  }
  return variants;
}

class Options
{
public:
  Options(CoarsePlan& plan, const Objective& objective, PolicyServer& policies,
          const UpperLevelOptions& options, const std::atomic<bool>& cancel)
    : plan_(plan)
    , objective_(objective)
    , policies_(policies)
    , options_(options)
    , cancel_(cancel)
    , variants_(variantsFor(plan))
    , budget_(options.lower)
  {
    budget_.max_backups = std::min(budget_.max_backups, kMostBackups);
  }

  [[nodiscard]] std::size_t numVariants() const { return variants_.size(); }

  /// @param paid_by  null: by the seconds saved
  const OptionOutcomes& outcomes(StateId state, std::size_t action, std::size_t variant,
                                 const CoarsePolicy* paid_by)
  {
    const auto [entry, is_new] = known_.try_emplace({state, action, variant});
    if (is_new)
      entry->second = simulated(state, action, variants_[variant], paid_by);
    return entry->second;
  }
  void forget() { known_.clear(); }

private:
  [[nodiscard]] OptionOutcomes simulated(StateId state, std::size_t action, double probability,
                                         const CoarsePolicy* paid_by)
  {
    const auto knowledge = plan_.knowledgeAt(state, probability);
    const LowerObjective pay = paid_by != nullptr ? LowerObjective{0.0, objective_.discount}
                                                  : plan_.worthSeconds(secondsSaved(state, action));
    auto task =
        std::make_shared<const refinement::PomdpTask>(plan_.task(state, action, knowledge, pay));
    pomdp::Model model = task->model();
    if (paid_by != nullptr)
    {
      CoarseBelief all;
      for (const StateId other : plan_.start())
      {
        if (const auto supposed = plan_.combined(state, other))
          all[*supposed] += 1.0;
      }
      CoarseStart start = coarseStart(plan_, all, state, action);
      start = coarseStart(plan_, start.at(probability), state, action);
      model = paid_by->paid(*task, plan_, start, action);
    }
    const LowerProblem problem{LowLevelTask(plan_.domain(), std::move(task), knowledge),
                               std::move(model)};
    SolveBudget budget = budget_;
    if (paid_by != nullptr)  // seconds are another unit
      budget.precision = std::max(budget.precision, kPrecision * objective_.stake());
    const std::string policy = policies_.solve(problem.model, budget, cancel_).id;
    return simulatedOutcomes(problem, policies_, policy,
                             {options_.threshold, options_.samples, state * 1000003ULL + action},
                             objective_.discount);
  }

  /// If all hypotheses are equally likely and take as long.
  [[nodiscard]] double secondsSaved(StateId state, std::size_t action)
  {
    const OptionModel& option = plan_.option(state, action);
    return static_cast<double>(std::max<std::size_t>(plan_.start().size(), 2)) *
           option.failure.seconds / option.detection;
  }

  CoarsePlan& plan_;
  const Objective& objective_;
  PolicyServer& policies_;
  const UpperLevelOptions& options_;
  const std::atomic<bool>& cancel_;
  std::vector<double> variants_;
  SolveBudget budget_;
  std::map<std::tuple<StateId, std::size_t, std::size_t>, OptionOutcomes> known_;
};

}  // namespace

std::shared_ptr<CoarsePolicy> solvedUpperLevel(CoarsePlan& plan, const CoarseBelief& start,
                                               const Objective& objective, PolicyServer& policies,
                                               const UpperLevelOptions& options,
                                               const std::atomic<bool>& cancel)
{
  Options known(plan, objective, policies, options, cancel);
  std::shared_ptr<CoarsePolicy> solved;
  for (int round = 0; round <= kRounds; ++round)
  {
    const std::shared_ptr<CoarsePolicy> before = solved;
    known.forget();
    solved = std::make_shared<CoarsePolicy>(
        plan, start, objective, known.numVariants(),
        [&](StateId state, std::size_t action, std::size_t variant) -> const OptionOutcomes& {
          return known.outcomes(state, action, variant, before.get());
        },
        options.limits, cancel);
    if (!solved->isGood())
      break;  // such values would mislead
  }
  return solved;
}

}  // namespace kr3::executive
