#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"
#include "search_limit.hpp"
#include "slice.hpp"

namespace kr3::reasoner
{

/// Plans up to this horizon are looked for with the fewest constants that are alike; for longer
/// ones there have to be more.
constexpr int kFirstHorizon = 4;

/// Plans on the part of a description and its history that can matter to a goal; the answer is that
/// of planning on all of it. Private to the package.
///
/// The part is widened when it turns out too small: constants that are alike are few for short
/// plans and more for longer ones, and all are kept where a relevant fluent may have one as its
/// value. What is left out is explained apart, so that an inconsistent history is noticed and the
/// kinds of assumption that it takes are the same.
class RelevantPlanner
{
public:
  /// All must outlive this.
  /// @param beginning  of a history that was progressed, or nullptr
  RelevantPlanner(DomainKnowledge& whole, const std::vector<CheckedRecord>& records,
                  int current_step, const Formula& goal,
                  std::shared_ptr<const Beginning> beginning);

  /// @throws as Reasoner::plan
  [[nodiscard]] PlanResult plan(const PlanOptions& options, const std::atomic<bool>* cancel) const;

private:
  struct Explained;

  /// @param rest  what is explained apart, or nullptr
  [[nodiscard]] Explained explain(Slice slice, const Explained* rest,
                                  const SearchLimit& limit) const;
  [[nodiscard]] bool mayBeSpare(const Explained& explained) const;

  const std::vector<CheckedRecord>& records_;
  int current_step_;
  const ReasonerOptions& options_;
  const Formula& goal_;
  Slicer slicer_;
};

/// @throws InvalidArgument  an option is out of range
void checkPlanOptions(const PlanOptions& options);

}  // namespace kr3::reasoner
