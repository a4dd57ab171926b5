#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "rule.hpp"
#include "signature.hpp"

namespace kr3::refinement
{

struct GroundAction
{
  std::string name;  ///< "move(rob1, c1)"
  std::string symbol;
  std::vector<int> arguments;
};

[[nodiscard]] inline std::vector<std::string> argumentNames(const Vocabulary& vocabulary,
                                                            const GroundAction& action)
{
  std::vector<std::string> names;
  for (const int argument : action.arguments)
  {
    names.push_back(vocabulary.name(argument));
  }
  return names;
}

/// One way an action can turn out.
struct Result
{
  std::string label;
  double share = 1.0;    ///< of the label's probability
  bool outside = false;  ///< it leaves the zoom; `values` is empty then
  Values values;
};

/// One ground observation law.
struct GroundObservation
{
  std::size_t fluent = 0;         ///< index of the ground fluent
  int value = Vocabulary::kNone;  ///< `observes f = value`; kNone for `observes f`
};

/// States and transitions of a description restricted to some constants, evaluated directly: laws
/// are matched against states, nothing is grounded ahead. Knowledge fluents, and what is defined by
/// them, are left out.
///
/// AL semantics: s' is a successor by effects E when s' is the closure, under the state
/// constraints, of E and what s and s' share (Gelfond and Kahl 2014, ch. 8). Choice sets are
/// evaluated in the whole description, so that an outcome that leaves the zoom is seen. Defined
/// fluents follow from a complete state; they must not define each other through negation. Not
/// thread-safe (it remembers choice sets).
///
/// Where a fluent is `elsewhere`, laws can be undetermined: whether they apply rests on which value
/// outside the zoom it has. The state stands for all of them, so
/// - an action is forbidden if it is for some of these values: what the model does is possible
///   whatever the value is, and no plan rests on trying until the value is a lucky one;
/// - its effects are those for each value, equally likely: none that can come about is excluded;
/// - a constraint is violated, or forces a value, only if it is so for all of them;
/// - a defined fluent that is undetermined has the value `elsewhere`, which is either truth value.
class Semantics
{
public:
  /// @param constants       what the zoom keeps; nullptr: everything
  /// @param with_elsewhere  ground fluents that get one more value, named `elsewhere`
  explicit Semantics(const reasoner::Description& description,
                     const std::set<std::string>* constants = nullptr,
                     const std::set<std::string>& with_elsewhere = {},
                     const std::string& elsewhere = {});

  [[nodiscard]] const Signature& signature() const { return signature_; }
  [[nodiscard]] const Vocabulary& vocabulary() const { return signature_.vocabulary(); }
  [[nodiscard]] const std::vector<PhysicalFluent>& fluents() const { return signature_.fluents(); }

  /// All complete states, in the order of the fluents' values. @throws ResourceExhausted  more than
  /// `max_states`
  [[nodiscard]] std::vector<Values> states(std::size_t max_states) const;

  /// Sets the defined fluents of a state, and checks its constraints. @return false when one is
  /// violated
  [[nodiscard]] bool complete(Values& state) const;

  /// Ground agent actions over the kept constants, in the order of the declarations.
  [[nodiscard]] std::vector<GroundAction> actions() const;
  [[nodiscard]] GroundAction groundAction(const reasoner::Atom& action) const;

  /// Where the condition stands that forbids the action in a state, or may do so where a fluent is
  /// `elsewhere`; nothing when it is executable.
  [[nodiscard]] std::optional<reasoner::SourcePosition> forbidden(const Values& state,
                                                                  const GroundAction& action) const;

  /// How the action can turn out; a label that is impossible in the state does not occur. Shares
  /// sum to 1 for each label that occurs; where a fluent is `elsewhere`, to the part of the values
  /// for which it occurs. The state may be partial: what is unknown stays so, and
  /// no condition on it holds.
  [[nodiscard]] std::vector<Result> results(const Values& state, const GroundAction& action) const;

  /// The action has a law on the fluent, so what it observes of it is feedback.
  [[nodiscard]] bool affects(const GroundAction& action, std::size_t fluent) const;

  [[nodiscard]] std::vector<GroundObservation> observations(const GroundAction& action) const;

private:
  struct Effect
  {
    std::size_t fluent;
    int value;
  };
  /// The ground fluents in the head and body of a constraint that a state violates.
  using Conflict = std::vector<std::size_t>;
  using EffectSet = std::vector<Effect>;

  void addConstraints(const reasoner::Description& description);
  void addActions(const reasoner::Description& description);
  void closeStatics(const std::vector<CompiledConstraint>& rules);

  [[nodiscard]] std::optional<Binding> bound(const Variables& variables,
                                             const std::vector<Slot>& slots,
                                             const std::vector<int>& arguments) const;
  [[nodiscard]] std::vector<int> choiceValues(const CompiledEffect& effect,
                                              const Variables& variables, Binding& binding,
                                              const Values& state) const;
  /// The labels of the laws that apply in a state; one empty label when none of these has any.
  [[nodiscard]] std::vector<std::string> labels(const std::vector<CompiledLaw>& laws,
                                                const Values& state,
                                                const GroundAction& action) const;
  [[nodiscard]] std::vector<EffectSet> effectSets(const std::vector<CompiledLaw>& laws,
                                                  const std::string& label, const Values& state,
                                                  const GroundAction& action) const;
  [[nodiscard]] bool leavesZoom(const Effect& effect) const;
  [[nodiscard]] bool isValue(std::size_t fluent, int value) const;
  /// Adds the fluents that a body mentions, also by way of definitions.
  void addMentioned(const std::vector<CompiledCondition>& body,
                    std::set<std::size_t>& symbols) const;
  /// The states that a state stands for, as far as the action's laws can tell them apart: those
  /// fluents that they mention have values outside the zoom for `elsewhere`.
  [[nodiscard]] std::vector<Values> told(const Values& state, const GroundAction& action) const;
  [[nodiscard]] std::vector<Result> resultsWhenTold(const Values& state,
                                                    const GroundAction& action) const;
  /// Makes values outside the zoom `elsewhere` again. @return false when one cannot be: it leaves
  /// the zoom
  [[nodiscard]] bool hide(Values& state) const;
  void define(Values& state, Truth truth) const;
  [[nodiscard]] Conflict involved(const CompiledConstraint& constraint,
                                  const Binding& binding) const;
  [[nodiscard]] std::optional<Conflict> close(Values& state) const;
  [[nodiscard]] std::vector<Values> successors(const Values& state, const EffectSet& effects) const;
  void search(const Values& state, const EffectSet& effects, std::set<std::size_t> released,
              std::set<std::set<std::size_t>>& tried, std::vector<Values>& found) const;
  void extend(Values& state, std::size_t fluent, std::size_t max_states,
              std::vector<Values>& found) const;

  Signature signature_;
  std::vector<reasoner::ActionDeclaration> actions_;
  std::unordered_map<std::string, std::vector<CompiledLaw>> laws_;
  std::vector<CompiledConstraint> constraints_;  ///< with an inertial head, or none
  std::vector<CompiledConstraint> definitions_;  ///< with a defined head
  std::unordered_map<std::string, std::vector<CompiledExecutability>> executabilities_;
  std::unordered_map<std::string, std::vector<CompiledObservation>> observations_;
  std::unordered_map<std::string, std::set<std::size_t>> mentioned_;  ///< by the laws of an action
  mutable std::map<std::pair<const CompiledEffect*, Binding>, std::vector<int>> remembered_choices_;
};

}  // namespace kr3::refinement
