// What a replay needs besides inputs: parameters of the reasoner, the domain's files, counted work.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/replay.hpp"

namespace kr3::executive
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";

/// A mission that looks for the book in the wrong place first.
std::vector<RecordedInput> recorded()
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.driver.history_window = 25;
  config.components_per_whole = 3;
  AbstractMissions missions(kOffice, config);
  std::vector<RecordedInput> inputs;
  MissionRecorder recorder(
      readDomainFiles(kOffice + "/domain.kr3", kOffice + "/refinement.kr3",
                      kOffice + "/models.yaml", kOffice + "/bindings.yaml",
                      missions.domain().map()),
      config.plan, [&inputs] { return static_cast<double>(inputs.size()); },
      [&inputs](const RecordedInput& input) { inputs.push_back(input); });
  static_cast<void>(
      missions.run(missions.scenario().goal, {"loc(tb1) = aux_library"}, 1, recorder));
  return inputs;
}

class ReplayParameters : public testing::Test
{
protected:
  static void SetUpTestSuite() { inputs_ = recorded(); }

  static ReplayResult replayed(const std::vector<RecordedInput>& inputs,
                               const ReplayOptions& options = {})
  {
    return replay(readMission(inputs), options);
  }

  static std::vector<RecordedInput> inputs_;
};

std::vector<RecordedInput> ReplayParameters::inputs_;

TEST_F(ReplayParameters, AreRecorded)
{
  const RecordedMission mission = readMission(inputs_);
  ASSERT_TRUE(mission.start.reasoner.has_value());
  EXPECT_EQ(mission.start.reasoner->history_window, 25U);
  EXPECT_FALSE(mission.start.reasoner->options.diagnose_exogenous);
  EXPECT_EQ(mission.start.config.history_window, 25U);
  const ReplayResult result = replayed(inputs_);
  EXPECT_TRUE(result.isSame());
  EXPECT_TRUE(result.not_promised.empty());
}

TEST_F(ReplayParameters, OfTheReasonerDecideDiagnosesAgain)
{
  auto other = inputs_;
  alter(other, "1.reasoner.diagnose_exogenous=true");
  const ReplayResult result = replayed(other);
  ASSERT_FALSE(result.isSame());
  ASSERT_TRUE(result.firstOtherChoice()->recorded.has_value());
  EXPECT_EQ(result.firstOtherChoice()->recorded->kind, "diagnosis");
}

TEST_F(ReplayParameters, ThatNobodyToldAreNamed)
{
  auto old = inputs_;
  const std::string key = "\"reasoner\":{";
  const auto begin = old[1].data.find(key);
  ASSERT_NE(begin, std::string::npos);
  const auto close = old[1].data.find('}', old[1].data.find("history_window", begin));
  old[1].data.replace(begin, close + 1 - begin, "\"reasoner\":null");
  const ReplayResult result = replayed(old);
  ASSERT_EQ(result.not_promised.size(), 1U);
  EXPECT_NE(result.not_promised[0].find("did not tell its parameters"), std::string::npos);
}

TEST_F(ReplayParameters, OutOfRangeAreRefusedWithTheInput)
{
  auto other = inputs_;
  alter(other, "1.reasoner.exception_weight=0");
  try
  {
    static_cast<void>(readMission(other));
    FAIL() << "not refused";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("input 1 (MISSION): exception_weight"), std::string::npos)
        << e.what();
  }
}

TEST_F(ReplayParameters, ASolveThatTimeEndedInItsPreparationIsNamed)
{
  auto other = inputs_;
  const auto policy = std::find_if(other.begin(), other.end(), [](const RecordedInput& input) {
    return input.data.find("\"kind\":\"policy\"") != std::string::npos;
  });
  ASSERT_NE(policy, other.end());
  const std::string key = "\"backups\":";
  const auto begin = policy->data.find(key) + key.size();
  policy->data.replace(begin, policy->data.find_first_not_of("0123456789", begin) - begin, "0");
  policy->data.insert(1, "\"cut_short\":true,");
  const ReplayResult result = replayed(other);
  ASSERT_EQ(result.not_promised.size(), 1U);
  EXPECT_EQ(result.not_promised[0], "input " + std::to_string(policy->sequence) +
                                        ": solving was ended by wall time before its first backup");
}

TEST(SolvedPolicy, IsCutShortWhenNeitherPrecisionNorWorkEndedIt)
{
  const SolveBudget budget{0.5, 30.0, 100};
  EXPECT_FALSE((SolvedPolicy{"", 1.0, 1.4, 20}.isCutShort(budget)));
  EXPECT_FALSE((SolvedPolicy{"", 1.0, 9.0, 100}.isCutShort(budget)));
  EXPECT_TRUE((SolvedPolicy{"", 1.0, 9.0, 99}.isCutShort(budget)));
  EXPECT_TRUE((SolvedPolicy{"", 1.0, 9.0, 0}.isCutShort({0.5, 30.0, 0})));
}

TEST_F(ReplayParameters, OtherFilesAreNamedWithTheirHashes)
{
  namespace fs = std::filesystem;
  ReplayOptions options;
  options.domain = kOffice;
  EXPECT_TRUE(replayed(inputs_, options).not_promised.empty());

  const fs::path folder = fs::path(testing::TempDir()) / "kr3_replay_parameters_test";
  fs::create_directories(folder);
  for (const char* name : {"domain.kr3", "refinement.kr3", "models.yaml", "bindings.yaml"})
    fs::copy_file(fs::path(kOffice) / name, folder / name, fs::copy_options::overwrite_existing);
  std::ofstream(folder / "models.yaml", std::ios::app) << "# another file\n";
  options.domain = folder.string();
  const ReplayResult result = replayed(inputs_, options);
  fs::remove_all(folder);
  EXPECT_TRUE(result.isSame());
  ASSERT_EQ(result.not_promised.size(), 1U);
  EXPECT_NE(result.not_promised[0].find("models.yaml is not the recorded file"), std::string::npos);
}

TEST_F(ReplayParameters, FilesThatAreNotThereAreNamed)
{
  ReplayOptions options;
  options.domain = "/nonexistent";
  EXPECT_THROW(static_cast<void>(replayed(inputs_, options)), Unavailable);
}

}  // namespace
}  // namespace kr3::executive
