#include "kr3_executive/plan_cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
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
constexpr double kUnknown = -1.0;       // costs are not negative
constexpr std::size_t kMaxOrdered = 8;  // hypotheses whose orders are all considered

/// The expected time to the goal for every first plan, with the others in the best order after it.
class BestOrder
{
public:
  /// @param efforts  [from][plan]; from the last entry: the present state, from others: after that
  ///                 plan's hypothesis was refuted, where the plan's own is null
  BestOrder(const std::vector<std::vector<std::shared_ptr<const PlanEffort>>>& efforts,
            const std::vector<double>& probabilities)
    : efforts_(efforts)
    , probabilities_(probabilities)
    , known_((std::size_t{1} << probabilities.size()) * efforts.size(), kUnknown)
  {
  }

  [[nodiscard]] double startingWith(std::size_t plan, unsigned left, std::size_t from)
  {
    double mass = 0.0;
    for (std::size_t i = 0; i < probabilities_.size(); ++i)
      mass += (left >> i & 1U) != 0 ? probabilities_[i] : 0.0;
    const double holds = mass > 0.0 ? probabilities_[plan] / mass : 1.0;
    const PlanEffort& effort = *efforts_[from][plan];
    const unsigned rest = left & ~(1U << plan);
    double cost = effort.before_s + holds * effort.success_s;
    if (holds < 1.0 && rest != 0)
      cost += (1.0 - holds) * (effort.failure_s + best(rest, plan));
    return cost;
  }

private:
  double best(unsigned left, std::size_t from)
  {
    double& known = known_[left * efforts_.size() + from];
    if (known >= 0.0)
      return known;
    double least = kInfinite;
    for (std::size_t i = 0; i < probabilities_.size(); ++i)
    {
      if ((left >> i & 1U) != 0)
        least = std::min(least, startingWith(i, left, from));
    }
    known = least;
    return least;
  }

  const std::vector<std::vector<std::shared_ptr<const PlanEffort>>>& efforts_;
  const std::vector<double>& probabilities_;
  std::vector<double> known_;  // least costs, shape [2^plans, from]
};

void addNumber(Fingerprinter& fingerprinter, double number)
{
  std::uint64_t bits = 0;  // all of them count
  std::memcpy(&bits, &number, sizeof bits);
  fingerprinter.add(bits);
}

void addTexts(Fingerprinter& fingerprinter, const std::vector<std::string>& texts)
{
  fingerprinter.add(static_cast<std::uint64_t>(texts.size()));
  for (const auto& text : texts)
    fingerprinter.addText(text);
}

/// A key for what depends on a state and on how beliefs are judged.
Fingerprinter keyBegun(const Fingerprint& state, double threshold, double prior)
{
  Fingerprinter fingerprinter;
  fingerprinter.add(state.high);
  fingerprinter.add(state.low);
  addNumber(fingerprinter, threshold);
  addNumber(fingerprinter, prior);
  return fingerprinter;
}

/// The state in which a plan's hypothesis holds, where the state leaves it open: another plan may
/// have settled it.
HighLevelState assuming(const HighLevelState& state, const std::vector<std::string>& hypothesis,
                        const reasoner::Description& high_level)
{
  std::vector<Literal> literals = state.literals;
  for (const auto& text : hypothesis)
  {
    Literal assumed = reasoner::parseGroundLiteral(text, high_level);
    const std::string fluent = reasoner::toString(assumed.atom);
    const bool known = std::any_of(literals.begin(), literals.end(), [&](const Literal& literal) {
      return reasoner::toString(literal.atom) == fluent;
    });
    if (!known)
      literals.push_back(std::move(assumed));
  }
  return highLevelState(std::move(literals));
}

}  // namespace

Effort PlanCosts::effort(const std::vector<Literal>& state, const std::string& action,
                         const std::vector<std::string>& assumed, double threshold, double prior)
{
  return effort(highLevelState(state), action, assumed, threshold, prior);
}

Effort PlanCosts::effort(const HighLevelState& state, const std::string& action,
                         const std::vector<std::string>& assumed, double threshold, double prior)
{
  const auto zoom = tasks_->zoom(state, action);
  refinement::InitialKnowledge knowledge;
  std::string hidden;
  std::vector<std::string> hypotheses;
  for (const auto& literal : zoom->zoom.start)
  {
    const bool valued = literal.value.name != "true" && literal.value.name != "false";
    if (!valued || !literal.equal)
      continue;
    const std::string text = reasoner::toString(literal);
    if (std::find(assumed.begin(), assumed.end(), text) == assumed.end())
      continue;
    hidden = reasoner::toString(literal.atom);
    knowledge.coarse[hidden] = {{literal.value.name, prior}};
    hypotheses.push_back(text);
  }
  Fingerprinter fingerprinter = keyBegun(zoom->key, threshold, prior);
  addTexts(fingerprinter, hypotheses);
  const Fingerprint key = fingerprinter.result();
  if (const auto known = efforts_.find(key))
    return *known;
  const Effort effort = effortOf(*tasks_->task(*zoom, knowledge), hidden, threshold, prior);
  efforts_.keep(key, effort, sizeof effort);
  return effort;
}

std::shared_ptr<const PlanEffort> PlanCosts::walked(const HighLevelState& state,
                                                    const reasoner::Plan& plan, double threshold,
                                                    double prior)
{
  Fingerprinter fingerprinter = keyBegun(state.key, threshold, prior);
  addTexts(fingerprinter, plan.hypothesis);
  for (const auto& step : plan.steps)
    addTexts(fingerprinter, step);
  const Fingerprint key = fingerprinter.result();
  if (auto known = plans_.find(key))
    return known;

  auto now = std::make_shared<const HighLevelState>(
      assuming(state, plan.hypothesis, tasks_->domain().highLevel()));
  PlanEffort total;
  bool checked = false;
  std::vector<std::string> before;
  for (const auto& step : plan.steps)
  {
    for (const auto& action : step)
    {
      Effort effort;
      try
      {
        effort = this->effort(*now, action, plan.hypothesis, threshold, prior);
        now = tasks_->successor(*now, action);
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
  total.refuted = std::make_shared<const HighLevelState>(state);
  try
  {
    for (std::size_t i = 0; checked && i < before.size(); ++i)
      total.refuted = tasks_->successor(*total.refuted, before[i]);
  }
  catch (const FailedPrecondition&)  // it was possible under the hypothesis only
  {
  }
  const std::size_t bytes = sizeof total + total.refuted->literals.size() * 2 * sizeof(Literal);
  return plans_.keep(key, std::move(total), bytes);
}

std::vector<double> PlanCosts::expected(const std::vector<Literal>& state,
                                        const std::vector<WeightedPlan>& plans, double threshold,
                                        double prior)
{
  const HighLevelState start = highLevelState(state);
  std::vector<std::shared_ptr<const PlanEffort>> now;
  std::vector<double> ratio;  // probability per second of checking
  for (std::size_t i = 0; i < plans.size(); ++i)
  {
    now.push_back(walked(start, plans[i].plan, threshold, prior));
    ratio.push_back(plans[i].probability / (1e-9 + now[i]->before_s + now[i]->failure_s));
  }
  std::vector<std::size_t> order(plans.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&ratio](std::size_t a, std::size_t b) { return ratio[a] > ratio[b]; });
  const std::size_t ordered = std::min(plans.size(), kMaxOrdered);

  std::vector<std::vector<std::shared_ptr<const PlanEffort>>> efforts(ordered + 1);
  std::vector<double> probabilities;
  for (std::size_t i = 0; i < ordered; ++i)
  {
    probabilities.push_back(plans[order[i]].probability);
    efforts[ordered].push_back(now[order[i]]);
    for (std::size_t j = 0; j < ordered; ++j)
    {
      efforts[i].push_back(
          i == j ? nullptr
                 : walked(*now[order[i]]->refuted, plans[order[j]].plan, threshold, prior));
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
