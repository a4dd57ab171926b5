// `It never repeats a refuted plan for ever`: laws of the transition function under any answers,
// and of whole missions under interventions. KR3_FUZZ_MISSIONS=N runs N drawn missions.

#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_executive/mission.hpp"
#include "kr3_executive/script_runner.hpp"

namespace kr3::executive
{
namespace
{

/// Answers whatever the transition function asks for, at random.
class AnyAnswers
{
public:
  explicit AnyAnswers(std::uint64_t seed) : random_(seed)
  {
    limits_.max_hl_actions = 12;
    limits_.max_ll_actions = 4;
    limits_.max_attempts = 2;
    limits_.max_reopened = 2;
    limits_.max_rebuilds = 2;
    limits_.max_detours = 2;
  }

  /// Decisions until the mission ends.
  std::size_t run()
  {
    take(step(State{}, GoalGiven{"goal", limits_, {}, 0}));
    std::size_t decisions = 0;
    std::uint32_t told = 0;
    while (state_.phase != Phase::kFinished && decisions < 5000)
    {
      ++decisions;
      const bool tells = told < 3 && below(20) == 0;
      told += tells ? 1 : 0;
      const Event event = tells ? Event{Told{{}}} : answer();
      before_ = state_;
      Transition transition = step(state_, event);
      // A told fact that has to wait leaves the pending decision as it is.
      if (std::holds_alternative<Wait>(transition.decision))
        continue;
      check(transition, event);
      take(std::move(transition));
    }
    return decisions;
  }

  std::vector<std::string> violations;

private:
  std::size_t below(std::size_t count) { return random_() % count; }

  std::string situation() { return below(2) == 0 ? "here" : "there"; }

  CostedPlan plan()
  {
    CostedPlan plan;
    plan.plan.hypothesis = {below(2) == 0 ? "loc(book) = hall" : "loc(book) = attic"};
    const std::size_t length = 1 + below(3);
    for (std::size_t i = 0; i < length; ++i)
      plan.plan.steps.push_back({"act" + std::to_string(below(2))});
    plan.cost_s = static_cast<double>(below(100));
    plan.situation = situation();
    plan.detour = below(4) == 0;
    return plan;
  }

  Assessment assessment()
  {
    Assessment result;
    result.achieved = below(3) == 0 ? 0.95 : 0.2;
    result.effects = {"done"};
    result.refutations = {{"loc(book) = hall", below(3) == 0 ? 0.95 : 0.3}};
    result.attempted = below(2) == 0;
    if (below(8) == 0)
      result.changed = {"elsewhere"};
    return result;
  }

  Event answer()
  {
    if (std::holds_alternative<RequestPlan>(pending_))
    {
      PlanReady ready;
      for (std::size_t i = below(4); i > 0; --i)
        ready.plans.push_back(plan());
      return ready;
    }
    if (std::holds_alternative<RequestPolicy>(pending_))
    {
      // The situation is that of the plan when it is the plan's first action.
      const std::string where = state_.plan_index == 0 ? state_.plan->situation : situation();
      if (below(6) == 0)
        return ActionImpossible{"impossible", where};
      return PolicyReady{assessment(), where};
    }
    if (std::holds_alternative<ExecutePolicyAction>(pending_))
    {
      switch (below(6))
      {
        case 0:
          return PolicyFinished{assessment()};
        case 1:
          return TaskLost{"odd", assessment()};
        default:
          return ActionExecuted{"act", assessment()};
      }
    }
    if (std::holds_alternative<AddRecords>(pending_))
      return RecordsAdded{state_.step + 1, below(3) == 0};
    if (std::holds_alternative<RequestDiagnosis>(pending_))
      return DiagnosisReady{below(6) != 0};
    return RefutationReopened{below(2) == 0};
  }

  /// Counts attempts in vain by itself, and checks that none is begun too often.
  void check(const Transition& transition, const Event& event)
  {
    const State& next = transition.state;
    if (std::holds_alternative<RefutationReopened>(event))
      in_vain_.clear();
    if (!before_.currentAction().empty())
    {
      const std::string key =
          attemptKey(before_.currentAction(), before_.plan->plan.hypothesis,
                     before_.phase == Phase::kPreparing ? next.situation : before_.situation);
      const bool ended = next.hl_actions_done > before_.hl_actions_done;
      if (ended && next.last_result != ActionResult::kAchieved &&
          !std::holds_alternative<Told>(event))
        ++in_vain_[key];
    }
    if (std::holds_alternative<PlanReady>(event) &&
        std::holds_alternative<RequestPolicy>(transition.decision) && next.plan_index == 0)
    {
      const std::string key =
          attemptKey(next.currentAction(), next.plan->plan.hypothesis, next.plan->situation);
      if (in_vain_[key] >= limits_.max_attempts)
        violations.push_back(key + " begun after " + std::to_string(in_vain_[key]) + " failures");
    }
  }

  void take(Transition transition)
  {
    state_ = std::move(transition.state);
    pending_ = std::move(transition.decision);
  }

  std::mt19937_64 random_;
  Limits limits_;
  State state_;
  State before_;
  Decision pending_;
  std::map<std::string, std::uint32_t> in_vain_;
};

TEST(Repetition, AnyAnswersEndTheMissionAndNothingIsTriedMoreOftenThanAllowed)
{
  // 12 actions of at most 4 + 2 low-level steps, each with planning, records, diagnosis.
  const std::size_t most = 12 * (4 + 2 * 2 + 6) + 100;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed)
  {
    AnyAnswers mission(seed);
    EXPECT_LE(mission.run(), most) << "seed " << seed;
    ASSERT_TRUE(mission.violations.empty()) << "seed " << seed << ": " << mission.violations[0];
  }
}

class Silent : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
};

Intervention moved(const std::string& action, const std::vector<std::string>& places,
                   std::uint32_t occurrence, std::uint32_t times)
{
  Intervention intervention;
  intervention.when.action = action;
  intervention.when.occurrence = occurrence;
  intervention.when.times = times;
  intervention.before.set = {{"loc(tb1)", places}};
  intervention.place = "drawn";
  return intervention;
}

Intervention blocked(const std::string& action, std::uint32_t occurrence, std::uint32_t times)
{
  Intervention intervention;
  intervention.when.action = action;
  intervention.when.occurrence = occurrence;
  intervention.when.times = times;
  intervention.force.blocked = true;
  intervention.force.outcome = "unreachable";
  intervention.place = "drawn";
  return intervention;
}

TEST(Repetition, APlanIsChosenABoundedNumberOfTimesWhateverHappens)
{
  AbstractMissions missions(std::string(KR3_DOMAINS_DIR) + "/office", [] {
    AbstractMissionConfig config = ScriptRunner::defaultConfig();
    config.components_per_whole = 2;
    return config;
  }());
  const std::vector<std::string> places{"office_c0", "main_library_c1", "aux_library_c0",
                                        "kitchen_c1", "corridor_c0"};
  const char* wanted = std::getenv("KR3_FUZZ_MISSIONS");
  const std::uint64_t count = wanted == nullptr ? 4 : std::strtoull(wanted, nullptr, 10);
  Silent silent;
  for (std::uint64_t seed = 1; seed <= count; ++seed)
  {
    std::mt19937_64 random(seed);
    MissionScript script;
    script.goal = "in_hand(rob1, tb1)";
    script.seed = seed;
    script.truths = {"loc(tb1) = " + places[random() % places.size()]};
    script.limits.max_hl_actions = 25;
    script.interventions.push_back(moved("search(*)", places,
                                         static_cast<std::uint32_t>(1 + random() % 4),
                                         static_cast<std::uint32_t>(random() % 3)));
    if (random() % 2 == 0)
      script.interventions.push_back(
          blocked("move(rob1, main_library_*)", 1, static_cast<std::uint32_t>(random() % 3)));
    const ScriptReport report = ScriptRunner::run(missions, script, silent);
    EXPECT_EQ(report.trace.num_endings, 1U) << "seed " << seed;
    std::map<std::vector<std::string>, std::size_t> chosen;
    for (const auto& plan : report.trace.plans)
      ++chosen[plan];
    // A plan is chosen again after a refuted one at most as often as its first action may fail, for
    // each refutation taken back once more; each detour may add one.
    const Limits& limits = script.limits;
    const std::size_t most =
        limits.max_attempts * (limits.max_reopened + 1) + limits.max_detours + 1;
    for (const auto& [plan, times] : chosen)
      EXPECT_LE(times, most) << "seed " << seed << ": " << plan.front();
  }
}

}  // namespace
}  // namespace kr3::executive
