#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Values of variables.
using Binding = std::map<std::string, std::string>;

/// Extends `binding` so that the open atom becomes the ground one. Returns
/// false where it cannot; `binding` is then worth nothing.
[[nodiscard]] bool unify(const Atom& open, const Atom& ground, Binding& binding);

/// Whether a comparison of two constants is true: of numbers by value, of others by name.
[[nodiscard]] bool holds(const std::string& left, Comparison::Operator op,
                         const std::string& right);

[[nodiscard]] Term bound(const Term& term, const Binding& binding);
[[nodiscard]] Atom bound(Atom atom, const Binding& binding);
[[nodiscard]] Literal bound(Literal literal, const Binding& binding);

/// What the variables of a statement stand in.
struct StatementParts
{
  std::vector<const Atom*> actions;
  std::vector<const Atom*> fluents;      ///< without a value
  std::vector<const Literal*> literals;  ///< heads and effects
  std::vector<const Body*> bodies;
};

/// Finds the ground instances of statements, for the part of a description that
/// a question is about. Statics are decided here once. Private to the package.
class Instances
{
public:
  /// @param description  must outlive this object
  explicit Instances(const Description& description);

  /// Calls `visit` with each binding of the statement's variables that extends
  /// `start`, fits the sorts, and under which every comparison, membership and
  /// static literal of the bodies is true.
  void forEach(const StatementParts& parts, const Binding& start,
               const std::function<void(const Binding&)>& visit) const;

  /// The literals of a body that are not static, ground.
  [[nodiscard]] std::vector<Literal> literals(const Body& body, const Binding& binding) const;

  [[nodiscard]] bool isStatic(const Literal& literal) const;

  /// Whether a ground static literal is true.
  [[nodiscard]] bool staticHolds(const Literal& literal) const;

private:
  struct Variables;

  void addDerivedStatics();
  [[nodiscard]] bool decided(const Condition& condition, const Binding& binding) const;
  [[nodiscard]] bool inSort(const std::string& element, const std::string& sort) const;

  const Description& description_;
  std::unordered_map<std::string, std::set<std::string>> elements_;  // of each sort
  std::unordered_map<std::string, std::string> statics_;             // term -> value
};

}  // namespace kr3::reasoner
