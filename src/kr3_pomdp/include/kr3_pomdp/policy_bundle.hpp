#pragma once

#include <iosfwd>
#include <string>

#include "kr3_pomdp/read_options.hpp"
#include "kr3_pomdp/solved_model.hpp"

namespace kr3::pomdp
{

/// Writes all that there is of a solution: the model's text, the policy, bounds, limits and work. A
/// head of lines with a key each and a hash of what follows, then both texts with their lengths.
void writeBundle(std::ostream& out, const SolvedModel& solved);

/// Reads it back: the same policy and bounds to the last bit.
///
/// @param name       of the input, for messages
/// @param max_bytes  of the whole; 0 = no limit
/// @throws InvalidArgument    no bundle, one of another version, cut short or changed, or a model
/// or
///                            policy that is malformed
/// @throws ResourceExhausted  larger than allowed; Cancelled  the options said no
[[nodiscard]] SolvedModel readBundle(std::istream& in, const std::string& name,
                                     std::size_t max_bytes = 0, const ReadOptions& options = {});

}  // namespace kr3::pomdp
