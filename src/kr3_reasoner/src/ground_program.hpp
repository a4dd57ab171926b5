#pragma once

#include <cstdint>
#include <vector>

#include <clingo.hh>

namespace kr3::reasoner
{

/// A ground answer set program as rules over atoms 1..num_atoms, kept so that it can be evaluated
/// and instantiated many times without being grounded again. Private to the package.
class GroundProgram
{
public:
  using AtomId = std::uint32_t;

  /// `atom` or, when negative, `not atom`; the weight counts in rules with a bound only.
  struct BodyLiteral
  {
    std::int32_t literal;
    std::int32_t weight;

    [[nodiscard]] AtomId atom() const
    {
      return static_cast<AtomId>(literal < 0 ? -literal : literal);
    }
    [[nodiscard]] bool negative() const { return literal < 0; }
  };

  /// The body holds when the weights of its true literals reach the bound. A conjunction has
  /// weights 1 and as bound the number of its literals.
  struct Rule
  {
    bool choice;
    bool conjunction;
    std::uint32_t head_begin;
    std::uint32_t head_end;
    std::uint32_t body_begin;
    std::uint32_t body_end;
    std::int32_t bound;

    [[nodiscard]] bool isConstraint() const { return head_begin == head_end; }
  };

  template <typename Item>
  struct Range
  {
    const Item* first;
    const Item* last;
    [[nodiscard]] const Item* begin() const { return first; }
    [[nodiscard]] const Item* end() const { return last; }
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  [[nodiscard]] AtomId numAtoms() const { return num_atoms_; }
  [[nodiscard]] const std::vector<Rule>& rules() const { return rules_; }
  [[nodiscard]] Range<AtomId> heads(const Rule& rule) const
  {
    return {heads_.data() + rule.head_begin, heads_.data() + rule.head_end};
  }
  [[nodiscard]] Range<BodyLiteral> body(const Rule& rule) const
  {
    return {bodies_.data() + rule.body_begin, bodies_.data() + rule.body_end};
  }

  /// Adds a rule with a conjunction as its body.
  void addRule(bool choice, Range<AtomId> heads, Range<std::int32_t> body);

  /// Adds a rule whose body is a sum with a lower bound.
  void addWeightRule(bool choice, Range<AtomId> heads, std::int32_t bound, Range<BodyLiteral> body);

  /// Adds all rules of another program over the same atoms.
  void append(const GroundProgram& other);

private:
  void note(AtomId atom) { num_atoms_ = std::max(num_atoms_, atom); }
  void addHeads(Rule& rule, Range<AtomId> heads);

  AtomId num_atoms_ = 0;
  std::vector<Rule> rules_;
  std::vector<AtomId> heads_;
  std::vector<BodyLiteral> bodies_;
};

/// Takes down what clingo grounds. Which program the rules go to may change between two groundings.
class GroundProgramRecorder : public Clingo::GroundProgramObserver
{
public:
  /// @param program  receives all rules from now on; must outlive its use
  void recordInto(GroundProgram& program) { program_ = &program; }

  void rule(bool choice, Clingo::AtomSpan head, Clingo::LiteralSpan body) override;
  void weight_rule(bool choice, Clingo::AtomSpan head, Clingo::weight_t lower_bound,
                   Clingo::WeightedLiteralSpan body) override;

private:
  GroundProgram* program_ = nullptr;
};

}  // namespace kr3::reasoner
