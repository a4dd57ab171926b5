#include "kr3_refinement/zoom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>
#include <variant>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/transition_system.hpp>

#include "semantics.hpp"
#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

using reasoner::Atom;
using reasoner::Description;
using reasoner::Literal;
using reasoner::Term;

std::string at(const reasoner::SourcePosition& position)
{
  return position.file + ":" + std::to_string(position.line);
}

/// s1 and s2 of an action, with the defined fluents that follow from what is known.
struct Transition
{
  Values before;
  Values after;
};

Transition transitionOf(const Semantics& semantics, const std::vector<Literal>& state,
                        const Atom& action)
{
  Transition transition{valuesOf(semantics, state), {}};
  const auto last = static_cast<std::ptrdiff_t>(semantics.signature().numInertial());
  const bool all_known = std::find(transition.before.begin(), transition.before.begin() + last,
                                   Vocabulary::kNone) == transition.before.begin() + last;
  Values completed = transition.before;
  static_cast<void>(semantics.complete(completed));
  // What follows from a part of the state does not decide whether the action is possible.
  transition.before = all_known ? completed : transition.before;
  const GroundAction ground = semantics.groundAction(action);
  if (const auto position = semantics.forbidden(transition.before, ground))
  {
    throw FailedPrecondition(ground.name + " is impossible in the state given, by " +
                             at(*position));
  }
  const std::vector<Result> results = semantics.results(transition.before, ground);
  if (results.empty())
  {
    throw FailedPrecondition(ground.name + " has no outcome in the state given");
  }
  transition.after = results.front().values;
  transition.before = std::move(completed);
  return transition;
}

/// The action's instance of a law's atom: which variables stand for which of its arguments.
std::optional<std::unordered_map<std::string, std::string>> unified(const Atom& pattern,
                                                                    const Atom& action)
{
  std::unordered_map<std::string, std::string> binding;
  if (pattern.name != action.name)
  {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < pattern.arguments.size(); ++i)
  {
    const Term& term = pattern.arguments[i];
    const std::string& constant = action.arguments[i].name;
    const std::string& given =
        term.is_variable ? binding.try_emplace(term.name, constant).first->second : term.name;
    if (given != constant)
    {
      return std::nullopt;
    }
  }
  return binding;
}

class RelevanceSearch
{
public:
  RelevanceSearch(const LowLevelDomain& domain, const Semantics& semantics, Atom action)
    : domain_(domain)
    , semantics_(semantics)
    , action_(std::move(action))
    , name_(reasoner::toString(action_))
  {
  }

  std::vector<RelevantConstant> run(const Transition& transition)
  {
    for (const Term& argument : action_.arguments)
    {
      add(argument.name, "argument of " + name_);
    }
    addChanges(transition);
    addConditions(transition.before);
    return std::move(found_);
  }

private:
  void add(const std::string& constant, const std::string& reason)
  {
    const bool is_truth_value = constant == "true" || constant == "false";
    const bool known =
        std::any_of(found_.begin(), found_.end(),
                    [&](const RelevantConstant& relevant) { return relevant.name == constant; });
    if (!is_truth_value && !known)
    {
      found_.push_back({constant, reason});
    }
  }

  void addChanges(const Transition& transition)
  {
    for (std::size_t i = 0; i < semantics_.fluents().size(); ++i)
    {
      if (transition.before[i] == transition.after[i])
      {
        continue;
      }
      const std::string& fluent = semantics_.fluents()[i].name;
      for (const int argument : semantics_.fluents()[i].arguments)
      {
        add(semantics_.vocabulary().name(argument),
            "argument of " + fluent + ", which " + name_ + " changes");
      }
      if (transition.before[i] != Vocabulary::kNone)
      {
        add(semantics_.vocabulary().name(transition.before[i]),
            "value of " + fluent + " before " + name_);
      }
      add(semantics_.vocabulary().name(transition.after[i]),
          "value of " + fluent + " after " + name_);
    }
  }

  void addConditions(const Values& before)
  {
    for (const reasoner::Executability& law : domain_.highLevel().executabilities)
    {
      const auto* pattern =
          law.actions.size() == 1 ? std::get_if<Atom>(&law.actions.front()) : nullptr;
      const auto binding = pattern == nullptr ? std::nullopt : unified(*pattern, action_);
      for (const reasoner::Condition& condition : law.body)
      {
        const auto* literal = std::get_if<Literal>(&condition);
        if (binding && literal != nullptr)
        {
          addCondition(*literal, *binding, before);
        }
      }
    }
  }

  /// Clause 3: the value in s1 of a fluent that is ground once the action's arguments are.
  void addCondition(const Literal& literal,
                    const std::unordered_map<std::string, std::string>& binding,
                    const Values& before)
  {
    Atom atom = literal.atom;
    for (Term& argument : atom.arguments)
    {
      const auto bound = binding.find(argument.name);
      if (argument.is_variable && bound == binding.end())
      {
        return;
      }
      argument = argument.is_variable ? Term{false, bound->second} : argument;
    }
    const std::optional<std::size_t> fluent =
        semantics_.signature().findFluent(reasoner::toString(atom));
    if (!fluent)
    {
      return;  // a static
    }
    if (before[*fluent] == Vocabulary::kNone)
    {
      throw FailedPrecondition(
          name_ + " depends on " + semantics_.fluents()[*fluent].name +
          ", which has no value in the state given; add its value, or the one the plan assumes");
    }
    for (const Term& argument : atom.arguments)
    {
      add(argument.name,
          "argument of " + reasoner::toString(atom) + ", on which " + name_ + " depends");
    }
    add(semantics_.vocabulary().name(before[*fluent]),
        "value of " + reasoner::toString(atom) + ", on which " + name_ + " depends");
  }

  const LowLevelDomain& domain_;
  const Semantics& semantics_;
  Atom action_;
  std::string name_;
  std::vector<RelevantConstant> found_;
};

void addConstants(const LowLevelDomain& domain, Zoom& zoom)
{
  for (const RelevantConstant& relevant : zoom.relevant)
  {
    zoom.constants.insert(relevant.name);
    for (const std::string& component : domain.components(relevant.name))
    {
      zoom.constants.insert(component);
    }
  }
}

/// What the high level cannot rule out: elements of sorts that only the low level has, and of sorts
/// of mere values (of nothing that has fluents itself) that a fluent of the low level alone takes.
void addLowLevelConstants(const LowLevelDomain& domain, Zoom& zoom)
{
  const Description& high = domain.highLevel();
  const auto add = [&](const reasoner::Sort& sort, const std::string& reason) {
    for (const std::string& element : sort.elements)
    {
      if (!domain.map().find(element) && zoom.constants.insert(element).second)
      {
        zoom.relevant.push_back({element, reason});
      }
    }
  };
  for (const reasoner::Sort& sort : domain.refinement().sorts)
  {
    if (high.findSort(sort.name) == nullptr)
    {
      add(sort, "of the sort " + sort.name + ", which only the low level has");
    }
  }
  const auto is_argument = [&](const std::string& element) {
    return std::any_of(high.fluents.begin(), high.fluents.end(), [&](const auto& fluent) {
      return std::any_of(fluent.argument_sorts.begin(), fluent.argument_sorts.end(),
                         [&](const std::string& name) {
        const std::vector<std::string>& elements = high.findSort(name)->elements;
        return std::find(elements.begin(), elements.end(), element) != elements.end();
      });
    });
  };
  for (const reasoner::FluentDeclaration& fluent : domain.refinement().fluents)
  {
    const reasoner::Sort* values =
        fluent.value_sort ? domain.description().findSort(*fluent.value_sort) : nullptr;
    if (values != nullptr && fluent.kind == reasoner::FluentKind::kInertial &&
        std::none_of(values->elements.begin(), values->elements.end(), is_argument))
    {
      add(*values, "value of " + fluent.name + ", which only the low level has");
    }
  }
}

void addStart(const Semantics& semantics, const Values& before, Zoom& zoom)
{
  for (std::size_t i = 0; i < semantics.signature().numInertial(); ++i)
  {
    const PhysicalFluent& fluent = semantics.fluents()[i];
    const bool relevant =
        std::all_of(fluent.arguments.begin(), fluent.arguments.end(), [&](int argument) {
          return zoom.constants.count(semantics.vocabulary().name(argument)) > 0;
        });
    if (relevant && before[i] != Vocabulary::kNone)
    {
      zoom.start.push_back(literalOf(semantics, i, before[i]));
    }
  }
}

}  // namespace

Zoom zoom(const LowLevelDomain& domain, const std::vector<Literal>& state, const Atom& action)
{
  const Semantics semantics(domain.highLevel());
  const Transition transition = transitionOf(semantics, state, action);
  Zoom result;
  result.action = reasoner::toString(action);
  for (std::size_t i = 0; i < semantics.signature().numInertial(); ++i)
  {
    if (transition.before[i] != transition.after[i])
    {
      if (transition.after[i] == Vocabulary::kNone)
      {
        throw FailedPrecondition(result.action + " leaves " + semantics.fluents()[i].name +
                                 " without a value in the state given");
      }
      result.effects.push_back(literalOf(semantics, i, transition.after[i]));
    }
  }
  if (result.effects.empty())
  {
    throw FailedPrecondition(result.action + " changes nothing in the state given");
  }
  result.relevant = RelevanceSearch(domain, semantics, action).run(transition);
  addConstants(domain, result);
  addLowLevelConstants(domain, result);
  addStart(semantics, transition.before, result);
  return result;
}

Zoom wholeDomain(const LowLevelDomain& domain, const std::vector<Literal>& state,
                 const std::vector<Literal>& goal)
{
  if (goal.empty())
  {
    throw InvalidArgument("the goal has no literal");
  }
  const Semantics semantics(domain.highLevel());
  const Values before = valuesOf(semantics, state);
  Zoom result;
  result.action = "whole domain";
  result.effects = goal;
  std::set<std::string> seen;
  for (const reasoner::Sort& sort : domain.highLevel().sorts)
  {
    for (const std::string& element : sort.elements)
    {
      if (seen.insert(element).second)
      {
        result.relevant.push_back({element, "nothing is zoomed away"});
      }
    }
  }
  addConstants(domain, result);
  addLowLevelConstants(domain, result);
  addStart(semantics, before, result);
  return result;
}

Description zoomedDescription(const LowLevelDomain& domain, const Zoom& zoom)
{
  return reasoner::restricted(domain.description(), zoom.constants);
}

std::vector<Literal> successor(const Description& high_level, const std::vector<Literal>& state,
                               const Atom& action)
{
  const Semantics semantics(high_level);
  const Transition transition = transitionOf(semantics, state, action);
  std::vector<Literal> result;
  for (std::size_t i = 0; i < semantics.signature().numInertial(); ++i)
  {
    if (transition.after[i] != Vocabulary::kNone)
    {
      result.push_back(literalOf(semantics, i, transition.after[i]));
    }
  }
  return result;
}

}  // namespace kr3::refinement
