// What holds of every mission, whatever happens: drawn interventions in two domains.
// KR3_FUZZ_MISSIONS and KR3_FUZZ_SEED run more of them, or others; KR3_FUZZ_REPORT=1 prints a line
// for each mission, 2 all that happens.

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/script_runner.hpp"
#include "kr3_executive/scripted_world.hpp"

namespace kr3::executive
{
namespace
{

std::uint64_t fromEnvironment(const char* name, std::uint64_t fallback)
{
  const char* text = std::getenv(name);
  return text == nullptr ? fallback : std::strtoull(text, nullptr, 10);
}

/// What may go wrong in a domain.
struct Playground
{
  std::string domain;
  std::vector<std::string> goals;
  std::string target;  ///< the fluent that the goals are about
  std::vector<std::string> wholes;
  std::vector<reasoner::Record> known;
  /// Actions with an outcome that fails.
  std::vector<std::pair<std::string, std::string>> failures;
  std::vector<std::string> blocked;  ///< patterns of actions that may be prevented
  std::string looks;                 ///< pattern of the actions that observe the target
  /// Literals that somebody may make true while a condition holds; and what is lost by the way.
  std::vector<std::pair<std::string, std::string>> moves;
};

Playground office()
{
  using reasoner::RecordKind;
  Playground play;
  play.domain = "office";
  play.goals = {"loc(tb1) = study_corner and not in_hand(rob1, tb1)", "in_hand(rob1, tb1)",
                "loc(tb1) = kitchen"};
  play.target = "loc(tb1)";
  play.wholes = {"office", "main_library", "aux_library", "kitchen", "study_corner", "corridor"};
  play.failures = {{"grasp(*)", "failed"}, {"move(*)", "slipped"}};
  play.blocked = {"move(*)", "move(rob1, study_corner_*)", "move(rob1, main_library_*)"};
  play.looks = "search(*)";
  play.moves = {{"loc(tb1) = kitchen", "-in_hand(rob1, tb1)"},
                {"loc(tb1) = main_library", "-in_hand(rob1, tb1)"},
                {"loc(rob1) = corridor", "-in_hand(rob1, tb2)"},
                {"-in_hand(rob1, tb1)", "in_hand(rob1, tb1)"}};
  return play;
}

Playground workbench()
{
  using reasoner::RecordKind;
  Playground play;
  play.domain = "workbench";
  play.goals = {"resolved(hum)", "resolved(hum) and not opened(psu)"};
  play.target = "cause(hum)";
  play.wholes = {"psu", "amplifier", "tuner", "display"};
  for (const char* statement :
       {"resolved(hum)", "opened(psu)", "opened(amplifier)", "opened(tuner)", "opened(display)"})
    play.known.push_back({RecordKind::kInitially, statement, false});
  play.failures = {{"unscrew(*)", "stuck"}, {"replace(*)", "dead_part"}};
  play.blocked = {"unscrew(*)", "close(*)"};
  play.looks = "probe(*)";
  play.moves = {{"cause(hum) = mixer", "-resolved(hum)"}, {"-opened(rectifier)", "-resolved(hum)"}};
  return play;
}

/// A script with drawn interventions.
class Drawer
{
public:
  Drawer(const Playground& play, const refinement::LowLevelDomain& domain, std::uint64_t seed)
    : play_(play), domain_(domain), random_(seed)
  {
  }

  /// @param honest  nothing that makes the robot's knowledge wrong without its noticing
  MissionScript script(bool honest)
  {
    MissionScript script;
    script.goal = any(play_.goals);
    script.seed = random_();
    script.truths = {play_.target + " = " + any(play_.wholes)};
    script.limits.max_hl_actions = 25;
    const std::size_t count = below(4);
    for (std::size_t i = 0; i < count; ++i)
      script.interventions.push_back(honest || below(2) == 0 ? mishap() : deceit());
    return script;
  }

private:
  std::size_t below(std::size_t count)
  {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }

  template <typename Items>
  const typename Items::value_type& any(const Items& items)
  {
    return items[below(items.size())];
  }

  Intervention empty(const std::string& place)
  {
    Intervention intervention;
    intervention.place = place;
    intervention.when.occurrence = static_cast<std::uint32_t>(1 + below(3));
    return intervention;
  }

  Intervention mishap()
  {
    // Failures in a row are evidence that the target is not there, and rightly believed to be.
    switch (failed_ ? 1 + below(2) : below(3))
    {
      case 0:
      {
        failed_ = true;
        const auto& [action, outcome] = any(play_.failures);
        Intervention failure = empty(outcome + " " + action);
        failure.when.action = action;
        failure.force.outcome = outcome;
        return failure;
      }
      case 1:
      {
        Intervention blocked = empty("blocked");
        blocked.when.action = any(play_.blocked);
        blocked.when.times = static_cast<std::uint32_t>(below(4));  // 0: for good
        blocked.force.blocked = true;
        return blocked;
      }
      default:
      {
        Intervention silent = empty("unavailable");
        silent.when.times = static_cast<std::uint32_t>(1 + below(2));
        silent.force.unavailable = true;
        return silent;
      }
    }
  }

  Intervention deceit()
  {
    const std::string value = any(play_.wholes);
    switch (below(4))
    {
      case 0:
      {
        Intervention told = empty("told " + value);
        reasoner::Record record;
        record.statement = play_.target + " = " + value;
        record.confidence = below(2) == 0 ? 0.6 : 0.95;
        record.source = "person";
        told.before.tell = {record};
        return told;
      }
      case 1:
      {
        Intervention seen = empty("seen " + value);
        seen.sightings = {{play_.target + " = " + any(domain_.components(value)), 0.9}};
        return seen;
      }
      case 2:
      {
        Intervention lie = empty("lie");
        lie.when.action = play_.looks;
        lie.when.times = static_cast<std::uint32_t>(1 + below(3));
        lie.force.observation = {below(2) == 0 ? "true" : "false"};
        return lie;
      }
      default:
      {
        const auto& [literal, condition] = any(play_.moves);
        Intervention moved = empty("moved " + literal);
        moved.when.conditions = {reasoner::parseGroundLiteral(condition, domain_.description())};
        moved.before.set = {change(literal)};
        return moved;
      }
    }
  }

  WorldChange change(const std::string& text)
  {
    if (text.front() == '-')
      return {text.substr(1), {"false"}};
    const auto equals = text.find(" = ");
    return {text.substr(0, equals), domain_.components(text.substr(equals + 3))};
  }

  const Playground& play_;
  const refinement::LowLevelDomain& domain_;
  std::mt19937_64 random_;
  bool failed_ = false;  // an outcome was made to fail
};

/// Watches a mission for what must never happen.
class Witness : public MissionObserver
{
public:
  explicit Witness(const refinement::LowLevelDomain& domain) : domain_(domain) {}

  void onEvent(const ReportedEvent& event) override
  {
    if (fromEnvironment("KR3_FUZZ_REPORT", 0) > 1)
      std::cout << std::setw(9) << toString(event.kind) << "  " << event.narration.text << "\n";
    if (event.kind == EventKind::kLowLevelAction &&
        event.narration.text.find("): impossible") != std::string::npos)
      ++impossible;
    endings += event.kind == EventKind::kDone || event.kind == EventKind::kFailed ||
                       event.kind == EventKind::kCancelled
                   ? 1
                   : 0;
    planned_ = planned_ || event.kind == EventKind::kPlan;
  }
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& snapshot) override
  {
    high_level = snapshot.state.currentAction();
    compareWithWorld(snapshot.history);
    if (!std::exchange(planned_, false) || !snapshot.state.plan)
      return;
    std::string key;
    for (const auto& record : snapshot.history)
      key += reasoner::toString(record) + "\n";
    for (const auto& literal : snapshot.state.plan->plan.hypothesis)
      key += literal + "\n";
    for (const auto& together : snapshot.state.plan->plan.steps)
      key += together.front() + "\n";
    most_repeated = std::max(most_repeated, ++plans_[key]);
  }

  AbstractWorld* world = nullptr;
  std::string high_level;
  std::vector<std::string> false_records;  ///< observations that were false when they were recorded
  std::size_t endings = 0;
  std::size_t impossible = 0;       ///< low-level actions that could not be done
  std::uint32_t most_repeated = 0;  ///< one plan under one hypothesis with one history

private:
  void compareWithWorld(const std::vector<reasoner::Record>& history)
  {
    for (; seen_ < history.size(); ++seen_)
    {
      const auto& record = history[seen_];
      if (record.kind != reasoner::RecordKind::kObserved || world == nullptr)
        continue;
      const auto formula = reasoner::parseGoal(record.statement, domain_.highLevel());
      if (world->holds(formula) != record.value)
        false_records.push_back(reasoner::toString(record));
    }
    seen_ = history.size();
  }

  const refinement::LowLevelDomain& domain_;
  bool planned_ = false;
  std::size_t seen_ = 0;
  std::map<std::string, std::uint32_t> plans_;
};

struct Case
{
  const char* name;
  Playground (*playground)();
  bool honest;
};

class MissionFuzz : public testing::TestWithParam<Case>
{
};

TEST_P(MissionFuzz, KeepsWhatHoldsOfEveryMission)
{
  const Playground play = GetParam().playground();
  const bool honest = GetParam().honest;
  AbstractMissionConfig config = ScriptRunner::defaultConfig();
  config.components_per_whole = 3;
  AbstractMissions missions(std::string(KR3_DOMAINS_DIR) + "/" + play.domain, config);
  const std::uint64_t count = fromEnvironment("KR3_FUZZ_MISSIONS", 12);
  const std::uint64_t first = fromEnvironment("KR3_FUZZ_SEED", 1);
  for (std::uint64_t seed = first; seed < first + count; ++seed)
  {
    Drawer drawer(play, missions.domain(), seed);
    const MissionScript script = drawer.script(honest);
    std::string drawn =
        "seed " + std::to_string(seed) + ", " + script.goal + ", " + script.truths.front();
    for (const auto& intervention : script.interventions)
      drawn += "; " + intervention.place + " from " + std::to_string(intervention.when.occurrence);
    SCOPED_TRACE(drawn);

    Witness witness(missions.domain());
    MissionSetup setup;
    setup.goal = script.goal;
    setup.truths = script.truths;
    setup.seed = script.seed;
    setup.noise = false;
    setup.limits = script.limits;
    setup.initial_records = missions.scenario().initial_records;
    setup.initial_records.insert(setup.initial_records.end(), play.known.begin(), play.known.end());
    const TrialResult result =
        missions.run(setup, witness,
                     [&](AbstractWorld& world, std::function<void(const reasoner::Record&)> tell) {
      witness.world = &world;
      return std::make_unique<ScriptedWorld>(
          missions.domain(), world, script, [&] { return witness.high_level; }, std::move(tell),
          script.seed);
        });

    if (fromEnvironment("KR3_FUZZ_REPORT", 0) > 0)
    {
      std::cout << (result.mission.achieved ? "declared" : "ended") << " and "
                << (result.goal_is_true ? "true" : "not true") << ", " << result.mission.hl_actions
                << " high-level, " << result.mission.ll_actions << " low-level actions, "
                << witness.impossible << " impossible: " << drawn << ": " << result.mission.reason
                << "\n";
    }

    EXPECT_EQ(witness.endings, 1U);
    EXPECT_TRUE(result.mission.code == ErrorCode::kOk ||
                result.mission.code == ErrorCode::kUnavailable)
        << result.mission.reason;
    EXPECT_FALSE(result.mission.reason.empty());
    EXPECT_LE(result.mission.hl_actions, script.limits.max_hl_actions);
    EXPECT_LE(witness.most_repeated, script.limits.max_attempts);
    InProcessReasoner reasoner(missions.domain().highLevel(), {});
    reasoner.setHistory(result.history);
    if (!reasoner.diagnose().consistent)
    {
      EXPECT_FALSE(result.mission.achieved);
      EXPECT_NE(result.mission.reason.find("inconsistent"), std::string::npos)
          << result.mission.reason;
    }
    if (honest)
    {
      EXPECT_EQ(witness.false_records, std::vector<std::string>{});
      EXPECT_TRUE(result.goal_is_true || !result.mission.achieved);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Domains, MissionFuzz,
                         testing::Values(Case{"OfficeMishaps", office, true},
                                         Case{"OfficeDeceit", office, false},
                                         Case{"WorkbenchMishaps", workbench, true},
                                         Case{"WorkbenchDeceit", workbench, false}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace kr3::executive
