#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>
#include <kr3_refinement/domain_task.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_memory.hpp"

namespace kr3::executive
{

/// The constants that a probabilistic method considers: those that can matter to the goal once no
/// default is known, and every element that the refinement magnifies, with its components. Fluents
/// over others are left out: they are independent of the goal (marginalised).
[[nodiscard]] std::set<std::string> constantsFor(const refinement::LowLevelDomain& domain,
                                                 const std::string& goal,
                                                 const std::vector<reasoner::Record>& history);

/// What is known of a task's fluents at the history's current step. What the history entails is
/// certain (or as certain as the record that says so); other valued fluents take any value that it
/// does not exclude, all equally likely; other boolean ones are false.
///
/// @param reasoner  holds the history; it does so again afterwards
/// @param memory    fine values known from earlier missions; they count before the history
/// @param default_probability  where only a default says that f = v: f = v has this probability,
///        what the next default would say without it has this share of the rest, and so on; values
///        that no default names share what is left. Nothing: defaults are not looked for.
/// @throws FailedPrecondition  the history is inconsistent
[[nodiscard]] refinement::InitialKnowledge knowledgeOf(HighLevelReasoner& reasoner,
                                                       const refinement::DomainTask& task,
                                                       const std::vector<reasoner::Record>& history,
                                                       const LowLevelMemory& memory,
                                                       std::optional<double> default_probability);

}  // namespace kr3::executive
