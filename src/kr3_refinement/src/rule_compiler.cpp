#include "rule_compiler.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{

/// The variables of one law while it is compiled.
class RuleCompiler::Scope
{
public:
  Scope(const reasoner::Description& description, const Signature& signature)
    : description_(description), signature_(signature)
  {
  }

  [[nodiscard]] bool restsOnKnowledge() const { return rests_on_knowledge_; }
  [[nodiscard]] Variables variables() && { return std::move(variables_); }

  Slot slot(const reasoner::Term& term, const ConstantSet* kept, const ConstantSet* full)
  {
    if (!term.is_variable)
    {
      return {false, signature_.vocabulary().find(term.name)};
    }
    const auto [entry, is_new] =
        variables_.slots.try_emplace(term.name, static_cast<int>(variables_.domains.size()));
    const auto index = static_cast<std::size_t>(entry->second);
    if (is_new)
    {
      typed_.push_back(false);
      variables_.domains.emplace_back();
      variables_.full_domains.emplace_back();
    }
    if (kept != nullptr)
    {
      variables_.domains[index] =
          typed_[index] ? variables_.domains[index].intersection(*kept) : *kept;
      variables_.full_domains[index] =
          typed_[index] ? variables_.full_domains[index].intersection(*full) : *full;
      typed_[index] = true;
    }
    return {true, entry->second};
  }

  CompiledLiteral literal(const reasoner::Atom& atom, const reasoner::Term* value, bool equal)
  {
    CompiledLiteral result;
    const std::optional<std::size_t> index = signature_.findSymbol(atom.name);
    if (!index)
    {
      rests_on_knowledge_ = true;
      return result;
    }
    const Symbol& symbol = signature_.symbols()[*index];
    result.symbol = *index;
    result.equal = equal;
    for (std::size_t i = 0; i < atom.arguments.size(); ++i)
    {
      result.arguments.push_back(
          slot(atom.arguments[i], symbol.argument_sorts[i], symbol.full_argument_sorts[i]));
    }
    if (value != nullptr)
    {
      result.value = slot(*value, symbol.value_sort, symbol.full_value_sort);
    }
    return result;
  }

  std::vector<Slot> actionArguments(const reasoner::Atom& atom)
  {
    const reasoner::ActionDeclaration* declaration = description_.findAction(atom.name);
    std::vector<Slot> result;
    for (std::size_t i = 0; i < atom.arguments.size(); ++i)
    {
      const std::string& sort = declaration->argument_sorts[i];
      result.push_back(slot(atom.arguments[i], &signature_.sort(sort), &signature_.fullSort(sort)));
    }
    return result;
  }

  std::vector<CompiledCondition> body(const reasoner::Body& conditions)
  {
    std::vector<CompiledCondition> result;
    for (const reasoner::Condition& condition : conditions)
    {
      if (const auto* l = std::get_if<reasoner::Literal>(&condition))
      {
        result.emplace_back(literal(l->atom, &l->value, l->equal));
      }
      else if (const auto* c = std::get_if<reasoner::Comparison>(&condition))
      {
        result.emplace_back(CompiledComparison{slot(c->left, nullptr, nullptr), c->op,
                                               slot(c->right, nullptr, nullptr)});
      }
      else
      {
        const auto& m = std::get<reasoner::Membership>(condition);
        const ConstantSet& full = signature_.fullSort(m.sort);
        const ConstantSet& kept = signature_.sort(m.sort);
        const Slot term = m.negated ? slot(m.term, nullptr, nullptr) : slot(m.term, &kept, &full);
        result.emplace_back(CompiledMembership{&full, term, m.negated});
      }
    }
    return result;
  }

  /// Adds to a body that the variables of a head that stand nowhere in it run through their sorts.
  /// @param with_value  whether its value is part of the head, which a chosen one is not
  void bindHead(const CompiledLiteral& head, bool with_value, const std::vector<Slot>& arguments,
                std::vector<CompiledCondition>& body) const
  {
    const Symbol& symbol = signature_.symbols()[head.symbol];
    std::vector<std::pair<Slot, const ConstantSet*>> slots;
    for (std::size_t i = 0; i < head.arguments.size(); ++i)
    {
      slots.emplace_back(head.arguments[i], symbol.full_argument_sorts[i]);
    }
    if (with_value)
    {
      slots.emplace_back(head.value, symbol.full_value_sort);
    }
    for (const auto& [slot, sort] : slots)
    {
      if (slot.is_variable && !mentions(arguments, slot.id) && !mentions(body, slot.id))
      {
        body.emplace_back(CompiledMembership{sort, slot, false});
      }
    }
  }

private:
  static bool mentions(const std::vector<Slot>& slots, int variable)
  {
    return std::any_of(slots.begin(), slots.end(), [variable](const Slot& slot) {
      return slot.is_variable && slot.id == variable;
    });
  }

  static bool mentions(const std::vector<CompiledCondition>& body, int variable)
  {
    return std::any_of(body.begin(), body.end(), [variable](const CompiledCondition& condition) {
      if (const auto* literal = std::get_if<CompiledLiteral>(&condition))
      {
        return mentions(literal->arguments, variable) || mentions({literal->value}, variable);
      }
      if (const auto* comparison = std::get_if<CompiledComparison>(&condition))
      {
        return mentions({comparison->left, comparison->right}, variable);
      }
      return mentions({std::get<CompiledMembership>(condition).term}, variable);
    });
  }

  const reasoner::Description& description_;
  const Signature& signature_;
  Variables variables_;
  std::vector<bool> typed_;
  bool rests_on_knowledge_ = false;
};

namespace
{

bool isStatic(const std::vector<CompiledCondition>& body, const Signature& signature)
{
  return std::all_of(body.begin(), body.end(), [&](const CompiledCondition& condition) {
    const auto* literal = std::get_if<CompiledLiteral>(&condition);
    return literal == nullptr || signature.symbols()[literal->symbol].is_static;
  });
}

}  // namespace

std::optional<CompiledConstraint> RuleCompiler::constraint(
    const reasoner::StateConstraint& law) const
{
  Scope scope(description_, signature_);
  CompiledConstraint result;
  if (law.head)
  {
    result.head = scope.literal(law.head->atom, &law.head->value, law.head->equal);
  }
  result.body = scope.body(law.body);
  result.position = law.position;
  if (scope.restsOnKnowledge())
  {
    return std::nullopt;
  }
  if (result.head)
  {
    scope.bindHead(*result.head, true, {}, result.body);
  }
  result.variables = std::move(scope).variables();
  return result;
}

std::optional<CompiledLaw> RuleCompiler::causalLaw(const reasoner::CausalLaw& law) const
{
  Scope scope(description_, signature_);
  CompiledLaw result;
  result.arguments = scope.actionArguments(law.action);
  result.body = scope.body(law.body);
  if (scope.restsOnKnowledge())
  {
    return std::nullopt;
  }
  for (const reasoner::Outcome& outcome : law.outcomes)
  {
    CompiledOutcome compiled{outcome.label, {}};
    for (const reasoner::Effect& effect : outcome.effects)
    {
      if (signature_.isLeftOut(effect.fluent.name))
      {
        continue;  // what an action tells is in its observation law
      }
      CompiledEffect compiled_effect;
      compiled_effect.is_choice = effect.is_choice;
      compiled_effect.fluent = scope.literal(effect.fluent, &effect.value, true);
      compiled_effect.choice = scope.body(effect.choice);
      compiled_effect.choice_is_static = isStatic(compiled_effect.choice, signature_);
      compiled.effects.push_back(std::move(compiled_effect));
    }
    result.outcomes.push_back(std::move(compiled));
  }
  for (const CompiledOutcome& outcome : result.outcomes)
  {
    for (const CompiledEffect& effect : outcome.effects)
    {
      if (!scope.restsOnKnowledge())
      {
        scope.bindHead(effect.fluent, !effect.is_choice, result.arguments, result.body);
      }
    }
  }
  if (scope.restsOnKnowledge())
  {
    throw InvalidArgument(law.position.file + ":" + std::to_string(law.position.line) +
                          ": the choice of an effect rests on knowledge; it must rest on statics "
                          "and physical fluents");
  }
  result.variables = std::move(scope).variables();
  return result;
}

std::optional<CompiledObservation> RuleCompiler::observation(
    const reasoner::ObservationLaw& law) const
{
  Scope scope(description_, signature_);
  CompiledObservation result;
  result.arguments = scope.actionArguments(law.action);
  result.fluent = scope.literal(law.fluent, law.value ? &*law.value : nullptr, true);
  result.has_value = law.value.has_value();
  if (scope.restsOnKnowledge())
  {
    return std::nullopt;
  }
  result.variables = std::move(scope).variables();
  return result;
}

std::optional<CompiledExecutability> RuleCompiler::executability(const reasoner::Executability& law,
                                                                 const std::string& action) const
{
  if (law.actions.size() != 1)
  {
    return std::nullopt;  // about actions at the same time; the low level takes one after the other
  }
  Scope scope(description_, signature_);
  CompiledExecutability result;
  if (const auto* atom = std::get_if<reasoner::Atom>(&law.actions.front()))
  {
    if (atom->name != action)
    {
      return std::nullopt;
    }
    result.arguments = scope.actionArguments(*atom);
  }
  result.body = scope.body(law.body);
  result.position = law.position;
  if (scope.restsOnKnowledge())
  {
    return std::nullopt;
  }
  result.variables = std::move(scope).variables();
  return result;
}

CompiledLiteral RuleCompiler::fact(const reasoner::Literal& literal) const
{
  Scope scope(description_, signature_);
  return scope.literal(literal.atom, &literal.value, literal.equal);
}

}  // namespace kr3::refinement
