#include "plan_program.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

#include "ground_fluents.hpp"
#include "plan_trial.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr long kMilli = 1000;

void collect(const Formula& formula, std::vector<Literal>& literals)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    literals.push_back(formula.literal);
  }
  for (const Formula& operand : formula.operands)
  {
    collect(operand, literals);
  }
}

/// Binds the variables of a pattern to constants. @return false when they do not fit
bool match(const std::vector<Term>& pattern, const std::vector<std::string>& constants,
           std::unordered_map<std::string, std::string>& binding)
{
  for (std::size_t i = 0; i < pattern.size(); ++i)
  {
    const bool fits =
        pattern[i].is_variable
            ? binding.emplace(pattern[i].name, constants[i]).first->second == constants[i]
            : pattern[i].name == constants[i];
    if (!fits)
    {
      return false;
    }
  }
  return pattern.size() == constants.size();
}

std::unique_ptr<UnrolledHistory> unrolled(const PlanningProblem& problem, Solver& solver)
{
  RuleSink sink(solver.control());
  const Optimum& optimum = problem.optimum;
  auto history = std::make_unique<UnrolledHistory>(
      problem.program, problem.records, problem.now,
      UnrolledHistory::Mode{optimum.assumable, optimum.settled ? &*optimum.settled : nullptr,
                            false},
      sink);
  history->bound(optimum.price, sink);
  return history;
}

}  // namespace

PlanProgram::PlanProgram(const PlanningProblem& problem, Formula goal, PlanQuality quality,
                         Start start)
  : problem_(&problem)
  , goal_(std::move(goal))
  , quality_(quality)
  , solver_({"1", "--warn=none"})
  , start_kind_(start)
  , history_(start == Start::kAfterHistory && !problem.optimum.constant_history
                 ? unrolled(problem, solver_)
                 : nullptr)
  , dynamics_(history_                        ? history_->dynamics()
              : start == Start::kAfterHistory ? problem.optimum.constant_history->dynamics()
                                              : problem.program.dynamics(false))
  , has_costs_(!problem.description.costs.empty())
{
  for (std::size_t a = 0; a < dynamics_.actions().size(); ++a)
  {
    if (!dynamics_.actions()[a].exogenous)
    {
      agent_actions_.push_back(static_cast<int>(a));
    }
  }
  RuleSink sink(solver_);
  if (history_)
  {
    findOpenFluents();
    // What is known at the current step is known to the plan.
    states_.push_back(problem.consequences.known(problem.now, history_->state(problem.now)));
  }
  else if (start == Start::kAfterHistory)
  {
    states_.push_back(problem.optimum.constant_history->state(problem.now));
  }
  else
  {
    const StateLiterals any(dynamics_.numValues(), PartialEvaluator::kOpen);
    states_.push_back(dynamics_.initialState(any, sink));
  }
  findTests(goal_);
  goal_now_ = goalAt(goal_, states_[0], sink);
  fails_.push_back(-goal_now_);
  queries_.push_back(kFalseLiteral);
}

// ---- Questions ----

void PlanProgram::begin(const PlanningProblem& problem, const SearchLimit& limit)
{
  problem_ = &problem;
  watch_ = std::make_unique<SolveWatch>(solver_.control(), limit);
  is_uncovered_ = true;
  if (searching_ == kFalseLiteral || has_additions_)
  {
    if (has_additions_)
    {
      solver_.control().with_backend([this](Clingo::Backend& backend) {
        backend.external(static_cast<Clingo::atom_t>(searching_), Clingo::ExternalType::Release);
      });
    }
    searching_ = newGuard();
    has_additions_ = false;
  }
  if (start_kind_ == Start::kAfterHistory)
  {
    start_ = states_[0];
    return;
  }
  const StateLiterals known = problem.consequences.known(
      problem.now, StateLiterals(dynamics_.numValues(), PartialEvaluator::kOpen));
  RuleSink sink;
  start_ = dynamics_.initialState(known, sink);
  is_exact_ = true;
  start_values_.clear();
  for (std::size_t f = 0; f < dynamics_.fluents().size(); ++f)
  {
    const GroundFluent& fluent = dynamics_.fluents()[f];
    if (fluent.kind == FluentKind::kDefined)
    {
      continue;
    }
    const std::size_t first = dynamics_.firstValue(f);
    const std::size_t end = first + fluent.values.size();
    const auto open =
        std::count(known.begin() + static_cast<std::ptrdiff_t>(first),
                   known.begin() + static_cast<std::ptrdiff_t>(end), PartialEvaluator::kOpen);
    is_exact_ = is_exact_ && open == 0;
    for (std::size_t v = first; v < end; ++v)
    {
      if (known[v] == kTrueLiteral || (open > 0 && known[v] == kFalseLiteral))
      {
        start_values_.push_back(known[v] == kTrueLiteral ? states_[0][v] : -states_[0][v]);
      }
    }
  }
}

bool PlanProgram::end()
{
  constexpr int kMostGuards = 200;  // what questions add stays in the solver
  bool interrupted = false;
  try
  {
    checkLimit();
  }
  catch (const Error&)
  {
    interrupted = true;  // perhaps the solver was told only after its last call
  }
  watch_.reset();
  return start_kind_ == Start::kAnyState && !interrupted && num_guards_ < kMostGuards;
}

bool PlanProgram::isDecided() const
{
  RuleSink sink;
  return isConstant(goalAt(goal_, start_, sink));
}

StateLiterals PlanProgram::startUnder(const OpenValues& hypothesis)
{
  if (hypothesis.empty())
  {
    return start_;
  }
  StateLiterals known = start_;
  for (std::size_t f = 0; f < dynamics_.fluents().size(); ++f)
  {
    const GroundFluent& fluent = dynamics_.fluents()[f];
    const std::size_t first = dynamics_.firstValue(f);
    const auto assumed = std::find_if(hypothesis.begin(), hypothesis.end(), [&](const auto& value) {
      return open_[open_index_.at(value.first)].name == fluent.name;
    });
    for (std::size_t v = 0; v < fluent.values.size(); ++v)
    {
      SolverLiteral& literal = known[first + v];
      if (assumed != hypothesis.end())
      {
        literal = fluent.values[v] == assumed->second ? kTrueLiteral : kFalseLiteral;
      }
      else if (!isConstant(literal))
      {
        literal = PartialEvaluator::kOpen;
      }
    }
  }
  RuleSink sink;
  return dynamics_.initialState(known, sink);
}

bool PlanProgram::surelyWorks(const PlanSteps& steps, const OpenValues& hypothesis)
{
  const std::optional<StateLiterals> state = stateAfter(steps, startUnder(hypothesis), dynamics_);
  RuleSink sink;
  return state && goalAt(goal_, *state, sink) == kTrueLiteral;
}

bool PlanProgram::surelyFails(const PlanSteps& steps, const OpenValues& hypothesis)
{
  return reasoner::surelyFails(steps, startUnder(hypothesis), dynamics_,
                               [this](const StateLiterals& state) {
    RuleSink sink;
    return goalAt(goal_, state, sink);
  });
}

bool PlanProgram::surelyOpen(const OpenValues& hypothesis)
{
  RuleSink sink;
  return goalAt(goal_, startUnder(hypothesis), sink) == kFalseLiteral;
}

std::vector<std::string> PlanProgram::possibleValues(const std::string& fluent) const
{
  const GroundFluent& open = open_[open_index_.at(fluent)];
  std::vector<std::string> possible;
  for (const std::string& value : open.values)
  {
    if (problem_->consequences.inSome(literalOf(open, value), problem_->now))
    {
      possible.push_back(value);
    }
  }
  return possible;
}

// ---- The goal ----

void PlanProgram::findOpenFluents()
{
  for (std::size_t f = 0; f < dynamics_.fluents().size(); ++f)
  {
    const GroundFluent& fluent = dynamics_.fluents()[f];
    if (fluent.kind == FluentKind::kDefined)
    {
      continue;
    }
    std::size_t possible = 0;
    for (const std::string& value : fluent.values)
    {
      possible += problem_->consequences.inSome(literalOf(fluent, value), problem_->now) ? 1 : 0;
    }
    if (possible > 1)
    {
      open_index_.emplace(Encoding::term(literalOf(fluent, "").atom), open_.size());
      open_.push_back(fluent);
      open_numbers_.push_back(static_cast<int>(f));
    }
  }
}

/// Finds the actions that test the goal: whether they can be executed depends on an open fluent of
/// it.
void PlanProgram::findTests(const Formula& goal)
{
  std::vector<Literal> wanted;
  collect(goal, wanted);
  tests_.assign(dynamics_.actions().size(), 0);
  for (const Literal& literal : wanted)
  {
    const auto open = open_index_.find(Encoding::term(literal.atom));
    if (open == open_index_.end())
    {
      continue;
    }
    for (const Executability& rule : problem_->description.executabilities)
    {
      const auto* pattern =
          rule.actions.size() == 1 ? std::get_if<Atom>(&rule.actions[0]) : nullptr;
      for (const Condition& condition : rule.body)
      {
        const auto* part = std::get_if<Literal>(&condition);
        if (pattern == nullptr || part == nullptr)
        {
          continue;
        }
        for (const int a : agent_actions_)
        {
          const auto index = static_cast<std::size_t>(a);
          if (tests_[index] == 0 &&
              tests(dynamics_.actions()[index], *part, *pattern, open_[open->second]))
          {
            tests_[index] = 1;
          }
        }
      }
    }
  }
}

bool PlanProgram::tests(const Dynamics::Action& action, const Literal& condition,
                        const Atom& pattern, const GroundFluent& fluent) const
{
  std::unordered_map<std::string, std::string> binding;
  return fluent.kind == FluentKind::kInertial && condition.atom.name == fluent.symbol &&
         pattern.name == action.symbol.name() &&
         match(condition.atom.arguments, fluent.arguments, binding) &&
         match(pattern.arguments, action.arguments, binding);
}

SolverLiteral PlanProgram::goalAt(const Formula& goal, const StateLiterals& state,
                                  RuleSink& sink) const
{
  std::vector<SolverLiteral> operands;
  for (const Formula& operand : goal.operands)
  {
    operands.push_back(goalAt(operand, state, sink));
  }
  switch (goal.kind)
  {
    case Formula::Kind::kLiteral:
      return literalIn(goal.literal, state);
    case Formula::Kind::kNot:
      return -operands.front();
    case Formula::Kind::kAnd:
      return sink.conjunction(operands);
    case Formula::Kind::kOr:
      return sink.disjunction(operands);
  }
  return kFalseLiteral;
}

SolverLiteral PlanProgram::literalIn(const Literal& open, const StateLiterals& state) const
{
  const Literal literal = normalized(open, problem_->description);
  if (problem_->description.findFluent(literal.atom.name)->kind == FluentKind::kStatic)
  {
    return problem_->consequences.inAll(literal, problem_->now) ? kTrueLiteral : kFalseLiteral;
  }
  const int fluent = dynamics_.fluentNumber(toString(literal.atom));
  const int index = fluent < 0 ? -1 : dynamics_.valueIndex(fluent, literal.value.name);
  const SolverLiteral value = index < 0 ? kFalseLiteral : state[static_cast<std::size_t>(index)];
  return literal.equal ? value : -value;
}

std::string PlanProgram::literalText(const std::pair<std::string, std::string>& value) const
{
  return toString(literalOf(open_[open_index_.at(value.first)], value.second),
                  problem_->description);
}

// ---- Growing ----

void PlanProgram::extendTo(int length)
{
  while (static_cast<int>(steps_.size()) < length)
  {
    checkLimit();
    queries_.push_back(newGuard());
    RuleSink sink(solver_.control());
    addStep(sink);
    addQuery(sink);
  }
}

void PlanProgram::addStep(RuleSink& sink)
{
  const StateLiterals before = states_.back();
  steps_.emplace_back();
  const std::vector<SolverLiteral> occurs = addActions(before, sink);
  addPayments(before, sink);
  addQuality(sink);
  states_.push_back(dynamics_.successor(before, occurs, sink));
}

/// The plan may have any action. It occurs unless it, or one before, turned out impossible, so that
/// what a plan does in a model in which it fails can be looked at, too. What is impossible in every
/// model is in no plan.
std::vector<SolverLiteral> PlanProgram::addActions(const StateLiterals& before, RuleSink& sink)
{
  Step& step = steps_.back();
  const std::vector<SolverLiteral> impossible = dynamics_.impossible(before, agent_actions_, sink);
  step.planned.assign(dynamics_.actions().size(), kFalseLiteral);
  std::vector<SolverLiteral> planned;
  std::vector<SolverLiteral> breaking = {broken_};
  std::vector<SolverLiteral> testing = {tested_};
  for (const int a : agent_actions_)
  {
    const auto action = static_cast<std::size_t>(a);
    if (impossible[action] == kTrueLiteral)
    {
      continue;
    }
    const SolverLiteral literal = sink.newChoice();
    step.planned[action] = literal;
    planned.push_back(literal);
    breaking.push_back(sink.conjunction({literal, impossible[action]}));
    if (tests_[action] != 0)
    {
      testing.push_back(literal);
    }
  }
  step.busy = sink.disjunction(planned);
  broken_ = sink.disjunction(breaking);
  tested_ = sink.disjunction(testing);
  std::vector<SolverLiteral> occurs(step.planned.size(), kFalseLiteral);
  for (const int a : agent_actions_)
  {
    const auto action = static_cast<std::size_t>(a);
    occurs[action] = sink.conjunction({step.planned[action], -broken_});
  }
  return occurs;
}

void PlanProgram::addPayments(const StateLiterals& before, RuleSink& sink)
{
  if (!has_costs_)
  {
    return;
  }
  const auto number = static_cast<int>(steps_.size()) - 1;
  const std::vector<SolverLiteral>& planned = steps_.back().planned;
  const std::vector<std::vector<ActionPrice>> prices = dynamics_.prices(before, sink);
  for (const int a : agent_actions_)
  {
    const auto action = static_cast<std::size_t>(a);
    std::vector<SolverLiteral> unless = {planned[action]};
    for (const ActionPrice& price : prices[action])  // the largest first
    {
      std::vector<SolverLiteral> body = unless;
      body.push_back(price.literal);
      payments_.push_back({number, price.cost_milli, sink.conjunction(body)});
      unless.push_back(-price.literal);
    }
    payments_.push_back({number, kMilli, sink.conjunction(unless)});
  }
  payments_.erase(std::remove_if(payments_.begin(), payments_.end(),
                                 [](const Payment& paid) { return paid.literal == kFalseLiteral; }),
                  payments_.end());
}

/// What a plan of this length must do in the model where it is looked for.
void PlanProgram::addQuery(RuleSink& sink)
{
  const bool any_length = quality_ == PlanQuality::kLeastCostAnyLength;
  const SolverLiteral query = queries_.back();
  fails_.push_back(sink.disjunction({-goalAt(goal_, states_.back(), sink), broken_}));
  sink.constraint({query, fails_.back()});
  sink.constraint({query, goal_now_, -tested_});
  for (std::size_t i = 0; i < steps_.size(); ++i)
  {
    if (!any_length)
    {
      sink.constraint({query, -steps_[i].busy});
    }
    else if (i > 0)
    {
      sink.constraint({query, steps_[i].busy, -steps_[i - 1].busy});
    }
  }
}

/// What is minimized grows with the plan.
void PlanProgram::addQuality(RuleSink& sink) const
{
  const bool any_length = quality_ == PlanQuality::kLeastCostAnyLength;
  const auto minimize = [&](int priority, const std::vector<Clingo::WeightedLiteral>& literals) {
    if (!literals.empty())
    {
      sink.minimize(priority, literals);
    }
  };
  std::vector<Clingo::WeightedLiteral> actions;
  for (const SolverLiteral planned : steps_.back().planned)
  {
    if (planned != kFalseLiteral)
    {
      actions.emplace_back(planned, 1);
    }
  }
  std::vector<Clingo::WeightedLiteral> costs;
  for (const Payment& paid : payments_)
  {
    if (paid.step + 1 == static_cast<int>(steps_.size()))
    {
      costs.emplace_back(paid.literal, static_cast<int>(paid.cost_milli));
    }
  }
  if ((quality_ == PlanQuality::kLeastCost || any_length) && has_costs_)
  {
    minimize(3, costs);
  }
  if (any_length)
  {
    minimize(3, has_costs_ ? std::vector<Clingo::WeightedLiteral>{} : actions);
    minimize(2, isConstant(steps_.back().busy)
                    ? std::vector<Clingo::WeightedLiteral>{}
                    : std::vector<Clingo::WeightedLiteral>{{steps_.back().busy, 1}});
  }
  if (quality_ != PlanQuality::kNone)
  {
    minimize(1, actions);
  }
}

}  // namespace kr3::reasoner
