#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "conditions.hpp"

namespace kr3::reasoner
{

/// A literal of a rule; boolean fluents have the values `true` and `false` and `equal` set.
struct RuleLiteral
{
  enum class Role
  {
    kBody,
    kChoice,  ///< says which values an outcome may choose
    kHead,    ///< of a state constraint or default
    kEffect,  ///< of a causal law
  };
  int symbol = 0;  ///< index in Description::fluents
  std::vector<Slot> arguments;
  Slot value;
  bool equal = true;
  Role role = Role::kBody;
};

struct RuleAction
{
  int symbol = 0;  ///< index in Description::actions
  std::vector<Slot> arguments;
};

/// A statement of a description, taken apart: what it says about fluents, statics and actions.
struct GroundableRule
{
  enum class Kind
  {
    kConstraint,
    kLaw,
    kExecutability,
    kDefault,
    kCost
  };
  struct Relation
  {
    Slot left;
    Comparison::Operator op;
    Slot right;
  };
  struct SortTest
  {
    int sort;
    Slot term;
    bool negated;
  };

  Kind kind = Kind::kConstraint;
  std::size_t index = 0;  ///< in the description's vector of its kind
  SourcePosition position;
  std::vector<RuleAction> actions;
  bool any_action = false;            ///< a variable stands for any agent action
  std::vector<RuleLiteral> literals;  ///< of fluents, in the order of the statement
  std::vector<RuleLiteral> statics;
  std::vector<Relation> relations;
  std::vector<SortTest> sort_tests;
  std::vector<std::vector<int>> variable_sorts;  ///< for each variable the sorts it stands in
  std::vector<bool> in_fluent;  ///< for each variable: it is an argument of some fluent
};

/// A ground fluent or action by its parts; an argument of an action may be kUnbound.
struct GroundAtom
{
  int symbol = 0;
  std::vector<ConstantId> arguments;

  bool operator==(const GroundAtom& other) const
  {
    return symbol == other.symbol && arguments == other.arguments;
  }
};

struct GroundAtomHash
{
  std::size_t operator()(const GroundAtom& atom) const;
};

/// The rules of a description, whose ground instances are made on demand: those that mention a
/// given fluent or action. Cost of construction: linear in the text of the description.
class GroundRules
{
public:
  /// @param description  must outlive this
  explicit GroundRules(const Description& description);

  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const std::vector<GroundableRule>& rules() const { return rules_; }

  /// Rules that mention a fluent, or an action, by their index in rules().
  [[nodiscard]] const std::vector<std::size_t>& rulesOfFluent(int symbol) const;
  [[nodiscard]] const std::vector<std::size_t>& rulesOfAction(int symbol) const;
  /// Joint executability conditions of any two actions.
  [[nodiscard]] const std::vector<std::size_t>& rulesOfAnyAction() const { return any_action_; }

  [[nodiscard]] ConstantId constant(const std::string& name) const;  ///< kUnbound when unknown
  [[nodiscard]] const std::string& name(ConstantId constant) const { return names_[constant]; }
  [[nodiscard]] std::size_t numConstants() const { return names_.size(); }
  [[nodiscard]] int fluentSymbol(const std::string& name) const { return fluents_.at(name); }
  [[nodiscard]] int actionSymbol(const std::string& name) const { return actions_.at(name); }
  [[nodiscard]] int sortIndex(const std::string& name) const { return sorts_.at(name); }
  [[nodiscard]] const std::vector<ConstantId>& elements(int sort) const { return elements_[sort]; }
  [[nodiscard]] bool inSort(ConstantId constant, int sort) const;
  [[nodiscard]] bool isStatic(int symbol) const;
  [[nodiscard]] bool isDefined(int symbol) const;

  [[nodiscard]] GroundAtom ground(const Atom& atom, bool is_action) const;
  [[nodiscard]] std::string fluentText(const GroundAtom& fluent) const;
  [[nodiscard]] std::string actionText(const GroundAtom& action) const;
  /// A literal of a rule under a binding, for people; variables that are not bound keep a `_`.
  [[nodiscard]] std::string literalText(const RuleLiteral& literal,
                                        const RuleBinding& binding) const;

  /// Binds the variables of a rule so that its slots are these constants. False: impossible.
  /// Constants that are kUnbound fit everything.
  [[nodiscard]] bool unify(const GroundableRule& rule, const std::vector<Slot>& slots,
                           const std::vector<ConstantId>& constants, RuleBinding& binding) const;

  /// The fluent of a literal, all of whose arguments are bound.
  [[nodiscard]] static GroundAtom bound(const RuleLiteral& literal, const RuleBinding& binding);
  [[nodiscard]] static ConstantId bound(const Slot& slot, const RuleBinding& binding);
  [[nodiscard]] static bool isBound(const RuleLiteral& literal, const RuleBinding& binding);

  /// Calls `visit` with every instance of a rule that extends a binding, in the order of the sorts.
  /// Variables that stand in no fluent's argument may stay kUnbound. What is known to be false ends
  /// an instance: a static, a comparison, a sort, or a literal for which `is_false` says so.
  /// @param also  further variables to bind
  void forEachInstance(const GroundableRule& rule, const RuleBinding& binding,
                       const std::vector<bool>& also,
                       const std::function<bool(const RuleLiteral&, const RuleBinding&)>& is_false,
                       const std::function<void(const RuleBinding&)>& visit) const;

  /// Whether `impossible A, B if A != B` forbids any two actions at the same time.
  [[nodiscard]] bool serial() const { return serial_; }

private:
  class RuleReader;

  [[nodiscard]] bool refuted(const GroundableRule& rule, const RuleBinding& binding) const;
  [[nodiscard]] bool refuted(const RuleLiteral& literal, const RuleBinding& binding) const;
  void add(GroundableRule rule);

  const Description& description_;
  std::vector<GroundableRule> rules_;
  std::vector<std::vector<std::size_t>> of_fluent_;
  std::vector<std::vector<std::size_t>> of_action_;
  std::vector<std::size_t> any_action_;
  std::unordered_map<std::string, ConstantId> constants_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, int> fluents_;
  std::unordered_map<std::string, int> actions_;
  std::unordered_map<std::string, int> sorts_;
  std::vector<std::vector<ConstantId>> elements_;
  std::vector<std::vector<bool>> member_;  // [sort][constant]
  std::unordered_map<GroundAtom, ConstantId, GroundAtomHash> facts_;
  std::vector<bool> derived_static_;  // by symbol: axioms add to the facts
  bool serial_ = false;
};

}  // namespace kr3::reasoner
