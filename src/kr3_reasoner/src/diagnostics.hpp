#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

/// Problems of a text, for people. Private to the package.
namespace kr3::reasoner
{

/// The candidate nearest to `name` by edit distance, as "; did you mean 'x'?", or nothing when none
/// is near.
[[nodiscard]] std::string suggestion(const std::string& name,
                                     const std::vector<std::string>& candidates);

/// "file:line:column: message".
[[nodiscard]] std::string toString(const Diagnostic& problem);

/// The text with each NUL byte as `\x00`: the message of an exception ends at the first one.
[[nodiscard]] std::string withoutNul(const std::string& text);

/// One line "file:line:column: message" for each problem, in the order of their places; the first
/// 1000 and how many there are more.
///
/// @param files  the order of the files, if there are several
/// @throws InvalidArgument  when there is a problem
void throwIfAny(std::vector<Diagnostic> problems, const std::vector<std::string>& files = {});

}  // namespace kr3::reasoner
