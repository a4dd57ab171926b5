#include "trial_job.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <set>

#include <kr3_common/error.hpp>

namespace kr3::experiments
{
namespace
{

using nlohmann::json;
using reasoner::Record;
using reasoner::RecordKind;

template <typename T>
T valueOf(const json& value, const std::string& key)
{
  try
  {
    return value.get<T>();
  }
  catch (const json::exception&)
  {
    throw InvalidArgument("'" + key + "': found " + value.dump() + " of the wrong type");
  }
}

template <typename T>
T countOf(const json& value, const std::string& key)
{
  if (!value.is_number_unsigned())
    throw InvalidArgument("'" + key + "': found " + value.dump() +
                          ", expected a whole number that is not negative");
  return value.get<T>();
}

double shareOf(const json& value, const std::string& key)
{
  const double share = valueOf<double>(value, key);
  if (!(share > 0.0 && share < 1.0))
    throw InvalidArgument("'" + key + "': found " + value.dump() + ", expected a number in (0, 1)");
  return share;
}

double positiveOf(const json& value, const std::string& key)
{
  const auto number = valueOf<double>(value, key);
  if (!(number > 0.0))
    throw InvalidArgument("'" + key + "': found " + value.dump() + ", expected a number above 0");
  return number;
}

/// What is believed above it counts as known, so it is above the belief in the contrary.
double thresholdOf(const json& value)
{
  const auto number = valueOf<double>(value, "threshold");
  if (!(number > 0.5 && number < 1.0))
    throw InvalidArgument("'threshold': found " + value.dump() + ", expected a number in (0.5, 1)");
  return number;
}

using Setter = std::function<void(TrialJob&, const json&)>;

const std::map<std::string, Setter>& setters()
{
  static const std::map<std::string, Setter> kSetters{
      {"domain",
       [](TrialJob& job, const json& v) { job.domain_dir = valueOf<std::string>(v, "domain"); }},
      {"goal", [](TrialJob& job, const json& v) { job.goal = valueOf<std::string>(v, "goal"); }},
      {"method",
       [](TrialJob& job, const json& v) {
    job.config.method = executive::methodNamed(valueOf<std::string>(v, "method"));
       }},
      {"bindings",
       [](TrialJob& job, const json& v) {
    job.config.bindings = valueOf<std::string>(v, "bindings");
       }},
      {"models",
       [](TrialJob& job, const json& v) { job.config.models = valueOf<std::string>(v, "models"); }},
      {"world_models",
       [](TrialJob& job, const json& v) {
    job.config.world_models = valueOf<std::string>(v, "world_models");
       }},
      {"components_per_whole",
       [](TrialJob& job, const json& v) {
    job.config.components_per_whole = countOf<std::size_t>(v, "components_per_whole");
       }},
      {"default_probability",
       [](TrialJob& job, const json& v) {
    job.config.driver.default_probability = shareOf(v, "default_probability");
       }},
      {"precision",
       [](TrialJob& job, const json& v) {
    job.config.driver.budget.precision = positiveOf(v, "precision");
       }},
      {"max_backups",
       [](TrialJob& job, const json& v) {
    job.config.driver.budget.max_backups = countOf<std::uint64_t>(v, "max_backups");
       }},
      {"bias", [](TrialJob& job,
                  const json& v) { job.config.baseline.default_probability = shareOf(v, "bias"); }},
      {"flat_planning",
       [](TrialJob& job, const json& v) {
    job.config.baseline.planning =
        executive::flatPlanningNamed(valueOf<std::string>(v, "flat_planning"));
       }},
      {"flat_precision",
       [](TrialJob& job, const json& v) {
    job.config.baseline.budget.precision = positiveOf(v, "flat_precision");
       }},
      {"flat_backups",
       [](TrialJob& job, const json& v) {
    job.config.baseline.budget.max_backups = countOf<std::uint64_t>(v, "flat_backups");
       }},
      {"online_prospects",
       [](TrialJob& job, const json& v) {
    job.config.baseline.online_prospects = countOf<std::uint64_t>(v, "online_prospects");
       }},
      {"max_hl_actions",
       [](TrialJob& job, const json& v) {
    job.limits.max_hl_actions = countOf<std::uint32_t>(v, "max_hl_actions");
       }},
      {"max_ll_actions",
       [](TrialJob& job, const json& v) {
    job.limits.max_ll_actions = countOf<std::uint32_t>(v, "max_ll_actions");
       }},
      {"threshold", [](TrialJob& job, const json& v) { job.limits.threshold = thresholdOf(v); }},
      };
  return kSetters;
}

std::vector<Trial> trialsOf(const json& values)
{
  if (!values.is_array() || values.empty())
    throw InvalidArgument("'trials': found " + values.dump() + ", expected a list of trials");
  std::vector<Trial> trials;
  for (const json& value : values)
  {
    if (!value.is_object() || !value.contains("seed"))
      throw InvalidArgument("'trials': found " + value.dump() +
                            ", expected {\"seed\": ..., \"truths\": [...], \"initially\": [...]}");
    Trial trial;
    trial.seed = countOf<std::uint64_t>(value.at("seed"), "seed");
    if (value.contains("truths"))
      trial.truths = valueOf<std::vector<std::string>>(value.at("truths"), "truths");
    if (value.contains("initially"))
      trial.initially = valueOf<std::vector<std::string>>(value.at("initially"), "initially");
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace

TrialJob readTrialJob(const std::string& line)
{
  json value;
  try
  {
    value = json::parse(line);
  }
  catch (const json::exception& error)
  {
    throw InvalidArgument(std::string("no JSON: ") + error.what());
  }
  if (!value.is_object())
    throw InvalidArgument("found " + value.dump() + ", expected an object");
  for (const char* key : {"job", "domain", "trials"})
  {
    if (!value.contains(key))
      throw InvalidArgument(std::string("'") + key + "' is missing");
  }
  TrialJob job;
  job.config.driver.budget.time_s = 0.0;
  job.config.baseline.budget.time_s = 0.0;
  job.config.plan.time_limit = std::chrono::hours(24);  // a row must not depend on the clock
  for (const auto& [key, entry] : value.items())
  {
    if (key == "job")
      job.id = valueOf<std::string>(entry, key);
    else if (key == "trials")
      job.trials = trialsOf(entry);
    else if (const auto setter = setters().find(key); setter != setters().end())
      setter->second(job, entry);
    else
      throw InvalidArgument("unknown key '" + key + "'");
  }
  value.erase("job");
  value.erase("trials");
  value.erase("goal");
  for (const char* key : {"max_hl_actions", "max_ll_actions", "threshold"})
    value.erase(key);  // of the mission, not of what is prepared for it
  job.configuration = value.dump();
  return job;
}

std::vector<Record> initialRecords(std::vector<Record> of_scenario, const Trial& trial,
                                   const reasoner::Description& description)
{
  const auto atomOf = [&](const std::string& text) {
    return reasoner::toString(reasoner::parseGroundLiteral(text, description).atom);
  };
  std::vector<Record> records = std::move(of_scenario);
  std::set<std::string> named;
  for (const std::string& text : trial.initially)
  {
    const reasoner::Literal literal = reasoner::parseGroundLiteral(text, description);
    if (!literal.equal)
      throw InvalidArgument("'initially': found " + text + ", expected f = v, f or -f");
    const std::string atom = reasoner::toString(literal.atom);
    if (!named.insert(atom).second)
      throw InvalidArgument("'initially': found " + atom + " twice, expected one value");
    const auto about = [&](const Record& record, RecordKind kind) {
      return record.kind == kind && atomOf(record.statement) == atom;
    };
    const bool seen = std::any_of(records.begin(), records.end(), [&](const Record& record) {
      return about(record, RecordKind::kObserved);
    });
    if (seen)
      throw InvalidArgument("'initially': found " + text + ", but the scenario has observed " +
                            atom);
    records.erase(
        std::remove_if(records.begin(), records.end(),
                       [&](const Record& record) { return about(record, RecordKind::kInitially); }),
        records.end());
    const std::string value = literal.value.name;
    const bool boolean = value == "true" || value == "false";
    records.push_back(
        {RecordKind::kInitially, boolean ? atom : atom + " = " + value, value != "false"});
  }
  return records;
}

json rowOf(const TrialJob& job, const Trial& trial, const executive::TrialResult& result,
           const std::vector<std::string>& policies, std::uint64_t backups)
{
  const executive::MissionResult& mission = result.mission;
  return {{"job", job.id},
          {"seed", trial.seed},
          {"declared", mission.achieved},
          {"goal_true", result.goal_is_true},
          {"hl_actions", mission.hl_actions},
          {"ll_actions", mission.ll_actions},
          {"duration_s", mission.duration_s},
          {"reason", mission.reason},
          {"policies", policies},
          {"backups", backups}};
}

}  // namespace kr3::experiments
