// The part of MissionDriver that plans (lines 3-6), and what it holds to be so.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "kr3_executive/driver.hpp"
#include "kr3_executive/model_fingerprint.hpp"
#include "kr3_executive/routes.hpp"
#include "literal_text.hpp"
#include "plan_steps.hpp"

namespace kr3::executive
{
namespace
{

/// Why a literal is believed that the history does not entail.
const std::string kAssumed = "assumed";

/// Whether a record that a statement has a truth value settles that a literal holds.
bool settles(const LiteralText& statement, bool value, const LiteralText& literal)
{
  if (statement.fluent() != literal.fluent() || !statement.equal || !literal.equal)
    return false;
  if (!literal.isBoolean())
    return value && statement.value == literal.value;
  return (statement.value == "true") == value ? literal.value == "true" : literal.value == "false";
}

}  // namespace

namespace
{

/// Which of two plans that cost the same is taken must not depend on how the search went, nor on
/// whose name comes first in the alphabet: an order drawn by fingerprints of their texts. Any seed
/// of the draw is as good as another; the scripted scenarios were written with this one.
void inDrawnOrder(std::vector<CostedPlan>& plans)
{
  const auto drawn = [](const CostedPlan& candidate) {
    constexpr std::uint64_t kSeed = 8;
    Fingerprinter fingerprinter;
    fingerprinter.add(kSeed);
    for (const auto& literal : candidate.plan.hypothesis)
      fingerprinter.addText(literal);
    for (const auto& step : candidate.plan.steps)
      fingerprinter.addText(step.front());
    return fingerprinter.result();
  };
  std::vector<std::pair<Fingerprint, std::size_t>> order;
  for (std::size_t i = 0; i < plans.size(); ++i)
    order.emplace_back(drawn(plans[i]), i);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.high, a.first.low) < std::tie(b.first.high, b.first.low);
  });
  std::vector<CostedPlan> sorted;
  for (const auto& entry : order)
    sorted.push_back(std::move(plans[entry.second]));
  plans = std::move(sorted);
}

}  // namespace

reasoner::Plan serialised(const reasoner::Plan& plan)
{
  reasoner::Plan flat{plan.hypothesis, {}};
  for (const auto& together : plan.steps)
  {
    for (const auto& action : together)
      flat.steps.push_back({action});
  }
  return flat;
}

Event MissionDriver::performPlan(const RequestPlan& request)
{
  const std::uint32_t max_plans =
      request.alternatives ? std::max<std::uint32_t>(config_.max_alternatives, 1) : 1;
  const reasoner::PlanResult result = reasoner_.plan(state_.goal, max_plans, cancel_);
  PlanReady event{result.goal_entailed, {}, result.reason};
  if (result.goal_entailed)
  {
    event.plans = plansToConfirmGoal();
    event.goal_entailed = event.plans.empty();
  }
  else
  {
    for (const auto& found : result.plans)
      event.plans.push_back({serialised(found)});
    inDrawnOrder(event.plans);
    markRefuted(event.plans);
  }
  if (!state_.failures.empty())
    tellSituations(event.plans);
  if (request.alternatives)
    addDetours(event.plans);
  if (event.plans.size() > 1)
    costPlans(event.plans);
  // A reason although there are plans: wall time left others out.
  note([&] {
    return reported(event.plans,
                    !result.complete && !result.plans.empty() && !result.reason.empty());
  });
  return event;
}

void MissionDriver::tellSituations(std::vector<CostedPlan>& plans)
{
  std::map<std::vector<std::string>, FluentValues> states;  // by hypothesis
  for (auto& candidate : plans)
  {
    const auto& hypothesis = candidate.plan.hypothesis;
    if (states.count(hypothesis) == 0)
      states[hypothesis] = valuesOf(believedState(hypothesis));
    candidate.situation =
        executive::situationOf(states[hypothesis], candidate.plan.steps.front().front());
  }
}

void MissionDriver::addDetours(std::vector<CostedPlan>& plans)
{
  if (state_.detours >= state_.limits.max_detours)
    return;
  std::vector<CostedPlan> found;
  std::set<std::string> tried;
  for (const auto& direct : plans)
  {
    const auto& hypothesis = direct.plan.hypothesis;
    const std::string& action = direct.plan.steps.front().front();
    const auto inVain = [&](const FluentValues& state, const std::string& other) {
      return state_.failuresOf(other, hypothesis, executive::situationOf(state, other)) >=
             state_.limits.max_attempts;
    };
    const FluentValues now = valuesOf(believedState(hypothesis));
    if (!inVain(now, action) || !tried.insert(attemptKey(action, hypothesis, {})).second)
      continue;
    for (auto& steps : detours(high_level_laws_, now, action, inVain, config_.max_alternatives))
    {
      CostedPlan round = direct;
      round.detour = true;
      steps.insert(steps.end(), direct.plan.steps.begin() + 1, direct.plan.steps.end());
      round.plan.steps = std::move(steps);
      round.situation = executive::situationOf(now, round.plan.steps.front().front());
      found.push_back(std::move(round));
    }
  }
  plans.insert(plans.end(), found.begin(), found.end());
}

std::string MissionDriver::situationOf(const std::string& action) const
{
  return executive::situationOf(valuesOf(task_state_), action);
}

void MissionDriver::costPlans(std::vector<CostedPlan>& plans)
{
  const std::vector<reasoner::Literal> known = believedState({});
  const double threshold = state_.limits.threshold;
  const double prior = config_.least_hypothesis_probability;
  const auto cost = [&](const std::vector<WeightedPlan>& weighted) {
    return costs_->expected(known, weighted, threshold, prior);
  };
  // Of the plans for one hypothesis the cheapest stands for all when hypotheses are compared.
  std::map<std::vector<std::string>, std::size_t> cheapest;
  std::vector<double> alone;
  for (std::size_t i = 0; i < plans.size(); ++i)
  {
    alone.push_back(cost({{plans[i].plan, 1.0}}).front());
    const auto known_one = cheapest.emplace(plans[i].plan.hypothesis, i).first;
    if (alone[i] < alone[known_one->second])
      known_one->second = i;
  }
  std::vector<std::vector<std::string>> hypotheses;
  std::vector<WeightedPlan> weighted;
  for (const auto& [hypothesis, index] : cheapest)
  {
    hypotheses.push_back(hypothesis);
    weighted.push_back({plans[index].plan, 0.0});
  }
  const std::vector<double> probabilities = hypothesisProbabilities(hypotheses);
  for (std::size_t i = 0; i < weighted.size(); ++i)
    weighted[i].probability = probabilities[i];
  const std::vector<double> costs = cost(weighted);
  for (std::size_t i = 0; i < plans.size(); ++i)
  {
    const auto group = cheapest.find(plans[i].plan.hypothesis);
    const auto at = static_cast<std::size_t>(std::distance(cheapest.begin(), group));
    plans[i].cost_s = costs[at] + (alone[i] - alone[group->second]);
  }
}

std::vector<double> MissionDriver::hypothesisProbabilities(
    const std::vector<std::vector<std::string>>& hypotheses) const
{
  std::map<std::string, std::set<std::string>> open;  // values by fluent
  for (const auto& hypothesis : hypotheses)
  {
    for (const auto& text : hypothesis)
    {
      const LiteralText literal = takeApart(text);
      if (literal.equal && !literal.isBoolean())
        open[literal.fluent()].insert(literal.value);
    }
  }
  std::map<std::string, double> of_literal;
  for (const auto& [fluent, values] : open)
  {
    // What was refuted may still be so, by a look that missed it or a change since: by the odds of
    // its refutations. The others share the rest by what the low level remembers.
    const Refutations refutations = openRefutations(fluent);
    const double even = 1.0 / static_cast<double>(values.size());
    std::vector<std::string> fresh;
    for (const auto& value : values)
    {
      const auto refuted = refutations.find(value);
      if (refuted == refutations.end())
        fresh.push_back(value);
      else
        of_literal[fluent + " = " + value] = even * std::exp(-logOddsOf(refuted->second));
    }
    if (fresh.empty())
      continue;
    const auto shares = probabilitiesOf(domain_, knowledge_.memory, fluent, fresh);
    for (std::size_t i = 0; i < fresh.size(); ++i)
      of_literal[fluent + " = " + fresh[i]] = even * static_cast<double>(fresh.size()) * shares[i];
  }
  std::vector<double> result;
  double sum = 0.0;
  for (const auto& hypothesis : hypotheses)
  {
    double probability = 1.0;
    for (const auto& text : hypothesis)
    {
      const LiteralText literal = takeApart(text);
      const auto known = of_literal.find(literal.fluent() + " = " + literal.value);
      if (literal.equal && known != of_literal.end())
        probability *= known->second;
    }
    result.push_back(probability);
    sum += probability;
  }
  for (auto& probability : result)
    probability = sum > 0.0 ? probability / sum : 1.0 / static_cast<double>(result.size());
  return result;
}

MissionDriver::Believed& MissionDriver::believedNow()
{
  if (believed_ && believed_->step == state_.step)
    return *believed_;
  Believed now{state_.step, {}, {}};
  for (const auto& text : reasoner_.entailedAt(state_.step))
  {
    if (text.find("!=") == std::string::npos)
      now.entailed.push_back(literals_.of(text));
  }
  believed_ = std::move(now);
  return *believed_;
}

void MissionDriver::forgetAnswers()
{
  supports_.clear();
  believed_.reset();
}

const std::vector<reasoner::Literal>& MissionDriver::believedState(
    const std::vector<std::string>& hypothesis)
{
  Believed& now = believedNow();
  const auto known = now.states.find(hypothesis);
  if (known != now.states.end())
    return known->second;
  return now.states.emplace(hypothesis, withAssumed(now.entailed, hypothesis)).first->second;
}

std::vector<reasoner::Literal> MissionDriver::withAssumed(
    std::vector<reasoner::Literal> state, const std::vector<std::string>& hypothesis)
{
  if (hypothesis.empty())
    return state;
  // What is assumed, with what the state constraints make of it.
  FluentValues known;
  FluentValues assumed;
  for (const auto& literal : state)
    known[reasoner::toString(literal.atom)] = literal.value.name;
  for (const auto& text : hypothesis)
  {
    const LiteralText literal = takeApart(text);
    if (literal.equal && known.count(literal.fluent()) == 0)
      assumed[literal.fluent()] = literal.value;
  }
  try
  {
    for (const auto& [fluent, value] : high_level_laws_.imposed(known, assumed))
    {
      if (known.count(fluent) == 0)
        assumed[fluent] = value;
    }
  }
  catch (const InvalidArgument&)  // it fits no state: the plan will turn out to be impossible
  {
  }
  for (const auto& [fluent, value] : assumed)
  {
    const bool boolean = value == "true" || value == "false";
    state.push_back(literals_.of(!boolean          ? fluent + " = " + value
                                 : value == "true" ? fluent
                                                   : "-" + fluent));
  }
  return state;
}

Support MissionDriver::supportOf(const std::string& literal)
{
  return supportOf(literal, state_.step);
}

Support MissionDriver::supportOf(const std::string& literal, int step)
{
  const auto known = supports_.find({literal, step});
  if (known != supports_.end())
    return known->second;
  Support support = findSupport(literal, step);
  supports_[{literal, step}] = support;
  return support;
}

Support MissionDriver::findSupport(const std::string& literal, int step)
{
  if (reasoner_.entails(literal, step) != reasoner::Answer::kTrue)
  {
    // A hypothesis, one of those that are left: its share is a half at most. To count them takes a
    // question for each.
    constexpr double kMostShare = 0.5;
    if (config_.least_hypothesis_probability >= kMostShare)
      return {config_.least_hypothesis_probability, kAssumed};
    const LiteralText parts = takeApart(literal);
    const auto* fluent = domain_.highLevel().findFluent(parts.symbol);
    std::size_t open = 0;
    if (fluent != nullptr && fluent->value_sort)
    {
      for (const auto& value : domain_.highLevel().findSort(*fluent->value_sort)->elements)
        open += reasoner_.possible(parts.fluent() + " = " + value, step) ? 1 : 0;
    }
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(open, 2));
    return {std::max(share, config_.least_hypothesis_probability), kAssumed};
  }
  // What was observed last needs no search for reasons.
  const LiteralText asked = takeApart(literal);
  const reasoner::Record* seen = nullptr;
  for (const auto& record : knowledge_.history)
  {
    const bool about = (record.kind == reasoner::RecordKind::kObserved ||
                        record.kind == reasoner::RecordKind::kInitially) &&
                       record.step <= step;
    if (about && settles(takeApart(record.statement), record.value, asked))
      seen = &record;
  }
  if (seen != nullptr)
    return {seen->confidence, "observed at step " + std::to_string(seen->step)};
  if (const auto left = step == state_.step ? supportByElimination(literal) : std::nullopt)
    return *left;

  // Which default it is matters to people only, and takes longer to find out.
  if (!interest_.narration && reasoner_.restsOnDefault(literal, step))
    return {config_.default_probability, "default"};
  const reasoner::Explanation why = reasoner_.explain(literal, step);
  const std::string by_default = reasoner::defaultBehind(why);
  if (!by_default.empty())
  {
    expected_by_default_[literal] = by_default;
    return {config_.default_probability, "default " + by_default};
  }
  double probability = 1.0;
  for (const auto& record : knowledge_.history)
  {
    const std::string text = reasoner::toString(record);
    if (std::find(why.records.begin(), why.records.end(), text) != why.records.end())
      probability *= record.confidence;
  }
  return {std::max(probability, config_.least_hypothesis_probability),
          why.reasons.empty() ? std::string() : why.reasons.back()};
}

std::optional<Support> MissionDriver::supportByElimination(const std::string& literal) const
{
  const LiteralText asked = takeApart(literal);
  const auto* fluent = domain_.highLevel().findFluent(asked.symbol);
  if (fluent == nullptr || !fluent->value_sort || !asked.equal)
    return std::nullopt;
  const Refutations open = openRefutations(asked.fluent());
  std::set<std::size_t> rests_on;
  for (const auto& value : domain_.highLevel().findSort(*fluent->value_sort)->elements)
  {
    const auto refuted = open.find(value);
    if (value == asked.value)
      continue;
    if (refuted == open.end())
      return std::nullopt;
    rests_on.insert(refuted->second.front());
  }
  double probability = 1.0;
  for (const std::size_t index : rests_on)
    probability *= knowledge_.history[index].confidence;
  // No worse a guess than what is only assumed: it must not be refuted by the mere number of the
  // others.
  return Support{std::max(probability, config_.least_hypothesis_probability),
                 "every other value was observed to be false"};
}

bool MissionDriver::mayHaveChanged(const std::string& fluent) const
{
  FluentValues now;
  for (const auto& literal : task_state_)
    now[reasoner::toString(literal.atom)] = literal.value.name;
  const auto before = now.find(fluent);
  if (before == now.end())
    return false;
  const std::vector<std::string> arguments = takeApart(fluent).arguments;
  const OutcomeChooser first{[](const auto&, const auto&) { return std::size_t{0}; },
                             [](std::size_t) { return std::size_t{0}; }};
  for (const auto& declaration : domain_.highLevel().actions)
  {
    if (!declaration.exogenous)
      continue;
    for (const auto& action : high_level_laws_.instances(declaration))
    {
      const bool about = std::all_of(arguments.begin(), arguments.end(), [&](const auto& name) {
        return std::any_of(action.arguments.begin(), action.arguments.end(),
                           [&](const auto& term) { return term.name == name; });
      });
      if (!about || !high_level_laws_.executable(now, action))
        continue;
      const FluentValues after = high_level_laws_.successor(now, action, first);
      const auto changed = after.find(fluent);
      if (changed != after.end() && changed->second != before->second)
        return true;
    }
  }
  return false;
}

}  // namespace kr3::executive
