#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kr3_reasoner/language.hpp"

/// The text of a file before it is parsed. Private to the package.
namespace kr3::reasoner
{

/// A statement of a file before it is parsed, with its final dot; or the whole text of a section
/// that holds answer set programming code. `text` points into the file's text.
struct Chunk
{
  std::string section;  ///< its header, as `facts` or `asp state`; empty before the first section
  std::string_view text;
  int line = 1;
  int column = 1;
};

/// Whether a section holds answer set programming code: `asp`, `asp state`, `asp transition`.
[[nodiscard]] bool isAspSection(const std::string& section);

/// Cuts a file into statements, so that an error in one does not hide those in the next.
[[nodiscard]] std::vector<Chunk> split(std::string_view text);

/// Reports bytes that no text file should have: NUL and other control characters, and what is not
/// UTF-8.
void checkBytes(std::string_view text, const std::string& file, std::vector<Diagnostic>& problems);

/// The word or character that `text` begins with, in quotes, for a message; `the end` of an empty
/// text. Long words are cut, unprintable characters are shown by number.
[[nodiscard]] std::string quotedWord(std::string_view text);

}  // namespace kr3::reasoner
