#include <algorithm>
#include <iterator>
#include <utility>

#include <kr3_common/error.hpp>

#include "ground_fluents.hpp"
#include "plan_program.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr long kMilli = 1000;

}  // namespace

void PlanProgram::checkLimit() const
{
  watch_->check("at horizon " + std::to_string(steps_.size()));
}

/// A literal that is free until it is assumed.
SolverLiteral PlanProgram::newGuard()
{
  ++num_guards_;
  Clingo::atom_t guard = 0;
  solver_.control().with_backend([&](Clingo::Backend& backend) {
    guard = backend.add_atom();
    backend.external(guard, Clingo::ExternalType::Free);
  });
  return static_cast<SolverLiteral>(guard);
}

/// Forbids the literals together.
void PlanProgram::addConstraint(std::vector<SolverLiteral> literals)
{
  RuleSink sink(solver_.control());
  sink.constraint(std::move(literals));
}

/// Whether there is a model under the assumptions; it is read then.
bool PlanProgram::solve(const Assumptions& assumptions, bool optimize)
{
  Assumptions open;
  for (const Assumptions* const some : {&std::as_const(start_values_), &assumptions})
  {
    for (const SolverLiteral literal : *some)
    {
      if (literal == kFalseLiteral)
      {
        return false;
      }
      if (literal != kTrueLiteral)
      {
        open.push_back(literal);
      }
    }
  }
  if (quality_ != PlanQuality::kNone)
  {
    solver_.configure("solve.opt_mode", optimize ? "opt" : "ignore");
    solver_.configure("solve.models", optimize ? "0" : "1");
  }
  checkLimit();
  auto handle =
      solver_.control().solve(Clingo::LiteralSpan(open.data(), open.size()), nullptr, false, true);
  bool found = false;
  for (handle.resume(); const Clingo::Model& model = handle.model(); handle.resume())
  {
    found = true;
    read(model);  // the last is the best
    if (!optimize)
    {
      break;
    }
  }
  const bool interrupted = handle.get().is_interrupted();
  checkLimit();
  if (interrupted)
  {
    throw InternalError("the solver was interrupted without a reason");
  }
  return found;
}

void PlanProgram::read(const Clingo::Model& model)
{
  const auto isTrue = [&](SolverLiteral literal) {
    return isConstant(literal) ? literal == kTrueLiteral : model.is_true(literal);
  };
  state_.clear();
  for (std::size_t i = 0; i < open_.size(); ++i)
  {
    const std::size_t first = dynamics_.firstValue(static_cast<std::size_t>(open_numbers_[i]));
    for (std::size_t v = 0; v < open_[i].values.size(); ++v)
    {
      if (isTrue(states_[0][first + v]))
      {
        state_.emplace_back(Encoding::term(literalOf(open_[i], "").atom), open_[i].values[v]);
        break;
      }
    }
  }
  planned_.assign(steps_.size(), {});
  for (std::size_t i = 0; i < steps_.size(); ++i)
  {
    for (const int a : agent_actions_)
    {
      const auto action = static_cast<std::size_t>(a);
      if (isTrue(steps_[i].planned[action]))
      {
        planned_[i].push_back(dynamics_.actions()[action].name);
      }
    }
    std::sort(planned_[i].begin(), planned_[i].end());
  }
  paid_.clear();
  std::copy_if(payments_.begin(), payments_.end(), std::back_inserter(paid_),
               [&](const Payment& paid) { return isTrue(paid.literal); });
  watched_truths_.clear();
  for (const SolverLiteral literal : watched_)
  {
    watched_truths_.push_back(isTrue(literal) ? 1 : 0);
  }
}

bool PlanProgram::goalMayBeFalse()
{
  RuleSink sink;
  const SolverLiteral holds = goalAt(goal_, start_, sink);
  return isConstant(holds) ? holds == kFalseLiteral : solve({fails_[0]});
}

bool PlanProgram::isUncovered()
{
  if (!is_uncovered_)
  {
    is_uncovered_ = solve({searching_});
  }
  return *is_uncovered_;
}

std::optional<Proposal> PlanProgram::propose(int length)
{
  if (is_uncovered_ == false)
  {
    return std::nullopt;
  }
  return proposal({searching_, queries_[static_cast<std::size_t>(length)]}, length);
}

std::optional<Proposal> PlanProgram::proposal(Assumptions assumptions, int length)
{
  for (auto i = static_cast<std::size_t>(length); i < steps_.size(); ++i)
  {
    assumptions.push_back(-steps_[i].busy);
  }
  if (!solve(assumptions, quality_ != PlanQuality::kNone))
  {
    return std::nullopt;
  }
  Proposal proposal;
  proposal.steps.assign(planned_.begin(), planned_.begin() + length);
  for (const auto& actions : proposal.steps)
  {
    proposal.num_actions += actions.size();
  }
  for (const Payment& paid : paid_)
  {
    proposal.cost_milli += paid.step < length ? paid.cost_milli : 0;
  }
  if (!has_costs_)
  {
    proposal.cost_milli = kMilli * static_cast<long>(proposal.num_actions);
  }
  while (!proposal.steps.empty() && proposal.steps.back().empty())
  {
    proposal.steps.pop_back();
  }
  proposal.state = state_;
  return proposal;
}

/// A literal that is true when the sum is above a bound.
SolverLiteral PlanProgram::sumAbove(long bound,
                                    const std::vector<Clingo::WeightedLiteral>& weighted)
{
  RuleSink sink(solver_.control());
  const SolverLiteral above = sink.newAtom();
  sink.weightRule(false, {static_cast<Clingo::atom_t>(above)}, static_cast<int>(bound) + 1,
                  weighted);
  return above;
}

SolverLiteral PlanProgram::costsMore(long cost_milli, int length)
{
  std::vector<Clingo::WeightedLiteral> weighted;
  for (const Payment& paid : payments_)
  {
    if (paid.step < length)
    {
      weighted.emplace_back(paid.literal, static_cast<int>(paid.cost_milli));
    }
  }
  return sumAbove(cost_milli, weighted);
}

SolverLiteral PlanProgram::hasMoreActions(std::size_t number, int length)
{
  std::vector<Clingo::WeightedLiteral> weighted;
  for (std::size_t i = 0; i < static_cast<std::size_t>(length); ++i)
  {
    for (const SolverLiteral planned : steps_[i].planned)
    {
      if (planned != kFalseLiteral)
      {
        weighted.emplace_back(planned, 1);
      }
    }
  }
  return sumAbove(static_cast<long>(number), weighted);
}

std::optional<Proposal> PlanProgram::proposeAnother(const Proposal& like,
                                                    const OpenValues& hypothesis,
                                                    const std::vector<PlanSteps>& but)
{
  const auto length = static_cast<int>(like.steps.size());
  const SolverLiteral guard = newGuard();
  for (const PlanSteps& steps : but)
  {
    std::vector<SolverLiteral> occurrences = {guard};
    for (const SolverLiteral chosen : fixed(steps, steps.size()))
    {
      if (chosen > 0)
      {
        occurrences.push_back(chosen);
      }
    }
    addConstraint(std::move(occurrences));
  }
  Assumptions assumptions = {guard, queries_[static_cast<std::size_t>(length)]};
  assume(assumptions, hypothesis);
  if (quality_ != PlanQuality::kNone)
  {
    assumptions.push_back(-hasMoreActions(like.num_actions, length));
  }
  if (has_costs_ && quality_ != PlanQuality::kFewestActions && quality_ != PlanQuality::kNone)
  {
    assumptions.push_back(-costsMore(like.cost_milli, length));
  }
  std::optional<Proposal> another = proposal(std::move(assumptions), length);
  if (another && another->steps.size() != like.steps.size())
  {
    return std::nullopt;
  }
  return another;
}

/// The plan's first steps and nothing else.
PlanProgram::Assumptions PlanProgram::fixed(const PlanSteps& steps, std::size_t upto) const
{
  Assumptions assumptions;
  for (std::size_t i = 0; i < steps_.size(); ++i)
  {
    for (const int a : agent_actions_)
    {
      const auto action = static_cast<std::size_t>(a);
      const SolverLiteral planned = steps_[i].planned[action];
      const bool chosen = i < upto && std::binary_search(steps[i].begin(), steps[i].end(),
                                                         dynamics_.actions()[action].name);
      assumptions.push_back(chosen ? planned : -planned);
    }
  }
  return assumptions;
}

SolverLiteral PlanProgram::valueAt(const GroundFluent& fluent, const std::string& value,
                                   std::size_t step) const
{
  const int index = dynamics_.valueIndex(dynamics_.fluentNumber(fluent.name), value);
  return states_[step][static_cast<std::size_t>(index)];
}

void PlanProgram::assume(Assumptions& assumptions, const OpenValues& values) const
{
  for (const auto& [fluent, value] : values)
  {
    assumptions.push_back(valueAt(open_[open_index_.at(fluent)], value, 0));
  }
}

std::optional<OpenValues> PlanProgram::failure(const PlanSteps& steps, const OpenValues& hypothesis)
{
  Assumptions assumptions = fixed(steps, steps.size());
  assumptions.push_back(fails_[steps.size()]);
  assume(assumptions, hypothesis);
  return solve(assumptions) ? std::optional<OpenValues>(state_) : std::nullopt;
}

std::optional<OpenValues> PlanProgram::dearer(const PlanSteps& steps, const OpenValues& hypothesis,
                                              long cost_milli)
{
  if (!has_costs_)
  {
    return std::nullopt;
  }
  Assumptions assumptions = fixed(steps, steps.size());
  assumptions.push_back(costsMore(cost_milli, static_cast<int>(steps.size())));
  assume(assumptions, hypothesis);
  return solve(assumptions) ? std::optional<OpenValues>(state_) : std::nullopt;
}

long PlanProgram::largestCost(const PlanSteps& steps, const OpenValues& hypothesis, long at_least)
{
  long cost = at_least;
  while (dearer(steps, hypothesis, cost))
  {
    cost = 0;
    for (const Payment& paid : paid_)
    {
      cost += paid.step < static_cast<int>(steps.size()) ? paid.cost_milli : 0;
    }
  }
  return cost;
}

std::optional<OpenValues> PlanProgram::stuck(const PlanSteps& steps, std::size_t step,
                                             const OpenValues& hypothesis,
                                             const std::vector<GroundFluent>& fluents)
{
  std::vector<SolverLiteral> literals;
  for (const GroundFluent& fluent : fluents)
  {
    for (const std::string& value : fluent.values)
    {
      const SolverLiteral literal = valueAt(fluent, value, step);
      if (!isConstant(literal))
      {
        literals.push_back(literal);
      }
    }
  }
  Assumptions before = fixed(steps, step);
  const Assumptions after = fixed(steps, step + 1);
  assume(before, hypothesis);
  const SolverLiteral guard = newGuard();
  before.push_back(guard);
  watched_ = literals;
  for (int seen = 0; solve(before); ++seen)
  {
    if (seen == kMaxStates)
    {
      throw ResourceExhausted("a step of a plan depends on more than " +
                              std::to_string(kMaxStates) + " combinations of unknown values");
    }
    const OpenValues found = state_;
    std::vector<SolverLiteral> there;
    for (std::size_t i = 0; i < literals.size(); ++i)
    {
      there.push_back(watched_truths_[i] != 0 ? literals[i] : -literals[i]);
    }
    Assumptions next = after;
    next.insert(next.end(), there.begin(), there.end());
    if (!solve(next))
    {
      return found;
    }
    there.push_back(guard);
    addConstraint(std::move(there));
  }
  return std::nullopt;
}

void PlanProgram::cover(const OpenValues& hypothesis)
{
  if (hypothesis.empty())
  {
    is_uncovered_ = false;  // by a plan for every state
    return;
  }
  is_uncovered_ = std::nullopt;
  has_additions_ = true;
  Assumptions literals = {searching_};
  assume(literals, hypothesis);
  addConstraint(std::move(literals));
}

void PlanProgram::coverAll(const std::vector<OpenValues>& hypotheses)
{
  if (hypotheses.empty())
  {
    return;
  }
  is_uncovered_ = std::nullopt;
  has_additions_ = true;
  RuleSink sink(solver_.control());
  for (const OpenValues& hypothesis : hypotheses)
  {
    Assumptions literals = {searching_};
    assume(literals, hypothesis);
    sink.constraint(std::move(literals));
  }
}

void PlanProgram::forbid(const PlanSteps& steps, int length)
{
  has_additions_ = true;
  Assumptions literals = fixed(steps, steps.size());
  literals.push_back(searching_);
  literals.push_back(queries_[static_cast<std::size_t>(length)]);
  addConstraint(std::move(literals));
}

}  // namespace kr3::reasoner
