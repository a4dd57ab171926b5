#include "pomdp_lexer.hpp"

#include <cctype>
#include <utility>

#include <kr3_common/error.hpp>

#include "number_text.hpp"

namespace kr3::pomdp
{

namespace
{

bool isBlank(char c)
{
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

bool mayStartNumber(std::string_view text)
{
  const char c = text.front();
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-';
}

}  // namespace

PomdpLexer::PomdpLexer(std::string text, std::string name)
  : text_(std::move(text)), name_(std::move(name))
{
  current_ = lex();
  following_ = lex();
}

Token PomdpLexer::take()
{
  const Token taken = current_;
  current_ = following_;
  following_ = lex();
  return taken;
}

Token PomdpLexer::lex()
{
  while (position_ < text_.size() && (isBlank(text_[position_]) || text_[position_] == '#'))
  {
    if (text_[position_] == '#')
    {
      while (position_ < text_.size() && text_[position_] != '\n')
      {
        ++position_;
      }
      continue;
    }
    if (text_[position_] == '\n')
    {
      ++line_;
      line_start_ = position_ + 1;
    }
    ++position_;
  }
  Token token;
  token.line = line_;
  token.column = static_cast<int>(position_ - line_start_) + 1;
  if (position_ == text_.size())
  {
    return token;
  }
  const std::size_t first = position_++;
  if (text_[first] == ':' || text_[first] == '*')
  {
    token.kind = text_[first] == ':' ? Token::Kind::kColon : Token::Kind::kStar;
  }
  else
  {
    while (position_ < text_.size() && !isBlank(text_[position_]) && text_[position_] != ':' &&
           text_[position_] != '*' && text_[position_] != '#')
    {
      ++position_;
    }
    token.kind = Token::Kind::kWord;
  }
  token.text = std::string_view(text_).substr(first, position_ - first);
  if (mayStartNumber(token.text))
  {
    if (const auto number = finiteNumber(token.text))
    {
      token.value = *number;
      token.kind = Token::Kind::kNumber;
    }
  }
  return token;
}

void PomdpLexer::fail(const Token& token, const std::string& expected) const
{
  const std::string found = token.kind == Token::Kind::kEnd ? std::string("the end of the text")
                                                            : "'" + std::string(token.text) + "'";
  failAt(token.line, token.column, "found " + found + ", expected " + expected);
}

void PomdpLexer::failAt(int line, int column, const std::string& what) const
{
  throw InvalidArgument(name_ + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
                        what);
}

}  // namespace kr3::pomdp
