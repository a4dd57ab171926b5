#include "sparc_terms.hpp"

#include <vector>

#include "print_text.hpp"

namespace kr3::reasoner::sparc
{

bool isAtom(const Literal& literal, const std::string& name, std::size_t arity)
{
  return literal.relation.empty() && literal.atom.name == name &&
         literal.atom.arguments.size() == arity;
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
