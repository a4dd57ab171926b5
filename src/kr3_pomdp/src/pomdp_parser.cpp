#include "pomdp_parser.hpp"

#include <cmath>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

// Whatever the caller allows: short texts with wildcards can ask for any amount of memory and time.
constexpr std::size_t kMaxEntries = std::size_t{1} << 27;
constexpr std::size_t kMaxCleared = std::size_t{1} << 30;

}  // namespace

void PomdpParser::set(bool is_transition, std::size_t action, std::size_t state, std::size_t column,
                      double p)
{
  const std::size_t num_columns =
      is_transition ? builder_->states().size() : builder_->observations().size();
  const std::size_t num_rows = (action == kAny ? builder_->actions().size() : 1) *
                               (state == kAny ? builder_->states().size() : 1);
  if (p != 0.0)
  {
    num_written_ += num_rows * (column == kAny ? num_columns : 1);
    checkCount(num_written_, allowed(options_.max_entries, kMaxEntries), "entries of T and O");
  }
  else
  {
    num_cleared_ += num_rows;
    checkCount(num_cleared_, kMaxCleared, "entries of T and O that become 0");
  }
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

void PomdpParser::mark(std::vector<Place>& places, std::size_t action, std::size_t state) const
{
  const std::size_t num_states = builder_->states().size();
  const std::size_t num_actions = builder_->actions().size();
  const std::size_t first_action = action == kAny ? 0 : action;
  const std::size_t first_state = state == kAny ? 0 : state;
  for (std::size_t a = first_action; a < (action == kAny ? num_actions : action + 1); ++a)
  {
    for (std::size_t s = first_state; s < (state == kAny ? num_states : state + 1); ++s)
    {
      places[a * num_states + s] = place_;
    }
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
      set(true, action, state, next, probability());
    }
    else
    {
      row(true, action, state);
    }
  }
  else if (acceptWord("identity"))
  {
    set(true, action, kAny, kAny, 0.0);
    for (std::size_t s = 0; s < num_states; ++s)
    {
      set(true, action, s, s, 1.0);
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
  mark(transition_places_, action, state);
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
      set(false, action, state, seen, probability());
    }
    else
    {
      row(false, action, state);
    }
  }
  else if (atWord("identity") && builder_->observations().size() == num_states)
  {
    lexer_.take();
    set(false, action, kAny, kAny, 0.0);
    for (std::size_t s = 0; s < num_states; ++s)
    {
      set(false, action, s, s, 1.0);
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
  mark(observation_places_, action, state);
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
      if (std::abs(sum - 1.0) > kFileSumTolerance)
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
    if (options_.keep_going && !options_.keep_going())
    {
      throw Cancelled("reading the model was cancelled");
    }
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
  return builder_->build(kFileSumTolerance);
}

}  // namespace kr3::pomdp
