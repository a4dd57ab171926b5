#include "formula_rules.hpp"

#include <vector>

#include "encoding.hpp"
#include "history.hpp"

namespace kr3::reasoner
{

namespace
{

/// The name of the atom for a formula; its rules are added to `rules`.
std::string addFormula(const Formula& formula, const Description& description, int& num_parts,
                       std::string& rules)
{
  std::vector<std::string> operands;
  for (const Formula& operand : formula.operands)
  {
    operands.push_back(addFormula(operand, description, num_parts, rules));
  }
  const std::string name = "part(" + std::to_string(num_parts++) + ",n)";
  if (formula.kind == Formula::Kind::kLiteral)
  {
    rules += name + " :- " +
             Encoding(description).literal(normalized(formula.literal, description), "n") + ".\n";
    return name;
  }
  std::string conjunction;
  for (const std::string& operand : operands)
  {
    if (formula.kind == Formula::Kind::kOr)
    {
      rules += name + " :- " + operand + ".\n";
    }
    conjunction += (conjunction.empty() ? "" : ", ") +
                   std::string(formula.kind == Formula::Kind::kNot ? "not " : "") + operand;
  }
  if (formula.kind != Formula::Kind::kOr)
  {
    rules += name + " :- " + conjunction + ".\n";
  }
  return name;
}

}  // namespace

std::string formulaRules(const Formula& formula, const Description& description,
                         const std::string& root)
{
  std::string rules;
  int num_parts = 0;
  const std::string name = addFormula(formula, description, num_parts, rules);
  return rules + root + " :- " + name + ".\n";
}

}  // namespace kr3::reasoner
