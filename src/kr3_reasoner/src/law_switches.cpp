#include "law_switches.hpp"

namespace kr3::reasoner
{

namespace
{

// Names that the language does not allow.
const char* const kSwitch = "_law";
const char* const kSwitchSort = "_laws";

void guard(Body& body, std::size_t law)
{
  if (law != kNoLaw)
  {
    Literal literal;
    literal.atom.name = kSwitch;
    literal.atom.arguments = {{false, std::to_string(law)}};
    literal.value = {false, "true"};
    body.emplace_back(std::move(literal));
  }
}

}  // namespace

Description switchable(const Description& description, const Laws& laws)
{
  Description result = description;
  Sort numbers;
  numbers.name = kSwitchSort;
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    numbers.elements.push_back(std::to_string(i));
  }
  result.sorts.push_back(std::move(numbers));
  FluentDeclaration fluent;
  fluent.name = kSwitch;
  fluent.kind = FluentKind::kStatic;
  fluent.argument_sorts = {kSwitchSort};
  result.fluents.push_back(std::move(fluent));
  for (std::size_t i = 0; i < result.causal_laws.size(); ++i)
  {
    guard(result.causal_laws[i].body, laws.ofCausalLaw(i));
  }
  for (std::size_t i = 0; i < result.constraints.size(); ++i)
  {
    guard(result.constraints[i].body, laws.ofConstraint(i));
  }
  for (std::size_t i = 0; i < result.executabilities.size(); ++i)
  {
    guard(result.executabilities[i].body, laws.ofExecutability(i));
  }
  return result;
}

std::string lawSwitches()
{
  return std::string("#external st(") + kSwitch + "(_N),true) : sort(" + kSwitchSort + ",_N).\n";
}

std::string openDefinitions(const Description& description, const Laws& laws)
{
  std::string text;
  for (const FluentDeclaration& fluent : description.fluents)
  {
    const std::size_t law =
        fluent.kind == FluentKind::kDefined ? laws.ofDefinition(fluent.name) : kNoLaw;
    if (law == kNoLaw)
    {
      continue;
    }
    std::string term = fluent.name;
    for (std::size_t i = 0; i < fluent.argument_sorts.size(); ++i)
    {
      term += (i == 0 ? "(_X" : ",_X") + std::to_string(i);
    }
    term += fluent.argument_sorts.empty() ? "" : ")";
    text += "{ h(" + term + ",true,_t) } :- defined(" + term + "), not st(" + kSwitch + "(" +
            std::to_string(law) + "),true).\n";
  }
  return text;
}

Clingo::Symbol switchOf(std::size_t law)
{
  return Clingo::Function("st", {Clingo::Function(kSwitch, {Clingo::Number(static_cast<int>(law))}),
                                 Clingo::Id("true")});
}

}  // namespace kr3::reasoner
