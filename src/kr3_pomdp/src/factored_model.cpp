#include "kr3_pomdp/factored_model.hpp"

#include <string>

#include <kr3_common/error.hpp>

#include "flattening.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxFactorSize = std::size_t{1} << 27;

}  // namespace

const Variable& FactoredModel::variable(const VariableRef& ref) const
{
  switch (ref.role)
  {
    case VariableRole::kAction:
      return actions.at(ref.index);
    case VariableRole::kObservation:
      return observations.at(ref.index);
    default:
      return state.at(ref.index);
  }
}

std::size_t FactoredModel::sizeOf(const Factor& factor) const
{
  std::size_t size = 1;
  for (const std::vector<VariableRef>* refs : {&factor.parents, &factor.of})
  {
    for (const VariableRef& ref : *refs)
    {
      size *= variable(ref).values.size();
      if (size > kMaxFactorSize)
      {
        throw ResourceExhausted("a factor with more than " + std::to_string(kMaxFactorSize) +
                                " entries");
      }
    }
  }
  return size;
}

Model FactoredModel::flattened(double sum_tolerance) const
{
  if (state.empty() || actions.empty())
  {
    throw InvalidArgument("a factored model needs a state variable and an action variable");
  }
  return Model(pomdp::flattened(*this, sum_tolerance));
}

}  // namespace kr3::pomdp
