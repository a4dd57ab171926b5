#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/read_options.hpp"

namespace kr3::pomdp
{

/// Reads Cassandra's .pomdp format.
///
/// @param name  of the input, for messages
/// @throws InvalidArgument  malformed; the message begins `name:line:column:` and says what was
///                          found and what was expected
/// @throws ResourceExhausted  larger than the options allow; Cancelled  they said no
/// Source: A. R. Cassandra, "POMDP file format", pomdp.org.
[[nodiscard]] Model readPomdp(std::istream& in, const std::string& name,
                              const ReadOptions& options = {});

/// @throws Unavailable      the file cannot be opened or read
/// @throws InvalidArgument  as above
[[nodiscard]] Model loadPomdp(const std::string& path);

/// Writes a model such that readPomdp gives the same model again, to the last bit.
/// @throws InvalidArgument  a name that the format cannot hold, or a model with several initial
///                          outcomes
void writePomdp(std::ostream& out, const Model& model);

/// Likewise, but where a name does not fit the format as other tools read it (a letter, then
/// letters, digits, `_` and `-`), numbers stand for all names of its kind and comments say them.
/// @return the kinds with numbers: "state", "action", "observation"
/// @throws InvalidArgument  a model with several initial outcomes
std::vector<std::string> writePomdpNumbered(std::ostream& out, const Model& model);

}  // namespace kr3::pomdp
