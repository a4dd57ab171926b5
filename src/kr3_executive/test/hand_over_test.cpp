// Missions whose low-level actions go through the bindings, with persons who hand things over.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_mission.hpp"

namespace kr3::executive
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";
const std::string kHandOver = "bindings_hand_over.yaml";

class Silent : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
};

/// Asks skill servers as the bindings say; the servers act in an abstract world. A person who is
/// asked to hand something over may not come.
class BoundWorld : public LowLevelExecutor
{
public:
  BoundWorld(AbstractWorld& world, const Bindings& bindings, std::vector<bool> persons,
             std::vector<std::string>& servers)
    : world_(world), bindings_(bindings), persons_(std::move(persons)), servers_(servers)
  {
  }

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& /*cancel*/) override
  {
    const SkillCall call = bindings_.call(action, believed);
    servers_.push_back(call.server);
    Disturbance disturbance;
    if (call.server == "skills/hand_over" && !persons_.empty())
    {
      disturbance.blocked = !persons_.front();
      persons_.erase(persons_.begin());
    }
    LowLevelResult result = world_.execute(action, disturbance);
    // What the skill would say: the outcome with these truths, and the values that it saw.
    std::vector<std::string> truths;
    std::vector<std::string> values;
    for (const auto& value : result.observation)
      (value == "true" || value == "false" ? truths : values).push_back(value);
    for (const auto& [label, tells] : bindings_.actions().at(action.symbol).outcomes)
    {
      if (tells == truths)
        result.outcome = label;
    }
    result.observation = bindings_.observation(action, result.outcome, values);
    return result;
  }

private:
  AbstractWorld& world_;
  const Bindings& bindings_;
  std::vector<bool> persons_;
  std::vector<std::string>& servers_;
};

struct Trial
{
  TrialResult result;
  std::map<std::string, int> asked;  ///< how often, by server
};

Trial run(const std::string& object, const std::vector<bool>& persons)
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 3;
  config.bindings = kHandOver;
  AbstractMissions missions(kOffice, config);
  const Bindings bindings =
      Bindings::read(kOffice + "/" + kHandOver, missions.domain().description());
  MissionSetup setup;
  setup.goal = "in_hand(rob1, " + object + ")";
  setup.truths = {"loc(" + object + ") = main_library"};
  setup.initial_records = missions.scenario().initial_records;
  setup.initial_records.push_back(
      {reasoner::RecordKind::kInitially, "loc(" + object + ") = main_library"});
  setup.noise = false;
  Silent observer;
  std::vector<std::string> servers;
  Trial trial;
  trial.result = missions.run(setup, observer, [&](AbstractWorld& world, const auto& /*tell*/) {
    return std::make_unique<BoundWorld>(world, bindings, persons, servers);
  });
  for (const auto& server : servers)
    ++trial.asked[server];
  return trial;
}

TEST(HandOver, AsksAPersonForTheSortsThatTheBindingsName)
{
  const Trial book = run("tb1", {true});
  EXPECT_TRUE(book.result.mission.achieved && book.result.goal_is_true)
      << book.result.mission.reason;
  EXPECT_EQ(book.asked.at("skills/hand_over"), 1);
  EXPECT_EQ(book.asked.count("skills/grasp"), 0U);

  const Trial printer = run("printer1", {});
  EXPECT_TRUE(printer.result.mission.achieved && printer.result.goal_is_true)
      << printer.result.mission.reason;
  EXPECT_EQ(printer.asked.at("skills/grasp"), 1);
  EXPECT_EQ(printer.asked.count("skills/hand_over"), 0U);
}

TEST(HandOver, APersonWhoDoesNotComeIsAFailedGraspAndIsAskedAgain)
{
  const Trial trial = run("tb1", {false, false, true});
  EXPECT_TRUE(trial.result.mission.achieved && trial.result.goal_is_true)
      << trial.result.mission.reason;
  EXPECT_EQ(trial.asked.at("skills/hand_over"), 3);
  int grasps = 0;
  for (const auto& record : trial.result.history)
    grasps += record.statement == "grasp(rob1, tb1)" ? 1 : 0;
  EXPECT_EQ(grasps, 1);
}

}  // namespace
}  // namespace kr3::executive
