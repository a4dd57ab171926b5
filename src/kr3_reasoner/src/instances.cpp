#include "instances.hpp"

#include <algorithm>
#include <cstdlib>

#include "encoding.hpp"
#include "history.hpp"
#include "solver.hpp"
#include "vocabulary.hpp"

namespace kr3::reasoner
{

namespace
{

bool isNumber(const std::string& text)
{
  const std::size_t start = text.empty() || text[0] != '-' ? 0 : 1;
  return text.size() > start && text.find_first_not_of("0123456789", start) == std::string::npos;
}

std::vector<Term> termsOf(const Condition& condition)
{
  if (const auto* literal = std::get_if<Literal>(&condition))
  {
    std::vector<Term> terms = literal->atom.arguments;
    terms.push_back(literal->value);
    return terms;
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    return {comparison->left, comparison->right};
  }
  return {std::get<Membership>(condition).term};
}

bool isGround(const Condition& condition, const Binding& binding)
{
  const std::vector<Term> terms = termsOf(condition);
  return std::all_of(terms.begin(), terms.end(), [&](const Term& term) {
    return !term.is_variable || binding.count(term.name) > 0;
  });
}

}  // namespace

bool holds(const std::string& left, Comparison::Operator op, const std::string& right)
{
  int order = left.compare(right);
  if (isNumber(left) && isNumber(right))
  {
    const long difference = std::stol(left) - std::stol(right);
    order = difference < 0 ? -1 : difference > 0 ? 1 : 0;
  }
  return satisfies(order, op);
}

Term bound(const Term& term, const Binding& binding)
{
  const auto found = term.is_variable ? binding.find(term.name) : binding.end();
  return found == binding.end() ? term : Term{false, found->second};
}

bool unify(const Atom& open, const Atom& ground, Binding& binding)
{
  if (open.name != ground.name || open.arguments.size() != ground.arguments.size())
  {
    return false;
  }
  for (std::size_t i = 0; i < open.arguments.size(); ++i)
  {
    const Term& term = open.arguments[i];
    const std::string& constant = ground.arguments[i].name;
    if (term.is_variable ? binding.emplace(term.name, constant).first->second != constant
                         : term.name != constant)
    {
      return false;
    }
  }
  return true;
}

Atom bound(Atom atom, const Binding& binding)
{
  for (Term& argument : atom.arguments)
  {
    argument = bound(argument, binding);
  }
  return atom;
}

Literal bound(Literal literal, const Binding& binding)
{
  literal.atom = bound(std::move(literal.atom), binding);
  literal.value = bound(literal.value, binding);
  return literal;
}

/// The variables of a statement with the sorts of the positions they stand in.
struct Instances::Variables
{
  std::map<std::string, std::vector<std::string>> sorts;

  void add(const Term& term, const std::string& sort)
  {
    if (term.is_variable)
    {
      sorts[term.name].push_back(sort);
    }
  }

  void add(const std::vector<Term>& terms, const std::vector<std::string>& sort_names)
  {
    for (std::size_t i = 0; i < terms.size(); ++i)
    {
      add(terms[i], sort_names[i]);
    }
  }

  void add(const Literal& literal, const Description& description)
  {
    const FluentDeclaration& fluent = *description.findFluent(literal.atom.name);
    add(literal.atom.arguments, fluent.argument_sorts);
    if (fluent.value_sort)
    {
      add(literal.value, *fluent.value_sort);
    }
  }
};

Instances::Instances(const Description& description) : description_(description)
{
  for (const Sort& sort : description.sorts)
  {
    elements_[sort.name].insert(sort.elements.begin(), sort.elements.end());
  }
  for (const Literal& fact : description.static_facts)
  {
    if (fact.equal && fact.value.name != "false")
    {
      statics_[toString(fact.atom)] = fact.value.name;
    }
  }
  addDerivedStatics();
}

/// Axioms may derive statics from the absence of others, so that the order of the rules must not
/// matter: clingo's grounder settles them.
void Instances::addDerivedStatics()
{
  const bool derives =
      std::any_of(description_.constraints.begin(), description_.constraints.end(),
                  [&](const StateConstraint& rule) { return rule.head && isStatic(*rule.head); });
  if (!derives)
  {
    return;
  }
  Solver solver({"--warn=none"});
  solver.add("base", {}, Encoding(description_).vocabulary() + "#defined st/2.\n");
  solver.ground({{"base", {}}});
  const Clingo::SymbolicAtoms atoms = solver.control().symbolic_atoms();
  for (auto it = atoms.begin(Clingo::Signature("st", 2)); it; ++it)
  {
    if (it->is_fact())
    {
      const auto arguments = it->symbol().arguments();
      statics_.emplace(toText(arguments[0]), toText(arguments[1]));
    }
  }
}

bool Instances::inSort(const std::string& element, const std::string& sort) const
{
  const auto found = elements_.find(sort);
  return found != elements_.end() && found->second.count(element) > 0;
}

bool Instances::isStatic(const Literal& literal) const
{
  return description_.findFluent(literal.atom.name)->kind == FluentKind::kStatic;
}

bool Instances::staticHolds(const Literal& open) const
{
  const Literal literal = normalized(open, description_);
  const auto found = statics_.find(toString(literal.atom));
  if (!description_.findFluent(literal.atom.name)->value_sort)
  {
    return (found != statics_.end()) == (literal.value.name == "true");
  }
  return (found != statics_.end() && found->second == literal.value.name) == literal.equal;
}

bool Instances::decided(const Condition& condition, const Binding& binding) const
{
  if (const auto* literal = std::get_if<Literal>(&condition))
  {
    return !isStatic(*literal) || staticHolds(bound(*literal, binding));
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    return holds(bound(comparison->left, binding).name, comparison->op,
                 bound(comparison->right, binding).name);
  }
  const auto& membership = std::get<Membership>(condition);
  return inSort(bound(membership.term, binding).name, membership.sort) != membership.negated;
}

void Instances::forEach(const StatementParts& parts, const Binding& start,
                        const std::function<void(const Binding&)>& visit) const
{
  Variables variables;
  for (const Atom* action : parts.actions)
  {
    variables.add(action->arguments, description_.findAction(action->name)->argument_sorts);
  }
  for (const Atom* fluent : parts.fluents)
  {
    variables.add(fluent->arguments, description_.findFluent(fluent->name)->argument_sorts);
  }
  for (const Literal* literal : parts.literals)
  {
    variables.add(*literal, description_);
  }
  std::vector<const Condition*> conditions;
  for (const Body* body : parts.bodies)
  {
    for (const Condition& condition : *body)
    {
      conditions.push_back(&condition);
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        variables.add(*literal, description_);
      }
      const auto* membership = std::get_if<Membership>(&condition);
      if (membership != nullptr && !membership->negated)
      {
        variables.add(membership->term, membership->sort);
      }
    }
  }
  std::vector<std::string> open;
  for (const auto& [name, sorts] : variables.sorts)
  {
    const auto value = start.find(name);
    if (value == start.end())
    {
      open.push_back(name);
    }
    else if (!std::all_of(sorts.begin(), sorts.end(),
                          [&](const std::string& sort) { return inSort(value->second, sort); }))
    {
      return;
    }
  }
  Binding binding = start;
  std::vector<bool> checked(conditions.size(), false);
  const std::function<void(std::size_t)> extend = [&](std::size_t next) {
    std::vector<std::size_t> now;
    bool fits = true;
    for (std::size_t i = 0; fits && i < conditions.size(); ++i)
    {
      if (!checked[i] && isGround(*conditions[i], binding))
      {
        checked[i] = true;
        now.push_back(i);
        fits = decided(*conditions[i], binding);
      }
    }
    if (fits && next == open.size())
    {
      visit(binding);
    }
    else if (fits)
    {
      const std::vector<std::string>& sorts = variables.sorts.at(open[next]);
      for (const std::string& element : description_.findSort(sorts.front())->elements)
      {
        if (std::all_of(sorts.begin() + 1, sorts.end(),
                        [&](const std::string& sort) { return inSort(element, sort); }))
        {
          binding[open[next]] = element;
          extend(next + 1);
        }
      }
      binding.erase(open[next]);
    }
    for (const std::size_t i : now)
    {
      checked[i] = false;
    }
  };
  extend(0);
}

std::vector<Literal> Instances::literals(const Body& body, const Binding& binding) const
{
  std::vector<Literal> ground;
  for (const Condition& condition : body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal != nullptr && !isStatic(*literal))
    {
      ground.push_back(normalized(bound(*literal, binding), description_));
    }
  }
  return ground;
}

}  // namespace kr3::reasoner
