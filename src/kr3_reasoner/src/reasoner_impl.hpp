#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "domain_knowledge.hpp"
#include "entailment_check.hpp"
#include "ground_fluents.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "models.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

/// A history with what has been found out about it. Private to the package.
class Reasoner::Impl
{
public:
  /// @param beginning  nullptr: step 0
  Impl(std::shared_ptr<DomainKnowledge> knowledge, int least_step,
       std::shared_ptr<const Beginning> beginning = nullptr);

  [[nodiscard]] const std::shared_ptr<DomainKnowledge>& knowledge() const { return knowledge_; }
  [[nodiscard]] const Description& description() const { return knowledge_->description(); }
  [[nodiscard]] const ReasonerOptions& options() const { return knowledge_->options(); }
  [[nodiscard]] const HistoryProgram& program() const { return *program_; }
  [[nodiscard]] const std::shared_ptr<const Beginning>& beginning() const { return beginning_; }
  [[nodiscard]] const Symbols& symbols() const { return knowledge_->symbols(); }
  [[nodiscard]] const Instances& instances() const { return knowledge_->instances(); }
  [[nodiscard]] const std::vector<CheckedRecord>& records() const { return records_; }
  [[nodiscard]] const std::vector<Record>& history() const { return history_; }
  [[nodiscard]] int leastStep() const { return least_step_; }
  [[nodiscard]] int currentStep() const;
  [[nodiscard]] Words words() const;

  /// @throws InvalidArgument  it does not fit the description, or is about a step before the first
  [[nodiscard]] CheckedRecord checked(const Record& record, int first_step) const;

  void take(std::vector<CheckedRecord> records);

  [[nodiscard]] const Limits& limits() const { return limits_; }
  void setLimits(const Limits& limits) { limits_ = limits; }

  /// To be kept while a public question is answered. @param name  for messages; a literal
  [[nodiscard]] DomainKnowledge::Question ask(const char* name)
  {
    return {*knowledge_, limits_, name};
  }
  /// The same, with a beginning; nullptr: step 0.
  void begin(std::shared_ptr<const Beginning> beginning, std::vector<CheckedRecord> records);

  void add(const std::vector<Record>& records);

  /// Lets the history begin at a step, or at the latest one before it where that can be
  /// represented, but not before `earliest`.
  Progress progress(int step, int earliest);

  /// Progresses the history when it is longer than ReasonerOptions::window.
  void keepWindow();

  /// The minimal price of the history; nothing when it is inconsistent.
  const std::optional<Optimum>& optimum();
  /// The same of a history that has to be consistent. @throws FailedPrecondition
  const Optimum& requiredOptimum();

  /// @throws InvalidArgument  there is no such step; FailedPrecondition  the history is
  /// inconsistent
  const Consequences& consequences(int step);
  void checkStep(int step) const;

  /// What no record excludes, whatever has to be assumed.
  [[nodiscard]] Consequences atAnyPrice();

  [[nodiscard]] std::string conflictText(const std::vector<std::size_t>& conflict) const;
  [[nodiscard]] std::string conflictText() const;

  /// @throws InvalidArgument  there is no such fluent
  [[nodiscard]] GroundFluent groundFluent(const std::string& name) const;

  /// Says why; shares its solver with earlier questions about the same history.
  [[nodiscard]] Explanation explain(const Literal& literal, int step);

  /// Says which records call for what the first `count` alternatives assume; the history begins at
  /// step 0.
  void justify(std::vector<ExplanationAlternative>& alternatives,
               const std::vector<std::vector<Clingo::Symbol>>& assumed, std::size_t count);

  /// What has to be given up so that none of `excluded` holds at `step`.
  std::vector<Retraction> retractions(
      const std::vector<Literal>& excluded, int step, std::size_t max_sets,
      const std::function<bool(const Reasoner&, std::string& opens)>& accept);

  /// What contradicts a literal at a step by itself has to be given up, whatever else is. When that
  /// is enough, it is the only minimal set of doubtful records without which the literal is
  /// possible: that one, or none when a certain record contradicts. Nothing: it is not enough.
  /// @param wanted  false in every model now
  [[nodiscard]] std::optional<std::vector<Retraction>> givingUpContrary(const Literal& wanted,
                                                                        int step);

private:
  [[nodiscard]] bool isLarge() const;
  /// The history without some of its records.
  [[nodiscard]] Reasoner without(const std::vector<std::size_t>& given_up) const;

  std::shared_ptr<DomainKnowledge> knowledge_;  // with the reasoners that this one supposes
  int least_step_;
  Limits limits_;
  std::shared_ptr<const Beginning> beginning_;
  std::unique_ptr<const HistoryProgram> program_;
  int tried_ = 0;  ///< the last step to which keepWindow() tried to progress
  std::vector<CheckedRecord> records_;
  std::vector<Record> history_;
  std::unique_ptr<std::optional<Optimum>> optimum_;
  std::unique_ptr<Consequences> consequences_;
  std::unique_ptr<HistoryCheck> check_;
};

}  // namespace kr3::reasoner
