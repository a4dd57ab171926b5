// The lower tasks that the hierarchy begins.

#include <algorithm>
#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>

#include "hierarchical_controller.hpp"
#include "lower_level.hpp"

namespace kr3::executive
{
namespace
{

using refinement::kElsewhere;

/// Of a lower policy that the upper level pays, as a part of what a mission can win or lose.
constexpr double kPrecision = 0.005;

/// A probability that stands for those near it, for the same reason.
double representativeOf(double probability)
{
  constexpr double kStep = 1.0;  // of the log-odds
  const double bounded = std::clamp(probability, 1e-4, 1.0 - 1e-4);
  const double steps = std::round(std::log(bounded / (1.0 - bounded)) / kStep);
  return 1.0 / (1.0 + std::exp(-steps * kStep));
}

}  // namespace

refinement::InitialKnowledge HierarchicalController::knowledgeFor(const Choice& choice,
                                                                  const DomainBelief& belief,
                                                                  bool representative) const
{
  refinement::InitialKnowledge knowledge;
  const auto& domain = belief.task().domain();
  const auto& fluents = belief.task().space().fluents();
  for (std::size_t i = 0; i < fluents.size(); ++i)
  {
    refinement::Distribution values = belief.task().fineMarginal(belief.states(), i);
    const std::string whole = coarseFluent(domain, fluents[i].name);
    const auto coarse = plan_->space().findFluent(whole);
    const auto& hidden = plan_->hidden();
    const bool open = coarse && std::find(hidden.begin(), hidden.end(), *coarse) != hidden.end();
    if (!open || whole != fluents[i].name)
    {
      knowledge.fine[fluents[i].name] = std::move(values);
      continue;
    }
    const std::string& supposed = plan_->space().value(choice.state, *coarse);
    const auto components = domain.components(supposed);
    double inside = 0.0;
    for (const auto& component : components)
      inside += values.count(component) != 0 ? values.at(component) : 0.0;
    const double mass = representative || inside <= 0.0 ? representativeOf(inside) : inside;
    refinement::Distribution local;
    if (inside > 1.0 - 1e-9)
      local = std::move(values);
    else
    {
      for (const auto& component : components)
      {
        const double share = values.count(component) != 0 ? values.at(component) : 0.0;
        local[component] =
            representative || inside <= 0.0 ? mass / static_cast<double>(components.size()) : share;
      }
      const bool boolean = fluents[i].values == std::vector<std::string>{"false", "true"};
      local[boolean ? (supposed == "true" ? "false" : "true") : kElsewhere] = 1.0 - mass;
    }
    knowledge.fine[fluents[i].name] = std::move(local);
  }
  return knowledge;
}

bool HierarchicalController::begin(const Choice& choice, const DomainBelief& belief,
                                   const std::atomic<bool>& cancel)
{
  try
  {
    const auto actual = knowledgeFor(choice, belief, false);
    // One policy serves all beliefs that differ in what was seen before.
    const auto solved = plan_->task(choice.state, choice.action, knowledgeFor(choice, belief, true),
                                    choice.objective);
    const pomdp::Model model =
        choice.is_paid
            ? policy_->paid(solved, *plan_,
                            coarseStart(*plan_, plan_->coarse(belief), choice.state, choice.action),
                            choice.action)
            : solved.model();
    SolveBudget budget = config_.budget;
    if (choice.is_paid)
      budget.precision = std::max(budget.precision, kPrecision * objective_.stake());
    const std::string policy = policies_.solve(model, budget, cancel).id;
    active_.emplace(Active{plan_->actionText(choice.action),
                           LowLevelTask(belief.task().domain(),
                                        std::make_shared<const refinement::PomdpTask>(plan_->task(
                                            choice.state, choice.action, actual, choice.objective)),
                                        actual),
                           policy, 0, 0,
                           choice.is_look ? std::optional(choice.action) : std::nullopt});
  }
  catch (const FailedPrecondition&)  // nothing to do there, or impossible
  {
    return false;
  }
  ++num_begun_;
  return true;
}

}  // namespace kr3::executive
