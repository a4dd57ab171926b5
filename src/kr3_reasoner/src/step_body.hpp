#pragma once

#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "conditions.hpp"
#include "join.hpp"
#include "signature.hpp"
#include "statement_shape.hpp"
#include "step_program.hpp"

namespace kr3::reasoner
{

/// The atoms of a StepProgram. The values before and the actions come first, the values now when
/// they are asked for, so that programs that do not speak of them stay small. Private to the
/// package, as all of this file.
class StepAtoms
{
public:
  using AtomId = StepProgram::AtomId;

  explicit StepAtoms(const Signature& signature);

  [[nodiscard]] AtomId before(int value) const { return static_cast<AtomId>(value) + 1; }
  [[nodiscard]] AtomId now(int value) const { return first_now_ + static_cast<AtomId>(value); }
  [[nodiscard]] AtomId occurs(int action) const
  {
    return first_action_ + static_cast<AtomId>(action);
  }
  [[nodiscard]] AtomId fresh() { return next_++; }

  /// Gives the values now their atoms.
  void beginNow();

  /// `fluent != value` as an atom that lasts from step to step. Call before beginNow().
  void watch(int value);
  [[nodiscard]] const std::vector<int>& watched() const { return watched_; }
  [[nodiscard]] AtomId unequalBefore(std::size_t number) const { return unequal_before_[number]; }
  [[nodiscard]] AtomId unequalNow(std::size_t number) const { return unequal_now_[number]; }
  [[nodiscard]] AtomId unequalNowOf(int value) const;

private:
  std::size_t num_values_;
  AtomId first_action_;
  AtomId first_now_ = 0;
  AtomId next_;
  std::vector<int> watched_;
  std::unordered_map<int, std::size_t> watched_numbers_;
  std::vector<AtomId> unequal_before_;
  std::vector<AtomId> unequal_now_;
};

/// What all parts of a step are ground with. All must outlive the grounding.
struct StepContext
{
  Vocabulary& vocabulary;
  const Statics& statics;
  const Signature& signature;
  StepAtoms& atoms;
  StepProgram& program;
  const SearchLimit& limit;
};

/// The body of a rule about one step: what is decided by the description alone, as Conditions, and
/// the literals of fluents that are left.
class StepBody
{
public:
  explicit StepBody(const StepContext& context) : context_(context), reader_(context.vocabulary) {}

  [[nodiscard]] ConditionReader& reader() { return reader_; }
  [[nodiscard]] const ConditionReader& reader() const { return reader_; }

  /// Adds conditions on the state before. `F = V` with `V != W`, where V stands nowhere else, is
  /// `not F = W`, so that there is one instance for each W.
  /// @param used  variables that stand outside the body, too
  void addBefore(const Body& body, const std::set<std::string>& used);
  /// Adds one condition on the state before, or now.
  void addBefore(const Condition& condition);
  void addNow(const Condition& condition);
  /// Adds `F != V` now where it has to be founded: as the atom that lasts from step to step.
  void addUnequalNow(const Literal& literal);

  /// Variables whose values an instance depends on: those of its literals, marked in `variables`.
  void markLiterals(std::vector<bool>& variables) const;

  /// Appends the body's literals. @return false when one of them cannot hold
  [[nodiscard]] bool write(const RuleBinding& binding, std::vector<std::int32_t>& body) const;

  /// All instances of the body. Call after everything has been added.
  /// @param wanted  variables that matter besides those of the literals
  void forEach(std::vector<bool> wanted,
               const std::function<void(const RuleBinding&)>& visit) const;

private:
  enum class Time
  {
    kBefore,
    kNow,
    kUnequalNow
  };
  struct Part
  {
    LiteralPattern literal;
    Time time;
    bool negative;
  };

  void add(const Condition& condition, Time time);
  void addDiffering(const Literal& literal, const Term& value);

  const StepContext& context_;
  ConditionReader reader_;
  std::vector<Part> parts_;
};

/// Marks the variables among some slots.
void markVariables(const std::vector<Slot>& slots, std::vector<bool>& variables);

}  // namespace kr3::reasoner
