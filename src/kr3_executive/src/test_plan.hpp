#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "kr3_executive/domain_belief.hpp"
#include "search_order.hpp"
#include "shortest_route.hpp"

namespace kr3::executive
{

/// Fluents that have different values in the states of a belief, by number.
[[nodiscard]] std::vector<std::size_t> openFluents(const DomainBelief& belief);

/// Ways through a domain for each state, as if the state were known: to where its hidden values can
/// be looked at, and to the goal. Kept between missions.
///
/// A state is a place (the values of all other fluents) and hidden values; both are numbered in the
/// order in which they are met.
class TestPlan
{
public:
  struct Parts
  {
    std::uint32_t place = 0;
    std::uint32_t hidden = 0;
  };

  /// @param hidden  fluents that the start belief leaves open, by number; those that some action
  ///                senses without changing them count as hidden
  TestPlan(refinement::DomainTask& task, reasoner::Formula goal, std::vector<std::size_t> hidden);

  [[nodiscard]] Parts parts(refinement::StateId state);
  /// The state with these parts, if there can be one.
  [[nodiscard]] std::optional<refinement::StateId> state(const Parts& parts);

  /// What testing the hidden values takes from a place; `end` is a place. Computed once.
  [[nodiscard]] const std::optional<Prospect>& prospect(const Parts& parts);

  /// Its last step is an action that tells whether a hidden fluent has the value that it has in the
  /// state, without changing it.
  [[nodiscard]] std::optional<Route> testFrom(refinement::StateId state)
  {
    return route(state, true);
  }
  [[nodiscard]] const std::optional<Route>& goalFrom(refinement::StateId state);

  /// Where a fluent is open that is known only as the outcome of actions (the robot's own place):
  /// the cheapest action that tells it, among those about what is likely.
  [[nodiscard]] std::optional<std::size_t> orienting(const DomainBelief& belief,
                                                     refinement::StateId likeliest);

private:
  using Allowed = std::vector<std::size_t>;

  /// A value that was computed, or not yet.
  struct Cell
  {
    bool known = false;
    std::optional<Prospect> prospect;
  };

  [[nodiscard]] bool isHidden(std::size_t fluent) const;
  [[nodiscard]] std::optional<Prospect> computed(const Parts& parts);
  [[nodiscard]] double detection(const Route& test) const;
  [[nodiscard]] Allowed actionsAbout(refinement::StateId state) const;
  [[nodiscard]] std::optional<Route> route(refinement::StateId state, bool to_test);
  [[nodiscard]] std::optional<Route> route(refinement::StateId state, bool to_test,
                                           const Allowed& actions);
  [[nodiscard]] bool tests(std::size_t action, refinement::StateId state) const;
  [[nodiscard]] std::optional<RouteStep> likeliest(refinement::StateId state, std::size_t action);

  refinement::DomainTask& task_;
  reasoner::Formula goal_;
  std::vector<std::size_t> hidden_;
  /// Actions over constants that every state's routes may use, and the others by each of the
  /// constants that they need besides.
  Allowed always_;
  std::unordered_map<std::string, Allowed> about_;
  std::vector<std::vector<std::string>> needs_;

  std::unordered_map<refinement::StateId, Parts> parts_;
  std::map<std::vector<std::string>, std::uint32_t> place_numbers_;
  std::map<std::vector<std::string>, std::uint32_t> hidden_numbers_;
  std::vector<refinement::StateId> places_;         ///< a state of each
  std::vector<refinement::StateId> hidden_values_;  ///< likewise
  std::vector<std::vector<Cell>> prospects_;        ///< by place and hidden values
  std::unordered_map<refinement::StateId, std::optional<Route>> goals_;
};

}  // namespace kr3::executive
