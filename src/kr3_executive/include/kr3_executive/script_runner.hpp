#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/mission_script.hpp"

namespace kr3::executive
{

/// What happened in a mission, as far as scripts can expect it.
struct MissionTrace
{
  struct HighLevelAction
  {
    std::string action;
    std::string result;  ///< as toString(ActionResult)
  };

  std::vector<HighLevelAction> high_level;
  std::vector<std::string> low_level;
  std::vector<std::vector<std::string>> explanations;  ///< E after each diagnosis
  std::vector<std::vector<std::string>> plans;         ///< actions of each plan that was chosen
  std::size_t num_initial_records = 0;
  std::uint32_t reopened = 0;
  std::vector<std::string> taken_back;  ///< records that left the history, without confidences
  std::size_t num_endings = 0;          ///< done, failed or cancelled
};

struct ScriptReport
{
  MissionScript script;
  TrialResult result;
  MissionTrace trace;
  std::vector<std::string> differences;  ///< from what was expected; none: passed

  [[nodiscard]] bool passed() const { return differences.empty(); }
};

/// How a mission differs from what is expected of it, one difference an entry.
[[nodiscard]] std::vector<std::string> differences(const Expectations& expect,
                                                   const TrialResult& result,
                                                   const MissionTrace& trace);

/// Runs scripts in the abstract world. Domains and policies are kept from script to script.
/// Not thread-safe.
class ScriptRunner
{
public:
  /// @param domain  directory of the domain of all scripts; empty: domains/NAME beside each script
  /// or
  ///                in the nearest directory above it that has one
  explicit ScriptRunner(std::string domain = {}, AbstractMissionConfig config = defaultConfig());

  /// Solves by counted work only, so that a script repeats exactly.
  [[nodiscard]] static AbstractMissionConfig defaultConfig();

  /// @param observer  is told everything too
  /// @throws Unavailable, InvalidArgument  as readScript and AbstractMissions
  ScriptReport run(const std::string& path, MissionObserver& observer);

  /// A script that is no file, for a domain. @throws InvalidArgument  as AbstractMissions::run
  static ScriptReport run(AbstractMissions& missions, MissionScript script,
                          MissionObserver& observer);

  /// The missions of a script's domain, made when first asked for.
  AbstractMissions& missionsOf(const std::string& path, const ScriptHeader& header);

private:
  [[nodiscard]] std::string directoryOf(const std::string& path, const std::string& domain) const;

  std::string domain_;
  AbstractMissionConfig config_;
  std::map<std::string, std::unique_ptr<AbstractMissions>> missions_;
};

}  // namespace kr3::executive
