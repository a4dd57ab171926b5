#include "state_view.hpp"

#include <cctype>
#include <optional>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{

Values valuesOf(const Semantics& semantics, const std::vector<reasoner::Literal>& state)
{
  const std::vector<PhysicalFluent>& fluents = semantics.fluents();
  const Signature& signature = semantics.signature();
  Values values(fluents.size(), Vocabulary::kNone);
  for (std::size_t i = 0; i < signature.numInertial(); ++i)
  {
    if (signature.symbols()[fluents[i].symbol].boolean)
    {
      values[i] = signature.falseValue();
    }
  }
  std::vector<bool> listed(fluents.size(), false);
  for (const reasoner::Literal& literal : state)
  {
    const std::optional<std::size_t> fluent =
        signature.findFluent(reasoner::toString(literal.atom));
    if (!literal.equal || !fluent || *fluent >= signature.numInertial())
    {
      continue;  // what follows from the rest, or says less than a value
    }
    const int value = signature.vocabulary().find(literal.value.name);
    if (value == Vocabulary::kNone)
    {
      throw InvalidArgument("'" + reasoner::toString(literal) + "' in the state: unknown value '" +
                            literal.value.name + "'");
    }
    if (listed[*fluent] && values[*fluent] != value)
    {
      throw InvalidArgument("the state gives " + fluents[*fluent].name + " two values, '" +
                            signature.vocabulary().name(values[*fluent]) + "' and '" +
                            literal.value.name + "'");
    }
    listed[*fluent] = true;
    values[*fluent] = value;
  }
  return values;
}

reasoner::Literal literalOf(const Semantics& semantics, std::size_t fluent, int value)
{
  const PhysicalFluent& physical = semantics.fluents()[fluent];
  reasoner::Literal literal;
  literal.atom.name = semantics.signature().symbols()[physical.symbol].name;
  for (const int argument : physical.arguments)
  {
    literal.atom.arguments.push_back({false, semantics.vocabulary().name(argument)});
  }
  literal.value = {false, semantics.vocabulary().name(value)};
  return literal;
}

std::string normalised(const std::string& fluent)
{
  std::string result;
  for (const char c : fluent)
  {
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
    {
      result += c;
      result += c == ',' ? " " : "";
    }
  }
  return result;
}

}  // namespace kr3::refinement
