#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

namespace kr3::refinement
{

/// Where a probability comes from.
enum class ModelSource : std::uint8_t
{
  kHandWritten,
  kLearned,
};

/// How often each labelled outcome of an action happens.
struct OutcomeModel
{
  std::map<std::string, double> probabilities;  ///< by label; sums to 1
  std::map<std::string, std::uint64_t> counts;  ///< sample sizes; empty when hand-written
  ModelSource source = ModelSource::kHandWritten;
};

/// How reliably an action tells what it observes.
struct ObservationModel
{
  /// `observes f = v`: Pr("true" | it is so) and Pr("true" | it is not).
  /// `observes f`: the value is right with probability `true_positive`, else one of the others, all
  /// equally likely.
  double true_positive = 1.0;
  double false_positive = 0.0;
  std::map<std::string, std::uint64_t> counts;
  ModelSource source = ModelSource::kHandWritten;
};

/// Seconds that an action takes: base_s + per_metre_s * distance.
struct CostModel
{
  double base_s = 1.0;
  double per_metre_s = 0.0;
  std::optional<reasoner::Atom>
      from;        ///< a fluent over the action's parameters, `loc(R)`: its value is the start
  std::string to;  ///< the action's parameter that is the end
  double impossible_s = 10.0;  ///< cost of trying it where it is impossible
};

struct ActionModel
{
  std::vector<std::string> parameters;  ///< names of the arguments in the models file, `R`, `C`
  OutcomeModel outcomes;
  std::map<std::string, ObservationModel> observations;  ///< by the name of the observed fluent
  CostModel cost;
};

struct RewardModel
{
  double success = 100.0;        ///< finishing where the high-level action's effects hold
  double given_up = 20.0;        ///< finishing where they cannot be reached
  double wrong_finish = -100.0;  ///< finishing where they could be
};

/// The numbers of the low level: probabilities, costs, rewards.
struct Models
{
  std::map<std::string, ActionModel> actions;  ///< by action name, one for each low-level action
  RewardModel rewards;
  double discount = 0.98;
  double threshold = 0.85;  ///< belief above it becomes knowledge
};

/// Reads models.yaml (schema: README.md) and checks it against the low-level description: every
/// labelled outcome and every observation law has its numbers, and nothing else is named.
///
/// @param low_level  LowLevelDomain::description()
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  every problem, one a line: "file:line: found, expected"
[[nodiscard]] Models readModels(const std::string& path, const reasoner::Description& low_level);

/// The same from a text. @param file  its name, for messages
[[nodiscard]] Models parseModels(const std::string& text, const std::string& file,
                                 const reasoner::Description& low_level);

}  // namespace kr3::refinement
