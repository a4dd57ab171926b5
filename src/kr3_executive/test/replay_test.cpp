// Missions recorded in the abstract world and computed again: the same without a change, and
// different where a changed input matters.

#include "kr3_executive/replay.hpp"

#include <algorithm>
#include <sstream>
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
const std::string kWorkbench = std::string(KR3_DOMAINS_DIR) + "/workbench";

AbstractMissionConfig config()
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 3;
  return config;
}

/// Runs a mission in the abstract world and keeps its inputs.
std::vector<RecordedInput> record(const std::string& domain, const std::string& goal,
                                  const std::vector<std::string>& truths, std::uint64_t seed,
                                  const AbstractMissionConfig& with = config())
{
  AbstractMissions missions(domain, with);
  std::vector<RecordedInput> inputs;
  MissionRecorder recorder(
      readDomainFiles(domain + "/domain.kr3", domain + "/refinement.kr3", domain + "/models.yaml",
                      domain + "/bindings.yaml", missions.domain().map()),
      with.plan, [&inputs] { return 0.5 * static_cast<double>(inputs.size()); },
      [&inputs](const RecordedInput& input) { inputs.push_back(input); },
      {with.method, with.baseline});
  static_cast<void>(
      missions.run(goal.empty() ? missions.scenario().goal : goal, truths, seed, recorder));
  return inputs;
}

/// Through the text of a file, as a bag's inputs go.
std::vector<RecordedInput> written(const std::vector<RecordedInput>& inputs)
{
  std::stringstream file;
  for (const auto& input : inputs)
    file << toJsonLine(input) << "\n";
  return readInputs(file, "file");
}

ReplayResult replayed(const std::vector<RecordedInput>& inputs, const ReplayOptions& options = {})
{
  return replay(readMission(inputs), options);
}

std::vector<RecordedInput> altered(std::vector<RecordedInput> inputs, const std::string& change)
{
  alter(inputs, change);
  return inputs;
}

std::string describe(const ReplayedDecision* decision)
{
  if (decision == nullptr)
    return "no difference";
  std::string text = std::to_string(decision->sequence) + " " + toString(decision->verdict);
  for (const auto* side : {&decision->recorded, &decision->replayed})
  {
    text += side == &decision->recorded ? "\nthen " : "\nnow ";
    if (!*side)
      continue;
    text += (*side)->kind;
    for (const auto& detail : (*side)->details)
      text += " | " + detail;
    for (const auto& number : (*side)->basis)
      text += " [" + number + "]";
  }
  return text;
}

/// Number of the first input of a kind whose data contain a text.
std::uint32_t find(const std::vector<RecordedInput>& inputs, InputKind kind,
                   const std::vector<std::string>& texts)
{
  for (const auto& input : inputs)
  {
    const bool all = std::all_of(texts.begin(), texts.end(), [&](const std::string& text) {
      return input.data.find(text) != std::string::npos;
    });
    if (input.kind == kind && all)
      return input.sequence;
  }
  ADD_FAILURE() << "no such input";
  return 0;
}

struct Recorded
{
  std::string name;
  std::string domain;
  std::string goal;
  std::vector<std::string> truths;
};

class RecordedMissions : public testing::TestWithParam<Recorded>
{
};

TEST_P(RecordedMissions, AreDecidedTheSameAgain)
{
  const Recorded& what = GetParam();
  const auto inputs = written(record(what.domain, what.goal, what.truths, 1));
  const RecordedMission mission = readMission(inputs);
  EXPECT_TRUE(mission.isComplete());
  const ReplayResult result = replay(mission, {});
  EXPECT_TRUE(result.isSame()) << describe(result.firstDifference());
  EXPECT_EQ(result.end, ReplayEnd::kMissionEnded) << result.reason;
  const auto decisions = std::count_if(inputs.begin(), inputs.end(), [](const auto& input) {
    return input.kind == InputKind::kDecision;
  });
  EXPECT_EQ(result.decisions.size(), static_cast<std::size_t>(decisions));
}

INSTANTIATE_TEST_SUITE_P(
    Domains, RecordedMissions,
    testing::Values(Recorded{"MainLibrary", kOffice, "", {"loc(tb1) = main_library"}},
                    Recorded{"AuxLibrary", kOffice, "", {"loc(tb1) = aux_library"}},
                    Recorded{"Kitchen", kOffice, "", {"loc(tb1) = kitchen"}},
                    Recorded{"Psu", kWorkbench, "resolved(hum)", {"cause(hum) = psu"}},
                    Recorded{"Amplifier", kWorkbench, "resolved(hum)", {"cause(hum) = amplifier"}}),
    [](const auto& recorded) { return recorded.param.name; });

AbstractMissionConfig configOf(Method method)
{
  AbstractMissionConfig by = config();
  by.method = method;
  by.baseline.budget = {0.5, 0.0, 500};
  by.baseline.default_probability = 0.8;
  by.baseline.option_samples = 10;
  return by;
}

class RecordedMethods : public testing::TestWithParam<Method>
{
};

TEST_P(RecordedMethods, DecideTheSameAgain)
{
  const auto inputs = written(
      record(kWorkbench, "resolved(hum)", {"cause(hum) = amplifier"}, 3, configOf(GetParam())));
  const RecordedMission mission = readMission(inputs);
  EXPECT_EQ(mission.method.method, GetParam());
  EXPECT_TRUE(mission.isComplete());
  const ReplayResult result = replay(mission, {});
  EXPECT_TRUE(result.isSame()) << describe(result.firstDifference());
  EXPECT_EQ(result.end, ReplayEnd::kMissionEnded) << result.reason;
  EXPECT_GT(result.decisions.size(), 1U);
}

TEST_P(RecordedMethods, DecideOtherwiseAfterAnotherObservation)
{
  const auto inputs =
      record(kWorkbench, "resolved(hum)", {"cause(hum) = amplifier"}, 3, configOf(GetParam()));
  bool differs = false;
  for (const auto& input : inputs)
  {
    for (const char* told : {"true", "false"})
    {
      const std::string text = std::string("\"observation\":[\"") + told + "\"]";
      if (input.kind != InputKind::kSkillResult || input.data.find(text) == std::string::npos)
        continue;
      const std::string other = told == std::string("true") ? "false" : "true";
      const ReplayResult result =
          replayed(altered(inputs, std::to_string(input.sequence) + ".observation=" + other));
      differs = differs || result.firstOtherChoice() != nullptr;
    }
  }
  EXPECT_TRUE(differs);
}

INSTANTIATE_TEST_SUITE_P(Methods, RecordedMethods, testing::ValuesIn(allMethods()),
                         [](const auto& method) { return toString(method.param); });

TEST(Replay, RefusesAnUnknownMethod)
{
  auto inputs = record(kWorkbench, "resolved(hum)", {"cause(hum) = psu"}, 3);
  try
  {
    static_cast<void>(readMission(altered(inputs, "1.method.name=pomdp3")));
    FAIL() << "it was read";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("input 1 (MISSION): method 'pomdp3'"), std::string::npos)
        << e.what();
  }
}

/// Decisions up to an input are the same; the first other choice comes after it.
void expectDivergenceAfter(const ReplayResult& result, std::uint32_t sequence)
{
  const ReplayedDecision* difference = result.firstDifference();
  const ReplayedDecision* choice = result.firstOtherChoice();
  ASSERT_NE(difference, nullptr);
  ASSERT_NE(choice, nullptr) << describe(difference);
  EXPECT_GT(difference->sequence, sequence) << describe(difference);
  EXPECT_GE(choice->sequence, difference->sequence);
}

TEST(Replay, AFoundObjectThatIsNotSeenIsSearchedOn)
{
  const auto inputs = record(kOffice, "", {"loc(tb1) = main_library"}, 1);
  const std::uint32_t seen =
      find(inputs, InputKind::kSkillResult, {"\"search(", "\"observation\":[\"true\"]"});
  const ReplayResult result =
      replayed(altered(inputs, std::to_string(seen) + ".observation=false"));
  expectDivergenceAfter(result, seen);
  const ReplayedDecision& choice = *result.firstOtherChoice();
  ASSERT_TRUE(choice.recorded && choice.replayed) << describe(&choice);
  EXPECT_EQ(choice.replayed->kind, "low_level_action") << describe(&choice);
  EXPECT_NE(choice.recorded->details, choice.replayed->details);
  const std::string& now = choice.replayed->details.front();
  EXPECT_TRUE(now.rfind("search(", 0) == 0 || now.rfind("move(", 0) == 0) << now;
  EXPECT_EQ(result.end, ReplayEnd::kOtherAction);
  EXPECT_NE(result.reason.find(now), std::string::npos) << result.reason;
}

TEST(Replay, AModuleThatTestsOtherwiseIsJudgedOtherwise)
{
  const auto inputs = record(kWorkbench, "resolved(hum)", {"cause(hum) = amplifier"}, 3);
  for (const auto& input : inputs)
  {
    if (input.kind != InputKind::kSkillResult)
      continue;
    const bool positive = input.data.find("\"observation\":[\"true\"]") != std::string::npos;
    const bool negative = input.data.find("\"observation\":[\"false\"]") != std::string::npos;
    if (!positive && !negative)
      continue;
    const std::string change =
        std::to_string(input.sequence) + ".observation=" + (positive ? "false" : "true");
    const ReplayResult result = replayed(altered(inputs, change));
    expectDivergenceAfter(result, input.sequence);
    return;
  }
  FAIL() << "nothing was tested";
}

TEST(Replay, WhatDoesNotMatterChangesNothing)
{
  const auto inputs = record(kOffice, "", {"loc(tb1) = aux_library"}, 1);
  const std::uint32_t skill = find(inputs, InputKind::kSkillResult, {"\"move("});
  const std::string number = std::to_string(skill);
  EXPECT_TRUE(replayed(altered(inputs, number + ".duration_s=99.5")).isSame());
  EXPECT_TRUE(replayed(altered(inputs, number + ".outcome=strolled")).isSame());
}

TEST(Replay, AFactThatIsKnownAtTheStartChangesThePlan)
{
  const auto inputs = record(kOffice, "", {"loc(tb1) = aux_library"}, 1);
  const ReplayResult result = replayed(altered(
      inputs, R"(1.history=[{"kind":0,"statement":"loc(rob1) = office","value":true,"step":0,)"
              R"("confidence":1.0,"source":"robot"},{"kind":0,"statement":"loc(tb1) = kitchen",)"
              R"("value":true,"step":0,"confidence":1.0,"source":"person"}])"));
  const ReplayedDecision* choice = result.firstOtherChoice();
  ASSERT_NE(choice, nullptr);
  const auto plan = std::find_if(
      result.decisions.begin(), result.decisions.end(),
      [](const auto& decision) { return decision.replayed && decision.replayed->kind == "plans"; });
  ASSERT_NE(plan, result.decisions.end());
  EXPECT_NE(plan->replayed->details.front().find("move(rob1, kitchen)"), std::string::npos)
      << describe(&*plan);
}

TEST(Replay, GoesOnInTheAbstractWorldOnRequest)
{
  const auto inputs = record(kOffice, "", {"loc(tb1) = main_library"}, 1);
  const std::uint32_t seen =
      find(inputs, InputKind::kSkillResult, {"\"search(", "\"observation\":[\"true\"]"});
  ReplayOptions options;
  options.continue_with_seed = 1;
  options.truths = {"loc(tb1) = aux_library"};
  const ReplayResult result =
      replayed(altered(inputs, std::to_string(seen) + ".observation=false"), options);
  expectDivergenceAfter(result, seen);
  EXPECT_EQ(result.end, ReplayEnd::kMissionEnded) << result.reason;
  ASSERT_TRUE(result.decisions.back().replayed);
  EXPECT_EQ(result.decisions.back().replayed->kind, "finish");
  EXPECT_EQ(result.decisions.back().replayed->details.front(), "achieved");
}

TEST(Replay, SolvesWithTheRecordedWorkWhatTimeEnded)
{
  // As if time had ended each solve after at most 7 backups.
  AbstractMissionConfig few = config();
  few.driver.budget = {1e-6, 0.0, 7};
  auto inputs = record(kOffice, "", {"loc(tb1) = main_library"}, 1, few);
  static_cast<void>(find(inputs, InputKind::kDecision, {"\"backups\":7"}));
  inputs = altered(altered(inputs, "1.config.solve_time_s=5"), "1.config.max_backups=0");
  const ReplayResult result = replayed(inputs);
  EXPECT_TRUE(result.isSame()) << describe(result.firstDifference());
}

TEST(Replay, EndsWhereTheRecordingEnds)
{
  auto inputs = record(kOffice, "", {"loc(tb1) = main_library"}, 1);
  inputs.resize(inputs.size() / 2);
  const RecordedMission mission = readMission(inputs);
  EXPECT_FALSE(mission.isComplete());
  const ReplayResult result = replay(mission, {});
  EXPECT_EQ(result.end, ReplayEnd::kRecordingEnded);
  EXPECT_TRUE(result.isSame()) << describe(result.firstDifference());
}

// ---- What cannot be replayed ------------------------------------------------------------------

/// The message of an InvalidArgument.
template <typename Call>
std::string refusal(Call call)
{
  try
  {
    call();
  }
  catch (const InvalidArgument& error)
  {
    return error.what();
  }
  return "not refused";
}

class UnusableRecording : public testing::Test
{
protected:
  static void SetUpTestSuite() { inputs_ = record(kWorkbench, "resolved(hum)", {}, 1); }

  static std::string refusalOf(const std::vector<RecordedInput>& inputs)
  {
    return refusal([&] { static_cast<void>(replayed(inputs)); });
  }

  static std::vector<RecordedInput> inputs_;
};

std::vector<RecordedInput> UnusableRecording::inputs_;

TEST_F(UnusableRecording, NamesAGap)
{
  auto inputs = inputs_;
  inputs.erase(inputs.begin() + 4);
  EXPECT_NE(refusalOf(inputs).find("expected input 4; inputs are missing"), std::string::npos)
      << refusalOf(inputs);
}

TEST_F(UnusableRecording, NamesAMissingStart)
{
  const std::vector<RecordedInput> rest(inputs_.begin() + 3, inputs_.end());
  EXPECT_NE(refusal([&] { static_cast<void>(splitMissions(rest)); }).find("middle of a mission"),
            std::string::npos);
  EXPECT_NE(refusal([] { static_cast<void>(splitMissions({})); }).find("no inputs"),
            std::string::npos);
  const std::vector<RecordedInput> start(inputs_.begin(), inputs_.begin() + 1);
  EXPECT_NE(refusalOf(start).find("no MISSION"), std::string::npos) << refusalOf(start);
}

TEST_F(UnusableRecording, NamesAnotherVersion)
{
  const auto text = refusalOf(altered(inputs_, "0.version=99"));
  EXPECT_NE(text.find("input 0 (DOMAIN): recorded by version 99"), std::string::npos) << text;
}

TEST_F(UnusableRecording, NamesAChangedText)
{
  const auto text = refusalOf(altered(inputs_, "0.domain.text=sorts"));
  EXPECT_NE(text.find("the text of domain.kr3 has the hash"), std::string::npos) << text;
}

TEST_F(UnusableRecording, NamesAMissingFieldAndAWrongType)
{
  auto inputs = inputs_;
  inputs[1].data = "{}";
  EXPECT_NE(refusalOf(inputs).find("input 1 (MISSION)"), std::string::npos) << refusalOf(inputs);
  inputs = altered(inputs_, R"(1.history=[{"kind":17}])");
  EXPECT_NE(refusalOf(inputs).find("record kind 17"), std::string::npos) << refusalOf(inputs);
  const std::string negative = refusalOf(altered(inputs_, "1.limits.max_ll_actions=-1"));
  EXPECT_NE(negative.find("max_ll_actions -1, expected"), std::string::npos) << negative;
  inputs = altered(inputs_, "1.goal=flies(pig)");
  EXPECT_NE(refusalOf(inputs).find("flies"), std::string::npos) << refusalOf(inputs);
}

TEST_F(UnusableRecording, NamesTheLineOfTruncatedJson)
{
  std::string text = toJsonLine(inputs_[0]) + "\n" + toJsonLine(inputs_[1]);
  std::istringstream file(text.substr(0, text.size() - 20));
  const std::string why = refusal([&] { static_cast<void>(readInputs(file, "some.jsonl")); });
  EXPECT_NE(why.find("some.jsonl:2: "), std::string::npos) << why;
}

TEST_F(UnusableRecording, NamesAChangeThatFitsNothing)
{
  for (const char* change : {"nonsense", "4", "x.observation=1", "99999.observation=true",
                             "1.nothing=3", "1.limits.threshold=high", "=", "."})
  {
    const std::string why = refusal([&] { static_cast<void>(altered(inputs_, change)); });
    EXPECT_NE(why, "not refused") << change;
  }
}

}  // namespace
}  // namespace kr3::executive
