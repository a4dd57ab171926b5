// Semantics: laws that rest on a value outside the zoom.

#include <utility>
#include <variant>

#include "semantics.hpp"

namespace kr3::refinement
{
namespace
{

constexpr int kNone = Vocabulary::kNone;

}  // namespace

void Semantics::addMentioned(const std::vector<CompiledCondition>& body,
                             std::set<std::size_t>& symbols) const
{
  for (const CompiledCondition& condition : body)
  {
    const auto* literal = std::get_if<CompiledLiteral>(&condition);
    if (literal == nullptr || !symbols.insert(literal->symbol).second)
    {
      continue;
    }
    for (const CompiledConstraint& definition : definitions_)
    {
      if (definition.head->symbol == literal->symbol)
      {
        addMentioned(definition.body, symbols);
      }
    }
  }
}

std::vector<Values> Semantics::told(const Values& state, const GroundAction& action) const
{
  std::vector<Values> result{state};
  const auto mentioned = mentioned_.find(action.symbol);
  for (std::size_t fluent = 0; fluent < signature_.numInertial(); ++fluent)
  {
    if (!signature_.isElsewhere(state[fluent]) || mentioned == mentioned_.end() ||
        mentioned->second.count(fluents()[fluent].symbol) == 0)
    {
      continue;
    }
    const Symbol& symbol = signature_.symbols()[fluents()[fluent].symbol];
    const ConstantSet outside = symbol.full_value_sort->without(*symbol.value_sort);
    std::vector<Values> longer;
    for (const Values& values : result)
    {
      for (const int value : outside.elements())
      {
        longer.push_back(values);
        longer.back()[fluent] = value;
      }
    }
    result = longer.empty() ? std::move(result) : std::move(longer);
  }
  return result;
}

bool Semantics::hide(Values& state) const
{
  bool hidden = false;
  for (std::size_t fluent = 0; fluent < signature_.numInertial(); ++fluent)
  {
    if (state[fluent] == kNone || isValue(fluent, state[fluent]))
    {
      continue;
    }
    if (!isValue(fluent, signature_.elsewhere()))
    {
      return false;
    }
    state[fluent] = signature_.elsewhere();
    hidden = true;
  }
  return !hidden || complete(state);
}

std::vector<Result> Semantics::results(const Values& state, const GroundAction& action) const
{
  if (signature_.elsewhere() == kNone)
  {
    return resultsWhenTold(state, action);
  }
  std::vector<Result> results;
  double num_possible = 0.0;
  for (Values& values : told(state, action))
  {
    if (values != state && !complete(values))
    {
      continue;
    }
    num_possible += 1.0;
    for (Result& result : resultsWhenTold(values, action))
    {
      if (!result.outside && !hide(result.values))
      {
        result.outside = true;
        result.values.clear();
      }
      results.push_back(std::move(result));
    }
  }
  for (Result& result : results)
  {
    result.share /= num_possible;
  }
  return results;
}

}  // namespace kr3::refinement
