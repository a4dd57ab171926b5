#include "sparc_general.hpp"

#include <algorithm>

#include "sparc_terms.hpp"

namespace kr3::reasoner::sparc
{

namespace
{

bool isAbout(const Literal& literal, const std::set<std::string>& names)
{
  return literal.relation.empty() && names.count(literal.atom.name) > 0;
}

bool mentions(const std::vector<Literal>& literals, const std::set<std::string>& names)
{
  return std::any_of(literals.begin(), literals.end(),
                     [&](const Literal& literal) { return isAbout(literal, names); });
}

bool isOccurs(const Literal& literal)
{
  return isAtom(literal, "occurs", 2);
}

/// `p(X) | -p(X)`: a choice between a literal and its contrary.
bool isEitherWay(const std::vector<Literal>& head)
{
  return head.size() == 2 && head[0].atom == head[1].atom &&
         head[0].is_negative != head[1].is_negative;
}

bool isVariableAt(const Literal& literal, std::size_t place)
{
  return literal.atom.arguments.size() > place && literal.atom.arguments[place].is_variable;
}

/// Success, goals other than the definition of one, and that something happens until then.
bool isPlanning(const Rule& rule)
{
  static const std::set<std::string> kPlanning = {"success", "goal", "something_happened"};
  const bool defines_goal =
      rule.head.size() == 1 && rule.head[0].atom.name == "goal" && !mentions(rule.body, kPlanning);
  if (!defines_goal && (mentions(rule.head, kPlanning) || mentions(rule.body, kPlanning)))
  {
    return true;
  }
  const bool any_action = rule.head.size() == 1 && isOccurs(rule.head[0]) &&
                          !rule.head[0].is_negative && isVariableAt(rule.head[0], 0);
  if (any_action && !rule.body.empty())
  {
    return true;  // which actions occur is the planner's and the diagnosis' business
  }
  const bool chooses = rule.is_choice || rule.restores_consistency || isEitherWay(rule.head);
  return chooses && !rule.head.empty() && std::all_of(rule.head.begin(), rule.head.end(), isOccurs);
}

/// What obs, hpd, attempt, impossible and current_step mean. Facts about them are no such rule.
bool isHistoryAxiom(const Rule& rule)
{
  static const std::set<std::string> kHistory = {"obs", "hpd", "attempt", "current_step"};
  if (rule.body.empty())
  {
    return rule.head.size() == 1 && rule.head[0].atom.name == "current_step";
  }
  const bool executability = rule.head.size() == 1 && isOccurs(rule.head[0]) &&
                             rule.head[0].is_negative && isVariableAt(rule.head[0], 0) &&
                             mentions(rule.body, {"impossible"});
  return executability || mentions(rule.body, kHistory);
}

}  // namespace

bool isGeneral(const Rule& rule)
{
  if (isPlanning(rule) || isHistoryAxiom(rule))
  {
    return true;
  }
  // every fluent is true or false at the start
  if (isEitherWay(rule.head) && isAtom(rule.head[0], "holds", 2) && isVariableAt(rule.head[0], 0))
  {
    return true;
  }
  if (rule.head.size() != 1)
  {
    return false;
  }
  const Literal& head = rule.head[0];
  const auto negated = std::find_if(rule.body.begin(), rule.body.end(), [](const Literal& literal) {
    return literal.is_default_negated;
  });
  if (negated == rule.body.end())
  {
    return false;
  }
  // closed worlds: -p(X) :- #s(X), not p(X), of statics and of fluents at step 0
  const bool plain = std::all_of(rule.body.begin(), rule.body.end(), [&](const Literal& literal) {
    return &literal == &*negated || literal.atom.name[0] == '#';
  });
  if (plain && head.is_negative && !negated->is_negative && head.atom == negated->atom &&
      (!isAtom(head, "holds", 2) || !isVariableAt(head, 1)))
  {
    return true;
  }
  if (!closedFluent(rule).empty())
  {
    return true;
  }
  // inertia, and the closed worlds of fluents and actions: they are about a variable
  return (isAtom(head, "holds", 2) || isOccurs(head)) && isVariableAt(head, 0);
}

bool isDefaultWithException(const Rule& rule, const Program& program)
{
  const auto initial = [](const Literal& literal) {
    return isAtom(literal, "holds", 2) && literal.atom.arguments[1].name == "0" &&
           !literal.atom.arguments[0].is_variable;
  };
  if (rule.restores_consistency || rule.head.size() != 1 || !initial(rule.head[0]) ||
      rule.body.empty())
  {
    return false;
  }
  const Literal& head = rule.head[0];
  return std::any_of(program.rules.begin(), program.rules.end(), [&](const Rule& other) {
    return other.restores_consistency && other.head.size() == 1 && initial(other.head[0]) &&
           other.head[0].is_negative != head.is_negative &&
           other.head[0].atom.arguments[0].name == head.atom.arguments[0].name;
  });
}

Completeness completenessOf(const Program& program, const Signature& signature)
{
  Completeness result;
  for (const Rule& rule : program.rules)
  {
    const bool about_holds = !rule.head.empty() && isAtom(rule.head[0], "holds", 2);
    if (about_holds && isEitherWay(rule.head) && isVariableAt(rule.head[0], 0))
    {
      result.states_are_complete = true;
    }
    if (!about_holds || rule.head.size() != 1 || !rule.head[0].is_negative ||
        rule.head[0].atom.arguments[1].name != "0" || !isGeneral(rule) ||
        isDefaultWithException(rule, program))
    {
      continue;
    }
    const Term& fluent = rule.head[0].atom.arguments[0];
    if (!fluent.is_variable)
    {
      result.closed_initially.insert(fluent.name);
      continue;
    }
    bool all = true;
    for (const Literal& literal : rule.body)
    {
      const auto found =
          signature.fluents_of.find(literal.atom.name[0] == '#' ? literal.atom.name.substr(1) : "");
      if (found != signature.fluents_of.end())
      {
        all = false;
        result.closed_initially.insert(found->second.begin(), found->second.end());
      }
    }
    for (const auto& [name, sorts] : signature.inertial)
    {
      if (all)
      {
        result.closed_initially.insert(name);
      }
    }
  }
  const bool all_closed = std::all_of(
      signature.inertial.begin(), signature.inertial.end(),
      [&](const auto& fluent) { return result.closed_initially.count(fluent.first) > 0; });
  result.states_are_complete = result.states_are_complete || all_closed;
  return result;
}

}  // namespace kr3::reasoner::sparc
