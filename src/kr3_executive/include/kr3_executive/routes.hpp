#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_executive/rule_interpreter.hpp"

/// Other ways to what an action was to do (lines 20-22 of Algorithm 1).
namespace kr3::executive
{

/// Ground literals `f = v` as values.
[[nodiscard]] FluentValues valuesOf(const std::vector<reasoner::Literal>& state);

/// Where an action begins, for telling attempts apart: the values of the fluents whose arguments
/// are all among the action's, "loc(rob1) = hall". The same words for the same values.
/// @param action  ground, as the language prints it
[[nodiscard]] std::string situationOf(const FluentValues& state, const std::string& action);

/// Says that an action is not to be tried in a state.
using Forbidden = std::function<bool(const FluentValues& state, const std::string& action)>;

/// The shortest sequences of two or more actions that lead from a state to where one action would
/// lead. They change no fluent on the way that the action itself does not change, as another way
/// round does, and begin with another action. Where a law has several outcomes the first counts.
///
/// @param action  ground, executable in `state`
/// @param most    so many at most, those that come first in the order of the description
/// @return actions a step, as reasoner::Plan::steps; empty when there is none
[[nodiscard]] std::vector<std::vector<std::vector<std::string>>> detours(
    const RuleInterpreter& laws, const FluentValues& state, const std::string& action,
    const Forbidden& forbidden, std::size_t most);

}  // namespace kr3::executive
