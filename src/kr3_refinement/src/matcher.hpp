#pragma once

#include <algorithm>
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
/// `elsewhere` differs from every value inside the zoom; it is one of those outside, which one is
/// undetermined unless there is only one. Surely matched, a variable may stand for `elsewhere`
/// itself; possibly matched, it stands for each value outside, and what the state does not tell of
/// such a value may hold. The values of different literals are not tied to each other beyond that,
/// so `surely` may miss bindings and `possibly` may find too many, never the other way.
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
          Found found, Truth truth)
    : signature_(signature)
    , variables_(variables)
    , body_(body)
    , state_(state)
    , binding_(binding)
    , found_(std::move(found))
    , truth_(truth)
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
    const Symbol& symbol = signature_.symbols()[literal.symbol];
    if (const Slot* hidden = hiddenArgument(literal))
    {
      return symbol.is_static ? decideStatic(literal, *hidden, done) : untold(literal, done);
    }
    const int value = signature_.value(literal, binding_, state_);
    if (value == Vocabulary::kNone)
    {
      return true;
    }
    if (isBound(literal.value))
    {
      const Equality equality = signature_.equality(constantOf(literal.value), value, symbol);
      return !matches(equality, literal.equal) || step(done);
    }
    if (!signature_.isElsewhere(value) || truth_ == Truth::kSurely)
    {
      return give(literal.value, value, !symbol.is_static, done);
    }
    return giveEach(literal.value, valuesOutside(literal.value).elements(), done);
  }
  bool decide(const CompiledComparison& comparison, std::uint64_t done)
  {
    if (!isBound(comparison.left))
    {
      return give(comparison.left, constantOf(comparison.right), false, done);
    }
    if (!isBound(comparison.right))
    {
      return give(comparison.right, constantOf(comparison.left), false, done);
    }
    const int left = constantOf(comparison.left);
    const int right = constantOf(comparison.right);
    if (!signature_.isElsewhere(left) && !signature_.isElsewhere(right))
    {
      return !holds(signature_.vocabulary(), left, comparison.op, right) || step(done);
    }
    using Operator = reasoner::Comparison::Operator;
    if (comparison.op != Operator::kEqual && comparison.op != Operator::kNotEqual)
    {
      return !matches(Equality::kUndetermined, true) || step(done);
    }
    const Slot& hidden = signature_.isElsewhere(left) ? comparison.left : comparison.right;
    const auto slot = static_cast<std::size_t>(hidden.id);
    const Equality equality =
        signature_.equality(left, right, variables_.domains[slot], variables_.full_domains[slot]);
    return !matches(equality, comparison.op == Operator::kEqual) || step(done);
  }
  bool decide(const CompiledMembership& membership, std::uint64_t done)
  {
    const int element = constantOf(membership.term);
    const auto fits = [&](int candidate) {
      return membership.sort->contains(candidate) != membership.negated;
    };
    return !(signature_.isElsewhere(element) ? allOutside(membership.term, fits) : fits(element)) ||
           step(done);
  }

  [[nodiscard]] bool matches(Equality equality, bool equal) const
  {
    return equality == Equality::kUndetermined ? truth_ == Truth::kPossibly
                                               : (equality == Equality::kEqual) == equal;
  }

  /// An argument that stands for a value outside the zoom, or nullptr; of a static only `elsewhere`
  /// itself, since statics are known outside the zoom too.
  [[nodiscard]] const Slot* hiddenArgument(const CompiledLiteral& literal) const
  {
    const bool is_static = signature_.symbols()[literal.symbol].is_static;
    for (const Slot& argument : literal.arguments)
    {
      const int constant = constantOf(argument);
      if (argument.is_variable &&
          (signature_.isElsewhere(constant) ||
           (!is_static &&
            !variables_.domains[static_cast<std::size_t>(argument.id)].contains(constant))))
      {
        return &argument;
      }
    }
    return nullptr;
  }

  /// A static of `elsewhere`: what it is for all the values outside.
  bool decideStatic(const CompiledLiteral& literal, const Slot& hidden, std::uint64_t done)
  {
    const int before = variable(hidden);
    int value = Vocabulary::kNone;
    const bool bound = isBound(literal.value);
    const bool all = allOutside(hidden, [&](int candidate) {
      variable(hidden) = candidate;
      const int own = hiddenArgument(literal) == nullptr
                          ? signature_.value(literal, binding_, state_)
                          : Vocabulary::kNone;
      const bool fits =
          own != Vocabulary::kNone && (bound ? (constantOf(literal.value) == own) == literal.equal
                                             : value == Vocabulary::kNone || value == own);
      value = own;
      return fits;
    });
    variable(hidden) = before;
    return !all || (bound ? step(done) : give(literal.value, value, false, done));
  }

  /// A fluent of something outside the zoom: the state does not tell its value.
  bool untold(const CompiledLiteral& literal, std::uint64_t done)
  {
    if (truth_ == Truth::kSurely)
    {
      return true;
    }
    if (isBound(literal.value))
    {
      return step(done);
    }
    const auto slot = static_cast<std::size_t>(literal.value.id);
    return giveEach(literal.value, variables_.full_domains[slot].elements(), done);
  }

  [[nodiscard]] ConstantSet valuesOutside(const Slot& slot) const
  {
    const auto index = static_cast<std::size_t>(slot.id);
    return variables_.full_domains[index].without(variables_.domains[index]);
  }

  /// Whether there are values outside that a variable may have, and all of them fit.
  template <typename Fits>
  [[nodiscard]] bool allOutside(const Slot& slot, Fits fits) const
  {
    const ConstantSet outside = valuesOutside(slot);
    const std::vector<int>& elements = outside.elements();
    return !elements.empty() && std::all_of(elements.begin(), elements.end(), fits);
  }

  /// @param is_fluents  a fluent's value, which may be one outside the zoom
  bool give(const Slot& slot, int value, bool is_fluents, std::uint64_t done)
  {
    const auto index = static_cast<std::size_t>(slot.id);
    const ConstantSet& fitting =
        is_fluents ? variables_.full_domains[index] : variables_.domains[index];
    if (!signature_.isElsewhere(value) && !fitting.contains(value))
    {
      return true;
    }
    return giveEach(slot, {value}, done);
  }

  bool giveEach(const Slot& slot, const std::vector<int>& values, std::uint64_t done)
  {
    for (const int value : values)
    {
      variable(slot) = value;
      const bool goes_on = step(done);
      variable(slot) = Vocabulary::kNone;
      if (!goes_on)
      {
        return false;
      }
    }
    return true;
  }

  const Signature& signature_;
  const Variables& variables_;
  const std::vector<CompiledCondition>& body_;
  const Values& state_;
  Binding& binding_;
  Found found_;
  Truth truth_;
};

/// Calls `found(binding)` for each match until it returns false. @return false when it was stopped
template <typename Found>
bool forEachMatch(const Signature& signature, const Variables& variables,
                  const std::vector<CompiledCondition>& body, const Values& state, Binding& binding,
                  Found found, Truth truth = Truth::kSurely)
{
  return Matcher<Found>(signature, variables, body, state, binding, std::move(found), truth).run();
}

}  // namespace kr3::refinement
