#include "sparc_tokens.hpp"

#include <algorithm>
#include <cstddef>

namespace kr3::reasoner::sparc
{

std::vector<Token> tokensOf(std::string_view text)
{
  const auto in_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  std::vector<Token> tokens;
  int line = 1;
  std::size_t line_start = 0;
  for (std::size_t i = 0; i < text.size();)
  {
    const std::size_t begin = i;
    if (text[i] == '%')
    {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (std::isspace(static_cast<unsigned char>(text[i])) != 0)
    {
      line += text[i] == '\n' ? 1 : 0;
      line_start = text[i] == '\n' ? i + 1 : line_start;
      ++i;
      continue;
    }
    i += 1;
    if (in_word(text[begin]) || text[begin] == '#')
    {
      while (i < text.size() && in_word(text[i]))
      {
        ++i;
      }
    }
    else if (i < text.size())
    {
      for (const char* two : {":-", ":+", ":~", "..", "!=", "<=", ">="})
      {
        i += text.substr(begin, 2) == two ? 1 : 0;
      }
    }
    tokens.push_back({std::string(text.substr(begin, i - begin)), line,
                      static_cast<int>(begin - line_start) + 1});
  }
  tokens.push_back({"", line, static_cast<int>(text.size() - line_start) + 1});
  return tokens;
}

}  // namespace kr3::reasoner::sparc
