#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "domain_knowledge.hpp"
#include "relevance.hpp"

namespace kr3::reasoner
{

/// A part of a description with its history that answers a question as the whole does. Private to
/// the package.
struct Slice
{
  std::shared_ptr<DomainKnowledge> domain;     ///< shared with earlier slices of the same content
  std::vector<CheckedRecord> records;          ///< first those that say the facts of the beginning
  std::size_t num_facts = 0;                   ///< of the records
  std::shared_ptr<const Beginning> beginning;  ///< of a history that was progressed, or nullptr
  ProblemSize size;

  /// Constants that stand for others like them: nothing tells these apart, and some were left out,
  /// since no plan up to the horizon can use more. Empty when nothing was left out in this way.
  std::vector<std::string> spares;
  std::vector<Literal> relevant;  ///< the relevant fluents, as literals with an empty value
};

/// Cuts slices for a goal out of a description with a history.
class Slicer
{
public:
  /// All must outlive this.
  /// @param beginning  of a history that was progressed, or nullptr
  Slicer(DomainKnowledge& whole, const std::vector<CheckedRecord>& records, int current_step,
         const Formula& goal, std::shared_ptr<const Beginning> beginning = nullptr);

  /// What can matter to the goal.
  /// @param horizon  longest plan that is wanted, for leaving out constants that are all alike;
  ///                 without it none is left out
  [[nodiscard]] Slice forGoal(std::optional<int> horizon, double extra_share) const;

  /// The records that do not matter to the goal and that need an explanation of their own, with
  /// what that can depend on. Nothing when all of them are plain facts.
  [[nodiscard]] std::optional<Slice> forRest() const;

  /// As forGoal, with the reasons.
  [[nodiscard]] RelevantPart report(int horizon) const;

  [[nodiscard]] ProblemSize wholeSize() const { return whole_.size(records_.size() - numFacts()); }

private:
  class Cut;

  [[nodiscard]] std::size_t numFacts() const;
  [[nodiscard]] Slice cutFor(const Relevance& relevance, const std::vector<ConstantId>& extra,
                             std::optional<int> horizon) const;
  [[nodiscard]] std::vector<ConstantId> addShare(Relevance& relevance, double share) const;

  DomainKnowledge& whole_;
  const GroundRules& rules_;
  std::shared_ptr<const Beginning> beginning_;
  std::vector<CheckedRecord> with_facts_;  // empty without a beginning
  const std::vector<CheckedRecord>& records_;
  int current_step_;
  const Formula& goal_;
  Relevance relevance_;  // of the goal
};

}  // namespace kr3::reasoner
