#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace kr3::reasoner::sparc
{

/// A word, a number, a name of a sort with its '#', or a sign.
struct Token
{
  std::string text;  ///< empty at the end
  int line = 1;
  int column = 1;

  [[nodiscard]] bool isWord() const
  {
    return !text.empty() && (std::isalnum(static_cast<unsigned char>(text[0])) != 0 ||
                             text[0] == '_' || (text[0] == '#' && text.size() > 1));
  }
};

/// The tokens of a program without comments, and an empty one at the end.
[[nodiscard]] std::vector<Token> tokensOf(std::string_view text);

}  // namespace kr3::reasoner::sparc
