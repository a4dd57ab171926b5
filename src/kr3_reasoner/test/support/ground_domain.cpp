#include "ground_domain.hpp"

#include <algorithm>

#include <kr3_common/error.hpp>

#include "grounder.hpp"

namespace kr3::reasoner::oracle
{

GroundDomain grounded(const Description& description)
{
  return Grounder(description).run();
}

std::optional<GroundLiteral> literalOf(const Literal& literal, const GroundDomain& domain)
{
  const std::string name = applied(literal.atom, {});
  for (std::size_t i = 0; i < domain.fluents.size(); ++i)
  {
    const GroundFluentInfo& fluent = domain.fluents[i];
    if (fluent.name == name)
    {
      const auto value = std::find(fluent.values.begin(), fluent.values.end(), literal.value.name);
      GroundLiteral result{static_cast<int>(i), static_cast<int>(value - fluent.values.begin()),
                           literal.equal};
      return fluent.boolean && !literal.equal ? GroundLiteral{result.fluent, 1 - result.value, true}
                                              : result;
    }
  }
  return std::nullopt;
}

int actionOf(const std::string& name, const GroundDomain& domain)
{
  const auto found = std::find_if(domain.actions.begin(), domain.actions.end(),
                                  [&](const GroundActionInfo& each) { return each.name == name; });
  if (found == domain.actions.end())
  {
    throw InternalError("unknown action " + name);
  }
  return static_cast<int>(found - domain.actions.begin());
}

bool staticHolds(const Literal& literal, const Description& description, const GroundDomain& domain)
{
  const std::string name = applied(literal.atom, {});
  const FluentDeclaration& fluent = *description.findFluent(literal.atom.name);
  if (!fluent.value_sort)
  {
    return (domain.true_statics.count(name) > 0) ==
           ((literal.value.name == "true") == literal.equal);
  }
  return (domain.true_statics.count(name + " = " + literal.value.name) > 0) == literal.equal;
}

std::string toString(const GroundLiteral& literal, const GroundDomain& domain)
{
  const GroundFluentInfo& fluent = domain.fluents[static_cast<std::size_t>(literal.fluent)];
  const std::string& value = fluent.values[static_cast<std::size_t>(literal.value)];
  if (fluent.boolean)
  {
    return (value == "false" ? "-" : "") + fluent.name;
  }
  return fluent.name + (literal.equal ? " = " : " != ") + value;
}

}  // namespace kr3::reasoner::oracle
