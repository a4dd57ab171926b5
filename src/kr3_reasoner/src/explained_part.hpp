#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "explain.hpp"
#include "slice.hpp"

namespace kr3::reasoner
{

/// Explains in the part of a description and its history that can matter to a literal. What is
/// cited suffices and is minimal there, and so it is in the whole, from which everything else is
/// taken away. Private to the package.
class ExplainedPart
{
public:
  /// @param whole  the whole description; its options must outlive this object
  ExplainedPart(DomainKnowledge& whole, const std::vector<CheckedRecord>& records, int current_step,
                const Literal& literal, const SearchLimit& limit);

  /// Nothing when the part does not entail the literal by itself: other records decide which
  /// assumptions are tried.
  [[nodiscard]] std::optional<Explanation> explain(const Literal& literal, int step,
                                                   const Laws& whole);

private:
  int current_step_;
  SearchLimit limit_;
  Slice slice_;
  std::vector<std::size_t> record_numbers_;  // in the whole history
  Description description_;
  HistoryProgram program_;
  Instances instances_;
  HistoryCheck check_;
};

}  // namespace kr3::reasoner
