#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rule.hpp"
#include "signature.hpp"

namespace kr3::refinement
{

[[nodiscard]] bool holds(const Vocabulary& vocabulary, int left, reasoner::Comparison::Operator op,
                         int right);

/// Finds the bindings under which a body holds in a state. A literal on a fluent without a value
/// does not hold.
///
/// Conditions that can be decided are taken first; a literal whose arguments are bound gives its
/// value to a variable; only then a variable runs through its elements.
template <typename Found>
class Matcher
{
public:
  /// @param found  called with the binding complete; returns false to stop
  Matcher(const Signature& signature, const Variables& variables,
          const std::vector<CompiledCondition>& body, const Values& state, Binding& binding,
          Found found)
    : signature_(signature)
    , variables_(variables)
    , body_(body)
    , state_(state)
    , binding_(binding)
    , found_(std::move(found))
  {
  }

  /// @return false when `found` stopped it. The binding is as before afterwards.
  bool run() { return step(0); }

private:
  [[nodiscard]] int constantOf(const Slot& slot) const
  {
    return Signature::constantOf(slot, binding_);
  }
  [[nodiscard]] bool isBound(const Slot& slot) const
  {
    return constantOf(slot) != Vocabulary::kNone || !slot.is_variable;
  }
  int& variable(const Slot& slot) { return binding_[static_cast<std::size_t>(slot.id)]; }

  bool step(std::uint64_t done)
  {
    const Slot* open = nullptr;
    for (std::size_t i = 0; i < body_.size(); ++i)
    {
      if ((done >> i & 1U) != 0)
      {
        continue;
      }
      const Slot* unbound =
          std::visit([this](const auto& condition) { return blocker(condition); }, body_[i]);
      if (unbound == nullptr)
      {
        const std::uint64_t rest = done | std::uint64_t{1} << i;
        return std::visit([&](const auto& condition) { return decide(condition, rest); }, body_[i]);
      }
      open = open == nullptr ? unbound : open;
    }
    if (open == nullptr)
    {
      return found_(binding_);
    }
    const std::vector<int>& elements =
        variables_.domains[static_cast<std::size_t>(open->id)].elements();
    for (const int element : elements)
    {
      variable(*open) = element;
      if (!step(done))
      {
        variable(*open) = Vocabulary::kNone;
        return false;
      }
    }
    variable(*open) = Vocabulary::kNone;
    return true;
  }

  /// The variable that keeps a condition from being decided, or nullptr.
  [[nodiscard]] const Slot* blocker(const CompiledLiteral& literal) const
  {
    for (const Slot& argument : literal.arguments)
    {
      if (!isBound(argument))
      {
        return &argument;
      }
    }
    return literal.equal || isBound(literal.value) ? nullptr : &literal.value;
  }
  [[nodiscard]] const Slot* blocker(const CompiledComparison& comparison) const
  {
    const bool gives = comparison.op == reasoner::Comparison::Operator::kEqual;
    if (!isBound(comparison.left))
    {
      return gives && isBound(comparison.right) ? nullptr : &comparison.left;
    }
    return isBound(comparison.right) || gives ? nullptr : &comparison.right;
  }
  [[nodiscard]] const Slot* blocker(const CompiledMembership& membership) const
  {
    return isBound(membership.term) ? nullptr : &membership.term;
  }

  bool decide(const CompiledLiteral& literal, std::uint64_t done)
  {
    const int value = signature_.value(literal, binding_, state_);
    if (value == Vocabulary::kNone)
    {
      return true;
    }
    if (!isBound(literal.value))
    {
      return give(literal.value, value, done);
    }
    return (constantOf(literal.value) == value) != literal.equal || step(done);
  }
  bool decide(const CompiledComparison& comparison, std::uint64_t done)
  {
    if (!isBound(comparison.left))
    {
      return give(comparison.left, constantOf(comparison.right), done);
    }
    if (!isBound(comparison.right))
    {
      return give(comparison.right, constantOf(comparison.left), done);
    }
    return !holds(signature_.vocabulary(), constantOf(comparison.left), comparison.op,
                  constantOf(comparison.right)) ||
           step(done);
  }
  bool decide(const CompiledMembership& membership, std::uint64_t done)
  {
    return membership.sort->contains(constantOf(membership.term)) == membership.negated ||
           step(done);
  }

  bool give(const Slot& slot, int value, std::uint64_t done)
  {
    if (value != signature_.elsewhere() &&
        !variables_.domains[static_cast<std::size_t>(slot.id)].contains(value))
    {
      return true;
    }
    variable(slot) = value;
    const bool goes_on = step(done);
    variable(slot) = Vocabulary::kNone;
    return goes_on;
  }

  const Signature& signature_;
  const Variables& variables_;
  const std::vector<CompiledCondition>& body_;
  const Values& state_;
  Binding& binding_;
  Found found_;
};

/// Calls `found(binding)` for each match until it returns false. @return false when it was stopped
template <typename Found>
bool forEachMatch(const Signature& signature, const Variables& variables,
                  const std::vector<CompiledCondition>& body, const Values& state, Binding& binding,
                  Found found)
{
  return Matcher<Found>(signature, variables, body, state, binding, std::move(found)).run();
}

}  // namespace kr3::refinement
