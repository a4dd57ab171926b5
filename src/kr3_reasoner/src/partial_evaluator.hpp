#pragma once

#include <cstdint>
#include <vector>

#include "ground_program.hpp"
#include "rule_sink.hpp"

namespace kr3::reasoner
{

/// Instantiates one ground program many times, each time for other values of its inputs, and writes
/// only what the inputs leave open. Private to the package; not thread-safe.
///
/// Inputs are atoms whose literals the caller gives. From them follows, as in the well-founded
/// semantics, what cannot be derived (false) and what must be (true); constraints with one open
/// literal, and groups of atoms of which exactly one is true (the values of a functional fluent),
/// decide more. An atom with one supporting literal, and a fluent that only inertia supports,
/// become names for what supports them. All this keeps the answer sets, since an atom is made false
/// only if it is so in every answer set, true only if it is derived without choices or is free to
/// be chosen and must be, and renamed only if it is equivalent and supported from outside any
/// cycle.
class PartialEvaluator
{
public:
  using AtomId = GroundProgram::AtomId;

  /// Value of an atom that the program defines.
  static constexpr SolverLiteral kOpen = 0;

  /// @param program      rules; those from index `frame_begin` on are frame rules: choice rules
  ///                     whose body is the same fluent's value one step before, at most one an atom
  /// @param groups       disjoint sets of atoms of which exactly one is true
  PartialEvaluator(GroundProgram program, std::size_t frame_begin,
                   std::vector<std::vector<AtomId>> groups);

  [[nodiscard]] const GroundProgram& program() const { return program_; }

  /// Evaluates the program and writes what is left of it.
  ///
  /// @param values  shape [numAtoms() + 1]; in: the literal of each input, kOpen for the others; a
  ///                rule with an input as head is a constraint on it. Out: every atom's literal.
  /// @param needed  if not null, only rules that these atoms depend on count
  void instantiate(std::vector<SolverLiteral>& values, RuleSink& sink,
                   const std::vector<AtomId>* needed = nullptr);

private:
  using Rule = GroundProgram::Rule;
  struct Occurrence
  {
    std::uint32_t rule;
    std::int32_t weight;
  };
  /// Lists of items by atom, in one array.
  template <typename Item>
  struct Index
  {
    std::vector<std::uint32_t> begin;
    std::vector<Item> items;
    [[nodiscard]] GroundProgram::Range<Item> of(AtomId atom) const
    {
      return {items.data() + begin[atom], items.data() + begin[atom + 1]};
    }
  };

  void buildIndices();
  void selectRules(const std::vector<AtomId>& needed);

  // Rounds of evaluation, until nothing changes. Each returns whether something was decided that
  // the rounds before did not know.
  void derivePossible();
  void fire(std::uint32_t rule);
  bool deriveCertain();
  void makeTrue(AtomId atom);
  bool decideGroups();
  bool decideUnits();
  [[nodiscard]] bool actsAsConstraint(const Rule& rule) const;
  [[nodiscard]] bool isChoosable(AtomId atom) const;
  [[nodiscard]] bool holds(const GroundProgram::BodyLiteral& literal) const;
  [[nodiscard]] bool isPossible(const GroundProgram::BodyLiteral& literal) const;

  // Writing.
  void name(RuleSink& sink);
  void nameGroup(const std::vector<AtomId>& group, RuleSink& sink);
  void nameSingle(AtomId atom, RuleSink& sink);
  [[nodiscard]] std::uint32_t frameRule(AtomId atom) const;
  [[nodiscard]] SolverLiteral valueOf(const GroundProgram::BodyLiteral& literal) const;
  void writeRule(const Rule& rule, RuleSink& sink);
  void writeHeads(const Rule& rule, const RuleSink::Body& body, RuleSink& sink);
  void writeWeightRule(const Rule& rule, RuleSink& sink);

  GroundProgram program_;
  std::size_t frame_begin_;
  std::vector<std::vector<AtomId>> groups_;
  std::vector<std::int32_t> group_of_;  // -1: none
  Index<Occurrence> positive_;          // rules by atoms of their positive bodies
  Index<std::uint32_t> supporting_;     // rules by heads
  std::vector<char> occurs_negatively_;
  std::vector<std::int32_t> initial_missing_;  // weight that positive literals must still give
  std::vector<std::uint32_t> without_positive_body_;

  // One instantiation.
  static constexpr std::uint32_t kNoRule = 0xffffffffU;
  std::vector<SolverLiteral>* values_ = nullptr;
  bool conflict_ = false;
  bool restricted_ = false;
  std::vector<char> selected_;  // rules, when restricted
  std::vector<char> is_input_;
  std::vector<char> is_alias_;
  std::vector<char> possible_;
  std::vector<char> possible_rule_;
  std::vector<char> named_group_;
  std::vector<std::int32_t> missing_;
  std::vector<AtomId> order_;  // atoms in the order in which they became possible
  std::vector<AtomId> queue_;
  bool renewed_ = false;
};

}  // namespace kr3::reasoner
