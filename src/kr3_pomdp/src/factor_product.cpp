#include "factor_product.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kr3::pomdp
{

namespace
{

std::string described(const FactoredModel& model, const Factor& factor)
{
  std::string text;
  for (const VariableRef& ref : factor.of)
  {
    text += (text.empty() ? "" : ", ") + model.variable(ref).name;
  }
  return "P(" + text + " | ...)";
}

/// Which rows hold no distribution, in words: the values of the parents.
std::string rowNamed(const FactoredModel& model, const Factor& factor, std::size_t row)
{
  std::string text;
  for (auto parent = factor.parents.rbegin(); parent != factor.parents.rend(); ++parent)
  {
    const Variable& variable = model.variable(*parent);
    text =
        (std::string(parent->role == VariableRole::kCurrent ? "next " : "") + variable.name + " = ")
            .append(variable.values[row % variable.values.size()])
            .append(text.empty() ? "" : ", ")
            .append(text);
    row /= variable.values.size();
  }
  return text;
}

/// Which factor gives each variable of a role, in an order in which what they depend on comes
/// first.
std::vector<const Factor*> ordered(const FactoredModel& model, const std::vector<Factor>& factors,
                                   VariableRole role, std::size_t num_variables)
{
  std::vector<int> defined(num_variables, 0);
  for (const Factor& factor : factors)
  {
    if (factor.values.size() != model.sizeOf(factor))
    {
      throw InvalidArgument(described(model, factor) + " has " +
                            std::to_string(factor.values.size()) + " entries, expected " +
                            std::to_string(model.sizeOf(factor)));
    }
    for (const VariableRef& ref : factor.of)
    {
      if (ref.role != role || ++defined.at(ref.index) > 1)
      {
        throw InvalidArgument(described(model, factor) + ": '" + model.variable(ref).name +
                              "' has another factor already, or none of this kind");
      }
    }
  }
  for (std::size_t i = 0; i < num_variables; ++i)
  {
    if (defined[i] == 0)
    {
      throw InvalidArgument("no probabilities are given for '" + model.variable({role, i}).name +
                            "'");
    }
  }
  std::vector<const Factor*> result;
  std::vector<bool> known(num_variables, false);
  std::vector<bool> taken(factors.size(), false);
  for (bool progress = true; progress;)
  {
    progress = false;
    for (std::size_t f = 0; f < factors.size(); ++f)
    {
      const auto ready = [&](const VariableRef& ref) {
        return ref.role != role || known[ref.index];
      };
      if (taken[f] || !std::all_of(factors[f].parents.begin(), factors[f].parents.end(), ready))
      {
        continue;
      }
      taken[f] = true;
      progress = true;
      for (const VariableRef& ref : factors[f].of)
      {
        known[ref.index] = true;
      }
      result.push_back(&factors[f]);
    }
  }
  if (result.size() != factors.size())
  {
    const auto f =
        static_cast<std::size_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
    throw InvalidArgument(described(model, factors[f]) + " depends on itself");
  }
  return result;
}

}  // namespace

FactorTable::FactorTable(const FactoredModel& model, const Factor& factor, double sum_tolerance)
  : factor_(&factor)
{
  for (const VariableRef& of : factor.of)
  {
    num_outcomes_ *= model.variable(of).values.size();
  }
  for (const VariableRef& parent : factor.parents)
  {
    parents_.push_back({Assignment::slot(model, parent), model.variable(parent).values.size()});
  }
  if (!factor.of.empty())
  {
    normalise(model, sum_tolerance);
    makeSparse();
  }
}

void FactorTable::normalise(const FactoredModel& model, double sum_tolerance)
{
  const std::vector<double>& values = factor_->values;
  for (std::size_t start = 0; start < values.size(); start += num_outcomes_)
  {
    double sum = 0.0;
    bool valid = true;
    for (std::size_t i = start; i < start + num_outcomes_; ++i)
    {
      valid = valid && values[i] >= 0.0;
      sum += values[i];
    }
    if (!valid || !(std::abs(sum - 1.0) <= sum_tolerance))
    {
      const std::string given = rowNamed(model, *factor_, start / num_outcomes_);
      throw InvalidArgument(described(model, *factor_) + (given.empty() ? "" : " given " + given) +
                            " sums to " + std::to_string(sum) +
                            (valid ? "" : " and has a negative entry") + ", expected 1");
    }
    if (std::abs(sum - 1.0) > 1e-12)  // keep what is exact to the last bits
    {
      if (normalised_.empty())
      {
        normalised_ = values;
      }
      for (std::size_t i = start; i < start + num_outcomes_; ++i)
      {
        normalised_[i] /= sum;
      }
    }
  }
}

void FactorTable::makeSparse()
{
  const std::size_t size = factor_->values.size();
  const double* const values = this->values();
  const auto num_zeros = static_cast<std::size_t>(std::count(values, values + size, 0.0));
  if (num_outcomes_ <= 4 || 2 * num_zeros < size)
  {
    return;
  }
  entries_.reserve(size - num_zeros);
  starts_.reserve(size / num_outcomes_ + 1);
  starts_.push_back(0);
  for (std::size_t start = 0; start < size; start += num_outcomes_)
  {
    for (std::size_t outcome = 0; outcome < num_outcomes_; ++outcome)
    {
      if (values[start + outcome] != 0.0)
      {
        entries_.push_back({static_cast<std::uint32_t>(outcome), values[start + outcome]});
      }
    }
    starts_.push_back(entries_.size());
  }
}

Product::Product(const FactoredModel& model, const std::vector<Factor>& factors, VariableRole role,
                 const Combinations& combinations, double sum_tolerance)
{
  for (const Factor* factor : ordered(model, factors, role, combinations.numVariables()))
  {
    Step step{FactorTable(model, *factor, sum_tolerance), {}};
    for (const VariableRef& ref : factor->of)
    {
      step.of.push_back({Assignment::slot(model, ref), model.variable(ref).values.size(),
                         combinations.stride(ref.index)});
    }
    steps_.push_back(std::move(step));
  }
}

}  // namespace kr3::pomdp
