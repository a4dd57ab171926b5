#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>

namespace kr3::pomdp
{

/// @throws Unavailable  the stream fails
[[nodiscard]] std::string readAll(std::istream& in, const std::string& name);

/// @throws Unavailable  the file cannot be opened or read
[[nodiscard]] std::string readFile(const std::string& path);

/// Whether the first character that is not blank begins an XML element.
[[nodiscard]] bool looksLikeXml(const std::string& text);

/// `name:line:column: `, lines and columns from 1.
/// @param offset  of a character in `text`, or its end
[[nodiscard]] std::string placeIn(const std::string& text, std::size_t offset,
                                  const std::string& name);

}  // namespace kr3::pomdp
