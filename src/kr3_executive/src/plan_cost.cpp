#include "kr3_executive/plan_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_refinement/zoom.hpp>

namespace kr3::executive
{
namespace
{

using reasoner::Literal;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxOrdered = 8;  // hypotheses whose orders are all considered

/// What carrying out a plan costs, from some state.
struct PlanEffort
{
  double before_s = 0.0;   ///< until the action that checks the hypothesis
  double success_s = 0.0;  ///< from there to the goal, if it holds
  double failure_s = 0.0;  ///< from there to its refutation, if not
};

/// The expected time to the goal for every first plan, with the others in the best order after it.
class BestOrder
{
public:
  /// @param efforts  [from][plan]; from the last entry: the present state, from others: after that
  ///                 plan's hypothesis was refuted
  BestOrder(const std::vector<std::vector<PlanEffort>>& efforts,
            const std::vector<double>& probabilities)
    : efforts_(efforts), probabilities_(probabilities)
  {
  }

  [[nodiscard]] double startingWith(std::size_t plan, unsigned left, std::size_t from)
  {
    double mass = 0.0;
    for (std::size_t i = 0; i < probabilities_.size(); ++i)
      mass += (left >> i & 1U) != 0 ? probabilities_[i] : 0.0;
    const double holds = mass > 0.0 ? probabilities_[plan] / mass : 1.0;
    const PlanEffort& effort = efforts_[from][plan];
    const unsigned rest = left & ~(1U << plan);
    double cost = effort.before_s + holds * effort.success_s;
    if (holds < 1.0 && rest != 0)
      cost += (1.0 - holds) * (effort.failure_s + best(rest, plan));
    return cost;
  }

private:
  double best(unsigned left, std::size_t from)
  {
    const auto known = known_.find({left, from});
    if (known != known_.end())
      return known->second;
    double least = kInfinite;
    for (std::size_t i = 0; i < probabilities_.size(); ++i)
    {
      if ((left >> i & 1U) != 0)
        least = std::min(least, startingWith(i, left, from));
    }
    known_[{left, from}] = least;
    return least;
  }

  const std::vector<std::vector<PlanEffort>>& efforts_;
  const std::vector<double>& probabilities_;
  std::map<std::pair<unsigned, std::size_t>, double> known_;
};

class PlanWalk
{
public:
  PlanWalk(PlanCosts& costs, const refinement::LowLevelDomain& domain, double threshold,
           double prior)
    : costs_(costs), domain_(domain), threshold_(threshold), prior_(prior)
  {
  }

  /// @param refuted  receives, when not null, the state in which the plan's hypothesis is refuted
  PlanEffort walk(std::vector<Literal> state, const reasoner::Plan& plan,
                  std::vector<Literal>* refuted)
  {
    const std::vector<Literal> without = state;
    std::vector<reasoner::Atom> before;
    for (const auto& text : plan.hypothesis)
    {
      Literal assumed = reasoner::parseGroundLiteral(text, domain_.highLevel());
      const std::string fluent = reasoner::toString(assumed.atom);
      const bool known = std::any_of(state.begin(), state.end(), [&](const Literal& literal) {
        return reasoner::toString(literal.atom) == fluent;
      });
      if (!known)  // another plan may have settled it
        state.push_back(std::move(assumed));
    }
    PlanEffort total;
    bool checked = false;
    for (const auto& step : plan.steps)
    {
      for (const auto& text : step)
      {
        const auto action = reasoner::parseGroundAction(text, domain_.highLevel());
        Effort effort;
        try
        {
          effort = costs_.effort(state, text, plan.hypothesis, threshold_, prior_);
          state = refinement::successor(domain_.highLevel(), state, action);
        }
        catch (const FailedPrecondition&)
        {
          continue;  // another plan has done it already
        }
        if (!checked && effort.checks)
        {
          checked = true;
          total.failure_s = effort.failure_s;
        }
        (checked ? total.success_s : total.before_s) += effort.success_s;
        if (!checked)
          before.push_back(action);
      }
    }
    if (refuted != nullptr)
    {
      *refuted = without;
      try
      {
        for (std::size_t i = 0; checked && i < before.size(); ++i)
          *refuted = refinement::successor(domain_.highLevel(), *refuted, before[i]);
      }
      catch (const FailedPrecondition&)  // it was possible under the hypothesis only
      {
      }
    }
    return total;
  }

private:
  PlanCosts& costs_;
  const refinement::LowLevelDomain& domain_;
  double threshold_;
  double prior_;
};

}  // namespace

Effort PlanCosts::effort(const std::vector<Literal>& state, const std::string& action,
                         const std::vector<std::string>& assumed, double threshold, double prior)
{
  const auto zoom =
      refinement::zoom(domain_, state, reasoner::parseGroundAction(action, domain_.highLevel()));
  refinement::InitialKnowledge knowledge;
  std::string hidden;
  std::string key = action + " " + std::to_string(threshold) + " " + std::to_string(prior);
  for (const auto& literal : zoom.start)
  {
    const std::string text = reasoner::toString(literal);
    const std::string fluent = reasoner::toString(literal.atom);
    key += "; " + text;
    const bool valued = literal.value.name != "true" && literal.value.name != "false";
    if (!valued || !literal.equal ||
        std::find(assumed.begin(), assumed.end(), text) == assumed.end())
      continue;
    knowledge.coarse[fluent] = {{literal.value.name, prior}};
    hidden = fluent;
    key += " assumed";
  }
  const auto known = known_.find(key);
  if (known != known_.end())
    return known->second;
  const Effort effort = effortOf(refinement::generatePomdp(domain_, models_, zoom, knowledge),
                                 hidden, threshold, prior);
  known_[key] = effort;
  return effort;
}

std::vector<double> PlanCosts::expected(const std::vector<Literal>& state,
                                        const std::vector<WeightedPlan>& plans, double threshold,
                                        double prior)
{
  PlanWalk walk(*this, domain_, threshold, prior);
  std::vector<PlanEffort> now;
  std::vector<std::vector<Literal>> refuted(plans.size());
  std::vector<double> ratio;  // probability per second of checking
  for (std::size_t i = 0; i < plans.size(); ++i)
  {
    now.push_back(walk.walk(state, plans[i].plan, &refuted[i]));
    ratio.push_back(plans[i].probability / (1e-9 + now[i].before_s + now[i].failure_s));
  }
  std::vector<std::size_t> order(plans.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&ratio](std::size_t a, std::size_t b) { return ratio[a] > ratio[b]; });
  const std::size_t ordered = std::min(plans.size(), kMaxOrdered);

  std::vector<std::vector<PlanEffort>> efforts(ordered + 1);
  std::vector<double> probabilities;
  for (std::size_t i = 0; i < ordered; ++i)
  {
    probabilities.push_back(plans[order[i]].probability);
    efforts[ordered].push_back(now[order[i]]);
    for (std::size_t j = 0; j < ordered; ++j)
    {
      efforts[i].push_back(i == j ? PlanEffort{}
                                  : walk.walk(refuted[order[i]], plans[order[j]].plan, nullptr));
    }
  }
  BestOrder best(efforts, probabilities);
  std::vector<double> costs(plans.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < ordered; ++i)
  {
    costs[order[i]] = best.startingWith(i, (1U << ordered) - 1U, ordered);
    largest = std::max(largest, costs[order[i]]);
  }
  // Beyond those the rule of the ratio alone: later than all of them, in its order.
  for (std::size_t i = ordered; i < plans.size(); ++i)
    costs[order[i]] = largest + 1.0 / std::max(ratio[order[i]], 1e-12);
  return costs;
}

}  // namespace kr3::executive
