#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include <kr3_pomdp/factored_model.hpp>

#include "dependence.hpp"

namespace kr3::refinement
{

/// All probability on one of `count` values.
[[nodiscard]] inline Dependence::Outcome certain(std::size_t value, std::size_t count)
{
  Dependence::Outcome outcome(count, 0.0);
  outcome[value] = 1.0;
  return outcome;
}

/// Writes the rows of a factor's table: a row for each combination of its parents' values.
class FactorTable
{
public:
  FactorTable(const pomdp::FactoredModel& model, std::vector<pomdp::VariableRef> parents,
              std::vector<pomdp::VariableRef> of)
    : factor_{std::move(parents), std::move(of), {}}
  {
    factor_.values.assign(model.sizeOf(factor_), 0.0);
    for (const pomdp::VariableRef& parent : factor_.parents)
    {
      sizes_.push_back(model.variable(parent).values.size());
    }
    row_size_ = factor_.of.empty() ? 1 : model.variable(factor_.of.front()).values.size();
  }

  /// Sets all rows. @param outcome  of the values of the parents
  template <typename OutcomeOf>
  void fill(const OutcomeOf& outcome)
  {
    const std::size_t rows =
        std::accumulate(sizes_.begin(), sizes_.end(), std::size_t{1}, std::multiplies<>());
    Dependence::Context context(sizes_.size(), 0);
    for (std::size_t row = 0; row < rows; ++row)
    {
      set(context, outcome(context));
      for (std::size_t i = sizes_.size(); i-- > 0;)
      {
        context[i] = context[i] + 1 < sizes_[i] ? context[i] + 1 : 0;
        if (context[i] != 0)
        {
          break;
        }
      }
    }
  }

  void set(const Dependence::Context& context, const Dependence::Outcome& outcome)
  {
    std::size_t row = 0;
    for (std::size_t i = 0; i < sizes_.size(); ++i)
    {
      row = row * sizes_[i] + context[i];
    }
    std::copy(outcome.begin(), outcome.end(),
              factor_.values.begin() + static_cast<std::ptrdiff_t>(row * row_size_));
  }

  [[nodiscard]] pomdp::Factor take() && { return std::move(factor_); }

private:
  pomdp::Factor factor_;
  std::vector<std::size_t> sizes_;
  std::size_t row_size_;
};

}  // namespace kr3::refinement
