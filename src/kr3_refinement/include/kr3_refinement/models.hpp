#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/low_level_domain.hpp"

namespace kr3::refinement
{

/// Where a probability comes from.
enum class ModelSource : std::uint8_t
{
  kHandWritten,
  kLearned,
};

/// How often each labelled outcome of an action happens. Those of the laws that apply in a state
/// are drawn together, scaled to a sum of 1.
struct OutcomeModel
{
  /// By label; sums to 1, over all labels or over those of each law.
  std::map<std::string, double> probabilities;
  std::map<std::string, std::uint64_t> counts;  ///< sample sizes; empty when hand-written
  /// Pseudo-count of each label in the Dirichlet prior; with the counts it gives the posterior,
  /// whose mean the probabilities are. Nothing: not said.
  std::optional<double> prior;
  ModelSource source = ModelSource::kHandWritten;
  int line = 0;  ///< in the models file; 0: made in memory
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
  std::optional<double> prior;  ///< pseudo-count of yes and of no in the Beta priors
  ModelSource source = ModelSource::kHandWritten;
  bool exact = false;  ///< declared never to err, so there is nothing to learn
  int line = 0;        ///< in the models file; 0: made in memory
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
  /// Sample sizes, `carried_out` and `impossible`; empty when hand-written.
  std::map<std::string, std::uint64_t> counts;
  double stddev_s = 0.0;  ///< of one duration about the expected one, when learned
  ModelSource source = ModelSource::kHandWritten;
  int line = 0;  ///< in the models file; 0: made in memory
};

/// The numbers of an action for some of its arguments only, where they differ from those for all.
struct ClassModel
{
  /// The constants that an argument may be, by its position; every other argument may be anything.
  std::map<std::size_t, std::set<std::string>> members;
  std::optional<OutcomeModel> outcomes;
  std::map<std::string, ObservationModel> observations;
  std::optional<CostModel> cost;
  std::string text;  ///< as the file has it, `{O: heavy}`
  int line = 0;      ///< in the models file; 0: made in memory

  [[nodiscard]] bool contains(const std::vector<std::string>& arguments) const;
  /// All arguments of this class are of the other as well.
  [[nodiscard]] bool isWithin(const ClassModel& other) const;
};

/// The numbers of an action: for all arguments, and for classes of them. For some arguments those
/// of the most specific class hold that has any; outcomes, each observation and the cost are looked
/// up apart from each other.
struct ActionModel
{
  std::vector<std::string> parameters;  ///< names of the arguments in the models file, `R`, `C`
  OutcomeModel outcomes;
  std::map<std::string, ObservationModel> observations;  ///< by the name of the observed fluent
  CostModel cost;
  std::vector<ClassModel> classes;

  /// @param arguments  of a ground action, of the low level or (of an action of both) the high one
  [[nodiscard]] const OutcomeModel& outcomesOf(const std::vector<std::string>& arguments) const;
  [[nodiscard]] const CostModel& costOf(const std::vector<std::string>& arguments) const;
  /// @throws InvalidArgument  there is no model of the fluent
  [[nodiscard]] const ObservationModel& observationOf(
      const std::string& fluent, const std::vector<std::string>& arguments) const;
};

struct RewardModel
{
  double success = 100.0;        ///< finishing where the high-level action's effects hold
  double given_up = 20.0;        ///< finishing where they cannot be reached
  double wrong_finish = -100.0;  ///< finishing where they could be
};

/// What a fluent of the low level alone may be before anything is known of it. Each ground fluent
/// is independent of the others.
struct FluentPrior
{
  /// By value; sums to 1, values that are not listed have probability 0.
  std::map<std::string, double> probabilities;
  int line = 0;  ///< in the models file; 0: made in memory
};

/// The numbers of the low level: probabilities, costs, rewards.
struct Models
{
  std::map<std::string, ActionModel> actions;  ///< by action name, one for each low-level action
  /// By name of a fluent that the refinement declares. Without one a boolean fluent is false, and
  /// any other has each of its values alike.
  std::map<std::string, FluentPrior> priors;
  RewardModel rewards;
  double discount = 0.98;
  double threshold = 0.85;  ///< belief above it becomes knowledge, in (0.5, 1)
  std::string file;         ///< that they were read from, for messages
};

struct ModelsOptions
{
  /// Refuse probabilities and durations that nobody learned from trials.
  bool require_learned = false;
};

/// Reads models.yaml (schema: docs/refinement.md) and checks it against the low-level description:
/// every labelled outcome and every observation law has its numbers, and nothing else is named.
///
/// @param low_level  LowLevelDomain::description()
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  every problem, one a line: "file:line: found, expected, mend"
[[nodiscard]] Models readModels(const std::string& path, const reasoner::Description& low_level,
                                const ModelsOptions& options = {});

/// The same from a text. @param file  its name, for messages
[[nodiscard]] Models parseModels(const std::string& text, const std::string& file,
                                 const reasoner::Description& low_level,
                                 const ModelsOptions& options = {});

/// As above, and checks in addition that the map has what costs ask of it: distances between the
/// values of `from` and of `to`. Components are also of the classes of their wholes.
[[nodiscard]] Models readModels(const std::string& path, const LowLevelDomain& domain,
                                const ModelsOptions& options = {});
[[nodiscard]] Models parseModels(const std::string& text, const std::string& file,
                                 const LowLevelDomain& domain, const ModelsOptions& options = {});

/// The numbers that were not learned, one line each: "models.yaml:16: outcomes of move". `exact`
/// observations are not listed.
[[nodiscard]] std::vector<std::string> handWritten(const Models& models);

/// Where the numbers of one ground action come from, one line each: "outcomes: learned, 200 samples
/// (models.yaml:16)".
///
/// @throws NotFound  the models have no such action
[[nodiscard]] std::vector<std::string> sources(const Models& models, const std::string& action,
                                               const std::vector<std::string>& arguments);

}  // namespace kr3::refinement
