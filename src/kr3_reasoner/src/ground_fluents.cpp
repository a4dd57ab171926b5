#include "ground_fluents.hpp"

namespace kr3::reasoner
{

std::vector<std::vector<std::string>> argumentTuples(const std::vector<std::string>& sorts,
                                                     const Description& description)
{
  std::vector<std::vector<std::string>> tuples = {{}};
  for (const std::string& sort : sorts)
  {
    std::vector<std::vector<std::string>> longer;
    for (const auto& tuple : tuples)
    {
      for (const std::string& element : description.findSort(sort)->elements)
      {
        longer.push_back(tuple);
        longer.back().push_back(element);
      }
    }
    tuples = std::move(longer);
  }
  return tuples;
}

std::string groundName(const std::string& symbol, const std::vector<std::string>& arguments)
{
  Atom atom;
  atom.name = symbol;
  for (const std::string& argument : arguments)
  {
    atom.arguments.push_back({false, argument});
  }
  return toString(atom);
}

std::vector<GroundFluent> groundFluents(const Description& description)
{
  std::vector<GroundFluent> fluents;
  for (const FluentDeclaration& declared : description.fluents)
  {
    if (declared.kind == FluentKind::kStatic)
    {
      continue;
    }
    const std::vector<std::string> values =
        declared.value_sort ? description.findSort(*declared.value_sort)->elements
                            : std::vector<std::string>{"false", "true"};
    if (values.empty())
    {
      continue;
    }
    for (const auto& arguments : argumentTuples(declared.argument_sorts, description))
    {
      fluents.push_back(
          {groundName(declared.name, arguments), declared.name, arguments, values, declared.kind});
    }
  }
  return fluents;
}

std::vector<std::string> groundActions(const ActionDeclaration& action,
                                       const Description& description)
{
  std::vector<std::string> actions;
  for (const auto& arguments : argumentTuples(action.argument_sorts, description))
  {
    actions.push_back(groundName(action.name, arguments));
  }
  return actions;
}

Literal literalOf(const GroundFluent& fluent, const std::string& value)
{
  Literal literal;
  literal.atom.name = fluent.symbol;
  for (const std::string& argument : fluent.arguments)
  {
    literal.atom.arguments.push_back({false, argument});
  }
  literal.value.name = value;
  return literal;
}

}  // namespace kr3::reasoner
