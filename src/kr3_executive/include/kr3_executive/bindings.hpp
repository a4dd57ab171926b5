#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// How one low-level action is done by a skill server.
struct Binding
{
  std::string action;                   ///< "search"
  std::vector<std::string> parameters;  ///< "R", "C", "O"
  std::string server;                   ///< name of the kr3_msgs/ExecuteSkill action server
  std::string skill;                    ///< name of the skill on that server
  /// A parameter ("C"), a quoted text ("'shelf'"), or a fluent's believed value ("${loc(R)}").
  std::vector<std::string> arguments;
  /// Outcome label to the values of the observation laws that tell true or false, in their order.
  /// The value of `observes f` with a valued f comes from the skill's result instead.
  std::map<std::string, std::vector<std::string>> outcomes;
  double expected_duration_s = 10.0;
  double time_limit_s = 0.0;  ///< given to the skill; 0 = the server's own
  /// Where the binding is for some arguments only: those, by the argument's index.
  std::map<std::size_t, std::set<std::string>> only_for;
};

/// A sensor that notices, whatever the robot does, that some fluents have changed: a gripper that
/// stops holding something.
struct Watch
{
  std::string topic;                 ///< of std_msgs/Bool
  bool becomes = true;               ///< the value that tells
  std::vector<std::string> fluents;  ///< ground, boolean, of the low level
  bool holds = true;                 ///< the value that they have then
  double confidence = 1.0;           ///< (0, 1]
};

/// How a fluent is said to people; `{1}` is its first argument, `{value}` its value.
struct Phrase
{
  std::string holds;    ///< "{1} in {value}"
  std::string refuted;  ///< "not found there"
};

/// What a skill server is asked to do.
struct SkillCall
{
  std::string server;
  std::string skill;
  std::vector<std::string> arguments;
  double time_limit_s = 0.0;
};

/// The bindings of a domain: an immutable value.
///
/// Invariant: every action that a policy may choose has a binding that fits its declaration.
class Bindings
{
public:
  /// Reads bindings.yaml and checks it.
  /// @param low_level  LowLevelDomain::description()
  /// @throws Unavailable      the file cannot be read
  /// @throws InvalidArgument  one line "file:line: found, expected" for each problem
  [[nodiscard]] static Bindings read(const std::string& path,
                                     const reasoner::Description& low_level);
  /// The same from a text. @param file  its name, for messages
  [[nodiscard]] static Bindings parse(const std::string& text, const std::string& file,
                                      const reasoner::Description& low_level);

  /// Those for all arguments, by action.
  [[nodiscard]] const std::map<std::string, Binding>& actions() const { return actions_; }
  [[nodiscard]] const std::vector<Watch>& watches() const { return watches_; }
  [[nodiscard]] const std::map<std::string, Phrase>& phrases() const { return phrases_; }
  /// Names of the servers in use, without duplicates.
  [[nodiscard]] std::vector<std::string> servers() const;

  /// @throws NotFound            no binding for the action
  /// @throws FailedPrecondition  a fluent among the arguments has no believed value
  [[nodiscard]] SkillCall call(const LowLevelAction& action, const FluentLookup& believed) const;

  /// One value for each observation law of the action.
  /// @param outcome   label that the skill returned
  /// @param observed  values that the skill returned
  /// @throws InvalidArgument  an outcome without an entry, or a missing value
  [[nodiscard]] std::vector<std::string> observation(
      const LowLevelAction& action, const std::string& outcome,
      const std::vector<std::string>& observed) const;

private:
  /// @throws NotFound  no binding for the action
  [[nodiscard]] const Binding& bindingOf(const LowLevelAction& action) const;

  std::map<std::string, Binding> actions_;
  std::vector<Binding> special_;  // for some arguments; they go before actions_, the first one wins
  std::vector<Watch> watches_;
  std::map<std::string, Phrase> phrases_;
  /// For each observation law of an action: whether its value comes from the skill's result.
  std::map<std::string, std::vector<bool>> valued_;
};

}  // namespace kr3::executive
