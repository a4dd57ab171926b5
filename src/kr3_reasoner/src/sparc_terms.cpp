#include "sparc_terms.hpp"

#include <set>
#include <vector>

#include "print_text.hpp"

namespace kr3::reasoner::sparc
{

bool isAtom(const Literal& literal, const std::string& name, std::size_t arity)
{
  return literal.relation.empty() && literal.atom.name == name &&
         literal.atom.arguments.size() == arity;
}

bool isAbnormality(const std::string& name)
{
  return name.rfind("ab", 0) == 0 &&
         (name.size() == 2 || name[2] == '_' || (name[2] >= '0' && name[2] <= '9'));
}

std::string closedFluent(const Rule& rule)
{
  if (rule.head.size() != 1 || rule.body.size() != 1 || !isAtom(rule.head[0], "holds", 2) ||
      !rule.head[0].is_negative || rule.body[0].is_negative || !rule.body[0].is_default_negated ||
      !(rule.head[0].atom == rule.body[0].atom))
  {
    return "";
  }
  const std::vector<Term>& arguments = rule.head[0].atom.arguments;
  std::set<std::string> variables;
  for (const Term& argument : arguments[0].arguments)
  {
    if (!argument.is_variable || !variables.insert(argument.name).second)
    {
      return "";
    }
  }
  return arguments[0].is_variable || !arguments[1].is_variable ? "" : arguments[0].name;
}

std::string text(const Term& term)
{
  if (term.name == "+" || (term.name == "-" && !term.arguments.empty()))
  {
    throw Refusal{"found arithmetic, expected it in steps only"};
  }
  std::vector<std::string> arguments;
  for (const Term& argument : term.arguments)
  {
    if (!argument.arguments.empty() && argument.name != "+" && argument.name != "-")
    {
      throw Refusal{"found the nested term " + argument.name +
                    "(...), expected constants and variables"};
    }
    arguments.push_back(text(argument));
  }
  return arguments.empty() ? term.name : term.name + "(" + joined(arguments, ", ") + ")";
}

Step stepOf(const Term& term)
{
  if (term.is_variable)
  {
    return {term.name, false, false};
  }
  if (term.name == "+" && term.arguments[0].is_variable && term.arguments[1].name == "1")
  {
    return {term.arguments[0].name, true, false};
  }
  if (term.name == "0" && term.arguments.empty())
  {
    return {"", false, true};
  }
  throw Refusal{"found a step that is not I, I+1 or 0"};
}

}  // namespace kr3::reasoner::sparc
