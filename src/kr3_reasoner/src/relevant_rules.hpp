#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "entailment_check.hpp"
#include "instances.hpp"
#include "laws.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

/// A ground instance of a state constraint or definition.
struct GroundRule
{
  std::optional<Literal> head;
  std::vector<Literal> body;
  SourcePosition position;
  std::size_t law = kNoLaw;
};

/// An action that happened: by a record, or assumed.
struct Occurrence
{
  Atom action;
  int step = 0;
  std::size_t record = kNoRecord;
  std::optional<std::size_t> assumed;  ///< index of the assumption that it happened, or failed
  bool failed = false;
  bool exogenous = false;
};

/// What one outcome of a ground causal law does.
struct GroundEffect
{
  Atom fluent;
  /// The values that it may give, each with the literals that must have held before.
  struct Option
  {
    std::string value;
    std::vector<Literal> condition;
  };
  std::vector<Option> options;  ///< one when the effect is certain
};

/// A ground causal law of an action that happened.
struct GroundLaw
{
  std::size_t occurrence = 0;
  std::vector<std::vector<GroundEffect>> outcomes;
  std::vector<std::vector<Literal>> bodies;  ///< it applies if one of them holds
  SourcePosition position;
  std::size_t law = kNoLaw;
};

/// An executability condition that actions that happened together have met.
struct GroundBan
{
  std::vector<std::size_t> occurrences;
  std::vector<Literal> body;
  SourcePosition position;
  std::size_t law = kNoLaw;
};

/// The ground part of a description that can matter to a literal, given which actions happened.
/// Private to the package.
class RelevantRules
{
public:
  /// @param world  with the actions that are assumed to have happened or failed
  /// @param kept   the records, defaults and laws that are there
  /// @param wide   follow constraints from bodies to heads, too: all that is connected
  RelevantRules(const Description& description, const Words& words, const Instances& instances,
                const std::vector<CheckedRecord>& records, const Laws& laws, const Cited& kept,
                const InitialWorld& world, const Atom& fluent, bool wide, const SearchLimit& limit);

  [[nodiscard]] const std::vector<Atom>& fluents() const { return fluents_; }
  [[nodiscard]] bool isRelevant(const Atom& fluent) const;
  [[nodiscard]] const std::vector<Occurrence>& occurrences() const { return occurrences_; }
  [[nodiscard]] const std::vector<GroundRule>& rules() const { return rules_; }
  [[nodiscard]] const std::vector<GroundLaw>& laws() const { return laws_; }
  [[nodiscard]] const std::vector<GroundBan>& bans() const { return bans_; }
  [[nodiscard]] const std::vector<GroundDefault>& defaults() const { return defaults_; }

private:
  void findOccurrences(const InitialWorld& world);
  void findLaws();
  void addLaw(std::size_t occurrence, const CausalLaw& law, std::size_t number,
              const Binding& binding);
  void want(const Atom& fluent);
  void want(const std::vector<Literal>& literals);
  void expand(const Atom& fluent);
  void expandConstraint(const StateConstraint& constraint, std::size_t law, const Atom& fluent);
  void expandBans(const Executability& rule, std::size_t law, const Atom& fluent);
  void addBans(const Executability& rule, std::size_t law, const Literal& about, const Atom& fluent,
               const std::vector<std::size_t>& happened);
  void expandDefault(const Default& rule, const Atom& fluent);
  void addRule(GroundRule rule);

  const Description& description_;
  const Words& words_;
  const Instances& instances_;
  const std::vector<CheckedRecord>& records_;
  const Laws& statements_;
  const Cited& kept_;
  bool wide_;
  std::vector<Atom> fluents_;
  std::set<std::string> wanted_;
  std::vector<Occurrence> occurrences_;
  std::vector<GroundRule> rules_;
  std::vector<GroundLaw> laws_;
  std::vector<GroundBan> bans_;
  std::vector<GroundDefault> defaults_;
  std::set<std::string> seen_;  // rules, bans and defaults, so that each is there once
};

}  // namespace kr3::reasoner
