/// kr3_trials: trials of experiments in the abstract simulator, for a scheduler. Reads a job a line
/// from the standard input and writes a row a line for each trial, then one that ends the job. Runs
/// until the input ends. Needs no ROS.

#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>
#include <kr3_executive/abstract_mission.hpp>
#include <kr3_executive/policy_cache.hpp>

#include "trial_job.hpp"

namespace
{

using namespace kr3;
using nlohmann::json;

constexpr std::size_t kConfigurationsKept = 4;

double cpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Which policies a mission used, and what solving them took. Wants nothing else: words cost time.
class PolicyNotes : public executive::MissionObserver
{
public:
  [[nodiscard]] executive::Interest interest() const override { return {false, false, false}; }
  void onEvent(const executive::ReportedEvent& /*event*/) override {}
  void onBelief(const executive::ReportedBelief& /*belief*/) override {}
  void onSnapshot(const executive::Snapshot& /*snapshot*/) override {}
  void onPolicy(const executive::SolvedPolicy& policy) override
  {
    policies.push_back(policy.id);
    backups += policy.backups;
  }

  std::vector<std::string> policies;
  std::uint64_t backups = 0;
};

/// The missions of a few configurations, the last used first: preparing them costs more than a
/// trial.
class Laboratory
{
public:
  explicit Laboratory(std::shared_ptr<executive::PolicyCache> policies)
    : policies_(std::move(policies))
  {
  }

  executive::AbstractMissions& missionsFor(const experiments::TrialJob& job)
  {
    for (auto entry = kept_.begin(); entry != kept_.end(); ++entry)
    {
      if (entry->first != job.configuration)
        continue;
      kept_.splice(kept_.begin(), kept_, entry);
      return *entry->second;
    }
    executive::AbstractMissionConfig config = job.config;
    config.policies = policies_;
    kept_.emplace_front(job.configuration, std::make_unique<executive::AbstractMissions>(
                                               job.domain_dir, std::move(config)));
    if (kept_.size() > kConfigurationsKept)
      kept_.pop_back();
    return *kept_.front().second;
  }

private:
  std::shared_ptr<executive::PolicyCache> policies_;
  std::list<std::pair<std::string, std::unique_ptr<executive::AbstractMissions>>> kept_;
};

void run(const experiments::TrialJob& job, Laboratory& laboratory)
{
  executive::AbstractMissions& missions = laboratory.missionsFor(job);
  const std::string goal = job.goal.empty() ? missions.scenario().goal : job.goal;
  if (goal.empty())
    throw InvalidArgument("'goal' is missing, and the domain's scenario has none");
  const double start_s = cpuSeconds();
  const executive::PolicyCacheStats before = missions.policyStats();
  for (const experiments::Trial& trial : job.trials)
  {
    executive::MissionSetup setup;
    setup.goal = goal;
    setup.truths = trial.truths;
    setup.seed = trial.seed;
    setup.initial_records = experiments::initialRecords(missions.scenario().initial_records, trial,
                                                        missions.domain().highLevel());
    setup.limits = job.limits;
    PolicyNotes notes;
    const executive::TrialResult result = missions.run(setup, notes);
    const ErrorCode code = result.mission.code;
    if (code == ErrorCode::kInvalidArgument || code == ErrorCode::kInternal)
    {
      throw InvalidArgument("the trial with seed " + std::to_string(trial.seed) +
                            " was refused, which is no mission lost: " + result.mission.reason);
    }
    std::cout << experiments::rowOf(job, trial, result, notes.policies, notes.backups) << '\n';
  }
  const executive::PolicyCacheStats after = missions.policyStats();
  json caches = json::object();  // since the missions were made
  for (const auto& [name, stats] : missions.cacheStats())
    caches[name] = {stats.hits, stats.misses};
  const json end{{"job", job.id},
                 {"done", true},
                 {"cpu_s", cpuSeconds() - start_s},
                 {"policy_hits", after.hits + after.disk_hits - before.hits - before.disk_hits},
                 {"policy_misses", after.misses - before.misses},
                 {"caches", caches}};
  std::cout << end << std::endl;
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Runs trials in the abstract simulator: a job a line in, a row a line out (JSON)."};
  executive::PolicyCacheOptions cache;
  app.add_option("--policies", cache.directory, "where policies are kept, a file each");
  CLI11_PARSE(app, argc, argv);
  cache.warn = [](const std::string& text) { std::cerr << "kr3_trials: " << text << "\n"; };
  try
  {
    Laboratory laboratory(std::make_shared<executive::PolicyCache>(cache));
    std::string line;
    while (std::getline(std::cin, line))
    {
      std::string id;
      try
      {
        const experiments::TrialJob job = experiments::readTrialJob(line);
        id = job.id;
        run(job, laboratory);
      }
      catch (const std::exception& error)
      {
        std::cout << json{{"job", id}, {"error", error.what()}} << std::endl;
      }
    }
  }
  catch (const std::exception& error)
  {
    std::cerr << "kr3_trials: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
