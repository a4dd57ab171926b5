#include "kr3_pomdp/pomdp_format.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <istream>
#include <iterator>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "pomdp_lexer.hpp"

namespace kr3::pomdp
{

namespace
{

/// Published files give numbers to six digits, so that long rows are off by more than rounding.
constexpr double kSumTolerance = 1e-4;

/// Where a row was last written.
struct Place
{
  int line = 0;
  int column = 0;
};

/// Recursive descent over one text. Used once.
class PomdpParser
{
public:
  PomdpParser(std::string text, const std::string& name) : lexer_(std::move(text), name) {}

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
    if (p < 0.0 || p > 1.0 + kSumTolerance)
    {
      lexer_.fail(token, "a probability in [0, 1]");
    }
    return p;
  }
  /// A name, an index, or '*'.
  std::size_t element(const NameTable& names, const std::string& kind);
  std::vector<std::string> names(const std::string& kind);

  PomdpLexer lexer_;
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

std::vector<std::string> PomdpParser::names(const std::string& kind)
{
  std::vector<std::string> found;
  if (atNumber() && lexer_.following().kind != Token::Kind::kNumber)
  {
    const Token token = lexer_.take();
    if (token.value < 1.0 || token.value > 1e7 || token.value != std::floor(token.value))
    {
      lexer_.fail(token, "the number of " + kind + "s, or their names");
    }
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
  if (std::abs(sum - 1.0) > kSumTolerance)
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

void PomdpParser::set(bool is_transition, std::size_t action, std::size_t state, std::size_t column,
                      double p)
{
  if (is_transition)
  {
    builder_->setTransition(action, state, column, p);
  }
  else
  {
    builder_->setObservation(action, state, column, p);
  }
}

void PomdpParser::row(bool is_transition, std::size_t action, std::size_t state)
{
  const std::size_t size =
      is_transition ? builder_->states().size() : builder_->observations().size();
  if (acceptWord("uniform"))
  {
    set(is_transition, action, state, kAny, 1.0 / static_cast<double>(size));
    return;
  }
  const bool reset = is_transition && acceptWord("reset");
  for (std::size_t i = 0; i < size; ++i)
  {
    set(is_transition, action, state, i, reset ? start_[i] : probability());
  }
}

void PomdpParser::transition()
{
  expectColon();
  const std::size_t action = element(builder_->actions(), "action");
  const std::size_t num_states = builder_->states().size();
  std::size_t state = kAny;
  if (acceptColon())
  {
    state = element(builder_->states(), "state");
    if (acceptColon())
    {
      const std::size_t next = element(builder_->states(), "state");
      builder_->setTransition(action, state, next, probability());
    }
    else
    {
      row(true, action, state);
    }
  }
  else if (acceptWord("identity"))
  {
    builder_->setTransition(action, kAny, kAny, 0.0);
    for (std::size_t s = 0; s < num_states; ++s)
    {
      builder_->setTransition(action, s, s, 1.0);
    }
  }
  else if (atWord("uniform") || atWord("reset"))
  {
    row(true, action, kAny);
  }
  else
  {
    for (std::size_t s = 0; s < num_states; ++s)
    {
      row(true, action, s);
    }
  }
  const std::size_t num_actions = builder_->actions().size();
  for (std::size_t a = action == kAny ? 0 : action; a < (action == kAny ? num_actions : action + 1);
       ++a)
  {
    for (std::size_t s = state == kAny ? 0 : state; s < (state == kAny ? num_states : state + 1);
         ++s)
    {
      transition_places_[a * num_states + s] = place_;
    }
  }
}

void PomdpParser::observation()
{
  expectColon();
  const std::size_t action = element(builder_->actions(), "action");
  const std::size_t num_states = builder_->states().size();
  std::size_t state = kAny;
  if (acceptColon())
  {
    state = element(builder_->states(), "state");
    if (acceptColon())
    {
      const std::size_t seen = element(builder_->observations(), "observation");
      builder_->setObservation(action, state, seen, probability());
    }
    else
    {
      row(false, action, state);
    }
  }
  else if (atWord("identity") && builder_->observations().size() == num_states)
  {
    lexer_.take();
    builder_->setObservation(action, kAny, kAny, 0.0);
    for (std::size_t s = 0; s < num_states; ++s)
    {
      builder_->setObservation(action, s, s, 1.0);
    }
  }
  else if (atWord("uniform"))
  {
    row(false, action, kAny);
  }
  else
  {
    for (std::size_t s = 0; s < num_states; ++s)
    {
      row(false, action, s);
    }
  }
  const std::size_t num_actions = builder_->actions().size();
  for (std::size_t a = action == kAny ? 0 : action; a < (action == kAny ? num_actions : action + 1);
       ++a)
  {
    for (std::size_t s = state == kAny ? 0 : state; s < (state == kAny ? num_states : state + 1);
         ++s)
    {
      observation_places_[a * num_states + s] = place_;
    }
  }
}

void PomdpParser::reward()
{
  expectColon();
  const double sign = costs_ ? -1.0 : 1.0;
  const std::size_t action = element(builder_->actions(), "action");
  expectColon();
  const std::size_t state = element(builder_->states(), "state");
  const std::size_t num_observations = builder_->observations().size();
  if (!acceptColon())
  {
    for (std::size_t next = 0; next < builder_->states().size(); ++next)
    {
      for (std::size_t seen = 0; seen < num_observations; ++seen)
      {
        builder_->setReward(action, state, next, seen, sign * number("a reward"));
      }
    }
    return;
  }
  const std::size_t next = element(builder_->states(), "state");
  if (!acceptColon())
  {
    for (std::size_t seen = 0; seen < num_observations; ++seen)
    {
      builder_->setReward(action, state, next, seen, sign * number("a reward"));
    }
    return;
  }
  const std::size_t seen = element(builder_->observations(), "observation");
  builder_->setReward(action, state, next, seen, sign * number("a reward"));
}

void PomdpParser::checkRows()
{
  const std::size_t num_states = builder_->states().size();
  for (std::size_t i = 0; i < transition_places_.size(); ++i)
  {
    const std::size_t a = i / num_states;
    const std::size_t s = i % num_states;
    const auto check = [&](double sum, const Place& place, const std::string& row) {
      if (std::abs(sum - 1.0) > kSumTolerance)
      {
        const Token& end = lexer_.current();
        lexer_.failAt(
            place.line == 0 ? end.line : place.line, place.line == 0 ? end.column : place.column,
            row + (place.line == 0 ? " is never given" : " sums to " + std::to_string(sum)) +
                ", expected a sum of 1");
      }
    };
    check(builder_->transitionSum(a, s), transition_places_[i],
          "T(. | state '" + builder_->states()[s] + "', action '" + builder_->actions()[a] + "')");
    check(builder_->observationSum(a, s), observation_places_[i],
          "O(. | action '" + builder_->actions()[a] + "', next state '" + builder_->states()[s] +
              "')");
  }
}

Model PomdpParser::parse()
{
  preamble();
  builder_.emplace(states_, actions_, observations_);
  builder_->setDiscount(*discount_);
  const std::size_t size = states_.size();
  start_.assign(size, 1.0 / static_cast<double>(size));
  transition_places_.resize(actions_.size() * size);
  observation_places_.resize(actions_.size() * size);
  while (lexer_.current().kind != Token::Kind::kEnd)
  {
    const Token token = lexer_.take();
    place_ = {token.line, token.column};
    if (token.text == "start")
    {
      start();
    }
    else if (token.text == "T")
    {
      transition();
    }
    else if (token.text == "O")
    {
      observation();
    }
    else if (token.text == "R")
    {
      reward();
    }
    else
    {
      lexer_.fail(token, "'start', 'T', 'O' or 'R'");
    }
  }
  checkRows();
  builder_->setInitialBelief(start_);
  return builder_->build(kSumTolerance);
}

}  // namespace

Model readPomdp(std::istream& in, const std::string& name)
{
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return PomdpParser(std::move(text), name).parse();
}

Model loadPomdp(const std::string& path)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  return readPomdp(in, path);
}

}  // namespace kr3::pomdp
