#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "beginning.hpp"
#include "ground_rules.hpp"
#include "history.hpp"
#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// The ground fluents on which a goal, or the explanation of some records, can depend: a fixpoint
/// over the ground instances of the rules, which are made on demand. Private to the package.
///
/// *Constants of the history.* A fluent that is known initially, that no constraint ties to others,
/// and that no occurred action, exogenous action, constraint or useful action changes keeps its
/// value. An instance of a rule that such a value refutes is dead. The rest is closed under:
///  - a constraint, a default, or a law or condition of an occurred (or exogenous) action that is
///  not
///    dead and mentions a relevant fluent makes all its fluents relevant: they may carry evidence
///    about each other;
///  - an agent action with an effect on a relevant fluent is useful; the bodies of its laws for
///  that
///    effect, its executability conditions and the conditions of its costs are relevant;
///  - what a useful action changes is relevant if a constraint that is not dead mentions it.
/// A definition makes its fluent relevant only where that carries evidence or is asked for.
///
/// Where a history was progressed, the fluents of a component of its beginning carry evidence about
/// each other, too.
///
/// Why this is exact: actions that are not useful can be left out of every plan, since what they
/// change appears in no condition that can ever matter to a useful action or the goal; and minimal
/// explanations of components that share no live rule add up.
class Relevance
{
public:
  /// Where an item came from: the fluent or action that made it relevant, and by which statement.
  struct Origin
  {
    int from = -1;  ///< in items(); -1: asked for
    std::string because;
  };
  struct Item
  {
    bool is_action = false;
    GroundAtom atom;
    Origin origin;
  };

  enum class Purpose
  {
    kPlan,    ///< what can matter to reaching a goal
    kExplain  ///< what is explained together with some records; no actions are planned
  };

  /// All must outlive this.
  /// @param beginning  of a history that was progressed, or nullptr
  Relevance(const GroundRules& rules, const std::vector<CheckedRecord>& records, int current_step,
            Purpose purpose, const Beginning* beginning);

  /// Asks for the fluents of a goal.
  void addGoal(const Formula& goal);
  void addFluent(const GroundAtom& fluent, const Origin& origin);
  /// The fluents of a record: observed, or of the laws and conditions of the action.
  void addRecord(std::size_t record);

  /// Closes what was asked for; may be called again after more was added.
  void close();

  [[nodiscard]] const std::vector<Item>& items() const { return items_; }
  [[nodiscard]] bool isRelevant(const GroundAtom& fluent) const;

  /// Whether a record says something about relevant fluents; of those that say the initial value of
  /// a fluent that stays constant, nothing is said.
  [[nodiscard]] bool concerns(std::size_t record) const;

  /// A certain initial value of a fluent that no part of the history contradicts or explains.
  [[nodiscard]] bool isPlainFact(std::size_t record) const;

  /// The argument positions of an action where only values stand; they are left open.
  [[nodiscard]] bool isOpenPosition(int action, std::size_t position) const
  {
    return open_position_[action][position];
  }

private:
  using Role = RuleLiteral::Role;
  using Kind = GroundableRule::Kind;

  /// Up to when a known initial value must have stayed for it to refute an instance.
  enum class Basis
  {
    kInitially,
    kHistory,
    kAlways
  };

  struct Occurrence
  {
    std::vector<GroundAtom> fluents;
    bool joined = false;  ///< its fluents are relevant
    bool asked = false;   ///< by its record
  };

  void findOpenPositions();
  void readBeginning(const Beginning& beginning);
  void readRecords();
  void findEvidence();
  void expandOccurrences();
  void collectOccurrences();
  void addTo(Occurrence& occurrence, std::size_t rule, const RuleBinding& binding);
  [[nodiscard]] bool isTied(const GroundAtom& fluent) const;

  [[nodiscard]] bool refutes(const RuleLiteral& literal, const RuleBinding& binding, Basis basis);
  void forEachLive(std::size_t rule, const RuleBinding& binding, Basis basis,
                   const std::function<void(const RuleBinding&)>& visit);
  void join(const GroundableRule& rule, const RuleBinding& binding, int from,
            const std::string& what);

  void expandFluent(int item);
  void expandConstraint(std::size_t rule, std::size_t literal, int item);
  void expandLaw(std::size_t rule, std::size_t literal, int item);
  void expandExogenous(std::size_t rule, const RuleBinding& binding, int item);
  void expandAction(int item);
  void addAction(const GroundAtom& action, const Origin& origin);
  void affect(const GroundAtom& fluent, int from);
  [[nodiscard]] GroundAtom actionOf(const GroundableRule& rule, const RuleBinding& binding) const;
  [[nodiscard]] std::vector<bool> actionVariables(const GroundableRule& rule) const;
  [[nodiscard]] std::string at(const GroundableRule& rule) const;

  void run(std::function<void()> task);
  void drain();

  const GroundRules& rules_;
  const std::vector<CheckedRecord>& records_;
  int current_step_;
  Purpose purpose_;
  int first_step_;
  std::vector<std::vector<bool>> open_position_;
  std::vector<bool> evidence_;   // by symbol of a defined fluent: it can carry evidence
  std::vector<bool> exogenous_;  // by symbol: exogenous actions change it
  std::unordered_map<GroundAtom, ConstantId, GroundAtomHash> known_;
  mutable std::unordered_map<GroundAtom, bool, GroundAtomHash> tied_;  // see isTied
  std::unordered_set<GroundAtom, GroundAtomHash> changed_;             // by occurred actions
  std::unordered_set<GroundAtom, GroundAtomHash> affected_;            // or by useful ones
  bool planning_ = false;

  std::vector<Item> items_;
  std::unordered_map<GroundAtom, int, GroundAtomHash> fluent_item_;
  std::unordered_map<GroundAtom, int, GroundAtomHash> action_item_;
  std::map<std::size_t, Occurrence> occurrences_;  // by record
  std::unordered_map<GroundAtom, std::vector<std::size_t>, GroundAtomHash> occurrences_of_;

  std::unordered_set<GroundAtom, GroundAtomHash> open_at_first_;  // in components of the beginning
  std::vector<std::vector<GroundAtom>> joined_;  // fluents of components of the beginning
  std::unordered_map<GroundAtom, std::vector<std::size_t>, GroundAtomHash> ties_of_;

  std::vector<std::function<void()>> tasks_;  // kept: those that rest on constant values run again
  std::vector<std::size_t> queue_;
  std::size_t running_ = 0;
  std::unordered_map<GroundAtom, std::vector<std::size_t>, GroundAtomHash> waiting_;
};

}  // namespace kr3::reasoner
