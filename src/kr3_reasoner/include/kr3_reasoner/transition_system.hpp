#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// A ground fluent with its values, as `loc(rob1)` over {office, kitchen}; boolean fluents have
/// {false, true}.
struct GroundFluent
{
  std::string name;    ///< "loc(rob1)"
  std::string symbol;  ///< "loc"
  std::vector<std::string> arguments;
  std::vector<std::string> values;
  FluentKind kind = FluentKind::kInertial;
};

/// A complete state: the index of the value of each ground fluent, in the order of
/// TransitionSystem::fluents().
using State = std::vector<int>;

/// One way in which an action can turn out in a state.
struct Successor
{
  State state;
  std::map<std::string, std::string>
      outcomes;  ///< label of the outcome taken by each labelled causal law that applied:
                 ///< action name -> label; empty when all laws were deterministic
};

/// The transition diagram of a small (zoomed) description, enumerated exactly: its states, its
/// ground agent actions, in which states each is executable, and where it leads (AL semantics:
/// successors closed under state constraints, with inertia; Gelfond and Kahl 2014, ch. 8).
///
/// Statics are folded in; inertial, knowledge and defined fluents are part of the state. Cost: one
/// clingo call.
class TransitionSystem
{
public:
  /// @throws ResourceExhausted  more than `max_states` states
  explicit TransitionSystem(const Description& description, std::size_t max_states = 100000);

  [[nodiscard]] const std::vector<GroundFluent>& fluents() const { return fluents_; }
  [[nodiscard]] const std::vector<State>& states() const { return states_; }
  [[nodiscard]] const std::vector<std::string>& actions() const
  {
    return actions_;
  }  ///< "move(rob1, c1)"
  [[nodiscard]] bool executable(std::size_t state, std::size_t action) const;

  /// Successors with indices into states(); empty when the action is not executable. shape: at
  /// least 1 when it is.
  struct IndexedSuccessor
  {
    std::size_t state;
    std::map<std::string, std::string> outcomes;
  };
  [[nodiscard]] const std::vector<IndexedSuccessor>& successors(std::size_t state,
                                                                std::size_t action) const;

private:
  std::vector<GroundFluent> fluents_;
  std::vector<State> states_;
  std::vector<std::string> actions_;
  std::vector<std::vector<std::vector<IndexedSuccessor>>> successors_;  // [state][action]
  std::vector<std::vector<bool>> executable_;                           // [state][action]
};

/// A description with every sort restricted to `constants`: declarations stay, elements, static
/// facts and ground occurrences that mention another constant go. Laws whose sorts become empty are
/// dropped; a condition on an emptied sort is decided as the JAIR paper's zoom demands (positive:
/// the law goes; negative: trivially true).
[[nodiscard]] Description restricted(const Description& description,
                                     const std::set<std::string>& constants);

/// All ground instances of the executability conditions of a ground action: for each condition its
/// body's literals.
[[nodiscard]] std::vector<std::vector<Literal>> executabilityBodies(const Description& description,
                                                                    const Atom& ground_action);

}  // namespace kr3::reasoner
