#include "sparc_bodies.hpp"

#include <algorithm>

#include "print_text.hpp"

namespace kr3::reasoner::sparc
{

bool BodyWriter::isStatic(const Literal& literal) const
{
  return literal.relation.empty() && signature_.static_names.count(literal.atom.name) > 0;
}

std::vector<std::string> BodyWriter::conditions(const Rule& rule, const Step& step) const
{
  std::vector<std::string> result;
  for (const Literal& literal : rule.body)
  {
    if (literal.is_default_negated && !isDecided(literal))
    {
      throw Refusal{
          "found 'not', expected it in closed worlds and inertia, or a program whose initial "
          "state is complete"};
    }
    const std::string& name = literal.atom.name;
    if (!literal.relation.empty())
    {
      const bool about_step = literal.atom.name == step.base || literal.right.name == step.base;
      if (!about_step)  // I < n bounds the steps, which KR3 does itself
      {
        result.push_back(text(literal.atom) + " " + literal.relation + " " + text(literal.right));
      }
    }
    else if (name[0] == '#')
    {
      if (literal.atom.arguments.size() != 1)
      {
        throw Refusal{"found the sort " + name + " without its argument"};
      }
      if (signature_.action_sorts.count(name.substr(1)) > 0)
      {
        continue;  // variables for actions stand for those of the agent
      }
      if (name.substr(1) != signature_.step_sort)
      {
        result.push_back(name.substr(1) + "(" + text(literal.atom.arguments[0]) + ")");
      }
    }
    else if (isAtom(literal, "holds", 2))
    {
      const Step here = stepOf(literal.atom.arguments[1]);
      if (here.base != step.base || here.next)
      {
        throw Refusal{"found holds at another step, expected all conditions at " +
                      (step.initial ? "step 0" : step.base)};
      }
      result.push_back((literal.is_negative != literal.is_default_negated ? "-" : "") +
                       fluentText(literal));
      addUnequal(literal, result);
    }
    else if (isStatic(literal))
    {
      result.push_back((literal.is_negative != literal.is_default_negated ? "-" : "") +
                       text(literal.atom));
    }
    else if (!isAtom(literal, "occurs", 2))
    {
      throw Refusal{"found " + name + " in a body, expected holds, occurs, a sort or a static"};
    }
  }
  return result;
}

bool BodyWriter::isDecided(const Literal& literal) const
{
  return isStatic(literal) || (isAtom(literal, "holds", 2) &&
                               (completeness_.states_are_complete ||
                                signature_.defined.count(literal.atom.arguments[0].name) > 0));
}

void BodyWriter::addUnequal(const Literal& literal, std::vector<std::string>& conditions) const
{
  const Term& fluent = literal.atom.arguments[0];
  const auto found = signature_.unequal.find(fluent.name);
  if (found != signature_.unequal.end() && found->second.first < fluent.arguments.size() &&
      found->second.second < fluent.arguments.size())
  {
    const std::string condition = text(fluent.arguments[found->second.first]) +
                                  " != " + text(fluent.arguments[found->second.second]);
    if (std::find(conditions.begin(), conditions.end(), condition) == conditions.end())
    {
      conditions.push_back(condition);
    }
  }
}

std::string fluentText(const Literal& literal)
{
  const Term& fluent = literal.atom.arguments[0];
  if (fluent.is_variable)
  {
    throw Refusal{"found the variable " + fluent.name +
                  " for a fluent, expected it in closed worlds and inertia only"};
  }
  return text(fluent);
}

std::string ifText(const std::vector<std::string>& body)
{
  return body.empty() ? "" : " if " + joined(body, ", ");
}

}  // namespace kr3::reasoner::sparc
