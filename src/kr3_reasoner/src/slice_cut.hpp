#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slice.hpp"

namespace kr3::reasoner
{

/// One slice in the making: the symbols, rules, constants and records that it keeps.
class Slicer::Cut
{
public:
  Cut(const Slicer& slicer, const Relevance& relevance);

  /// Keeps a goal's statics and constants.
  void keepGoal(const Formula& goal);

  /// Closes the kept rules and constants. No relevant instance of a rule mentions other symbols
  /// than the relevant ones, so that rules which do can go.
  void close();

  /// Leaves out constants that are alike, but for as many as a plan of so many steps can tell apart
  /// from the rest.
  std::vector<std::string> leaveOutAlike(int horizon);

  [[nodiscard]] bool keeps(ConstantId constant) const;
  [[nodiscard]] bool keepsRecord(std::size_t record) const { return record_kept_[record]; }
  void need(ConstantId constant);

  [[nodiscard]] Slice take() const;

private:
  [[nodiscard]] SliceStore::Key key() const;
  [[nodiscard]] Description description() const;
  void needAll(const std::vector<ConstantId>& constants);

  void keepItems();

  /// Values of relevant fluents that the beginning tells apart.
  void keepBeginning();
  [[nodiscard]] bool isRelevant(const BeginningComponent& component) const;
  [[nodiscard]] std::shared_ptr<const Beginning> beginning() const;

  void keepOccurrences();

  void keepStaticRecords();

  [[nodiscard]] std::size_t count() const;

  /// Whether all constants in arguments of fluents and actions are kept.
  [[nodiscard]] bool isOverKept(const GroundableRule& rule) const;

  void keepRules();

  /// Preferences are transitive: what stands between two defaults that are kept is kept.
  void keepPreferred();

  /// The elements that variables of statics stand for: what facts say about them distinguishes
  /// them.
  void needVariables(const GroundableRule& rule, bool derives_static);

  [[nodiscard]] bool isChoice(const GroundableRule& rule, const RuleLiteral& effect) const;

  /// What fluents that are kept, and open arguments of actions, can be.
  void keepValues();

  /// Observations of relevant fluents, and what is known initially about others that are left.
  void keepRecords();

  /// How many constants that are alike, elements of these sorts, a plan can tell apart: those that
  /// its actions mention, that the variables of one rule stand for, and that fluents have as
  /// values.
  [[nodiscard]] std::size_t distinguishable(const std::vector<bool>& sorts, int horizon) const;

  void copyRule(const GroundableRule& rule, Description& part) const;

  DomainKnowledge& whole_;
  const GroundRules& rules_;
  const std::vector<CheckedRecord>& records_;
  const Beginning* beginning_;  // nullptr: step 0
  std::size_t num_facts_;
  int current_step_;
  const Relevance& relevance_;
  std::vector<bool> fluent_kept_;  // statics too
  std::vector<bool> action_kept_;
  std::vector<bool> rule_kept_;
  std::vector<bool> record_kept_;
  std::vector<bool> needed_;    // constants that something names
  std::vector<bool> possible_;  // and those that are mere values
};

}  // namespace kr3::reasoner
