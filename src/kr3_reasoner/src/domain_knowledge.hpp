#pragma once

#include <memory>

#include "ground_rules.hpp"
#include "history_program.hpp"
#include "instances.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "plan_program_store.hpp"
#include "progression.hpp"
#include "slice_store.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// What is made of a description, or of a slice of one, once and kept while the history grows; the
/// reasoners that a reasoner supposes have it in common. All of it is made when it is first asked
/// for. Private to the package; not thread-safe.
class DomainKnowledge
{
public:
  /// @throws InvalidArgument  a price below 1, or another option out of range
  DomainKnowledge(Description description, const ReasonerOptions& options);
  DomainKnowledge(const DomainKnowledge&) = delete;
  DomainKnowledge& operator=(const DomainKnowledge&) = delete;

  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const ReasonerOptions& options() const { return program_.options(); }
  [[nodiscard]] const Symbols& symbols() const { return symbols_; }
  [[nodiscard]] const HistoryProgram& program() const { return program_; }
  /// Limits what is made, until another limit is given.
  void limitTo(const SearchLimit& limit) { program_.limitTo(limit); }
  [[nodiscard]] const Instances& instances();

  /// A question being answered: what it does ends with its limit. A question that is asked to
  /// answer another one ends with that.
  class Question
  {
  public:
    /// @param name    for messages, "diagnosis"; a literal
    Question(DomainKnowledge& knowledge, const Limits& limits, const char* name);
    ~Question();
    Question(const Question&) = delete;
    Question& operator=(const Question&) = delete;

  private:
    DomainKnowledge& knowledge_;
  };

  [[nodiscard]] const GroundRules& groundRules();

  /// Of the description with so many records.
  [[nodiscard]] ProblemSize size(std::size_t num_records);

  [[nodiscard]] SliceStore& slices() { return slices_; }
  [[nodiscard]] PlanProgramStore& plans() { return plans_; }
  [[nodiscard]] Progression& progression() { return progression_; }

private:
  const Description description_;
  Symbols symbols_;
  HistoryProgram program_;
  std::unique_ptr<Instances> instances_;
  std::unique_ptr<GroundRules> ground_rules_;
  int num_questions_ = 0;  // that are being answered, one within the other
  std::unique_ptr<ProblemSize> size_;
  Progression progression_;
  SliceStore slices_;
  PlanProgramStore plans_;  // the last: they refer to the others
};

/// Ground fluents, constants and actions of a description.
[[nodiscard]] ProblemSize sizeOf(const Description& description);

}  // namespace kr3::reasoner
