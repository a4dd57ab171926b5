#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>
#include <kr3_reasoner/transition_system.hpp>

namespace kr3::refinement
{

/// A state of a StateSpace, counted from 0 in the order in which states were met.
using StateId = std::uint32_t;

/// The states of a description and what actions do in them, evaluated as they are asked for: for
/// descriptions with more states than can be listed. Knowledge fluents, and what is defined by
/// them, are left out. Not thread-safe.
class StateSpace
{
public:
  struct Action
  {
    std::string text;  ///< "search(rob1, c1, tb1)"
    std::string symbol;
    std::vector<std::string> arguments;
  };
  struct Outcome
  {
    std::string label;             ///< of the causal law's outcome, empty without one
    double share = 1.0;            ///< of the label's probability
    std::optional<StateId> state;  ///< nothing: it leaves the constants that were kept
  };
  /// What an action tells about: a value, or whether the fluent has a given one.
  struct Observation
  {
    std::size_t fluent = 0;
    std::optional<std::string> value;
    bool caused = false;  ///< the action has a law on the fluent: this is feedback
  };

  /// @param constants  that are kept; a fluent or action over others is left out
  StateSpace(const reasoner::Description& description, const std::set<std::string>& constants);
  ~StateSpace();
  StateSpace(StateSpace&&) noexcept;
  StateSpace& operator=(StateSpace&&) noexcept;
  StateSpace(const StateSpace&) = delete;
  StateSpace& operator=(const StateSpace&) = delete;

  /// The inertial ground fluents, with their values.
  [[nodiscard]] const std::vector<reasoner::GroundFluent>& fluents() const;
  [[nodiscard]] std::optional<std::size_t> findFluent(const std::string& name) const;
  /// The ground agent actions, in the order of their declarations.
  [[nodiscard]] const std::vector<Action>& actions() const;
  [[nodiscard]] const std::vector<Observation>& observations(std::size_t action) const;

  /// The state with these values, in the order of fluents().
  /// @return nothing when a constraint forbids it
  /// @throws InvalidArgument  not one value for each fluent, or an unknown one
  [[nodiscard]] std::optional<StateId> find(const std::vector<std::string>& values);
  [[nodiscard]] const std::string& value(StateId state, std::size_t fluent) const;
  [[nodiscard]] std::size_t numStatesMet() const;

  [[nodiscard]] bool executable(StateId state, std::size_t action) const;
  /// How an executable action can turn out; shares sum to 1 for each label that occurs.
  [[nodiscard]] std::vector<Outcome> results(StateId state, std::size_t action);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::refinement
