// The part of MissionDriver that asks whether a goal that the history entails is known to be true.

#include <algorithm>
#include <utility>

#include "kr3_executive/driver.hpp"
#include "plan_steps.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Formula;
using reasoner::Literal;

Literal contrary(Literal literal)
{
  if (literal.value.name == "true" || literal.value.name == "false")
    literal.value.name = literal.value.name == "true" ? "false" : "true";
  else
    literal.equal = !literal.equal;
  return literal;
}

}  // namespace

double MissionDriver::rememberedProbability(const Literal& literal) const
{
  const auto remembered = knowledge_.memory.find(reasoner::toString(literal.atom));
  if (remembered == knowledge_.memory.end() || !literal.equal)
    return 0.0;
  double probability = 0.0;
  for (const auto& [value, share] : remembered->second.values)
    probability += domain_.coarse(value) == literal.value.name ? share : 0.0;
  return probability;
}

MissionDriver::Doubt MissionDriver::doubtOf(const Formula& formula, bool negated)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    const Literal literal = negated ? contrary(formula.literal) : formula.literal;
    const std::string text = reasoner::toString(literal, domain_.highLevel());
    if (reasoner_.entails(text, state_.step) != reasoner::Answer::kTrue)
      return {literal, 0.0, {}};
    const Support support = supportOf(text);
    return {literal, std::max(support.probability, rememberedProbability(literal)), support.reason};
  }
  if (formula.kind == Formula::Kind::kNot)
    return doubtOf(formula.operands.front(), !negated);
  // All that a conjunction needs has to be known, of a disjunction one operand.
  const bool all = (formula.kind == Formula::Kind::kAnd) != negated;
  std::optional<Doubt> result;
  for (const auto& operand : formula.operands)
  {
    Doubt doubt = doubtOf(operand, negated);
    if (!result || (doubt.probability < result->probability) == all)
      result = std::move(doubt);
  }
  return result.value_or(Doubt{{}, 1.0, {}});
}

std::vector<CostedPlan> MissionDriver::plansToConfirmGoal()
{
  const Doubt doubt = doubtOf(reasoner::parseGoal(state_.goal, domain_.highLevel()), false);
  if (doubt.probability > state_.limits.threshold || doubt.probability <= 0.0)
    return {};
  const std::string contradicted = reasoner::toString(contrary(doubt.literal), domain_.highLevel());
  const std::string fluent = reasoner::toString(doubt.literal.atom);
  std::vector<CostedPlan> plans;
  for (const auto& found : reasoner_.plan(contradicted, 1, cancel_).plans)
  {
    CostedPlan plan{serialised(found), 0.0, reasoner::toString(doubt.literal, domain_.highLevel()),
                    doubt.reason};
    const std::size_t checks = stepThatChecks(plan.plan, fluent);
    if (checks == plan.plan.steps.size())
      continue;
    plan.plan.steps.resize(checks + 1);
    const bool known = std::any_of(plans.begin(), plans.end(), [&](const CostedPlan& other) {
      return other.plan.steps == plan.plan.steps;
    });
    if (!known)
      plans.push_back(std::move(plan));
  }
  return plans;
}

std::size_t MissionDriver::stepThatChecks(const reasoner::Plan& plan, const std::string& fluent)
{
  auto state =
      std::make_shared<const HighLevelState>(highLevelState(believedState(plan.hypothesis)));
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
  {
    const std::string& action = plan.steps[i].front();
    try
    {
      const auto zoom = costs_->tasks().zoom(*state, action);
      const auto& start = zoom->zoom.start;
      if (std::any_of(start.begin(), start.end(), [&](const Literal& literal) {
            return reasoner::toString(literal.atom) == fluent;
          }))
        return i;
      state = costs_->tasks().successor(*state, action);
    }
    catch (const FailedPrecondition&)  // what is believed does not fit the plan
    {
      break;
    }
  }
  return plan.steps.size();
}

}  // namespace kr3::executive
