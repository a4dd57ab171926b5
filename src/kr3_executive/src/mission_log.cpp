#include "kr3_executive/mission_log.hpp"

#include <cstdio>

#include <kr3_pomdp/solved_model.hpp>

namespace kr3::executive
{
namespace
{

std::string described(const reasoner::Record& record)
{
  char confidence[40];
  std::snprintf(confidence, sizeof confidence, "%.9g", record.confidence);
  return reasoner::toString(record) + ", " + confidence + ", " + record.source;
}

std::string joined(const std::vector<std::string>& items, const char* separator)
{
  std::string text;
  for (const auto& item : items)
    text += (text.empty() ? "" : separator) + item;
  return text;
}

std::string exact(double number)
{
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.17g", number);
  return digits;
}

std::string fingerprint(const pomdp::Belief& belief)
{
  std::string text;
  for (const double probability : belief.probabilities())
    text += exact(probability) + ' ';
  return "belief " + pomdp::contentHash(text);
}

struct Details
{
  const State& state;

  std::vector<std::string> operator()(const Wait&) const { return {}; }
  std::vector<std::string> operator()(const RequestPlan& request) const
  {
    std::vector<std::string> details{state.goal};
    if (request.alternatives)
      details.emplace_back("with alternatives");
    return details;
  }
  std::vector<std::string> operator()(const RequestPolicy& request) const
  {
    // Together with the plan that was chosen: the same first action may serve another one.
    std::vector<std::string> details{request.action};
    if (request.rebuild)
      details.emplace_back("rebuild");
    if (state.plan)
    {
      details.push_back("assuming " + joined(state.plan->plan.hypothesis, ", "));
      for (std::size_t i = state.plan_index + 1; i < state.plan->plan.steps.size(); ++i)
        details.push_back("then " + joined(state.plan->plan.steps[i], " and "));
    }
    return details;
  }
  std::vector<std::string> operator()(const ExecutePolicyAction&) const
  {
    return {state.currentAction()};
  }
  std::vector<std::string> operator()(const AddRecords& request) const
  {
    std::vector<std::string> details;
    for (const auto& record : request.records)
      details.push_back(described(record));
    return details;
  }
  std::vector<std::string> operator()(const RequestDiagnosis&) const { return {}; }
  std::vector<std::string> operator()(const ReopenRefutation&) const { return {}; }
  std::vector<std::string> operator()(const Finish& finish) const
  {
    return {finish.achieved ? "achieved" : "not achieved", finish.reason};
  }
};

struct Kind
{
  const char* operator()(const Wait&) const { return "wait"; }
  const char* operator()(const RequestPlan&) const { return "request_plan"; }
  const char* operator()(const RequestPolicy&) const { return "request_policy"; }
  const char* operator()(const ExecutePolicyAction&) const { return "execute_policy_action"; }
  const char* operator()(const AddRecords&) const { return "add_records"; }
  const char* operator()(const RequestDiagnosis&) const { return "request_diagnosis"; }
  const char* operator()(const ReopenRefutation&) const { return "reopen_refutation"; }
  const char* operator()(const Finish&) const { return "finish"; }
};

}  // namespace

const char* toString(const Decision& decision)
{
  return std::visit(Kind{}, decision);
}

ReportedDecision reported(const Decision& decision, const State& state)
{
  return {0, toString(decision), std::visit(Details{state}, decision), {}, {}};
}

ReportedDecision reported(const std::vector<CostedPlan>& plans, bool cut_short)
{
  ReportedDecision decision{0, "plans", {}, {}, {}, cut_short};
  for (const auto& candidate : plans)
  {
    std::string steps;
    for (const auto& together : candidate.plan.steps)
      steps += (steps.empty() ? "" : ", then ") + joined(together, " and ");
    const std::string& assumed = joined(candidate.plan.hypothesis, ", ");
    decision.details.push_back(steps + (assumed.empty() ? "" : ", assuming " + assumed));
    decision.basis.push_back("cost " + exact(candidate.cost_s));
  }
  return decision;
}

ReportedDecision reported(const std::string& action, const SolvedPolicy& policy,
                          const pomdp::Belief& belief)
{
  return {0,
          "policy",
          {action},
          {"worth " + exact(policy.lower) + " to " + exact(policy.upper), fingerprint(belief)},
          policy};
}

ReportedDecision reported(const reasoner::Diagnosis& diagnosis)
{
  ReportedDecision decision{0, "diagnosis", {}, {}, {}};
  if (!diagnosis.consistent)
    decision.details.emplace_back("inconsistent");
  for (const auto& explanation : diagnosis.explanations)
    decision.details.push_back(explanation.empty() ? "nothing" : joined(explanation, ", "));
  return decision;
}

ReportedDecision reportedLateDiagnosis()
{
  ReportedDecision decision{0, "diagnosis", {"not found in time"}, {}, {}};
  decision.cut_short = true;
  return decision;
}

ReportedDecision reportedLowLevel(const std::string& action, const pomdp::Belief& belief)
{
  ReportedDecision decision{0, "low_level_finish", {}, {fingerprint(belief)}, {}};
  if (!action.empty())
  {
    decision.kind = "low_level_action";
    decision.details = {action};
  }
  return decision;
}

}  // namespace kr3::executive
