#pragma once

#include <string>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// A text of a request, if it is short enough to be looked at.
/// @param what  names the field in the error
/// @throws InvalidArgument  more than 4096 bytes, or a NUL byte
[[nodiscard]] const std::string& checkedText(const std::string& text, const std::string& what);

/// The text as valid UTF-8 without control characters: any other byte becomes `\xNN`. What clients
/// sent may stand in our answers, and clients in Python refuse what is no UTF-8.
/// @param max_size  the rest is left out, and the text says so
[[nodiscard]] std::string printable(const std::string& text, std::size_t max_size = 50000);

/// The options on which answers depend, as one JSON object with the names of the parameters.
[[nodiscard]] std::string jsonOf(const ReasonerOptions& options);

}  // namespace kr3::reasoner
