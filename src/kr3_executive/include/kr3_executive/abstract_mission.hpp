#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/bindings.hpp"
#include "kr3_executive/cached_reasoner.hpp"
#include "kr3_executive/driver.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/method.hpp"
#include "kr3_executive/scenario.hpp"

namespace kr3::executive
{

struct AbstractMissionConfig
{
  Method method = Method::kPa;
  BaselineOptions baseline;
  DriverConfig driver;
  reasoner::PlanOptions plan;
  /// Components of each magnified element where the domain has no map.yaml.
  std::size_t components_per_whole = 4;
  double pitch_m = 2.0;
  std::string bindings = "bindings.yaml";  ///< file in the domain's directory
  /// The numbers that the robot plans with and believes by; file in the domain's directory.
  std::string models = "models.yaml";
  /// The chances and durations of the simulated world, where they are others than the robot
  /// believes; file in the domain's directory, of the same form. Empty: `models`.
  std::string world_models;
  bool require_learned = false;  ///< refuse numbers that were not learned from trials
  /// Shared with missions of other threads; null: policies are cached by these missions alone.
  std::shared_ptr<PolicyCache> policies;
};

/// The records of a mission that say that a value which was assumed does not hold.
struct RefutationCount
{
  std::size_t all = 0;
  std::size_t wrong = 0;     ///< it did hold when that was recorded
  std::size_t doubtful = 0;  ///< not believed above the threshold: a policy gave up
  std::size_t doubtful_wrong = 0;
};

struct TrialResult
{
  MissionResult mission;
  bool goal_is_true = false;              ///< in the world
  std::vector<reasoner::Record> history;  ///< at the end
  RefutationCount refutations;
  FluentValues fine;  ///< of the low level, true in the world at the end
};

/// One mission to run. Aggregate.
struct MissionSetup
{
  std::string goal;
  /// Literals that are true in the world: `f = v`, `f` or `-f` of the high level or of the low one.
  std::vector<std::string> truths;
  std::uint64_t seed = 1;
  std::vector<reasoner::Record> initial_records;  ///< told when the mission starts
  Limits limits;
  bool noise = true;  ///< chances as in the models; without, all goes as it should
};

/// What stands between the mission and the world, such as a script; `tell` takes what a person
/// says.
using ExecutorOf = std::function<std::unique_ptr<LowLevelExecutor>(
    AbstractWorld& world, std::function<void(const reasoner::Record&)> tell)>;

/// Missions of one domain in the abstract simulator, all in process. From trial to trial policies,
/// generated tasks, costs and answers of the reasoner are cached, by the content of all that they
/// depend on; nothing else is carried over, and a trial goes as if it were the first. Not
/// thread-safe; one instance per thread.
class AbstractMissions
{
public:
  /// @param directory  of the domain: domain.kr3, refinement.kr3, the files that `config` names,
  ///                   and, where they exist, scenario.yaml and map.yaml
  /// @throws Unavailable, InvalidArgument  a file is missing or wrong
  AbstractMissions(const std::string& directory, AbstractMissionConfig config);

  /// The same missions for another thread: what was read is shared, and all caches but that of the
  /// probabilistic methods. Trials go the same way in whichever they are run.
  [[nodiscard]] std::unique_ptr<AbstractMissions> another() const;

  [[nodiscard]] const Scenario& scenario() const { return shared_->scenario; }
  [[nodiscard]] const refinement::LowLevelDomain& domain() const { return *shared_->domain; }
  /// What the robot believes of its actions and sensors.
  [[nodiscard]] const refinement::Models& models() const { return shared_->models; }
  /// What is so in the world.
  [[nodiscard]] const refinement::Models& worldModels() const
  {
    return shared_->world ? *shared_->world : shared_->models;
  }
  [[nodiscard]] const Bindings& bindings() const { return shared_->bindings; }

  /// The first valued fluent that a goal mentions. @throws InvalidArgument  it mentions none
  [[nodiscard]] std::string targetFluent(const std::string& goal) const;

  /// Of the policies, also those of others who share them.
  [[nodiscard]] PolicyCacheStats policyStats() const { return policies_.stats(); }
  /// Of the other caches, by name, with those of others who share them.
  [[nodiscard]] std::map<std::string, ContentCacheStats> cacheStats() const;

  /// One mission from the scenario's initial records. What `truths` and those records leave open is
  /// as the defaults say, and where they are silent drawn at random.
  /// @param truths  literals `f = v` or `f` of the high level that are true in the world
  TrialResult run(const std::string& goal, const std::vector<std::string>& truths,
                  std::uint64_t seed, MissionObserver& observer);

  /// The same with everything given. @param executor  none: the world itself
  TrialResult run(const MissionSetup& setup, MissionObserver& observer,
                  const ExecutorOf& executor = {});

private:
  /// The literal as the low level writes it; none when it is not one of the low level.
  [[nodiscard]] std::optional<std::string> lowLevelLiteral(const std::string& text) const;

  /// What the missions of several threads share.
  struct Shared
  {
    std::unique_ptr<refinement::LowLevelDomain> domain;
    refinement::Models models;
    std::optional<refinement::Models> world;  ///< none: `models`
    Bindings bindings;
    Scenario scenario;
    std::shared_ptr<ReasonerCache> answers = std::make_shared<ReasonerCache>();
    std::shared_ptr<PlanCosts> costs = {};
  };
  AbstractMissions(std::shared_ptr<Shared> shared, AbstractMissionConfig config);
  [[nodiscard]] static std::shared_ptr<Shared> read(const std::string& directory,
                                                    const AbstractMissionConfig& config);

  AbstractMissionConfig config_;
  std::shared_ptr<Shared> shared_;
  InProcessPolicyServer policies_;
  CachedReasoner knower_;  // of the whole description
  CachedReasoner reasoner_;
  std::shared_ptr<BaselineCache> baseline_cache_ = makeBaselineCache();
};

}  // namespace kr3::executive
