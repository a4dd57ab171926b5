#include "kr3_executive/script_runner.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/scripted_world.hpp"
#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

constexpr std::uint64_t kScriptBackups = 400;

std::string withoutConfidence(reasoner::Record record)
{
  record.confidence = 1.0;  // which is not printed then
  return reasoner::toString(record);
}

/// Collects the trace and passes everything on.
class Tracer : public MissionObserver
{
public:
  explicit Tracer(MissionObserver& next) : next_(next) {}

  void onEvent(const ReportedEvent& event) override
  {
    diagnosed_ = diagnosed_ || event.kind == EventKind::kDiagnosis;
    if (event.kind == EventKind::kHighLevelAction)
      trace.high_level.push_back({event.hl_action, "none"});
    trace.num_endings += event.kind == EventKind::kDone || event.kind == EventKind::kFailed ||
                                 event.kind == EventKind::kCancelled
                             ? 1
                             : 0;
    planned_ = planned_ || event.kind == EventKind::kPlan;
    next_.onEvent(event);
  }

  void onBelief(const ReportedBelief& belief) override { next_.onBelief(belief); }

  void onSnapshot(const Snapshot& snapshot) override
  {
    high_level = snapshot.state.currentAction();
    trace.reopened = snapshot.state.reopened;
    noteWhatWasTakenBack(snapshot.history);
    if (std::exchange(diagnosed_, false))
      trace.explanations.push_back(snapshot.exceptions);
    if (std::exchange(planned_, false) && snapshot.state.plan)
    {
      trace.plans.emplace_back();
      for (const auto& together : snapshot.state.plan->plan.steps)
        trace.plans.back().insert(trace.plans.back().end(), together.begin(), together.end());
    }
    if (snapshot.state.hl_actions_done > done_ && !trace.high_level.empty())
      trace.high_level.back().result = toString(snapshot.state.last_result);
    done_ = snapshot.state.hl_actions_done;
    next_.onSnapshot(snapshot);
  }

  MissionTrace trace;
  std::string high_level;  ///< under execution

private:
  /// Records stay in their order: those that are there no more were taken back.
  void noteWhatWasTakenBack(const std::vector<reasoner::Record>& history)
  {
    std::vector<std::string> texts;
    for (const auto& record : history)
      texts.push_back(withoutConfidence(record));
    std::size_t next = 0;
    for (const auto& text : history_)
    {
      if (next < texts.size() && texts[next] == text)
        ++next;
      else
        trace.taken_back.push_back(text);
    }
    history_ = std::move(texts);
  }

  MissionObserver& next_;
  std::vector<std::string> history_;  ///< at the last snapshot
  bool diagnosed_ = false;
  bool planned_ = false;
  std::uint32_t done_ = 0;
};

/// Owns a scripted world and notes what is asked of it.
class ScriptedMission : public LowLevelExecutor
{
public:
  ScriptedMission(std::unique_ptr<ScriptedWorld> world, std::vector<std::string>& actions,
                  std::vector<std::string>& problems)
    : world_(std::move(world)), actions_(actions), problems_(problems)
  {
  }
  ~ScriptedMission() override
  {
    problems_ = world_->problems();
    for (const auto& place : world_->unused())
      problems_.push_back(place + ": this intervention never happened");
  }
  ScriptedMission(const ScriptedMission&) = delete;
  ScriptedMission& operator=(const ScriptedMission&) = delete;

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override
  {
    actions_.push_back(canonicalText(action));
    return world_->execute(action, believed, cancel);
  }

private:
  std::unique_ptr<ScriptedWorld> world_;
  std::vector<std::string>& actions_;
  std::vector<std::string>& problems_;
};

std::string truthText(bool value)
{
  return value ? "true" : "false";
}

bool anyMatches(const std::vector<std::string>& texts, const std::string& pattern)
{
  return std::any_of(texts.begin(), texts.end(),
                     [&](const auto& text) { return matchesPattern(text, pattern); });
}

void compareHighLevel(const std::vector<ExpectedAction>& expected,
                      const std::vector<MissionTrace::HighLevelAction>& found,
                      std::vector<std::string>& out)
{
  for (std::size_t i = 0; i < std::max(expected.size(), found.size()); ++i)
  {
    const std::string there =
        i < found.size() ? found[i].action + ": " + found[i].result : "nothing";
    const std::string wanted =
        i < expected.size()
            ? expected[i].action + (expected[i].result.empty() ? "" : ": " + expected[i].result)
            : "nothing";
    const bool same = i < found.size() && i < expected.size() &&
                      matchesPattern(found[i].action, expected[i].action) &&
                      (expected[i].result.empty() || expected[i].result == found[i].result);
    if (!same)
      out.push_back("high-level action " + std::to_string(i + 1) + ": " + there + "; expected " +
                    wanted);
  }
}

/// All of them, in order.
void comparePatterns(const std::string& what, const std::vector<std::string>& expected,
                     const std::vector<std::string>& found, std::vector<std::string>& out)
{
  for (std::size_t i = 0; i < std::max(expected.size(), found.size()); ++i)
  {
    const std::string there = i < found.size() ? found[i] : "nothing";
    const std::string wanted = i < expected.size() ? expected[i] : "nothing";
    if (i >= found.size() || i >= expected.size() || !matchesPattern(there, wanted))
      out.push_back(what + " " + std::to_string(i + 1) + ": " + there + "; expected " + wanted);
  }
}

void compareExplanations(const std::vector<std::vector<std::string>>& expected,
                         const std::vector<std::vector<std::string>>& found,
                         std::vector<std::string>& out)
{
  for (std::size_t i = 0; i < std::max(expected.size(), found.size()); ++i)
  {
    std::vector<std::string> there = i < found.size() ? found[i] : std::vector<std::string>{};
    std::vector<std::string> wanted =
        i < expected.size() ? expected[i] : std::vector<std::string>{};
    std::sort(there.begin(), there.end());
    std::sort(wanted.begin(), wanted.end());
    bool same = i < found.size() && i < expected.size() && there.size() == wanted.size();
    for (std::size_t k = 0; same && k < there.size(); ++k)
      same = matchesPattern(there[k], wanted[k]);
    if (!same)
    {
      out.push_back("diagnosis " + std::to_string(i + 1) + ": " +
                    (i < found.size() ? listed(there) : "none was made") + "; expected " +
                    (i < expected.size() ? listed(wanted) : "none"));
    }
  }
}

}  // namespace

std::vector<std::string> differences(const Expectations& expect, const TrialResult& result,
                                     const MissionTrace& trace)
{
  std::vector<std::string> out;
  const auto compareTruth =
      [&](const std::optional<bool>& wanted, bool found, const std::string& what) {
    if (wanted && *wanted != found)
      out.push_back(what + ": " + truthText(found) + "; expected " + truthText(*wanted) + " (" +
                    result.mission.reason + ")");
  };
  compareTruth(expect.declared, result.mission.achieved, "declared");
  compareTruth(expect.goal_true, result.goal_is_true, "true in the world");
  if (expect.reason && !matchesPattern(result.mission.reason, *expect.reason))
    out.push_back("reason: " + result.mission.reason + "; expected " + *expect.reason);
  if (expect.high_level)
  {
    auto found = trace.high_level;
    if (expect.more_high_level && found.size() > expect.high_level->size())
      found.resize(expect.high_level->size());
    compareHighLevel(*expect.high_level, found, out);
  }
  auto from = trace.low_level.begin();
  for (const auto& pattern : expect.low_level)
  {
    const auto found = std::find_if(from, trace.low_level.end(), [&](const auto& action) {
      return matchesPattern(action, pattern);
    });
    if (found == trace.low_level.end())
    {
      out.push_back("low-level actions: no " + pattern + " after " +
                    (from == trace.low_level.begin() ? std::string("the start") : *(from - 1)));
      break;
    }
    from = found + 1;
  }
  for (const auto& pattern : expect.never)
  {
    if (anyMatches(trace.low_level, pattern))
      out.push_back("low-level actions: " + pattern + ", which was never to be done");
  }
  std::vector<std::string> records;
  for (const auto& record : result.history)
    records.push_back(withoutConfidence(record));
  if (expect.history)
  {
    const auto start =
        static_cast<std::ptrdiff_t>(std::min(trace.num_initial_records, records.size()));
    comparePatterns("record", *expect.history, {records.begin() + start, records.end()}, out);
  }
  for (const auto& pattern : expect.recorded)
  {
    if (!anyMatches(records, pattern))
      out.push_back("history: no " + pattern);
  }
  for (const auto& pattern : expect.not_recorded)
  {
    if (anyMatches(records, pattern))
      out.push_back("history: " + pattern + ", which was not to be recorded");
  }
  if (expect.explanations)
    compareExplanations(*expect.explanations, trace.explanations, out);
  if (expect.reopened && *expect.reopened != trace.reopened)
    out.push_back("refutations reopened: " + std::to_string(trace.reopened) + "; expected " +
                  std::to_string(*expect.reopened));
  if (expect.taken_back)
    comparePatterns("record taken back", *expect.taken_back, trace.taken_back, out);
  if (expect.max_low_level_actions && trace.low_level.size() > *expect.max_low_level_actions)
    out.push_back("low-level actions: " + std::to_string(trace.low_level.size()) +
                  "; expected at most " + std::to_string(*expect.max_low_level_actions));
  return out;
}

ScriptRunner::ScriptRunner(std::string domain, AbstractMissionConfig config)
  : domain_(std::move(domain)), config_(std::move(config))
{
}

AbstractMissionConfig ScriptRunner::defaultConfig()
{
  AbstractMissionConfig config;
  config.driver.budget.time_s = 0.0;
  config.driver.budget.max_backups = kScriptBackups;
  return config;
}

std::string ScriptRunner::directoryOf(const std::string& path, const std::string& domain) const
{
  namespace fs = std::filesystem;
  if (!domain_.empty())
  {
    const fs::path given = fs::weakly_canonical(fs::path(domain_) / "");
    if (given.parent_path().filename() != domain)
      throw InvalidArgument(path + ": its domain is " + domain + ", not '" + domain_ + "'");
    return domain_;
  }
  const fs::path start = fs::weakly_canonical(fs::path(path)).parent_path();
  for (fs::path place = start;; place = place.parent_path())
  {
    const fs::path found = place / "domains" / domain;
    if (fs::is_directory(found))
      return found.string();
    if (place == place.parent_path())
      break;
  }
  throw InvalidArgument(path + ": no directory domains/" + domain + " in " + start.string() +
                        " or above it");
}

AbstractMissions& ScriptRunner::missionsOf(const std::string& path, const ScriptHeader& header)
{
  const std::string directory = directoryOf(path, header.domain);
  auto& missions = missions_[directory + " " + header.bindings + " " +
                             std::to_string(header.components_per_whole)];
  if (!missions)
  {
    AbstractMissionConfig config = config_;
    config.components_per_whole = header.components_per_whole;
    if (!header.bindings.empty())
      config.bindings = header.bindings;
    missions = std::make_unique<AbstractMissions>(directory, config);
  }
  return *missions;
}

ScriptReport ScriptRunner::run(const std::string& path, MissionObserver& observer)
{
  AbstractMissions& missions = missionsOf(path, readScriptHeader(path));
  return run(missions, readScript(path, missions.domain()), observer);
}

ScriptReport ScriptRunner::run(AbstractMissions& missions, MissionScript script,
                               MissionObserver& observer)
{
  ScriptReport report;
  report.script = std::move(script);
  Tracer tracer(observer);
  std::vector<std::string> problems;
  MissionSetup setup{report.script.goal,
                     report.script.truths,
                     report.script.seed,
                     report.script.initial_records.value_or(missions.scenario().initial_records),
                     report.script.limits,
                     report.script.noise};
  setup.initial_records.insert(setup.initial_records.end(), report.script.further_records.begin(),
                               report.script.further_records.end());
  tracer.trace.num_initial_records = setup.initial_records.size();
  report.result = missions.run(
      setup, tracer, [&](AbstractWorld& world, std::function<void(const reasoner::Record&)> tell) {
        return std::make_unique<ScriptedMission>(
            std::make_unique<ScriptedWorld>(
                missions.domain(), world, report.script, [&] { return tracer.high_level; },
                std::move(tell), setup.seed),
            tracer.trace.low_level, problems);
      });
  report.trace = std::move(tracer.trace);
  report.differences = differences(report.script.expect, report.result, report.trace);
  report.differences.insert(report.differences.begin(), problems.begin(), problems.end());
  if (report.trace.num_endings != 1)
    report.differences.push_back("the mission ended " + std::to_string(report.trace.num_endings) +
                                 " times");
  return report;
}

}  // namespace kr3::executive
