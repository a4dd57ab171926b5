#include "input_json.hpp"

#include <chrono>
#include <limits>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/solved_model.hpp>

#include "kr3_executive/mission_recording.hpp"
#include "memory_json.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;

/// @throws InvalidArgument  the field is no whole number in [0, most]
template <typename Count>
Count countAt(const json& item, const char* field, Count most = std::numeric_limits<Count>::max())
{
  const json& value = item.at(field);
  const bool is_count =
      value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
  if (!is_count || value.get<std::uint64_t>() > most)
    throw InvalidArgument(std::string(field) + " " + value.dump() +
                          ", expected a number from 0 to " + std::to_string(most));
  return value.get<Count>();
}

json toJson(const DomainFile& file)
{
  return {{"name", file.name}, {"text", file.text}, {"hash", pomdp::contentHash(file.text)}};
}

DomainFile fileFromJson(const json& item)
{
  DomainFile file{item.at("name"), item.at("text")};
  const std::string hash = pomdp::contentHash(file.text);
  if (item.at("hash") != hash)
    throw InvalidArgument("the text of " + file.name + " has the hash " + hash + ", recorded was " +
                          item.at("hash").dump());
  return file;
}

json toJson(const refinement::ComponentMap& map)
{
  json components = json::array();
  json neighbors = json::array();
  json distances = json::array();
  for (std::size_t i = 0; i < map.size(); ++i)
  {
    const auto& component = map.components()[i];
    components.push_back({component.name, component.part_of});
    neighbors.push_back(map.neighbors(i));
    json row = json::array();
    for (std::size_t k = 0; k < map.size(); ++k)
    {
      const double distance = map.distance(i, k);
      row.push_back(distance < std::numeric_limits<double>::infinity() ? json(distance) : json());
    }
    distances.push_back(std::move(row));
  }
  return {{"components", components},
          {"neighbors", neighbors},
          {"facts", map.facts()},
          {"distances_m", distances}};
}

refinement::ComponentMap mapFromJson(const json& item)
{
  refinement::ComponentMapData data;
  for (const auto& component : item.at("components"))
    data.components.push_back({component.at(0), component.at(1)});
  item.at("neighbors").get_to(data.neighbors);
  item.at("facts").get_to(data.facts);
  for (const auto& row : item.at("distances_m"))
  {
    for (const auto& distance : row)
      data.distances_m.push_back(distance.is_null() ? std::numeric_limits<double>::infinity()
                                                    : distance.get<double>());
  }
  return refinement::ComponentMap(std::move(data));
}

json toJson(const reasoner::Record& record)
{
  return {{"kind", static_cast<int>(record.kind)},
          {"statement", record.statement},
          {"value", record.value},
          {"step", record.step},
          {"confidence", record.confidence},
          {"source", record.source}};
}

reasoner::Record recordFromJson(const json& item)
{
  const int kind = item.at("kind").get<int>();
  if (kind < 0 || kind > static_cast<int>(reasoner::RecordKind::kInitially))
    throw InvalidArgument("record kind " + std::to_string(kind));
  return {static_cast<reasoner::RecordKind>(kind),
          item.at("statement"),
          item.at("value"),
          item.at("step"),
          item.at("confidence"),
          item.at("source")};
}

json toJson(const std::vector<reasoner::Record>& records)
{
  json list = json::array();
  for (const auto& record : records)
    list.push_back(toJson(record));
  return list;
}

std::vector<reasoner::Record> recordsFromJson(const json& list)
{
  std::vector<reasoner::Record> records;
  for (const auto& item : list)
    records.push_back(recordFromJson(item));
  return records;
}

json toJson(const Limits& limits)
{
  return {{"max_hl_actions", limits.max_hl_actions},
          {"max_ll_actions", limits.max_ll_actions},
          {"max_attempts", limits.max_attempts},
          {"max_reopened", limits.max_reopened},
          {"max_rebuilds", limits.max_rebuilds},
          {"max_detours", limits.max_detours},
          {"threshold", limits.threshold}};
}

Limits limitsFromJson(const json& item)
{
  Limits limits;
  limits.max_hl_actions = countAt<std::uint32_t>(item, "max_hl_actions");
  limits.max_ll_actions = countAt<std::uint32_t>(item, "max_ll_actions");
  limits.max_attempts = countAt<std::uint32_t>(item, "max_attempts");
  limits.max_reopened = countAt<std::uint32_t>(item, "max_reopened");
  limits.max_rebuilds = countAt<std::uint32_t>(item, "max_rebuilds");
  // Recordings of before there were detours have none.
  limits.max_detours =
      item.contains("max_detours") ? countAt<std::uint32_t>(item, "max_detours") : 0;
  item.at("threshold").get_to(limits.threshold);
  return limits;
}

json toJson(const DriverConfig& config)
{
  return {{"limits", toJson(config.limits)},
          {"precision", config.budget.precision},
          {"solve_time_s", config.budget.time_s},
          {"max_backups", config.budget.max_backups},
          {"default_probability", config.default_probability},
          {"least_hypothesis_probability", config.least_hypothesis_probability},
          {"change_probability", config.change_probability},
          {"max_skill_retries", config.max_skill_retries},
          {"max_alternatives", config.max_alternatives},
          {"history_window", config.history_window},
          {"explain_facts", config.explain_facts}};
}

DriverConfig configFromJson(const json& item)
{
  DriverConfig config;
  config.limits = limitsFromJson(item.at("limits"));
  item.at("precision").get_to(config.budget.precision);
  item.at("solve_time_s").get_to(config.budget.time_s);
  config.budget.max_backups = countAt<std::uint64_t>(item, "max_backups");
  item.at("default_probability").get_to(config.default_probability);
  item.at("least_hypothesis_probability").get_to(config.least_hypothesis_probability);
  config.max_skill_retries = countAt<std::uint32_t>(item, "max_skill_retries");
  item.at("change_probability").get_to(config.change_probability);
  if (item.contains("max_alternatives"))
    config.max_alternatives = countAt<std::uint32_t>(item, "max_alternatives");
  if (item.contains("history_window"))
    config.history_window = countAt<std::uint32_t>(item, "history_window");
  item.at("explain_facts").get_to(config.explain_facts);
  return config;
}

int weightAt(const json& item, const char* field)
{
  const int weight = static_cast<int>(countAt<std::uint32_t>(item, field, 1000000));
  if (weight < 1)
    throw InvalidArgument(std::string(field) + " 0, expected at least 1");
  return weight;
}

}  // namespace

json toJson(const ReasonerSettings& settings)
{
  const reasoner::ReasonerOptions& options = settings.options;
  return {{"diagnose_exogenous", options.diagnose_exogenous},
          {"exception_weight", options.exception_weight},
          {"exogenous_weight", options.exogenous_weight},
          {"default_weights", options.default_weights},
          {"max_combinations", options.max_combinations},
          {"max_carried_explanations", options.max_carried_explanations},
          {"history_window", settings.history_window}};
}

ReasonerSettings settingsFromJson(const json& item)
{
  ReasonerSettings settings;
  reasoner::ReasonerOptions& options = settings.options;
  item.at("diagnose_exogenous").get_to(options.diagnose_exogenous);
  options.exception_weight = weightAt(item, "exception_weight");
  options.exogenous_weight = weightAt(item, "exogenous_weight");
  item.at("default_weights").get_to(options.default_weights);
  options.max_combinations = weightAt(item, "max_combinations");
  options.max_carried_explanations = weightAt(item, "max_carried_explanations");
  settings.history_window = countAt<std::uint32_t>(item, "history_window");
  return settings;
}

ReasonerSettings settingsFromText(const std::string& text, std::uint32_t history_window)
{
  try
  {
    json item = json::parse(text);
    item["history_window"] = history_window;
    item.emplace("default_weights", json::object());
    item.emplace("max_carried_explanations", reasoner::ReasonerOptions{}.max_carried_explanations);
    ReasonerSettings settings = settingsFromJson(item);
    settings.options.window = item.at("window");
    return settings;
  }
  catch (const json::exception& e)
  {
    throw InvalidArgument("parameters of the reasoner: " + std::string(e.what()));
  }
}

ErrorCode codeFromJson(const json& item)
{
  return static_cast<ErrorCode>(
      countAt<std::uint8_t>(item, "code", static_cast<std::uint8_t>(ErrorCode::kInternal)));
}

json toJson(const DomainFiles& domain)
{
  return {{"version", kRecordingVersion},
          {"domain", toJson(domain.domain)},
          {"refinement", toJson(domain.refinement)},
          {"models", toJson(domain.models)},
          {"bindings", toJson(domain.bindings)},
          {"map", toJson(domain.map)}};
}

DomainFiles domainFromJson(const json& item)
{
  const int version = item.at("version").get<int>();
  if (version != kRecordingVersion)
    throw InvalidArgument("recorded by version " + std::to_string(version) + ", expected " +
                          std::to_string(kRecordingVersion));
  return {fileFromJson(item.at("domain")), fileFromJson(item.at("refinement")),
          fileFromJson(item.at("models")), fileFromJson(item.at("bindings")),
          mapFromJson(item.at("map"))};
}

json toJson(const reasoner::PlanOptions& plan)
{
  return {{"max_horizon", plan.max_horizon},
          {"time_limit_ms", plan.time_limit.count()},
          {"preference", static_cast<int>(plan.preference)},
          {"all", plan.all},
          {"max_plans", plan.max_plans},
          {"relevant_only", plan.relevant_only},
          {"extra_share", plan.extra_share}};
}

reasoner::PlanOptions planOptionsFromJson(const json& item)
{
  reasoner::PlanOptions plan;
  item.at("max_horizon").get_to(plan.max_horizon);
  plan.time_limit = std::chrono::milliseconds(item.at("time_limit_ms").get<std::int64_t>());
  plan.preference = static_cast<reasoner::PlanPreference>(countAt<std::uint8_t>(
      item, "preference", static_cast<std::uint8_t>(reasoner::PlanPreference::kCheapest)));
  item.at("all").get_to(plan.all);
  item.at("max_plans").get_to(plan.max_plans);
  item.at("relevant_only").get_to(plan.relevant_only);
  item.at("extra_share").get_to(plan.extra_share);
  return plan;
}

json toJson(const PlanningMethod& method)
{
  const BaselineOptions& baseline = method.baseline;
  return {{"name", toString(method.method)},
          {"default_probability", baseline.default_probability},
          {"planning", toString(baseline.planning)},
          {"precision", baseline.budget.precision},
          {"solve_time_s", baseline.budget.time_s},
          {"max_backups", baseline.budget.max_backups},
          {"max_rows", baseline.max_rows},
          {"max_states", baseline.max_states},
          {"option_samples", baseline.option_samples},
          {"online_prospects", baseline.online_prospects},
          {"online_candidates", baseline.online_candidates}};
}

PlanningMethod methodFromJson(const json& item)
{
  PlanningMethod method;
  method.method = methodNamed(item.at("name"));
  BaselineOptions& baseline = method.baseline;
  item.at("default_probability").get_to(baseline.default_probability);
  baseline.planning = flatPlanningNamed(item.at("planning"));
  item.at("precision").get_to(baseline.budget.precision);
  item.at("solve_time_s").get_to(baseline.budget.time_s);
  baseline.budget.max_backups = countAt<std::uint64_t>(item, "max_backups");
  baseline.max_rows = countAt<std::size_t>(item, "max_rows");
  baseline.max_states = countAt<std::size_t>(item, "max_states");
  baseline.option_samples = countAt<std::size_t>(item, "option_samples");
  // Older recordings have neither.
  if (item.contains("online_prospects"))
    baseline.online_prospects = countAt<std::uint64_t>(item, "online_prospects");
  if (item.contains("online_candidates"))
    baseline.online_candidates = countAt<std::size_t>(item, "online_candidates");
  return method;
}

json toJson(const MissionBegun& mission)
{
  return {{"goal", mission.goal},
          {"initial", toJson(mission.initial)},
          {"limits", toJson(mission.limits)},
          {"time_limit_s", mission.time_limit_s},
          {"config", toJson(mission.config)},
          {"reasoner", mission.reasoner ? toJson(*mission.reasoner) : json()},
          {"history", toJson(mission.knowledge.history)},
          {"memory", toJson(mission.knowledge.memory)}};
}

MissionBegun missionFromJson(const json& item)
{
  std::optional<ReasonerSettings> settings;
  if (const auto found = item.find("reasoner"); found != item.end() && !found->is_null())
    settings = settingsFromJson(*found);
  return {item.at("goal"),
          recordsFromJson(item.at("initial")),
          limitsFromJson(item.at("limits")),
          item.at("time_limit_s"),
          configFromJson(item.at("config")),
          {recordsFromJson(item.at("history")),
           memoryFromJson(item.at("memory"), "a recorded mission")},
          settings};
}

json toJson(const SkillEnded& skill)
{
  json sightings = json::array();
  for (const auto& sighting : skill.result.sightings)
    sightings.push_back({{"literal", sighting.literal}, {"confidence", sighting.confidence}});
  json item = {{"action", skill.action.text},           {"code", static_cast<int>(skill.code)},
               {"outcome", skill.result.outcome},       {"observation", skill.result.observation},
               {"confidence", skill.result.confidence}, {"duration_s", skill.result.duration_s},
               {"sightings", std::move(sightings)}};
  if (skill.code != ErrorCode::kOk)
    item["message"] = skill.message;
  return item;
}

SkillEnded skillFromJson(const json& item)
{
  SkillEnded skill;
  item.at("action").get_to(skill.action.text);
  skill.code = codeFromJson(item);
  skill.message = item.value("message", std::string());
  item.at("outcome").get_to(skill.result.outcome);
  item.at("observation").get_to(skill.result.observation);
  item.at("confidence").get_to(skill.result.confidence);
  item.at("duration_s").get_to(skill.result.duration_s);
  for (const auto& sighting : item.at("sightings"))
    skill.result.sightings.push_back({sighting.at("literal"), sighting.at("confidence")});
  return skill;
}

json toJson(const FactTold& told)
{
  json item = toJson(told.record);
  item["during_mission"] = told.during_mission;
  return item;
}

FactTold toldFromJson(const json& item)
{
  return {recordFromJson(item), item.at("during_mission")};
}

json toJson(const ReportedDecision& decision)
{
  json item = {{"decision", decision.sequence},
               {"kind", decision.kind},
               {"details", decision.details},
               {"basis", decision.basis}};
  if (decision.policy)
  {
    item["policy"] = {{"lower", decision.policy->lower},
                      {"upper", decision.policy->upper},
                      {"backups", decision.policy->backups}};
  }
  if (decision.cut_short)
    item["cut_short"] = true;
  return item;
}

ReportedDecision decisionFromJson(const json& item)
{
  ReportedDecision decision{
      item.at("decision"), item.at("kind"), item.at("details"), item.at("basis"), {}};
  if (const auto found = item.find("policy"); found != item.end())
  {
    decision.policy.emplace();
    found->at("lower").get_to(decision.policy->lower);
    found->at("upper").get_to(decision.policy->upper);
    found->at("backups").get_to(decision.policy->backups);
  }
  decision.cut_short = item.value("cut_short", false);
  return decision;
}

}  // namespace kr3::executive
