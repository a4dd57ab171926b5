#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

struct Beginning;

/// A permutation of constants: those that keep their names are left out.
class Renaming
{
public:
  void set(const std::string& from, const std::string& to) { names_[from] = to; }
  [[nodiscard]] const std::string& operator()(const std::string& name) const;
  /// Every identifier of a text. Fluents, actions and sorts have names that no constant has.
  [[nodiscard]] std::string ofText(const std::string& text) const;
  [[nodiscard]] Renaming inverse() const;
  /// First this one, then another.
  [[nodiscard]] Renaming then(const Renaming& second) const;

private:
  std::map<std::string, std::string> names_;
};

/// What a history says about its current step, and nothing else of it: histories that come to the
/// same have equal situations, however they came there and however many steps they took. As long
/// as no record has to be taken to be wrong, the answers about the current step and all later ones
/// depend on nothing else (docs/progression.md). Immutable.
class Situation
{
public:
  /// Before anything is recorded.
  Situation();

  /// All of the content; equal texts, equal situations.
  [[nodiscard]] const std::string& text() const { return text_; }

  /// With more records at the current step. Their own steps, confidences and sources do not matter.
  [[nodiscard]] Situation with(const std::vector<Record>& records) const;

private:
  friend class Situations;
  Situation(std::shared_ptr<const Beginning> beginning, std::vector<Record> records);

  std::shared_ptr<const Beginning> beginning_;  // nullptr: step 0
  std::vector<Record> records_;                 // sorted
  std::string text_;
};

/// A situation with other names, and which they are.
struct RenamedSituation
{
  Situation situation;
  Renaming renaming;  ///< from the names before
};

/// Answers about situations of one description. What is said of a situation is a function of its
/// text: a plan is looked for anew each time. Not thread-safe.
class Situations
{
public:
  explicit Situations(Description description, const ReasonerOptions& options = {});
  ~Situations();
  Situations(const Situations&) = delete;
  Situations& operator=(const Situations&) = delete;

  /// Whether this description is one that situations can be made of: all of it is known to the
  /// reasoner (no code of answer set programming).
  [[nodiscard]] bool supported() const;

  /// Under the names that it would have if constants that nothing tells apart had been named by
  /// what is said of them. Equal but for such names: mostly equal then.
  /// @param about  a text that is said of the same constants, such as a goal
  [[nodiscard]] RenamedSituation canonical(const Situation& situation,
                                           const std::string& about = {}) const;

  /// @throws InvalidArgument  a record does not fit the description
  void check(const std::vector<Record>& records) const;

  struct Later
  {
    Situation situation;
    /// Whether nothing but exceptions to defaults was assumed on the way, and the same failures by
    /// all combinations.
    bool exceptions_only = true;
  };

  /// One step later, when the actions among its records have occurred. Nothing when a record would
  /// have to be taken to be wrong, or when there are too many combinations of values to keep.
  [[nodiscard]] std::optional<Later> next(const Situation& situation);

  /// Whether a minimal explanation of the situation does without exogenous actions and wrong
  /// records.
  [[nodiscard]] bool exceptionsExplain(const Situation& situation);

  /// The values that each ground fluent takes in some model, in the order of its sort; shape
  /// [fluents], in the order of declaration. Nothing when a record would have to be taken to be
  /// wrong.
  using PossibleValues = std::vector<std::vector<std::string>>;
  [[nodiscard]] std::optional<PossibleValues> possibleValues(const Situation& situation);

  /// The same in models at any price: with the kinds of assumption that explain the situation, but
  /// as many as are needed.
  [[nodiscard]] std::optional<PossibleValues> valuesAtAnyPrice(const Situation& situation);

  /// Indices of the observations that say the contrary of a literal, whenever they say so.
  [[nodiscard]] std::vector<std::size_t> contraryTo(const std::vector<Record>& records,
                                                    const Literal& literal) const;
  /// The situation without these observations of its step.
  [[nodiscard]] Situation without(const Situation& situation, const Literal& contrary_to) const;
  /// As Reasoner::retractionsFor, when these records are given up.
  /// @param indices  of the records, in the history
  [[nodiscard]] Retraction retraction(const std::vector<Record>& records,
                                      std::vector<std::size_t> indices,
                                      const Literal& opened) const;

  /// The same under other names.
  [[nodiscard]] PossibleValues renamed(const PossibleValues& values, const Renaming& to) const;
  /// As Reasoner::entailedAt the current step.
  [[nodiscard]] std::vector<Literal> entailed(const PossibleValues& values) const;
  /// As Reasoner::entails at the current step; nothing for a static.
  [[nodiscard]] std::optional<Answer> entails(const PossibleValues& values,
                                              const Literal& literal) const;

  /// As Reasoner::plan.
  [[nodiscard]] PlanResult plan(const Situation& situation, const std::string& goal,
                                const PlanOptions& options, const std::atomic<bool>* cancel) const;
  /// The same under other names.
  [[nodiscard]] PlanResult renamed(const PlanResult& plans, const Renaming& to) const;

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::reasoner
