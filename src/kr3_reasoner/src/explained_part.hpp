#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "explain.hpp"
#include "slice.hpp"

namespace kr3::reasoner
{

/// Explains in the part of a description and its history that can matter to some fluents. What is
/// cited suffices and is minimal there, and so it is in the whole, from which everything else is
/// taken away. Private to the package.
class ExplainedPart
{
public:
  /// @param whole  the whole description; its options must outlive this object
  /// @param about  what is to be explained
  ExplainedPart(DomainKnowledge& whole, const std::vector<CheckedRecord>& records, int current_step,
                const std::vector<Literal>& about, const SearchLimit& limit);

  /// Nothing when the part does not entail the literal by itself: other records decide which
  /// assumptions are tried.
  [[nodiscard]] std::optional<Explanation> explain(const Literal& literal, int step,
                                                   const Laws& whole);

  /// As Explainer::justify; all that is assumed is about what this part was made for.
  void justify(ExplanationAlternative& alternative, const std::vector<Clingo::Symbol>& assumed,
               const std::vector<bool>& known);

private:
  int current_step_;
  SearchLimit limit_;
  Slice slice_;
  std::vector<std::size_t> record_numbers_;  // in the whole history
  Description description_;
  HistoryProgram program_;
  Instances instances_;
  std::unique_ptr<HistoryCheck> check_;  // made when it is first asked for
};

}  // namespace kr3::reasoner
