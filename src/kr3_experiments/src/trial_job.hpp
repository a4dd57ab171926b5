#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <kr3_executive/abstract_mission.hpp>

namespace kr3::experiments
{

/// One trial: a seed, and what is true in the world from the start.
struct Trial
{
  std::uint64_t seed = 1;
  std::vector<std::string> truths;     ///< literals of the high level, such as "f(x) = v"
  std::vector<std::string> initially;  ///< the same, known to the robot
};

/// Trials of one configuration. Everything that a row depends on is here and in the domain's files.
struct TrialJob
{
  std::string id;
  std::string domain_dir;
  std::string goal;  ///< empty: the scenario's
  executive::AbstractMissionConfig config;
  executive::Limits limits;
  std::vector<Trial> trials;
  /// Job without id and trials, as text: jobs with the same share their missions' caches.
  std::string configuration;
};

/// A job from one line of JSON. Keys: `job`, `domain`, `trials` (`seed`; `truths` and `initially`
/// where they are wanted) are required; `goal`, `method`, `bindings`, `models`, `world_models`,
/// `components_per_whole`, `default_probability`, `precision`, `max_backups`, `bias`,
/// `flat_planning`, `flat_precision`, `flat_backups`, `max_hl_actions`, `max_ll_actions`,
/// `threshold` have the defaults of the executive. Solvers get no time limit: what a trial does is
/// a function of the job alone.
///
/// @throws InvalidArgument  no JSON, or an unknown, missing or wrong key; the message names it
[[nodiscard]] TrialJob readTrialJob(const std::string& line);

/// What the robot is told at the start of a trial: the scenario's records, what it says initially
/// of the fluents of `initially` replaced.
/// @throws InvalidArgument  a literal does not fit the description or says what is not so, or there
///                          are two of a fluent, or the scenario has observed it
[[nodiscard]] std::vector<reasoner::Record> initialRecords(
    std::vector<reasoner::Record> of_scenario, const Trial& trial,
    const reasoner::Description& description);

/// What a trial came to, with the ids of the policies that it used, in their order.
[[nodiscard]] nlohmann::json rowOf(const TrialJob& job, const Trial& trial,
                                   const executive::TrialResult& result,
                                   const std::vector<std::string>& policies, std::uint64_t backups);

}  // namespace kr3::experiments
