// A robot whose models are not those of the world it acts in.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_mission.hpp"

namespace kr3::executive
{
namespace
{

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::uint64_t kTrials = 40;

class Quiet : public MissionObserver
{
public:
  [[nodiscard]] Interest interest() const override { return {false, false, false}; }
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
};

/// The office with further models files, in a directory of the test's own.
class WorldModels : public testing::Test
{
protected:
  void SetUp() override
  {
    directory_ = fs::path(testing::TempDir()) / "world_models_test";
    fs::remove_all(directory_);
    fs::create_directories(directory_);
    for (const char* name :
         {"domain.kr3", "refinement.kr3", "models.yaml", "bindings.yaml", "scenario.yaml"})
      fs::copy_file(fs::path(KR3_DOMAINS_DIR) / "office" / name, directory_ / name);
  }
  void TearDown() override { fs::remove_all(directory_); }

  /// Writes a copy of models.yaml with one text in place of another.
  void write(const std::string& name, const std::string& from, const std::string& to) const
  {
    std::ifstream file(directory_ / "models.yaml");
    std::stringstream text;
    text << file.rdbuf();
    std::string changed = text.str();
    const auto at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    std::ofstream(directory_ / name) << changed;
  }

  [[nodiscard]] AbstractMissionConfig config(const std::string& models,
                                             const std::string& world_models) const
  {
    AbstractMissionConfig config;
    config.driver.budget = {0.5, 0.0, 400};
    config.components_per_whole = 3;
    config.models = models;
    config.world_models = world_models;
    return config;
  }

  [[nodiscard]] std::vector<TrialResult> trials(const AbstractMissionConfig& config,
                                                std::uint64_t count) const
  {
    AbstractMissions missions(directory_.string(), config);
    Quiet quiet;
    std::vector<TrialResult> results;
    for (std::uint64_t seed = 1; seed <= count; ++seed)
      results.push_back(
          missions.run("loc(tb1) != main_library", {"loc(tb1) = main_library"}, seed, quiet));
    return results;
  }

  [[nodiscard]] static std::size_t falseDeclarations(const std::vector<TrialResult>& results)
  {
    std::size_t count = 0;
    for (const auto& result : results)
      count += result.mission.achieved && !result.goal_is_true ? 1 : 0;
    return count;
  }

  fs::path directory_;
};

constexpr const char* kSensor = "{true_positive: 0.90, false_positive: 0.05, source: hand-written}";
constexpr const char* kBlind = "{true_positive: 0.50, false_positive: 0.05, source: hand-written}";
constexpr const char* kTooGood =
    "{true_positive: 0.99, false_positive: 0.002, source: hand-written}";

TEST_F(WorldModels, EqualFilesGoAsOneFileDoes)
{
  write("same.yaml", "discount: 0.98", "discount: 0.98");
  const auto one = trials(config("models.yaml", ""), 8);
  const auto two = trials(config("models.yaml", "same.yaml"), 8);
  const auto other_names = trials(config("same.yaml", "models.yaml"), 8);
  for (const auto* results : {&two, &other_names})
  {
    for (std::size_t i = 0; i < one.size(); ++i)
    {
      EXPECT_EQ(one[i].mission.achieved, (*results)[i].mission.achieved);
      EXPECT_EQ(one[i].mission.hl_actions, (*results)[i].mission.hl_actions);
      EXPECT_EQ(one[i].mission.ll_actions, (*results)[i].mission.ll_actions);
      EXPECT_EQ(one[i].mission.duration_s, (*results)[i].mission.duration_s);
      EXPECT_EQ(one[i].fine, (*results)[i].fine);
      EXPECT_EQ(one[i].history.size(), (*results)[i].history.size());
    }
  }
}

TEST_F(WorldModels, ARobotThatTrustsItsSensorTooMuchDeclaresWhatIsNotSo)
{
  write("blind.yaml", kSensor, kBlind);
  write("too_good.yaml", kSensor, kTooGood);
  const std::size_t knowing = falseDeclarations(trials(config("blind.yaml", ""), kTrials));
  const std::size_t trusting =
      falseDeclarations(trials(config("too_good.yaml", "blind.yaml"), kTrials));
  const std::size_t rightly = falseDeclarations(trials(config("too_good.yaml", ""), kTrials));
  EXPECT_GE(trusting, kTrials / 3);  // it takes what it overlooked for what is elsewhere
  EXPECT_LE(knowing, kTrials / 8);   // it looks again
  EXPECT_LE(rightly, kTrials / 8);
}

TEST_F(WorldModels, DurationsAreTheWorlds)
{
  write("slow.yaml", "base_s: 2.0, impossible_s: 12.0", "base_s: 1002.0, impossible_s: 12.0");
  const auto result = trials(config("models.yaml", "slow.yaml"), 1).front();
  EXPECT_GT(result.mission.duration_s, 1000.0);
}

TEST_F(WorldModels, WrongFilesAreNamed)
{
  EXPECT_THROW(AbstractMissions(directory_.string(), config("models.yaml", "nowhere.yaml")),
               Unavailable);
  write("wrong.yaml", "true_positive: 0.90", "true_positive: 1.90");
  for (const auto& with : {config("wrong.yaml", ""), config("models.yaml", "wrong.yaml")})
  {
    try
    {
      const AbstractMissions missions(directory_.string(), with);
      FAIL();
    }
    catch (const InvalidArgument& error)
    {
      EXPECT_THAT(error.what(), HasSubstr("wrong.yaml:"));
    }
  }
}

}  // namespace
}  // namespace kr3::executive
