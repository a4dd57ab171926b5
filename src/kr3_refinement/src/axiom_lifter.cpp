#include "axiom_lifter.hpp"

#include <utility>
#include <variant>

namespace kr3::refinement
{

using reasoner::Atom;
using reasoner::Body;
using reasoner::Comparison;
using reasoner::Condition;
using reasoner::Effect;
using reasoner::FluentDeclaration;
using reasoner::FluentKind;
using reasoner::Literal;
using reasoner::Magnification;
using reasoner::Membership;
using reasoner::Term;

AxiomLifter::AxiomLifter(const reasoner::Description& high_level,
                         const std::vector<Magnification>& magnifications,
                         const std::set<std::string>& magnified_sorts,
                         const std::map<std::string, std::string>& fine_sorts, Problems& problems)
  : high_level_(high_level)
  , magnified_sorts_(magnified_sorts)
  , fine_sorts_(fine_sorts)
  , problems_(problems)
{
  for (const Magnification& magnification : magnifications)
  {
    for (const std::string& element : high_level.findSort(magnification.coarse)->elements)
    {
      magnified_constants_.emplace(element, &magnification);
    }
  }
}

const Magnification* AxiomLifter::magnificationOf(const std::string& constant) const
{
  const auto entry = magnified_constants_.find(constant);
  return entry == magnified_constants_.end() ? nullptr : entry->second;
}

void AxiomLifter::report(const reasoner::SourcePosition& position, const std::string& message)
{
  problems_.add(position, message);
}

/// One law while it is lifted: its fine variables, and the conditions that lifting adds.
class AxiomLifter::Law
{
public:
  Law(AxiomLifter& lifter, reasoner::SourcePosition position)
    : lifter_(lifter), position_(std::move(position))
  {
  }

  /// First pass: which variables stand at fine positions.
  void note(const Atom& fluent, const Term& value)
  {
    const FluentDeclaration& declaration = *lifter_.high_level_.findFluent(fluent.name);
    if (declaration.kind == FluentKind::kStatic)
    {
      return;
    }
    note(fluent, declaration.argument_sorts);
    if (declaration.value_sort)
    {
      note(value, *declaration.value_sort);
    }
  }
  void note(const Atom& atom, const std::vector<std::string>& sorts)
  {
    for (std::size_t i = 0; i < sorts.size(); ++i)
    {
      note(atom.arguments[i], sorts[i]);
    }
  }
  void noteAction(const Atom& action)
  {
    note(action, lifter_.high_level_.findAction(action.name)->argument_sorts);
  }
  void note(const Body& body)
  {
    for (const Condition& condition : body)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        note(literal->atom, literal->value);
      }
    }
  }

  /// Second pass. Added conditions go into `added`.
  [[nodiscard]] Body lift(const Body& body)
  {
    Body result;
    for (const Condition& condition : body)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        result.emplace_back(liftLiteral(*literal));
      }
      else if (const auto* comparison = std::get_if<Comparison>(&condition))
      {
        result.emplace_back(liftComparison(*comparison));
      }
      else
      {
        result.emplace_back(liftMembership(std::get<Membership>(condition)));
      }
      result.insert(result.end(), added.begin(), added.end());
      added.clear();
    }
    return result;
  }
  [[nodiscard]] Atom liftAction(const Atom& action)
  {
    return liftAtom(action, lifter_.high_level_.findAction(action.name)->argument_sorts);
  }
  [[nodiscard]] Atom liftFluent(const Atom& fluent)
  {
    return liftAtom(fluent, lifter_.high_level_.findFluent(fluent.name)->argument_sorts);
  }
  [[nodiscard]] Literal liftHead(const Literal& head)
  {
    Literal result = head;
    result.atom = liftFluent(head.atom);
    const std::optional<std::string>& sort =
        lifter_.high_level_.findFluent(head.atom.name)->value_sort;
    if (sort && lifter_.isFine(*sort) && lifter_.magnificationOf(head.value.name) != nullptr &&
        !head.value.is_variable)
    {
      lifter_.report(
          position_,
          "this axiom gives '" + head.atom.name + "' the value '" + head.value.name +
              "', which has components on the low level; bind the value by a variable in the body");
    }
    return result;
  }
  [[nodiscard]] Effect liftEffect(const Effect& effect)
  {
    Effect result = effect;
    result.fluent = liftFluent(effect.fluent);
    const std::optional<std::string>& sort =
        lifter_.high_level_.findFluent(effect.fluent.name)->value_sort;
    const Magnification* magnification = lifter_.magnificationOf(effect.value.name);
    if (effect.is_choice)
    {
      Body outer = std::exchange(added, {});
      result.choice = lift(effect.choice);
      added = std::move(outer);
    }
    else if (sort && lifter_.isFine(*sort) && !effect.value.is_variable && magnification != nullptr)
    {
      result.is_choice = true;  // some component of it
      result.value = fresh();
      result.choice = {partOf(*magnification, result.value, effect.value, true)};
    }
    return result;
  }

  Body added;

private:
  void note(const Term& term, const std::string& sort)
  {
    if (term.is_variable && lifter_.isFine(sort))
    {
      fine_.emplace(term.name, sort);
    }
  }

  [[nodiscard]] Term fresh() { return {true, "Component_" + std::to_string(++num_fresh_)}; }
  [[nodiscard]] static Literal partOf(const Magnification& magnification, const Term& part,
                                      const Term& whole, bool equal)
  {
    return {{magnification.component_static, {part}, {}}, whole, equal};
  }

  /// The magnification of a fine variable; nullptr with a report when its sort mixes magnified and
  /// other elements.
  const Magnification* magnificationOf(const Term& variable)
  {
    const std::string& sort = fine_.at(variable.name);
    const std::vector<std::string>& elements = lifter_.high_level_.findSort(sort)->elements;
    const Magnification* magnification =
        elements.empty() ? nullptr : lifter_.magnificationOf(elements.front());
    for (const std::string& element : elements)
    {
      if (magnification == nullptr || lifter_.magnificationOf(element) != magnification)
      {
        lifter_.report(position_, "variable " + variable.name + " of sort '" + sort +
                                      "', only some of whose elements are magnified, stands in a "
                                      "static; write this axiom "
                                      "for components in the refinement");
        return nullptr;
      }
    }
    return magnification;
  }

  /// A term at a coarse position.
  [[nodiscard]] Term coarse(const Term& term)
  {
    if (!term.is_variable || fine_.count(term.name) == 0)
    {
      return term;
    }
    const Magnification* magnification = magnificationOf(term);
    const Term whole{true, term.name + "_whole"};
    if (magnification != nullptr)
    {
      added.emplace_back(partOf(*magnification, term, whole, true));
    }
    return whole;
  }

  /// A term at a fine position.
  [[nodiscard]] Term fine(const Term& term)
  {
    const Magnification* magnification =
        term.is_variable ? nullptr : lifter_.magnificationOf(term.name);
    if (magnification == nullptr)
    {
      return term;
    }
    Term part = fresh();
    added.emplace_back(partOf(*magnification, part, term, true));
    return part;
  }

  [[nodiscard]] Atom liftAtom(const Atom& atom, const std::vector<std::string>& sorts)
  {
    Atom result = atom;
    for (std::size_t i = 0; i < sorts.size(); ++i)
    {
      result.arguments[i] = lifter_.isFine(sorts[i]) ? fine(atom.arguments[i]) : atom.arguments[i];
    }
    return result;
  }

  [[nodiscard]] Literal liftLiteral(const Literal& literal)
  {
    const FluentDeclaration& declaration = *lifter_.high_level_.findFluent(literal.atom.name);
    Literal result = literal;
    if (declaration.kind == FluentKind::kStatic)
    {
      for (Term& argument : result.atom.arguments)
      {
        argument = coarse(argument);
      }
      result.value = coarse(result.value);
      return result;
    }
    const bool all = !literal.equal || literal.value.name == "false";
    for (const Term& argument : literal.atom.arguments)
    {
      if (all && !argument.is_variable && lifter_.magnificationOf(argument.name) != nullptr)
      {
        lifter_.report(position_, "'" + toString(literal) + "' speaks of all components of '" +
                                      argument.name +
                                      "'; write this axiom for components in the refinement");
      }
    }
    result.atom = liftAtom(literal.atom, declaration.argument_sorts);
    const bool fine_value = declaration.value_sort && lifter_.isFine(*declaration.value_sort);
    const Magnification* magnification = fine_value && !literal.value.is_variable
                                             ? lifter_.magnificationOf(literal.value.name)
                                             : nullptr;
    if (magnification != nullptr)
    {
      const Term part = fresh();
      added.emplace_back(partOf(*magnification, part, literal.value, literal.equal));
      result.value = part;
      result.equal = true;
    }
    return result;
  }

  [[nodiscard]] Condition liftComparison(const Comparison& comparison)
  {
    for (const bool swapped : {false, true})
    {
      const Term& variable = swapped ? comparison.right : comparison.left;
      const Term& constant = swapped ? comparison.left : comparison.right;
      const Magnification* magnification =
          constant.is_variable ? nullptr : lifter_.magnificationOf(constant.name);
      if (magnification != nullptr && variable.is_variable && fine_.count(variable.name) > 0)
      {
        return partOf(*magnification, variable, constant,
                      comparison.op == Comparison::Operator::kEqual);
      }
    }
    return comparison;
  }

  [[nodiscard]] Membership liftMembership(const Membership& membership)
  {
    const auto sort = lifter_.fine_sorts_.find(membership.sort);
    Membership result = membership;
    if (membership.term.is_variable && fine_.count(membership.term.name) > 0 &&
        sort != lifter_.fine_sorts_.end())
    {
      result.sort = sort->second;
    }
    return result;
  }

  AxiomLifter& lifter_;
  reasoner::SourcePosition position_;
  std::map<std::string, std::string> fine_;  // variable -> the high-level sort of its position
  int num_fresh_ = 0;
};

reasoner::CausalLaw AxiomLifter::lifted(const reasoner::CausalLaw& law)
{
  Law scope(*this, law.position);
  scope.noteAction(law.action);
  scope.note(law.body);
  for (const reasoner::Outcome& outcome : law.outcomes)
  {
    for (const Effect& effect : outcome.effects)
    {
      scope.note(effect.fluent, effect.value);
      scope.note(effect.choice);
    }
  }
  reasoner::CausalLaw result = law;
  result.action = scope.liftAction(law.action);
  for (reasoner::Outcome& outcome : result.outcomes)
  {
    for (Effect& effect : outcome.effects)
    {
      effect = scope.liftEffect(effect);
    }
  }
  Body head_conditions = std::exchange(scope.added, {});
  result.body = scope.lift(law.body);
  result.body.insert(result.body.end(), head_conditions.begin(), head_conditions.end());
  return result;
}

reasoner::StateConstraint AxiomLifter::lifted(const reasoner::StateConstraint& law)
{
  Law scope(*this, law.position);
  scope.note(law.body);
  reasoner::StateConstraint result = law;
  if (law.head && high_level_.findFluent(law.head->atom.name)->kind != FluentKind::kStatic)
  {
    scope.note(law.head->atom, law.head->value);
    result.head = scope.liftHead(*law.head);
  }
  Body head_conditions = std::exchange(scope.added, {});
  result.body = scope.lift(law.body);
  result.body.insert(result.body.end(), head_conditions.begin(), head_conditions.end());
  return result;
}

reasoner::Executability AxiomLifter::lifted(const reasoner::Executability& law)
{
  Law scope(*this, law.position);
  for (const auto& action : law.actions)
  {
    if (const auto* atom = std::get_if<Atom>(&action))
    {
      scope.noteAction(*atom);
    }
  }
  scope.note(law.body);
  reasoner::Executability result = law;
  for (auto& action : result.actions)
  {
    if (auto* atom = std::get_if<Atom>(&action))
    {
      *atom = scope.liftAction(*atom);
    }
  }
  Body head_conditions = std::exchange(scope.added, {});
  result.body = scope.lift(law.body);
  result.body.insert(result.body.end(), head_conditions.begin(), head_conditions.end());
  return result;
}

}  // namespace kr3::refinement
