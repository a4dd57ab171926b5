#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

namespace kr3::executive
{

/// Values of ground fluents by name: {"loc(rob1)", "office"}. A boolean fluent that is not listed
/// is false; a valued one that is not listed is unknown, and no condition on it holds.
using FluentValues = std::map<std::string, std::string>;

/// Chooses among outcomes.
struct OutcomeChooser
{
  /// Index into the labels, of all laws that apply, of the outcomes that are possible now.
  std::function<std::size_t(const std::string& action_symbol,
                            const std::vector<std::string>& labels)>
      outcome;
  /// Index into the values of a choice `{Z : ...}`; not called for an empty one.
  std::function<std::size_t(std::size_t num_values)> value;
};

/// Applies the laws of a description to one concrete state at a time: a plain interpreter, made
/// independently of the zoom and of the answer set solver, so that a world simulated with it is a
/// fair test of both.
///
/// Covers statics, inertial fluents, defined fluents (least fixpoint of their axioms, read in the
/// order of the file), causal laws with several outcomes, state constraints with heads, and
/// executability conditions of one action. Knowledge fluents are no part of the world: false.
/// Not thread-safe: grounding of the names is cached.
class RuleInterpreter
{
public:
  explicit RuleInterpreter(const reasoner::Description& description);

  [[nodiscard]] const reasoner::Description& description() const { return description_; }

  [[nodiscard]] bool executable(const FluentValues& state, const reasoner::Atom& action) const;

  /// The state after the action. The action must be executable. The labels of all laws that apply
  /// name one event, which is drawn once; an event cannot happen where one of its effects has no
  /// value to choose, and without a possible one nothing changes.
  /// @param label  receives nothing when null or no law has labels, else the event's
  [[nodiscard]] FluentValues successor(const FluentValues& state, const reasoner::Atom& action,
                                       const OutcomeChooser& chooser,
                                       std::string* label = nullptr) const;

  /// The state after something outside gave fluents these values, with what the state constraints
  /// make of it.
  /// @throws InvalidArgument  the values contradict the state constraints
  [[nodiscard]] FluentValues imposed(const FluentValues& state, const FluentValues& values) const;

  /// Whether a ground literal holds.
  [[nodiscard]] bool holds(const FluentValues& state, const reasoner::Literal& literal) const;
  [[nodiscard]] bool holds(const FluentValues& state, const reasoner::Formula& formula) const;

  /// Whether no state constraint is violated.
  [[nodiscard]] bool consistent(const FluentValues& state) const;

  /// All instances of an action by its declaration.
  [[nodiscard]] std::vector<reasoner::Atom> instances(
      const reasoner::ActionDeclaration& action) const;

private:
  using Binding = std::map<std::string, std::string>;
  using Visit = std::function<bool(const Binding&)>;  // true: stop

  bool match(const FluentValues& state, const reasoner::Body& body, std::vector<bool>& done,
             Binding& binding, const Visit& visit) const;
  bool forEach(const FluentValues& state, const reasoner::Body& body, const Binding& binding,
               const Visit& visit) const;
  bool matchLiteral(const FluentValues& state, const reasoner::Literal& literal, Binding& binding,
                    const std::function<bool()>& next) const;
  [[nodiscard]] std::string valueOf(const FluentValues& state, const std::string& symbol,
                                    const std::string& ground) const;
  bool applyConstraints(FluentValues& state, const std::map<std::string, bool>& caused,
                        bool strict) const;
  /// The state with its defined fluents, or only with those that the laws ask about: a description
  /// may define much for people that decides nothing.
  enum class Defined
  {
    kUsed,
    kAll,
  };
  [[nodiscard]] FluentValues withDefined(const FluentValues& state, Defined which) const;
  [[nodiscard]] std::set<std::string> definedInUse() const;

  reasoner::Description description_;
  FluentValues statics_;
  bool has_defined_ = false;
  std::set<std::string> used_defined_;  // by name of the fluent
};

}  // namespace kr3::executive
