#pragma once

#include <iosfwd>
#include <string>

#include "kr3_pomdp/factored_model.hpp"
#include "kr3_pomdp/read_options.hpp"

namespace kr3::pomdp
{

/// Reads the POMDPX format: tables and decision diagrams, several variables of each kind, seen
/// state variables.
///
/// A text may be several times in a file (`*` for all values, `-` for each in turn): what is given
/// later replaces what was given before; what is not given is 0.
///
/// @param name     of the input, for messages
/// @param options  max_names is for the values of one variable, max_rows is not used
/// @throws InvalidArgument    malformed; the message begins `name:line:column:` and says what was
///                            found and what was expected
/// @throws ResourceExhausted  larger than the options allow, or a table is too large; Cancelled
///                            they said no
/// Source: "PomdpX File Format (version 1.0)", documentation of APPL, National University of
/// Singapore.
[[nodiscard]] FactoredModel readPomdpx(std::istream& in, const std::string& name,
                                       const ReadOptions& options = {});

/// @throws Unavailable      the file cannot be opened or read
/// @throws InvalidArgument  as above
[[nodiscard]] FactoredModel loadPomdpx(const std::string& path);

/// Writes a flat model as one state variable, such that reading it gives the same values and
/// probabilities to the last bit. What the robot sees before its first action becomes a second,
/// seen variable.
/// @throws InvalidArgument  a name that the format cannot hold
void writePomdpx(std::ostream& out, const Model& model);

/// Writes a model with its factors, as tables: reading it gives the same values, probabilities and
/// variables; a state variable's name is its name before the action.
/// @throws InvalidArgument  a name that the format cannot hold or that two variables have, a factor
///                          of the wrong shape
void writePomdpx(std::ostream& out, const FactoredModel& model);

/// Reads either format: POMDPX where the file begins with `<`, else Cassandra's.
/// @throws Unavailable  the file cannot be opened or read; InvalidArgument  malformed
[[nodiscard]] Model loadModel(const std::string& path);

}  // namespace kr3::pomdp
