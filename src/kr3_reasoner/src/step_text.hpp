#pragma once

#include "kr3_reasoner/transition_system.hpp"
#include "search_limit.hpp"
#include "step_program.hpp"

namespace kr3::reasoner
{

/// A ground action of a description.
struct GroundAction
{
  std::string name;  ///< `move(rob1, office)`
  std::string symbol;
  std::vector<std::string> arguments;
};

/// Grounds the text of Encoding for one step with clingo: the same as groundStep, slower, but with
/// the raw code of experts. Private to the package.
///
/// @param fluents  of the description, in the order of Signature
/// @param actions  likewise; laws of exogenous actions that are not among them are left out
[[nodiscard]] StepProgram groundStepText(const Description& description,
                                         const std::vector<GroundFluent>& fluents,
                                         const std::vector<GroundAction>& actions,
                                         const SearchLimit& limit = {});

}  // namespace kr3::reasoner
