#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_executive/abstract_mission.hpp"

/// What counted work takes on this machine, so that budgets in counted work can be told in seconds.
namespace kr3::executive
{

struct WorkRateOptions
{
  std::vector<double> cpu_s{1.0, 10.0, 100.0};  ///< ascending, positive
  std::uint64_t missions = 5;                   ///< online, for the number of decisions
  std::uint64_t first_seed = 1;
  AbstractMissionConfig mission;  ///< its `method` and `baseline.planning` do not matter
};

struct WorkRates
{
  std::size_t num_states = 0;  ///< of the flat model; 0: it is refused for its size
  /// Backups of the solver when so much CPU time was used, model and first policy included; shape
  /// of WorkRateOptions::cpu_s. Where it was solved before, as many more as the time would allow.
  std::vector<std::uint64_t> backups;
  double prospects_per_s = 0.0;  ///< of online planning
  double decisions = 0.0;        ///< low-level actions of a mission, mean
  /// For each action, so that a mission of so many actions plans for these seconds; same shape.
  std::vector<std::uint64_t> prospects;
  /// Prospects after which the first decision finds nothing better: larger budgets are not used up.
  std::uint64_t most_used = 0;
};

/// Measures with the scenario's goal, places drawn as for POMDP-1.
/// @param directory  of the domain, with a scenario
/// @throws InvalidArgument  no goal, or seconds that are not positive and ascending
[[nodiscard]] WorkRates workRates(const std::string& directory, const WorkRateOptions& options);

/// One line of JSON: {"states", "backups", "prospects_per_s", "decisions", "prospects",
/// "most_used"}.
void print(std::ostream& out, const WorkRates& rates);

}  // namespace kr3::executive
