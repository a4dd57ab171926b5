#pragma once

#include <memory>
#include <string>
#include <vector>

#include "beginning.hpp"
#include "kr3_reasoner/situation.hpp"

// What a situation says, and which names it may say it with. Private to the package.
namespace kr3::reasoner
{

/// Identifiers and what stands between them, in order.
[[nodiscard]] std::vector<std::string> tokensOf(const std::string& text);

/// What a situation says, statement by statement; each in tokens. In no order.
using Said = std::vector<std::vector<std::string>>;
[[nodiscard]] Said saidOf(const Beginning* beginning, const std::vector<Record>& records);

/// The same as one text, its statements sorted.
[[nodiscard]] std::string textOf(const Said& said);

/// Constants by the sorts that they are in, those left out that a statement of the description
/// names: no answer changes when two of one class change their names. None where the description
/// compares constants by their order.
[[nodiscard]] std::vector<std::vector<std::string>> interchangeable(const Description& description);

/// Gives the constants of each class its names by what is said of them.
[[nodiscard]] Renaming canonicalNames(const Said& said,
                                      const std::vector<std::vector<std::string>>& classes);

/// The same beginning under other names, with its rows in the order of these.
[[nodiscard]] std::shared_ptr<const Beginning> renamedBeginning(
    const std::shared_ptr<const Beginning>& beginning, const Renaming& renaming);

/// A beginning at step 1, with no more of the past than prices, of each row above the cheapest one:
/// nothing that comes later depends on what was paid for, or on what all rows had to pay.
/// @pre no level takes records to be wrong
[[nodiscard]] std::shared_ptr<const Beginning> settledBeginning(const Beginning& beginning);

/// Whether its rows and explanations assume the same failures of actions, if any, so that what
/// tells them apart is exceptions to defaults. False for an inconsistent level.
/// @pre no exogenous actions, and no records that are wrong
[[nodiscard]] bool differsInExceptionsOnly(const BeginningLevel& level);

}  // namespace kr3::reasoner
