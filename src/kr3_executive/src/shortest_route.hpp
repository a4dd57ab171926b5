#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <kr3_refinement/state_space.hpp>

namespace kr3::executive
{

/// An action as if it always had its likeliest outcome, repeated until it has.
struct RouteStep
{
  std::size_t action = 0;
  refinement::StateId next = 0;
  double cost_s = 0.0;
};

struct Route
{
  std::vector<RouteStep> steps;
  double cost_s = 0.0;

  [[nodiscard]] refinement::StateId endFrom(refinement::StateId start) const
  {
    return steps.empty() ? start : steps.back().next;
  }
};

using Visit = std::function<void(const RouteStep&)>;
using Successors = std::function<void(refinement::StateId, const Visit&)>;
/// Whether a route may end in a state, and with which last step: nothing when it may not; a step
/// that leads from the state to itself at cost 0 when nothing is left to do.
using RouteEnd = std::function<std::optional<RouteStep>(refinement::StateId)>;

/// Dijkstra's algorithm.
/// @param max_nodes  states that are looked at
/// @return nothing when no end is in reach
[[nodiscard]] std::optional<Route> shortestRoute(refinement::StateId start,
                                                 const Successors& successors, const RouteEnd& end,
                                                 std::size_t max_nodes);

}  // namespace kr3::executive
