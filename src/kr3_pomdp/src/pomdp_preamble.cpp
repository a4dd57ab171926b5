#include <algorithm>
#include <cmath>
#include <set>

#include <kr3_common/error.hpp>

#include "pomdp_parser.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr double kMaxNames = 1e7;
// Whatever the caller allows: a few words of a text can ask for any amount of memory.
constexpr std::size_t kMaxRows = std::size_t{1} << 24;

}  // namespace

void PomdpParser::checkCount(std::size_t count, std::size_t limit, const std::string& what) const
{
  if (count > limit)
  {
    throw ResourceExhausted("a model of " + std::to_string(count) + " " + what +
                            ", expected at most " + std::to_string(limit));
  }
}

std::vector<std::string> PomdpParser::names(const std::string& kind)
{
  std::vector<std::string> found;
  if (atNumber() && lexer_.following().kind != Token::Kind::kNumber)
  {
    const Token token = lexer_.take();
    if (token.value < 1.0 || token.value > kMaxNames || token.value != std::floor(token.value))
    {
      lexer_.fail(token, "the number of " + kind + "s, at most " +
                             std::to_string(static_cast<std::size_t>(kMaxNames)) +
                             ", or their names");
    }
    checkCount(static_cast<std::size_t>(token.value), allowed(options_.max_names, kMaxRows),
               kind + "s");
    for (std::size_t i = 0; i < static_cast<std::size_t>(token.value); ++i)
    {
      found.push_back(std::to_string(i));
    }
    return found;
  }
  std::set<std::string_view> seen;
  while (lexer_.current().kind == Token::Kind::kWord || atNumber())
  {
    const bool keyword =
        lexer_.following().kind == Token::Kind::kColon ||
        (atWord("start") && lexer_.following().kind == Token::Kind::kWord &&
         (lexer_.following().text == "include" || lexer_.following().text == "exclude"));
    if (keyword)
    {
      break;
    }
    const Token token = lexer_.take();
    if (!seen.insert(token.text).second)
    {
      lexer_.failAt(token.line, token.column,
                    "the " + kind + " '" + std::string(token.text) + "' is there already");
    }
    found.emplace_back(token.text);
  }
  checkCount(found.size(), allowed(options_.max_names, kMaxRows), kind + "s");
  if (found.empty())
  {
    lexer_.fail(lexer_.current(), "the number of " + kind + "s, or their names");
  }
  return found;
}

std::size_t PomdpParser::element(const NameTable& names, const std::string& kind)
{
  const Token token = lexer_.take();
  if (token.kind == Token::Kind::kStar)
  {
    return kAny;
  }
  if (token.kind == Token::Kind::kWord || token.kind == Token::Kind::kNumber)
  {
    if (const auto found = names.find(token.text))
    {
      return *found;
    }
    if (token.kind == Token::Kind::kNumber && token.value >= 0.0 &&
        token.value < static_cast<double>(names.size()) && token.value == std::floor(token.value))
    {
      return static_cast<std::size_t>(token.value);
    }
  }
  lexer_.fail(token, "a declared " + kind + ", its index below " + std::to_string(names.size()) +
                         ", or '*'");
}

void PomdpParser::preamble()
{
  std::set<std::string> seen;
  while (true)
  {
    const Token token = lexer_.current();
    const std::string key(token.text);
    const bool known = key == "discount" || key == "values" || key == "states" ||
                       key == "actions" || key == "observations";
    if (token.kind != Token::Kind::kWord || !known)
    {
      break;
    }
    lexer_.take();
    expectColon();
    if (!seen.insert(key).second)
    {
      lexer_.failAt(token.line, token.column, "'" + key + "' is there already");
    }
    if (key == "discount")
    {
      const Token value = lexer_.current();
      discount_ = number("the discount");
      if (!(*discount_ > 0.0 && *discount_ <= 1.0))
      {
        lexer_.fail(value, "a discount in (0, 1]");
      }
    }
    else if (key == "values")
    {
      costs_ = atWord("cost");
      if (!acceptWord("cost") && !acceptWord("reward"))
      {
        lexer_.fail(lexer_.current(), "'reward' or 'cost'");
      }
    }
    else if (key == "states")
    {
      states_ = names("state");
    }
    else if (key == "actions")
    {
      actions_ = names("action");
    }
    else
    {
      observations_ = names("observation");
    }
  }
  for (const char* key : {"discount", "values", "states", "actions", "observations"})
  {
    if (seen.count(key) == 0)
    {
      lexer_.fail(lexer_.current(), "'" + std::string(key) + ":' before anything else");
    }
  }
  checkCount(actions_.size() * states_.size(), allowed(options_.max_rows, kMaxRows),
             "rows (actions times states)");
}

void PomdpParser::start()
{
  if (acceptWord("include"))
  {
    expectColon();
    startStates(true);
    return;
  }
  if (acceptWord("exclude"))
  {
    expectColon();
    startStates(false);
    return;
  }
  expectColon();
  const std::size_t size = builder_->states().size();
  if (atWord("uniform") && !builder_->states().find("uniform"))
  {
    lexer_.take();
    start_.assign(size, 1.0 / static_cast<double>(size));
    return;
  }
  const bool one_state =
      lexer_.current().kind == Token::Kind::kWord ||
      (atNumber() && size > 1 && lexer_.following().kind != Token::Kind::kNumber);
  start_.assign(size, 0.0);
  if (one_state)
  {
    start_[element(builder_->states(), "state")] = 1.0;
    return;
  }
  const Token first = lexer_.current();
  double sum = 0.0;
  for (double& p : start_)
  {
    p = probability();
    sum += p;
  }
  if (std::abs(sum - 1.0) > kFileSumTolerance)
  {
    lexer_.failAt(first.line, first.column,
                  "the start belief sums to " + std::to_string(sum) + ", expected 1");
  }
  if (std::abs(sum - 1.0) > 1e-12)
  {
    for (double& p : start_)
    {
      p /= sum;
    }
  }
}

void PomdpParser::startStates(bool include)
{
  const std::size_t size = builder_->states().size();
  std::vector<bool> listed(size, false);
  const Token first = lexer_.current();
  while ((lexer_.current().kind == Token::Kind::kWord || atNumber()) &&
         lexer_.following().kind != Token::Kind::kColon)
  {
    listed[element(builder_->states(), "state")] = true;
  }
  const auto count = static_cast<double>(std::count(listed.begin(), listed.end(), include));
  if (count == 0.0)
  {
    lexer_.fail(first, include ? "states to start in" : "states that leave one to start in");
  }
  start_.assign(size, 0.0);
  for (std::size_t s = 0; s < size; ++s)
  {
    start_[s] = listed[s] == include ? 1.0 / count : 0.0;
  }
}

}  // namespace kr3::pomdp
