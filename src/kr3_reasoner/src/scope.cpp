#include "scope.hpp"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "check.hpp"

namespace kr3::reasoner
{

namespace
{

bool contains(const std::vector<std::string>& items, const std::string& item)
{
  return std::find(items.begin(), items.end(), item) != items.end();
}

}  // namespace

std::vector<std::string> sortNames(const Description& description)
{
  std::vector<std::string> names;
  for (const Sort& sort : description.sorts)
  {
    names.push_back(sort.name);
  }
  return names;
}

Scope::Scope(const Description& description, SourcePosition position,
             std::vector<Diagnostic>& problems)
  : description_(description), position_(std::move(position)), problems_(problems)
{
}

void Scope::report(const SourcePosition& position, const std::string& message)
{
  problems_.push_back({position.line > 0 ? position : position_, message});
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
  const Sort* sort = description_.findSort(sort_name);
  if (sort != nullptr && !contains(sort->elements, term.name))
  {
    report(position, "found '" + term.name + "', expected an element of the sort " + sort_name +
                         suggestion(term.name, sort->elements));
  }
}

void Scope::useArguments(const Atom& atom, const std::vector<std::string>& sorts,
                         const std::string& what)
{
  if (atom.arguments.size() != sorts.size())
  {
    report(atom.position, "found " + std::to_string(atom.arguments.size()) + " arguments of the " +
                              what + " " + atom.name + ", expected " +
                              std::to_string(sorts.size()));
  }
  for (std::size_t i = 0; i < std::min(sorts.size(), atom.arguments.size()); ++i)
  {
    useTerm(atom.arguments[i], sorts[i], atom.position);
  }
}

const FluentDeclaration* Scope::useFluent(const Atom& atom)
{
  const FluentDeclaration* fluent = description_.findFluent(atom.name);
  if (fluent == nullptr)
  {
    std::vector<std::string> known = sortNames(description_);
    for (const FluentDeclaration& declared : description_.fluents)
    {
      known.push_back(declared.name);
    }
    const bool is_action = description_.findAction(atom.name) != nullptr;
    report(atom.position, is_action ? "found the action " + atom.name + ", expected a fluent"
                                    : "unknown fluent, static or sort '" + atom.name + "'" +
                                          suggestion(atom.name, known));
    for (const Term& term : atom.arguments)  // so that its variables are not reported as well
    {
      if (term.is_variable)
      {
        variables_[term.name];
      }
    }
    return nullptr;
  }
  useArguments(atom, fluent->argument_sorts,
               fluent->kind == FluentKind::kStatic ? "static" : "fluent");
  return fluent;
}

void Scope::useValue(const FluentDeclaration& fluent, const Term& value,
                     const SourcePosition& position)
{
  if (fluent.value_sort)
  {
    if (!value.is_variable && value.name == "true" &&
        !contains(description_.findSort(*fluent.value_sort) == nullptr
                      ? std::vector<std::string>{}
                      : description_.findSort(*fluent.value_sort)->elements,
                  "true"))
    {
      report(position, "found " + fluent.name + " without a value, expected '" + fluent.name +
                           "(...) = ' and an element of the sort " + *fluent.value_sort);
      return;
    }
    useTerm(value, *fluent.value_sort, position);
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

const FluentDeclaration* Scope::useLiteral(const Literal& literal)
{
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
  const ActionDeclaration* action = description_.findAction(atom.name);
  if (action == nullptr)
  {
    std::vector<std::string> known;
    for (const ActionDeclaration& declared : description_.actions)
    {
      known.push_back(declared.name);
    }
    report(atom.position, "unknown action '" + atom.name + "'" + suggestion(atom.name, known));
    for (const Term& term : atom.arguments)
    {
      if (term.is_variable)
      {
        variables_[term.name];
      }
    }
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

void Scope::useBody(const Body& body)
{
  for (const Condition& condition : body)
  {
    if (const auto* literal = std::get_if<Literal>(&condition))
    {
      useLiteral(*literal);
    }
    else if (const auto* comparison = std::get_if<Comparison>(&condition))
    {
      mention(comparison->left, position_);
      mention(comparison->right, position_);
    }
    else
    {
      const auto& membership = std::get<Membership>(condition);
      if (description_.findSort(membership.sort) == nullptr)
      {
        report(position_, "unknown sort '" + membership.sort + "'" +
                              suggestion(membership.sort, sortNames(description_)));
      }
      else if (!membership.negated && membership.term.is_variable)
      {
        useTerm(membership.term, membership.sort, position_);
      }
      else
      {
        mention(membership.term, position_);
      }
    }
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
    std::vector<std::string> common;
    bool first = true;
    bool checkable = !use.sorts.empty();
    const std::set<std::string> distinct(use.sorts.begin(), use.sorts.end());
    for (const std::string& sort_name : distinct)
    {
      const Sort* sort = description_.findSort(sort_name);
      if (sort == nullptr || sort->elements.empty())
      {
        checkable = false;
        break;
      }
      if (first)
      {
        common = sort->elements;
      }
      else
      {
        const std::unordered_set<std::string> elements(sort->elements.begin(),
                                                       sort->elements.end());
        common.erase(
            std::remove_if(common.begin(), common.end(),
                           [&](const std::string& item) { return elements.count(item) == 0; }),
            common.end());
      }
      first = false;
    }
    if (use.is_action && !use.sorts.empty())
    {
      report(use.position, "the variable " + name +
                               " stands for an action and for an element of the sort " +
                               use.sorts.front());
    }
    else if (checkable && common.empty())
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
