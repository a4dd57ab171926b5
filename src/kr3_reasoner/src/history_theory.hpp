#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "propagation.hpp"
#include "relevant_rules.hpp"

namespace kr3::reasoner
{

/// What a clause of a HistoryTheory says.
struct ClauseOrigin
{
  ReasonKind kind = ReasonKind::kTogether;
  int step = 0;
  SourcePosition position;
  std::size_t law = kNoLaw;
  std::size_t record = kNoRecord;
  std::string default_name;
  std::string action;
  std::optional<std::size_t> assumed;  ///< index into the world's assumptions
  int fluent_variable = -1;  ///< kInertia: of the later step; the earlier one's is the next
  int earlier_variable = -1;
  bool silent = false;  ///< a step that people need not see
};

/// What may be used in a proof; nullptr: everything.
struct Evidence
{
  const std::set<std::size_t>* records = nullptr;
  const std::set<std::string>* defaults = nullptr;  ///< ground
  const std::set<std::size_t>* assumed = nullptr;
};

/// What a variable of the theory stands for.
struct VariableMeaning
{
  std::optional<std::size_t> fluent;  ///< of RelevantRules::fluents()
  int since = 0;                      ///< the fluent keeps its value from this step on
  std::optional<std::size_t> occurrence;
  std::string action;  ///< of an auxiliary: whose effect it stands for, if an action's
};

/// A history in one of its initial worlds as clauses over the relevant fluents at each step, so
/// that proofs are found and not only answers. It has the same models as HistoryProgram with that
/// world's assumptions, up to what is not relevant. Private to the package.
///
/// A fluent that nothing which happened can change at a step has one variable for the step before
/// and the step: without effects a successor state is the state itself, and so is the part of it
/// that effects and constraints do not reach.
class HistoryTheory
{
public:
  HistoryTheory(const Description& description, const Words& words, const Instances& instances,
                const std::vector<CheckedRecord>& records, const Laws& laws, const Cited& kept,
                const InitialWorld& world, int current_step, const Atom& fluent, bool wide,
                const SearchLimit& limit);

  /// The inference of a literal from the evidence, or -1. What is observed is tried before what
  /// defaults say.
  [[nodiscard]] int prove(const Literal& literal, int step, const Evidence& evidence,
                          int max_cases);

  /// The inference of a contradiction, or -1.
  /// @param excepted  defaults that are supposed to have applied nevertheless
  [[nodiscard]] int refute(const Evidence& evidence, const std::vector<GroundDefault>& excepted,
                           int max_cases);

  [[nodiscard]] const Inference& inference(int number) const
  {
    return propagation_.inference(number);
  }
  [[nodiscard]] const ClauseOrigin& origin(int number) const
  {
    return origins_[static_cast<std::size_t>(number)];
  }
  [[nodiscard]] const VariableMeaning& meaning(int variable) const
  {
    return meanings_[static_cast<std::size_t>(variable)];
  }
  [[nodiscard]] Literal literalOf(const FiniteLiteral& literal) const;
  [[nodiscard]] const RelevantRules& rules() const { return rules_; }

private:
  using Body = std::vector<FiniteLiteral>;
  struct Support
  {
    std::string value;
    Body body;
    std::string action;
    std::size_t law;
  };
  class InitialClosure;
  /// What may give each fluent a value at a step.
  using Supports = std::map<std::size_t, std::vector<Support>>;

  void findChanges();
  void addTransitions();
  void addRule(const GroundRule& rule, int step);
  void addLaw(const GroundLaw& law, Supports& supports);
  void addEffects(const GroundLaw& law, const FiniteLiteral& applies, Supports& supports);
  void addFrame(std::size_t fluent, int step, const std::vector<Support>& supports);
  void addBans();
  void addDefinitions();

  [[nodiscard]] std::optional<std::size_t> fluentIndex(const Atom& atom) const;
  [[nodiscard]] int variable(std::size_t fluent, int step) const;
  /// The law that defines a fluent, or kNoLaw.
  [[nodiscard]] std::size_t definitionOf(std::size_t fluent) const;
  [[nodiscard]] bool changes(std::size_t fluent, int step) const;
  [[nodiscard]] FiniteLiteral at(const Literal& literal, int step) const;
  [[nodiscard]] Body at(const std::vector<Literal>& literals, int step) const;
  [[nodiscard]] FiniteLiteral conjunction(const Body& body, const std::string& action, int origin);
  int addOrigin(ClauseOrigin origin);
  void addImplication(const Body& body, std::optional<FiniteLiteral> head, int origin);

  [[nodiscard]] int originOf(std::size_t record);
  void assumeRecords(const Evidence& evidence);
  /// The founded closure of what is known initially, from the evidence only, as inferences.
  [[nodiscard]] std::vector<int> closure(const Evidence& evidence,
                                         const std::vector<GroundDefault>& excepted);

  const Description& description_;
  const Words& words_;
  const std::vector<CheckedRecord>& records_;
  const Laws& laws_;
  const Cited& kept_;
  const InitialWorld& world_;
  int current_step_;
  RelevantRules rules_;
  Propagation propagation_;
  std::vector<ClauseOrigin> origins_;
  std::vector<VariableMeaning> meanings_;
  std::map<std::string, std::size_t> fluent_index_;
  std::vector<std::vector<std::string>> values_;         // of each fluent
  std::vector<std::map<std::string, int>> value_index_;  // of each fluent
  std::vector<std::map<int, int>> variables_;            // of each fluent: by first step
  std::vector<int> occurrence_variables_;
  std::map<std::size_t, int> record_origins_;
  std::size_t base_ = 0;  // mark of the propagation without evidence
};

}  // namespace kr3::reasoner
