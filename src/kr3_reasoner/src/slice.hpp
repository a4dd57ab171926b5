#pragma once

#include <optional>
#include <vector>

#include "relevance.hpp"

namespace kr3::reasoner
{

/// A part of a description with its history that answers a question as the whole does. Private to
/// the package.
struct Slice
{
  Description description;
  std::vector<CheckedRecord> records;
  ProblemSize size;

  /// Constants that stand for others like them: nothing tells these apart, and some were left out,
  /// since no plan up to the horizon can use more. Empty when nothing was left out in this way.
  std::vector<std::string> spares;
  std::vector<Literal> relevant;  ///< the relevant fluents, as literals with an empty value
};

/// Cuts slices out of a description with a history.
class Slicer
{
public:
  /// All must outlive this.
  Slicer(const GroundRules& rules, const std::vector<CheckedRecord>& records, int current_step);

  /// What can matter to a goal.
  /// @param horizon  longest plan that is wanted, for leaving out constants that are all alike;
  ///                 without it none is left out
  [[nodiscard]] Slice forGoal(const Formula& goal, std::optional<int> horizon,
                              double extra_share) const;

  /// The records that the last call of forGoal left out and that need an explanation of their own,
  /// with what that can depend on. Nothing when all of them are plain facts.
  [[nodiscard]] std::optional<Slice> forRest(const Formula& goal) const;

  /// As forGoal, with the reasons.
  [[nodiscard]] RelevantPart report(const Formula& goal, int horizon) const;

  [[nodiscard]] ProblemSize wholeSize() const;

private:
  class Cut;

  [[nodiscard]] Relevance relevanceOf(const Formula& goal) const;
  [[nodiscard]] std::vector<ConstantId> addShare(Relevance& relevance, const Formula& goal,
                                                 double share) const;

  const GroundRules& rules_;
  const std::vector<CheckedRecord>& records_;
  int current_step_;
};

/// Ground fluents, constants, actions and records.
[[nodiscard]] ProblemSize sizeOf(const Description& description, std::size_t num_records);

}  // namespace kr3::reasoner
