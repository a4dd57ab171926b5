#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>
#include <kr3_refinement/low_level_domain.hpp>

#include "kr3_executive/mission.hpp"

/// Scripts of missions in the abstract world: what is true, what goes wrong and when, and what is
/// expected to come of it. The file format is in docs/scenarios.md.
namespace kr3::executive
{

/// Whether a text matches a pattern in which `*` stands for any characters, none included.
[[nodiscard]] bool matchesPattern(const std::string& text, const std::string& pattern);

/// A fluent of the low level gets one of these values, drawn when there are several.
struct WorldChange
{
  std::string fluent;
  std::vector<std::string> values;
};

/// Which low-level actions an intervention is about; all that is given has to hold.
struct Trigger
{
  std::string action = "*";                   ///< pattern of the low-level action
  std::string high_level = "*";               ///< pattern of the high-level action under execution
  std::vector<reasoner::Literal> conditions;  ///< true in the world before the action
  std::uint32_t number = 0;      ///< of the low-level action in the mission, from 1; 0 = any
  std::uint32_t occurrence = 1;  ///< the first such action that it applies to, from 1
  std::uint32_t times = 1;       ///< so many such actions in all; 0 = every one from there on
};

/// Something that happens in the world beside what the robot does.
struct Happening
{
  std::vector<WorldChange> set;
  std::vector<reasoner::Record> tell;  ///< a person tells facts; their steps are set by the mission
};

/// What a low-level action is turned into.
struct ForcedResult
{
  std::optional<std::string> outcome;    ///< label
  bool blocked = false;                  ///< no effect
  bool unavailable = false;              ///< the skill cannot be executed at all
  std::vector<WorldChange> becomes;      ///< true after the effect, before the observation
  std::vector<std::string> observation;  ///< one value for each observation law; empty: the truth
};

struct Intervention
{
  Trigger when;
  Happening before;
  ForcedResult force;
  Happening after;
  std::vector<std::pair<std::string, double>> sightings;  ///< literals with confidences
  std::string place;                                      ///< "file:line", for messages
};

/// A fluent that the robot notices by the way, whatever it does it for.
struct Notice
{
  std::string after;    ///< "search(R, C, O)": parameters are variables
  std::string literal;  ///< "loc(X) = V": variables not in `after` range over their sorts
  std::vector<std::string> conditions;  ///< of the low level, such as "neighbor(V, C)"
  double confidence = 1.0;
};

/// A high-level action as it was decided on, and how it ended.
struct ExpectedAction
{
  std::string action;  ///< pattern
  std::string result;  ///< as toString(ActionResult); empty: any
};

/// What a script expects; what is not given is not checked.
struct Expectations
{
  std::optional<bool> declared;       ///< the mission says that the goal is achieved
  std::optional<bool> goal_true;      ///< the goal is true in the world at the end
  std::optional<std::string> reason;  ///< pattern
  /// All of them, in order; with `more`, others may follow.
  std::optional<std::vector<ExpectedAction>> high_level;
  bool more_high_level = false;
  std::vector<std::string> low_level;  ///< patterns that match actions in this order
  std::vector<std::string> never;      ///< patterns of low-level actions that do not occur
  std::optional<std::vector<std::string>>
      history;                            ///< patterns: all records after the initial ones
  std::vector<std::string> recorded;      ///< patterns of records at the end
  std::vector<std::string> not_recorded;  ///< patterns of records that are not there at the end
  std::optional<std::vector<std::vector<std::string>>> explanations;  ///< after each diagnosis
  std::optional<std::uint32_t> reopened;                              ///< refutations taken back
  std::optional<std::vector<std::string>> taken_back;  ///< patterns: all such records, in order
  std::optional<std::uint32_t> max_low_level_actions;
};

/// One mission. Plain data; readScript checks it.
struct MissionScript
{
  std::string name;      ///< what happens, in a sentence
  std::string recovery;  ///< what is recovered from; may be empty
  std::string goal;
  std::optional<std::vector<reasoner::Record>> initial_records;  ///< none: those of scenario.yaml
  std::vector<reasoner::Record> further_records;                 ///< after those
  std::vector<std::string> truths;  ///< literals of the high or low level, true in the world
  std::uint64_t seed = 1;
  bool noise = false;
  Limits limits;
  std::vector<Intervention> interventions;
  std::vector<Notice> notices;
  Expectations expect;
};

/// What has to be known before a script can be checked against its domain.
struct ScriptHeader
{
  std::string domain;    ///< name of a directory under `domains`
  std::string bindings;  ///< file in that directory; empty: bindings.yaml
  std::size_t components_per_whole = 3;
};

/// @throws Unavailable, InvalidArgument  as readScript
[[nodiscard]] ScriptHeader readScriptHeader(const std::string& path);

/// Reads a script and checks it against its domain: keys, literals, records, patterns that match no
/// action, labels and numbers of observations.
///
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  every problem, one a line: "file:line: found, expected"
[[nodiscard]] MissionScript readScript(const std::string& path,
                                       const refinement::LowLevelDomain& domain);
/// The same from a text. @param file  its name, for messages
[[nodiscard]] MissionScript parseScript(const std::string& text, const std::string& file,
                                        const refinement::LowLevelDomain& domain);

}  // namespace kr3::executive
