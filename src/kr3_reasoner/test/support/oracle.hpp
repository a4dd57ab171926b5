#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ground_domain.hpp"
#include "kr3_reasoner/reasoner.hpp"

/// Zhang et al. (2014), Definitions 1 to 3, by enumeration: no solver, no grounder, no clever idea.
/// For tiny domains only.
namespace kr3::reasoner::oracle
{

/// The value (by index) of every fluent, in the order of GroundDomain::fluents.
using Values = std::vector<int>;

/// One model of a history: what is assumed, sorted, and the state at each step.
struct Model
{
  std::vector<std::string> assumed;
  std::vector<Values> states;

  bool operator==(const Model& other) const
  {
    return assumed == other.assumed && states == other.states;
  }
  bool operator<(const Model& other) const
  {
    return std::tie(assumed, states) < std::tie(other.assumed, other.states);
  }
};

struct Answers
{
  bool consistent = false;
  int cost = 0;
  std::set<Model> models;
};

/// The transition diagram of a ground domain.
class Diagram
{
public:
  /// @throws ResourceExhausted  more than `max_states` assignments
  explicit Diagram(const GroundDomain& domain, std::size_t max_assignments);

  [[nodiscard]] const std::vector<Values>& states() const { return states_; }

  /// Whether these actions can be executed together in a state, by the executability conditions.
  [[nodiscard]] bool possible(const Values& state, const std::set<int>& actions) const;

  /// The states to which the joint execution may lead.
  [[nodiscard]] const std::vector<std::size_t>& successors(std::size_t state,
                                                           const std::set<int>& actions) const;

private:
  using Effects = std::map<int, int>;  ///< value by fluent

  void complete(Values& values, std::size_t fluent);
  [[nodiscard]] std::vector<Values> withDefinitions(const Values& values) const;
  [[nodiscard]] std::vector<Effects> effectsOf(const GroundLaw& law, const Values& state) const;
  [[nodiscard]] bool caused(const Values& before, const Values& after,
                            const Effects& effects) const;

  const GroundDomain& domain_;
  std::size_t max_assignments_;
  std::vector<Values> states_;
  mutable std::map<std::pair<std::size_t, std::set<int>>, std::vector<std::size_t>> successors_;
};

/// A set of literals that respects `f != w` for each `f = v` in it.
class Knowledge
{
public:
  explicit Knowledge(const GroundDomain& domain);

  /// @return whether the literal is new
  bool add(const GroundLiteral& literal);
  [[nodiscard]] bool has(const GroundLiteral& literal) const;
  [[nodiscard]] bool has(const GroundBody& body) const;
  bool operator==(const Knowledge& other) const { return literals_ == other.literals_; }
  bool operator<(const Knowledge& other) const { return literals_ < other.literals_; }

private:
  const GroundDomain* domain_;
  std::set<std::pair<std::pair<int, int>, bool>> literals_;
};

/// The closures of a set of literals under constraints and defaults (Definition 1), preferences
/// obeyed. Several when defaults of equal rank conflict; none when there is no founded one.
[[nodiscard]] std::set<Knowledge> closures(const GroundDomain& domain, const GroundBody& initially);

[[nodiscard]] GroundLiteral contrary(const GroundLiteral& literal, const GroundDomain& domain);
[[nodiscard]] bool holds(const GroundBody& body, const Values& state);

/// All models of a history with minimal explanations. @throws ResourceExhausted  the domain or the
/// history is too large to enumerate
[[nodiscard]] Answers answersOf(const Description& description, const std::vector<Record>& records,
                                const ReasonerOptions& options);

}  // namespace kr3::reasoner::oracle
