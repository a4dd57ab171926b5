#pragma once

#include <string>
#include <string_view>

namespace kr3::pomdp
{

/// A piece of a .pomdp text and where it is.
struct Token
{
  enum class Kind
  {
    kWord,    ///< name or keyword
    kNumber,  ///< `value`
    kColon,
    kStar,
    kEnd,
  };
  Kind kind = Kind::kEnd;
  std::string_view text;  ///< valid as long as the lexer's text
  double value = 0.0;
  int line = 1;
  int column = 1;
};

/// Splits a .pomdp text. A word is any run without blanks, ':' and '#', so names may hold more
/// characters than Cassandra's letters, digits, '-' and '_'.
class PomdpLexer
{
public:
  /// @param name  of the text, for messages
  PomdpLexer(std::string text, std::string name);
  PomdpLexer(const PomdpLexer&) = delete;
  PomdpLexer& operator=(const PomdpLexer&) = delete;

  [[nodiscard]] const Token& current() const { return current_; }
  [[nodiscard]] const Token& following() const { return following_; }
  /// Returns the current token and goes to the next.
  Token take();

  /// @throws InvalidArgument  `name:line:column: found ..., expected ...`
  [[noreturn]] void fail(const Token& token, const std::string& expected) const;
  /// @throws InvalidArgument  `name:line:column: what`
  [[noreturn]] void failAt(int line, int column, const std::string& what) const;

private:
  Token lex();

  std::string text_;
  std::string name_;
  std::size_t position_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
  Token current_;
  Token following_;
};

}  // namespace kr3::pomdp
