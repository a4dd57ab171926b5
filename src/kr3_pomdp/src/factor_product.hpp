#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/factored_model.hpp"

namespace kr3::pomdp
{

/// Combinations of values of some variables, numbered; the last variable changes fastest.
class Combinations
{
public:
  static constexpr std::size_t kMaxCombinations = std::size_t{1} << 24;

  /// @param what  is counted, for messages
  /// @throws InvalidArgument  a variable without values; ResourceExhausted  too many
  template <typename Variables>
  Combinations(const Variables& variables, const char* what)
  {
    for (const Variable& variable : variables)
    {
      if (variable.values.empty())
      {
        throw InvalidArgument("variable '" + variable.name + "' has no values");
      }
      count_ *= variable.values.size();
      if (count_ > kMaxCombinations)
      {
        throw ResourceExhausted(std::string("more than ") + std::to_string(kMaxCombinations) + " " +
                                what);
      }
    }
    std::size_t stride = count_;
    for (const Variable& variable : variables)
    {
      sizes_.push_back(variable.values.size());
      stride /= variable.values.size();
      strides_.push_back(stride);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t numVariables() const { return sizes_.size(); }
  [[nodiscard]] std::size_t stride(std::size_t variable) const { return strides_[variable]; }
  [[nodiscard]] std::size_t value(std::size_t combination, std::size_t variable) const
  {
    return combination / strides_[variable] % sizes_[variable];
  }

private:
  std::size_t count_ = 1;
  std::vector<std::size_t> sizes_;
  std::vector<std::size_t> strides_;
};

/// The values of all variables at one place of an enumeration.
class Assignment
{
public:
  explicit Assignment(const FactoredModel& model)
    : values_(2 * model.state.size() + model.actions.size() + model.observations.size())
  {
  }

  /// Where a variable's value is.
  [[nodiscard]] static std::size_t slot(const FactoredModel& model, const VariableRef& ref)
  {
    switch (ref.role)
    {
      case VariableRole::kPrevious:
        return ref.index;
      case VariableRole::kCurrent:
        return model.state.size() + ref.index;
      case VariableRole::kAction:
        return 2 * model.state.size() + ref.index;
      default:
        return 2 * model.state.size() + model.actions.size() + ref.index;
    }
  }

  [[nodiscard]] std::size_t operator[](std::size_t slot) const { return values_[slot]; }
  void set(std::size_t slot, std::size_t value)
  {
    values_[slot] = static_cast<std::uint32_t>(value);
  }

private:
  std::vector<std::uint32_t> values_;
};

/// A factor whose probabilities sum to 1, ready to be looked up. The factor must outlive it.
class FactorTable
{
public:
  /// @param sum_tolerance  how far from 1 the probabilities of a row may sum; they are normalised.
  ///                       Rewards are taken as they are
  /// @throws InvalidArgument  a row that is no distribution; the message names it
  FactorTable(const FactoredModel& model, const Factor& factor, double sum_tolerance);

  [[nodiscard]] const std::vector<VariableRef>& of() const { return factor_->of; }

  /// The place of the row for these values of the parents.
  [[nodiscard]] std::size_t row(const Assignment& assignment) const
  {
    std::size_t row = 0;
    for (const Parent& parent : parents_)
    {
      row = row * parent.size + assignment[parent.slot];
    }
    return row;
  }

  /// The only value of a row, of a reward.
  [[nodiscard]] double value(std::size_t row) const { return values()[row]; }

  /// Calls `found(outcome, probability)` for each outcome of a row that is possible.
  template <typename Found>
  void forEach(std::size_t row, const Found& found) const
  {
    if (!starts_.empty())
    {
      for (std::size_t i = starts_[row]; i < starts_[row + 1]; ++i)
      {
        found(entries_[i].index, entries_[i].probability);
      }
      return;
    }
    const double* const values = this->values() + row * num_outcomes_;
    for (std::size_t outcome = 0; outcome < num_outcomes_; ++outcome)
    {
      if (values[outcome] != 0.0)
      {
        found(outcome, values[outcome]);
      }
    }
  }

private:
  struct Parent
  {
    std::size_t slot;
    std::size_t size;
  };

  [[nodiscard]] const double* values() const
  {
    return normalised_.empty() ? factor_->values.data() : normalised_.data();
  }
  void normalise(const FactoredModel& model, double sum_tolerance);
  void makeSparse();

  const Factor* factor_;
  std::size_t num_outcomes_ = 1;
  std::vector<Parent> parents_;
  std::vector<double> normalised_;  // empty: the factor's own values
  // Rows without their zeros, where most entries are zero.
  std::vector<SparseEntry> entries_;
  std::vector<std::size_t> starts_;
};

/// A product of factors: the probabilities of all combinations of some variables.
class Product
{
public:
  /// The factors in an order in which what they depend on comes first.
  ///
  /// @param role  of the variables; each must have just one factor
  /// @throws InvalidArgument  a factor of the wrong shape or whose rows are no distributions, a
  ///                          variable without a factor or with two, or a circle
  Product(const FactoredModel& model, const std::vector<Factor>& factors, VariableRole role,
          const Combinations& combinations, double sum_tolerance);

  /// Calls `found` with the index and the probability of each combination that is possible, with
  /// its values in `assignment`.
  template <typename Found>
  void forEach(Assignment& assignment, const Found& found) const
  {
    descend(0, 1.0, 0, assignment, found);
  }

private:
  struct Outcome
  {
    std::size_t slot;
    std::size_t size;
    std::size_t stride;
  };
  struct Step
  {
    FactorTable table;
    std::vector<Outcome> of;
  };

  template <typename Found>
  void descend(std::size_t depth, double probability, std::size_t combination,
               Assignment& assignment, const Found& found) const
  {
    if (depth == steps_.size())
    {
      found(combination, probability);
      return;
    }
    const Step& step = steps_[depth];
    step.table.forEach(step.table.row(assignment), [&](std::size_t outcome, double p) {
      std::size_t next = combination;
      for (std::size_t i = step.of.size(); i-- > 0;)
      {
        const Outcome& of = step.of[i];
        const std::size_t value = i == 0 ? outcome : outcome % of.size;
        assignment.set(of.slot, value);
        next += value * of.stride;
        outcome = i == 0 ? 0 : outcome / of.size;
      }
      descend(depth + 1, probability * p, next, assignment, found);
    });
  }

  std::vector<Step> steps_;
};

}  // namespace kr3::pomdp
