#include "commands.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>

#include <kr3_common/error.hpp>

#include "explanation_json.hpp"
#include "kr3_reasoner/sparc.hpp"

namespace kr3::reasoner::tool
{

namespace
{

ReasonerOptions optionsFor(const Arguments& arguments)
{
  ReasonerOptions options;
  options.diagnose_exogenous = arguments.exogenous;
  options.exception_weight = arguments.exception_weight;
  options.exogenous_weight = arguments.exogenous_weight;
  for (const std::string& weight : arguments.default_weights)
  {
    const std::size_t sign = weight.find('=');
    const std::string number = sign == std::string::npos ? "" : weight.substr(sign + 1);
    if (number.empty() || number.size() > 6 ||
        number.find_first_not_of("0123456789") != std::string::npos)
    {
      throw InvalidArgument("found the weight '" + weight + "' of a default, expected NAME=NUMBER");
    }
    options.default_weights[weight.substr(0, sign)] = std::stoi(number);
  }
  return options;
}

void checkDefaultNames(const ReasonerOptions& options, const Description& description)
{
  for (const auto& [name, weight] : options.default_weights)
  {
    const bool known =
        std::any_of(description.defaults.begin(), description.defaults.end(),
                    [&name = name](const Default& rule) { return rule.name.name == name; });
    if (!known)
    {
      throw InvalidArgument("unknown default '" + name + "' in a weight");
    }
  }
}

std::chrono::milliseconds timeLimit(const Arguments& arguments)
{
  constexpr double kMaxSeconds = 1e6;
  const double seconds = std::min(arguments.time_limit_s, kMaxSeconds);
  return std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(seconds * 1e3)));
}

/// The reasoner with the history, and with what is assumed on top of it.
Reasoner reasonerFor(const Arguments& arguments)
{
  const ReasonerOptions options = optionsFor(arguments);
  Description description = readDescription(arguments.files);
  checkDefaultNames(options, description);
  Reasoner reasoner(std::move(description), options);
  reasoner.setLimits({timeLimit(arguments), nullptr});
  for (const std::string& file : arguments.histories)
  {
    reasoner.addRecords(readHistory(file, reasoner.description()));
  }
  if (arguments.progress >= 0)
  {
    const Progress progress = reasoner.progress(arguments.progress);
    if (progress.first_step < arguments.progress)
    {
      std::string why;
      for (const std::string& reason : progress.kept_because)
      {
        why += (why.empty() ? "" : "; ") + reason;
      }
      throw ResourceExhausted("the history cannot be progressed to step " +
                              std::to_string(arguments.progress) + ", only to step " +
                              std::to_string(progress.first_step) + ": " + why);
    }
  }
  for (const std::string& record : arguments.assumed)
  {
    const bool ended = record.find_last_not_of(" \t\n") == record.rfind('.');
    std::vector<Record> records =
        parseHistory(ended ? record : record + ".", "'" + record + "'", reasoner.description());
    for (Record& assumed : records)
    {
      assumed.source = "assumed";
    }
    reasoner.addRecords(records);
  }
  return reasoner;
}

int stepFor(const Arguments& arguments, const Reasoner& reasoner)
{
  return arguments.step < 0 ? reasoner.currentStep() : arguments.step;
}

const char* textOf(Answer answer)
{
  return answer == Answer::kTrue ? "true" : answer == Answer::kFalse ? "false" : "unknown";
}

/// A record's text with its place in a file, as it stands in an answer.
Json recordJson(const std::string& text, const Reasoner& reasoner)
{
  Json json = {{"record", text}, {"file", nullptr}, {"line", nullptr}};
  for (const Record& record : reasoner.history())
  {
    if (record.position.line > 0 && toString(record) == text)
    {
      json["file"] = record.position.file;
      json["line"] = record.position.line;
      break;
    }
  }
  return json;
}

Json recordsJson(const std::vector<std::string>& texts, const Reasoner& reasoner)
{
  Json list = Json::array();
  for (const std::string& text : texts)
  {
    list.push_back(recordJson(text, reasoner));
  }
  return list;
}

Reply inconsistent(Json json, const Reasoner& reasoner)
{
  json["consistent"] = false;
  json["conflict"] = recordsJson(reasoner.diagnose().conflict, reasoner);
  return {std::move(json), false};
}

Json sizeJson(const ProblemSize& size)
{
  return {{"fluents", size.fluents},
          {"constants", size.constants},
          {"actions", size.actions},
          {"records", size.records}};
}

Json itemsJson(const std::vector<RelevantItem>& items)
{
  Json list = Json::array();
  for (const RelevantItem& item : items)
  {
    list.push_back({{"name", item.name}, {"why", item.why}});
  }
  return list;
}

PlanOptions planOptions(const Arguments& arguments)
{
  PlanOptions options;
  options.max_horizon = arguments.max_horizon;
  options.preference = arguments.preference == "cheapest" ? PlanPreference::kCheapest
                       : arguments.preference == "cheapest-shortest"
                           ? PlanPreference::kCheapestShortest
                           : PlanPreference::kShortest;
  options.all = arguments.all;
  options.max_plans = arguments.max_plans;
  options.relevant_only = !arguments.whole;
  options.time_limit =
      arguments.time_limit_s > 0.0 ? timeLimit(arguments) : std::chrono::minutes(1);
  return options;
}

}  // namespace

Reply check(const Arguments& arguments)
{
  Description description;
  if (arguments.base.empty())
  {
    description = readDescription(arguments.files);
  }
  else
  {
    if (arguments.files.size() != 1)
    {
      throw InvalidArgument("found " + std::to_string(arguments.files.size()) +
                            " files with --base, expected one refinement");
    }
    description = readRefinement(arguments.files[0], readDescription(arguments.base));
  }
  const auto num_statics = static_cast<std::size_t>(
      std::count_if(description.fluents.begin(), description.fluents.end(),
                    [](const FluentDeclaration& f) { return f.kind == FluentKind::kStatic; }));
  Json json = {{"files", arguments.files},
               {"sorts", description.sorts.size()},
               {"statics", num_statics},
               {"facts", description.static_facts.size()},
               {"fluents", description.fluents.size() - num_statics},
               {"actions", description.actions.size()},
               {"axioms", description.causal_laws.size() + description.constraints.size() +
                              description.executabilities.size()},
               {"observations", description.observations.size()},
               {"defaults", description.defaults.size()}};
  if (!arguments.histories.empty())
  {
    const Reasoner reasoner = reasonerFor(arguments);
    json["records"] = reasoner.history().size();
    json["current_step"] = reasoner.currentStep();
  }
  return {json, true};
}

Reply translate(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  if (arguments.goal.empty())
  {
    return {{{"program", reasoner.translation()}}, true};
  }
  int length = arguments.length;
  bool found = true;
  if (length < 0)
  {
    const PlanResult result = reasoner.plan(arguments.goal, planOptions(arguments));
    found = result.goal_entailed || !result.plans.empty();
    length = arguments.max_horizon;
    for (const Plan& plan : result.plans)
    {
      length = std::min(length, static_cast<int>(plan.steps.size()));
    }
    length = result.goal_entailed ? 0 : length;
  }
  const std::string note = "% No plan of at most " + std::to_string(length) +
                           " steps was found, so this program has no answer set.\n";
  return {{{"program", (found ? "" : note) + reasoner.translation(arguments.goal, length)},
           {"length", length}},
          found};
}

Reply entails(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const int step = stepFor(arguments, reasoner);
  if (arguments.literal.empty())
  {
    Json literals = Json::array();
    for (const Literal& literal : reasoner.entailedAt(step))
    {
      literals.push_back(toString(literal, reasoner.description()));
    }
    return {{{"step", step}, {"literals", literals}}, true};
  }
  const Answer answer = reasoner.entails(arguments.literal, step);
  return {{{"literal", arguments.literal},
           {"step", step},
           {"answer", textOf(answer)},
           {"possible", reasoner.possible(arguments.literal, step)}},
          answer == Answer::kTrue};
}

Reply explain(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const int step = stepFor(arguments, reasoner);
  const Explanation explanation = reasoner.explain(arguments.literal, step);
  Json records = recordsJson(explanation.records, reasoner);
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    records[i]["index"] = explanation.record_indices[i];
  }
  return {{{"literal", arguments.literal},
           {"step", step},
           {"answer", textOf(reasoner.entails(arguments.literal, step))},
           {"reasons", explanation.reasons},
           {"records", std::move(records)},
           {"defaults", explanation.defaults},
           {"laws", lawsJson(explanation.laws)},
           {"proof", explanation.entailed ? proofJson(explanation.proof) : Json(nullptr)}},
          explanation.entailed};
}

Reply models(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const std::size_t limit = arguments.all ? 0 : arguments.limit;
  const std::vector<HistoryModel> found = reasoner.models(limit == 0 ? 0 : limit + 1);
  const std::size_t num_listed = limit == 0 ? found.size() : std::min(limit, found.size());
  Json models = Json::array();
  for (std::size_t i = 0; i < num_listed; ++i)
  {
    Json states = Json::array();
    for (const std::vector<Literal>& state : found[i].states)
    {
      states.push_back(Json::array());
      for (const Literal& literal : state)
      {
        states.back().push_back(toString(literal, reasoner.description()));
      }
    }
    models.push_back({{"assumed", found[i].assumed},
                      {"first_step", found[i].first_step},
                      {"states", states},
                      {"actions", found[i].actions}});
  }
  return {{{"complete", num_listed == found.size()}, {"models", models}}, true};
}

Reply diagnose(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const Diagnosis diagnosis = reasoner.diagnose();
  if (!diagnosis.consistent)
  {
    return inconsistent(Json::object(), reasoner);
  }
  Json explanations = Json::array();
  for (std::size_t i = 0; i < diagnosis.explanations.size(); ++i)
  {
    Json assumptions = Json::array();
    for (const Assumption& assumption : diagnosis.alternatives.at(i).assumptions)
    {
      assumptions.push_back({{"statement", assumption.statement},
                             {"in_words", assumption.sentence},
                             {"price", assumption.price},
                             {"defaults", assumption.defaults}});
    }
    explanations.push_back({{"statements", diagnosis.explanations[i]},
                            {"in_words", diagnosis.in_words[i]},
                            {"price", diagnosis.alternatives[i].price},
                            {"assumptions", assumptions}});
  }
  Json parts = Json::array();
  for (const ExplanationPart& part : diagnosis.parts)
  {
    parts.push_back(
        {{"price", part.price}, {"complete", part.complete}, {"explanations", Json::array()}});
    for (std::size_t i = 0; i < part.explanations.size(); ++i)
    {
      parts.back()["explanations"].push_back(
          {{"statements", part.explanations[i]}, {"in_words", part.in_words[i]}});
    }
  }
  return {{{"consistent", true},
           {"cost", diagnosis.cost},
           {"complete", diagnosis.complete},
           {"explanations", explanations},
           {"parts", parts}},
          true};
}

Reply plan(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const PlanResult result = reasoner.plan(arguments.goal, planOptions(arguments));
  Json plans = Json::array();
  for (const Plan& found : result.plans)
  {
    plans.push_back(
        {{"hypothesis", found.hypothesis}, {"cost", found.cost}, {"steps", found.steps}});
  }
  return {{{"goal", arguments.goal},
           {"first_step", reasoner.currentStep()},
           {"goal_entailed", result.goal_entailed},
           {"plans", plans},
           {"complete", result.complete},
           {"reason", result.reason},
           {"cpu_s", result.cpu_s},
           {"considered", sizeJson(result.considered)},
           {"whole", sizeJson(result.whole)},
           {"widened", result.widened}},
          result.goal_entailed || !result.plans.empty()};
}

Reply relevant(const Arguments& arguments)
{
  const Reasoner reasoner = reasonerFor(arguments);
  const RelevantPart part = reasoner.relevant(arguments.goal);
  Json records = Json::array();
  for (const Record& record : part.records)
  {
    records.push_back(recordJson(toString(record), reasoner));
  }
  return {{{"goal", arguments.goal},
           {"constants", itemsJson(part.constants)},
           {"fluents", itemsJson(part.fluents)},
           {"actions", itemsJson(part.actions)},
           {"records", records},
           {"considered", sizeJson(part.considered)},
           {"whole", sizeJson(part.whole)}},
          true};
}

Reply importSparc(const Arguments& arguments)
{
  if (arguments.files.size() != 1)
  {
    throw InvalidArgument("found " + std::to_string(arguments.files.size()) +
                          " files, expected one SPARC program");
  }
  const SparcImport imported = readSparc(arguments.files[0]);
  return {{{"description", imported.description},
           {"history", imported.history},
           {"goals", imported.goals}},
          true};
}

}  // namespace kr3::reasoner::tool
