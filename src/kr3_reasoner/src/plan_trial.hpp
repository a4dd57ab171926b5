#pragma once

#include <functional>
#include <optional>

#include "plan_program.hpp"

namespace kr3::reasoner
{

/// The state that a plan leads to; nothing when it depends on what is open in the state before, or
/// on luck, whether the plan can be executed, or where it leads. Needs no solver. Private to the
/// package.
/// @param state  constants, and literals of any program for what is open
[[nodiscard]] std::optional<StateLiterals> stateAfter(const PlanSteps& steps, StateLiterals state,
                                                      Dynamics& dynamics);

/// Whether it is certain that an action of the plan turns out impossible, or that it leads to a
/// state in which the goal is false. Needs no solver.
/// @param goal  its literal in a state: constant where that is known
[[nodiscard]] bool surelyFails(const PlanSteps& steps, StateLiterals state, Dynamics& dynamics,
                               const std::function<SolverLiteral(const StateLiterals&)>& goal);

}  // namespace kr3::reasoner
