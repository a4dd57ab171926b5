#include "kr3_executive/narration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;

std::string rounded(double value, int digits = 2)
{
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string filled(std::string pattern, const LiteralText& literal)
{
  const auto replace = [&pattern](const std::string& key, const std::string& value) {
    for (auto at = pattern.find(key); at != std::string::npos; at = pattern.find(key, at))
    {
      pattern.replace(at, key.size(), value);
      at += value.size();
    }
  };
  for (std::size_t i = 0; i < literal.arguments.size(); ++i)
    replace("{" + std::to_string(i + 1) + "}", literal.arguments[i]);
  replace("{value}", literal.value);
  return pattern;
}

json assessmentJson(const Assessment& assessment)
{
  json refutations = json::object();
  for (const auto& refutation : assessment.refutations)
    refutations[refutation.literal] = refutation.probability;
  return {{"achieved", assessment.achieved}, {"refuted", refutations}};
}

json planJson(const reasoner::Plan& plan)
{
  return {{"hypothesis", plan.hypothesis}, {"steps", plan.steps}};
}

}  // namespace

const char* toString(EventKind kind)
{
  switch (kind)
  {
    case EventKind::kGoal:
      return "GOAL";
    case EventKind::kPlan:
      return "PLAN";
    case EventKind::kHighLevelAction:
      return "HL_ACTION";
    case EventKind::kPolicy:
      return "POLICY";
    case EventKind::kLowLevelAction:
      return "LL_ACTION";
    case EventKind::kRecord:
      return "RECORD";
    case EventKind::kDiagnosis:
      return "DIAGNOSIS";
    case EventKind::kReplan:
      return "REPLAN";
    case EventKind::kDone:
      return "DONE";
    case EventKind::kFailed:
      return "FAILED";
    case EventKind::kCancelled:
      return "CANCELLED";
  }
  return "UNKNOWN";
}

Narrator::Narrator(std::map<std::string, Phrase> phrases) : phrases_(std::move(phrases)) {}

std::string Narrator::phrase(const std::string& literal) const
{
  const LiteralText parts = takeApart(literal);
  const auto found = phrases_.find(parts.symbol);
  if (found == phrases_.end() || found->second.holds.empty())
    return literal;
  const std::string text = filled(found->second.holds, parts);
  const bool denied = !parts.equal || parts.value == "false";
  return denied ? "not " + text : text;
}

std::string Narrator::refuted(const std::string& literal) const
{
  const auto found = phrases_.find(takeApart(literal).symbol);
  return found == phrases_.end() || found->second.refuted.empty() ? "but this is not so"
                                                                  : found->second.refuted;
}

Narration Narrator::goal(const std::string& goal) const
{
  return {"goal: " + goal, json{{"goal", goal}}.dump()};
}

Narration Narrator::plan(const CostedPlan& plan, std::size_t num_plans) const
{
  std::string text = plan.confirms.empty()
                         ? "plan: "
                         : "plan to make sure that " + phrase(plan.confirms) +
                               (plan.reason.empty() ? "" : " (" + plan.reason + ")") + ": ";
  for (std::size_t i = 0; i < plan.plan.steps.size(); ++i)
    text += (i == 0 ? "" : ", ") + listed(plan.plan.steps[i]);
  if (!plan.plan.hypothesis.empty())
  {
    std::vector<std::string> assumed;
    for (const auto& literal : plan.plan.hypothesis)
      assumed.push_back(phrase(literal));
    text += "; it assumes " + listed(assumed);
  }
  if (num_plans > 1)
  {
    text += "; the cheapest of " + std::to_string(num_plans) + ", about " +
            rounded(plan.cost_s, 0) + " s";
  }
  json data = planJson(plan.plan);
  data["cost_s"] = std::isfinite(plan.cost_s) ? json(plan.cost_s) : json();
  data["num_plans"] = num_plans;
  if (!plan.confirms.empty())
    data["confirms"] = plan.confirms;
  return {text, data.dump()};
}

Narration Narrator::highLevelAction(const std::string& action, int step) const
{
  return {"step " + std::to_string(step) + ": " + action,
          json{{"action", action}, {"step", step}}.dump()};
}

Narration Narrator::policy(const std::string& action, const SolvedPolicy& policy,
                           const refinement::PomdpTask& task) const
{
  const auto& model = task.model();
  std::vector<std::string> relevant;
  for (const auto& constant : task.zoom().relevant)
    relevant.push_back(constant.name);
  const std::string text = "policy for " + action + ": " + std::to_string(model.numStates()) +
                           " states over " + listed(relevant) + ", value in [" +
                           rounded(policy.lower, 1) + ", " + rounded(policy.upper, 1) + "]" +
                           (policy.cached ? " (from the cache)" : "");
  return {text, json{{"action", action},
                     {"policy_id", policy.id},
                     {"lower", policy.lower},
                     {"upper", policy.upper},
                     {"backups", policy.backups},
                     {"cpu_s", policy.cpu_s},
                     {"cached", policy.cached},
                     {"states", model.numStates()},
                     {"actions", model.numActions()},
                     {"observations", model.numObservations()},
                     {"relevant", relevant}}
                    .dump()};
}

Narration Narrator::lowLevelAction(const LowLevelAction& action, const LowLevelResult& result,
                                   const LowLevelTask& task,
                                   const std::vector<std::string>& ignored) const
{
  std::string text = action.symbol;
  for (std::size_t i = 0; i < action.arguments.size(); ++i)
    text += (i == 0 ? "(" : ", ") + action.arguments[i];
  text += action.arguments.empty() ? "" : ")";
  if (!result.outcome.empty())
    text += ": " + result.outcome;
  if (!result.observation.empty())
    text += " (" + listed(result.observation) + ")";
  json sightings = json::array();
  for (const auto& sighting : result.sightings)
  {
    text += "; noticed " + sighting.literal + " (" + rounded(sighting.confidence) + ")";
    sightings.push_back({{"literal", sighting.literal}, {"confidence", sighting.confidence}});
  }
  for (const auto& why : ignored)
    text += "; ignored " + why;
  const std::string summary = task.pomdp().summary(task.belief());
  text += "; " + summary;
  json data = {{"action", action.text},
               {"symbol", action.symbol},
               {"arguments", action.arguments},
               {"outcome", result.outcome},
               {"observation", result.observation},
               {"confidence", result.confidence},
               {"duration_s", result.duration_s},
               {"sightings", sightings},
               {"ignored", ignored},
               {"belief", summary},
               {"assessment", assessmentJson(task.assess())}};
  return {text, data.dump()};
}

Narration Narrator::record(const reasoner::Record& record, bool unexpected) const
{
  return {reasoner::toString(record) + (unexpected ? " (unexpected)" : ""),
          json{{"record", reasoner::toString(record)},
               {"kind", static_cast<int>(record.kind)},
               {"statement", record.statement},
               {"value", record.value},
               {"step", record.step},
               {"confidence", record.confidence},
               {"source", record.source},
               {"unexpected", unexpected}}
              .dump()};
}

Narration Narrator::summedUp(int steps, std::size_t records_left) const
{
  return {std::to_string(steps) + " earlier steps were summed up; " + std::to_string(records_left) +
              " records are left",
          json({{"summed_up_steps", steps}, {"records", records_left}}).dump()};
}

Narration Narrator::replan(const std::string& why) const
{
  return {"the plan is no longer valid: " + why, json{{"why", why}}.dump()};
}

Narration Narrator::end(const Finish& finish, const State& state) const
{
  std::string text = finish.achieved ? "done: " : "not achieved: ";
  text += finish.reason;
  text += " after " + std::to_string(state.hl_actions_done) + " high-level and " +
          std::to_string(state.ll_actions_done) + " low-level actions";
  return {text, json{{"achieved", finish.achieved},
                     {"reason", finish.reason},
                     {"hl_actions", state.hl_actions_done},
                     {"ll_actions", state.ll_actions_done}}
                    .dump()};
}

std::string Narrator::surprise(const reasoner::Record& record, const Support& expected) const
{
  const std::string basis = expected.reason.empty() ? "" : " (" + expected.reason + ")";
  const bool act = record.kind == reasoner::RecordKind::kHappened ||
                   record.kind == reasoner::RecordKind::kAttempted;
  if (act)
    return record.statement + " occurred unintended";
  if (!record.value)
    return "expected " + phrase(record.statement) + basis + ", " + refuted(record.statement);
  return "expected otherwise" + basis + ", but " + phrase(record.statement);
}

std::string Narrator::inWords(const std::vector<std::string>& explanation,
                              const std::map<std::string, std::string>& defaults_of) const
{
  static const std::string kInit = "init(";
  static const std::string kFalse = ", false)";
  static const std::string kFailed = "failed(";
  std::vector<std::string> sentences;
  for (const auto& statement : explanation)
  {
    const auto end = statement.rfind(kFalse);
    const auto comma = statement.rfind(", ");
    if (statement.compare(0, kInit.size(), kInit) == 0 && end != std::string::npos)
    {
      const std::string literal = statement.substr(kInit.size(), end - kInit.size());
      const LiteralText parts = takeApart(literal);
      const auto by = defaults_of.find(literal);
      const std::string subject = parts.arguments.empty() ? literal : parts.arguments.front();
      sentences.push_back(by == defaults_of.end()
                              ? "from the start it was not so that " + phrase(literal)
                              : subject + " is an exception to " + by->second);
    }
    else if (statement.compare(0, kFailed.size(), kFailed) == 0 && comma != std::string::npos)
    {
      sentences.push_back(statement.substr(kFailed.size(), comma - kFailed.size()) +
                          " failed at step " +
                          statement.substr(comma + 2, statement.size() - comma - 3));
    }
    else
      sentences.push_back("there was " + statement);
  }
  return listed(sentences);
}

Narration Narrator::diagnosis(const std::vector<std::string>& surprises,
                              const reasoner::Diagnosis& diagnosis,
                              const std::vector<std::string>& known,
                              const std::map<std::string, std::string>& defaults_of,
                              const std::vector<std::string>& expectations) const
{
  std::string text = listed(surprises);
  if (!diagnosis.consistent)
  {
    text += "; no explanation: " + listed(diagnosis.conflict) + " contradict each other";
  }
  else if (!diagnosis.explanations.empty() && !diagnosis.explanations.front().empty())
  {
    const std::size_t others = diagnosis.explanations.size() - 1;
    std::vector<std::string> fresh;
    for (const auto& part : diagnosis.explanations.front())
    {
      if (std::find(known.begin(), known.end(), part) == known.end())
        fresh.push_back(part);
    }
    if (!fresh.empty())
      text += ": " + inWords(fresh, defaults_of);
    if (others > 0)
      text += std::string(", or one of ") + (diagnosis.complete ? "" : "more than ") +
              std::to_string(others) + " other explanations";
  }
  if (!expectations.empty())
    text += "; now expected " + listed(expectations);
  return {text, json{{"surprises", surprises},
                     {"consistent", diagnosis.consistent},
                     {"cost", diagnosis.cost},
                     {"explanations", diagnosis.explanations},
                     {"in_words", diagnosis.in_words},
                     {"conflict", diagnosis.conflict},
                     {"now_expected", expectations}}
                    .dump()};
}

}  // namespace kr3::executive
