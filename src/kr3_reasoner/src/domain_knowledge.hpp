#pragma once

#include <memory>

#include "ground_rules.hpp"
#include "history_program.hpp"
#include "instances.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// What a reasoner makes of its description once and keeps while the history grows; the reasoners
/// that it supposes have it in common. Private to the package; not thread-safe.
class DomainKnowledge
{
public:
  /// @throws InvalidArgument  a price below 1
  DomainKnowledge(Description description, const ReasonerOptions& options);

  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const ReasonerOptions& options() const { return program_.options(); }
  [[nodiscard]] const Symbols& symbols() const { return symbols_; }
  [[nodiscard]] const HistoryProgram& program() const { return program_; }
  [[nodiscard]] const Instances& instances() const { return instances_; }

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

  /// Made when it is first asked for.
  [[nodiscard]] const GroundRules& groundRules();

private:
  const Description description_;
  Symbols symbols_;
  HistoryProgram program_;
  Instances instances_;
  std::unique_ptr<GroundRules> ground_rules_;
  int num_questions_ = 0;  // that are being answered, one within the other
};

}  // namespace kr3::reasoner
