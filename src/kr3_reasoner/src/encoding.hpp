#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// A description as an answer set program. Private to the package.
///
/// `h(F, V, t)`: the fluent F has the value V at step t (defined fluents: only V = true). `occ(A,
/// t)`: the action A occurs between t and t + 1. `st(F, V)`: the static F has the value V.
/// Variables of the description keep their names; our own begin with an underscore, which the
/// language does not allow. Parts: `base`, `state(_t)`, `trans(_t)` from _t-1 to _t (a
/// constant of the description may be called `t`).
class Encoding
{
public:
  /// @param description  must outlive the encoding
  explicit Encoding(const Description& description) : description_(description) {}

  /// Sorts, fluents with their values, statics, actions (part `base`).
  [[nodiscard]] std::string signature() const { return vocabulary() + values() + actions(); }

  /// Its parts: sorts, fluents and statics; the values of fluents; actions.
  [[nodiscard]] std::string vocabulary() const;
  [[nodiscard]] std::string values() const;
  [[nodiscard]] std::string actions() const;

  /// State constraints and definitions at step t, and that every fluent has one value (part
  /// `state(t)`).
  [[nodiscard]] std::string state() const;

  /// Causal laws, inertia and executability from t-1 to t (part `trans(t)`). `imp(A, t-1)`: A is
  /// impossible at t-1.
  [[nodiscard]] std::string transition() const;

  /// What is particular to the description in `state()` and `transition()`: all of them but that
  /// fluents have one value, that they keep it, and that what is impossible does not occur.
  [[nodiscard]] std::string constraints() const;
  [[nodiscard]] std::string effects() const;
  [[nodiscard]] std::string executability() const;

  /// `price(A, C, t-1)`: an occurrence of A at t-1 costs at least C thousandths (part `trans(t)`).
  [[nodiscard]] std::string prices() const;

  /// `1 { h(F, V, 0) } 1` for every fluent that is not defined.
  [[nodiscard]] static std::string anyState();

  /// A literal at a step in a body: `h(loc(X), P, t)`.
  [[nodiscard]] std::string literal(const Literal& literal, const std::string& step) const;

  /// A ground or open fluent or action as a term: `loc(rob1)`.
  [[nodiscard]] static std::string term(const Atom& atom);

  /// The conditions that bind the variables of these parts to their sorts, each with a leading
  /// comma.
  class Guards;

  /// `% file:line` of a statement, for people who read the translation.
  [[nodiscard]] static std::string comment(const SourcePosition& position);

  /// A body's conditions at a step, each with a leading comma.
  [[nodiscard]] std::string body(const Body& body, const std::string& step) const;

  [[nodiscard]] bool isBoolean(const Literal& literal) const;

private:
  [[nodiscard]] std::string stateBody(const StateConstraint& constraint) const;
  [[nodiscard]] std::string unequalRules() const;
  [[nodiscard]] std::string lawRules(const CausalLaw& law, std::size_t index) const;
  [[nodiscard]] std::string executabilityRules(const Executability& rule, std::size_t index) const;
  [[nodiscard]] std::string exclusionRules(const Executability& rule) const;
  [[nodiscard]] std::string condition(const Condition& condition, const std::string& step) const;
  [[nodiscard]] std::string differs(const Literal& literal, const Term& value) const;
  [[nodiscard]] std::string conditionsBefore(const Body& body, const Guards& guards,
                                             const std::set<std::string>& used) const;

  /// The raw blocks of a part, as they are.
  [[nodiscard]] std::string rawBlocks(AspPart part) const;

  const Description& description_;
};

/// Collects the variables of a statement with the sorts of the positions they stand in.
class Encoding::Guards
{
public:
  explicit Guards(const Description& description) : description_(description) {}

  Guards& fluent(const Atom& atom);
  Guards& literal(const Literal& literal);
  Guards& action(const Atom& atom);
  Guards& body(const Body& body);

  /// Adds the variables of `other` that are in `known` too.
  Guards& shared(const Guards& other, const Guards& known);

  /// `, sort(place, P), ...`, but not for the variables of `without`.
  [[nodiscard]] std::string text(const std::set<std::string>& without = {}) const;

  /// The variables seen, in the order of their names.
  [[nodiscard]] std::vector<std::string> variables() const;

private:
  void add(const Term& term, const std::string& sort);

  const Description& description_;
  std::map<std::string, std::vector<std::string>> sorts_;
};

}  // namespace kr3::reasoner
