#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace kr3::refinement
{

/// Outcomes in contexts, from which the part of the context is found on which the outcome depends.
/// An outcome is a distribution (or one number, such as a reward).
class Dependence
{
public:
  using Context = std::vector<std::uint32_t>;
  using Outcome = std::vector<double>;

  /// @param width  of a context
  explicit Dependence(std::size_t width) : width_(width) {}

  /// The same context may be added again with the same outcome (within 1e-12).
  void add(const Context& context, const Outcome& outcome);

  /// Columns of the context that determine the outcome, ascending: none can be left out.
  /// @param order  columns that may be left out, those to be left out first first
  [[nodiscard]] std::vector<std::size_t> columns(const std::vector<std::size_t>& order) const;

  /// Calls `found(context restricted to columns, outcome)` once for each such context.
  /// @param columns  as given by columns()
  template <typename Found>
  void forEach(const std::vector<std::size_t>& columns, const Found& found) const
  {
    for (const std::size_t row : representatives(columns))
    {
      Context context;
      for (const std::size_t column : columns)
      {
        context.push_back(contexts_[row * width_ + column]);
      }
      found(context, outcomes_[outcome_of_[row]]);
    }
  }

private:
  /// Numbers rows such that rows equal in the columns have the same number.
  [[nodiscard]] std::vector<std::uint32_t> grouped(const std::vector<std::size_t>& rows,
                                                   const std::vector<std::size_t>& columns) const;
  [[nodiscard]] bool determined(const std::vector<std::size_t>& rows,
                                const std::vector<std::size_t>& columns) const;
  /// The first row of each group.
  [[nodiscard]] std::vector<std::size_t> representatives(
      const std::vector<std::size_t>& columns) const;
  [[nodiscard]] std::vector<std::size_t> firstOfEach(const std::vector<std::size_t>& rows,
                                                     const std::vector<std::size_t>& columns) const;

  std::size_t width_;
  std::vector<std::uint32_t> contexts_;    // row-major, shape [rows, width]
  std::vector<std::uint32_t> outcome_of_;  // shape [rows]
  std::vector<Outcome> outcomes_;
  std::map<std::vector<double>, std::uint32_t> outcome_numbers_;  // by rounded entries
};

}  // namespace kr3::refinement
