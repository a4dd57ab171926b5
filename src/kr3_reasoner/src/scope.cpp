#include "scope.hpp"

#include <algorithm>
#include <set>

#include "diagnostics.hpp"

namespace kr3::reasoner
{

namespace
{

/// The number of arguments as the user wrote the fluent.
std::string expectedArguments(const FluentDeclaration& fluent)
{
  const std::size_t arity = fluent.argument_sorts.size() + (fluent.predicate_form ? 1 : 0);
  return std::to_string(arity);
}

}  // namespace

Scope::Scope(const Symbols& symbols, const SourcePosition& position,
             std::vector<Diagnostic>& problems)
  : symbols_(symbols), position_(position), problems_(problems)
{
}

void Scope::report(const SourcePosition& position, const std::string& message)
{
  problems_.push_back({position.line > 0 ? position : position_, message});
}

std::string Scope::nearest(const std::string& name,
                           const std::vector<std::string>& candidates) const
{
  constexpr std::size_t kEnough = 100;  // looking is slow, and nobody reads that far
  return problems_.size() < kEnough ? suggestion(name, candidates) : "";
}

void Scope::useTerm(const Term& term, const std::string& sort_name, const SourcePosition& position)
{
  if (term.is_variable)
  {
    Use& use = variables_[term.name];
    use.sorts.push_back(sort_name);
    if (use.sorts.size() == 1)
    {
      use.position = position;
    }
    return;
  }
  const Sort* sort = symbols_.sort(sort_name);
  if (sort != nullptr && !symbols_.hasElement(*sort, term.name))
  {
    report(position, "found '" + term.name + "', expected an element of the sort " + sort_name +
                         nearest(term.name, sort->elements));
  }
}

void Scope::useArguments(const Atom& atom, const std::vector<std::string>& sorts,
                         const std::string& what)
{
  for (std::size_t i = 0; i < std::min(sorts.size(), atom.arguments.size()); ++i)
  {
    useTerm(atom.arguments[i], sorts[i], atom.position);
  }
  for (std::size_t i = sorts.size(); i < atom.arguments.size(); ++i)
  {
    if (atom.arguments[i].is_variable)
    {
      variables_[atom.arguments[i].name];  // the arity is wrong, the variable is not unsafe
    }
  }
  if (!what.empty() && atom.arguments.size() != sorts.size())
  {
    report(atom.position, "found " + std::to_string(atom.arguments.size()) + " arguments of the " +
                              what + " " + atom.name + ", expected " +
                              std::to_string(sorts.size()));
  }
}

void Scope::useUnknown(const Atom& atom)
{
  useArguments(atom, {}, "");  // so that its variables are not reported as well
}

const FluentDeclaration* Scope::useFluent(const Atom& atom)
{
  const FluentDeclaration* fluent = symbols_.fluent(atom.name);
  if (fluent == nullptr)
  {
    const bool is_action = symbols_.action(atom.name) != nullptr;
    report(atom.position, is_action ? "found the action " + atom.name + ", expected a fluent"
                                    : "unknown fluent, static or sort '" + atom.name + "'" +
                                          nearest(atom.name, symbols_.fluentAndSortNames()));
    useUnknown(atom);
    return nullptr;
  }
  const std::string what = fluent->kind == FluentKind::kStatic ? "static" : "fluent";
  const std::size_t arity = fluent->argument_sorts.size();
  if (fluent->predicate_form && atom.arguments.size() != arity)
  {
    useArguments(atom, fluent->argument_sorts, "");
    report(atom.position, "found " + std::to_string(atom.arguments.size()) + " arguments of the " +
                              what + " " + atom.name + ", expected " + expectedArguments(*fluent));
    return nullptr;
  }
  useArguments(atom, fluent->argument_sorts, what);
  return fluent;
}

void Scope::useValue(const FluentDeclaration& fluent, const Term& value,
                     const SourcePosition& position)
{
  if (fluent.value_sort)
  {
    const Sort* sort = symbols_.sort(*fluent.value_sort);
    const bool no_value = !value.is_variable && (value.name == "true" || value.name == "false") &&
                          (sort == nullptr || !symbols_.hasElement(*sort, value.name));
    if (no_value && fluent.predicate_form)
    {
      report(position, "found " + std::to_string(fluent.argument_sorts.size()) +
                           " arguments of the fluent " + fluent.name + ", expected " +
                           expectedArguments(fluent));
    }
    else if (no_value)
    {
      report(position, "found " + fluent.name + " without a value, expected '" + fluent.name +
                           (fluent.argument_sorts.empty() ? "" : "(...)") +
                           " = ' and an element of the sort " + *fluent.value_sort);
    }
    else
    {
      useTerm(value, *fluent.value_sort, position);
    }
  }
  else if (value.is_variable || (value.name != "true" && value.name != "false"))
  {
    report(position, "found '" + value.name + "' as the value of " + fluent.name +
                         ", expected true or false: it is boolean");
    if (value.is_variable)
    {
      variables_[value.name];
    }
  }
}

bool Scope::isPredicateOfFunction(const Literal& literal)
{
  const FluentDeclaration* fluent = symbols_.fluent(literal.atom.name);
  const std::vector<Term>& arguments = literal.atom.arguments;
  const bool boolean = !literal.value.is_variable && literal.equal &&
                       (literal.value.name == "true" || literal.value.name == "false");
  if (fluent == nullptr || !fluent->value_sort || fluent->predicate_form || !boolean ||
      arguments.size() != fluent->argument_sorts.size() + 1)
  {
    return false;
  }
  Literal function = literal;
  function.atom.arguments.pop_back();
  function.value = arguments.back();
  function.equal = literal.value.name == "true";
  useArguments(function.atom, fluent->argument_sorts, "");
  useTerm(arguments.back(), *fluent->value_sort, literal.atom.position);
  report(literal.atom.position, "found " + toString(literal) + ", expected " + toString(function) +
                                    ": " + literal.atom.name + " is a function");
  return true;
}

const FluentDeclaration* Scope::useLiteral(const Literal& literal)
{
  if (isPredicateOfFunction(literal))
  {
    return nullptr;
  }
  const FluentDeclaration* fluent = useFluent(literal.atom);
  if (fluent != nullptr)
  {
    useValue(*fluent, literal.value, literal.atom.position);
  }
  else if (literal.value.is_variable)
  {
    variables_[literal.value.name];
  }
  return fluent;
}

void Scope::useAction(const Atom& atom)
{
  const ActionDeclaration* action = symbols_.action(atom.name);
  if (action == nullptr)
  {
    const bool is_fluent = symbols_.fluent(atom.name) != nullptr;
    report(atom.position, is_fluent ? "found the fluent " + atom.name + ", expected an action"
                                    : "unknown action '" + atom.name + "'" +
                                          nearest(atom.name, symbols_.actionNames()));
    useUnknown(atom);
    return;
  }
  useArguments(atom, action->argument_sorts, "action");
}

void Scope::useActionVariable(const Term& variable)
{
  Use& use = variables_[variable.name];
  use.is_action = true;
  use.position = position_;
}

void Scope::mention(const Term& term, const SourcePosition& position)
{
  if (term.is_variable)
  {
    mentioned_.emplace(term.name, position);
  }
}

void Scope::useCondition(const Condition& condition)
{
  if (const auto* literal = std::get_if<Literal>(&condition))
  {
    useLiteral(*literal);
    return;
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    mention(comparison->left, comparison->position);
    mention(comparison->right, comparison->position);
    return;
  }
  const auto& membership = std::get<Membership>(condition);
  if (symbols_.sort(membership.sort) == nullptr)
  {
    report(membership.position, "unknown sort '" + membership.sort + "'" +
                                    nearest(membership.sort, symbols_.sortNames()));
  }
  else if (!membership.negated && membership.term.is_variable)
  {
    useTerm(membership.term, membership.sort, membership.position);
  }
  else
  {
    mention(membership.term, membership.position);
  }
}

void Scope::useBody(const Body& body)
{
  for (const Condition& condition : body)
  {
    useCondition(condition);
  }
}

void Scope::finish()
{
  for (const auto& [name, position] : mentioned_)
  {
    if (variables_.count(name) == 0)
    {
      report(
          position,
          "the variable " + name +
              " is unsafe, expected it as an argument or value of a fluent, an action or a sort");
    }
  }
  for (const auto& [name, use] : variables_)
  {
    if (use.is_action && !use.sorts.empty())
    {
      report(use.position, "the variable " + name +
                               " stands for an action and for an element of the sort " +
                               use.sorts.front());
    }
    else if (!symbols_.haveCommonElement(use.sorts))
    {
      std::string sorts;
      for (const std::string& sort : std::set<std::string>(use.sorts.begin(), use.sorts.end()))
      {
        sorts += (sorts.empty() ? "" : " and ") + sort;
      }
      report(use.position, "the variable " + name + " stands in positions of the sorts " + sorts +
                               ", which have no common element");
    }
  }
}

void Scope::requireGround(const std::string& what)
{
  for (const auto& [name, use] : variables_)
  {
    report(use.position,
           "found the variable " + name + ", expected a " + what + " without variables");
  }
}

}  // namespace kr3::reasoner
