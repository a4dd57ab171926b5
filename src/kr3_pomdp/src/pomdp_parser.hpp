#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "file_tolerance.hpp"
#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/read_options.hpp"
#include "pomdp_lexer.hpp"

namespace kr3::pomdp
{

/// Where a row was last written.
struct Place
{
  int line = 0;
  int column = 0;
};

/// Recursive descent over one text in Cassandra's format. Used once.
class PomdpParser
{
public:
  PomdpParser(std::string text, const std::string& name, ReadOptions options = {})
    : lexer_(std::move(text), name), options_(std::move(options))
  {
  }

  Model parse();

private:
  void preamble();
  void start();
  void startStates(bool include);
  void transition();
  void observation();
  void reward();
  void row(bool is_transition, std::size_t action, std::size_t state);
  void set(bool is_transition, std::size_t action, std::size_t state, std::size_t column, double p);
  /// What the caller allows, 0 being no limit, and what is possible at all.
  static std::size_t allowed(std::size_t option, std::size_t possible)
  {
    return option == 0 ? possible : std::min(option, possible);
  }
  /// @throws ResourceExhausted  `count` is above `limit`
  void checkCount(std::size_t count, std::size_t limit, const std::string& what) const;
  /// Notes that the statement being read wrote these rows.
  void mark(std::vector<Place>& places, std::size_t action, std::size_t state) const;
  void checkRows();

  bool atWord(std::string_view word) const
  {
    return lexer_.current().kind == Token::Kind::kWord && lexer_.current().text == word;
  }
  bool atNumber() const { return lexer_.current().kind == Token::Kind::kNumber; }
  bool acceptWord(std::string_view word)
  {
    const bool found = atWord(word);
    if (found)
    {
      lexer_.take();
    }
    return found;
  }
  bool acceptColon()
  {
    const bool found = lexer_.current().kind == Token::Kind::kColon;
    if (found)
    {
      lexer_.take();
    }
    return found;
  }
  void expectColon()
  {
    if (!acceptColon())
    {
      lexer_.fail(lexer_.current(), "':'");
    }
  }
  double number(const std::string& expected)
  {
    if (!atNumber() || !std::isfinite(lexer_.current().value))
    {
      lexer_.fail(lexer_.current(), expected);
    }
    return lexer_.take().value;
  }
  double probability()
  {
    const Token token = lexer_.current();
    const double p = number("a probability");
    if (p < 0.0 || p > 1.0 + kFileSumTolerance)
    {
      lexer_.fail(token, "a probability in [0, 1]");
    }
    return p;
  }
  /// A name, an index, or '*'.
  std::size_t element(const NameTable& names, const std::string& kind);
  std::vector<std::string> names(const std::string& kind);

  PomdpLexer lexer_;
  ReadOptions options_;
  std::size_t num_written_ = 0;  // entries of T and O
  std::size_t num_cleared_ = 0;  // rows in which entries became 0
  std::optional<double> discount_;
  bool costs_ = false;
  std::vector<std::string> states_;
  std::vector<std::string> actions_;
  std::vector<std::string> observations_;
  std::vector<double> start_;
  std::optional<ModelBuilder> builder_;
  std::vector<Place> transition_places_;
  std::vector<Place> observation_places_;
  Place place_;  // of the statement being read
};

}  // namespace kr3::pomdp
