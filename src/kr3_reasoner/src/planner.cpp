#include "planner.hpp"

#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "domain_knowledge.hpp"
#include "kr3_reasoner/situation.hpp"
#include "plan_reach.hpp"
#include "plan_trial.hpp"
#include "unsolvable.hpp"

namespace kr3::reasoner
{

namespace
{

using Clock = std::chrono::steady_clock;
constexpr double kMilli = 1000.0;

PlanQuality qualityOf(const Description& description, PlanPreference preference, bool serial)
{
  // Where every action costs the same and excludes the others, steps, actions and costs agree.
  const bool uniform = description.costs.empty();
  if (serial && (uniform || preference == PlanPreference::kShortest))
  {
    return PlanQuality::kNone;
  }
  switch (preference)
  {
    case PlanPreference::kShortest:
      return PlanQuality::kFewestActions;
    case PlanPreference::kCheapestShortest:
      return uniform ? PlanQuality::kFewestActions : PlanQuality::kLeastCost;
    case PlanPreference::kCheapest:
      return PlanQuality::kLeastCostAnyLength;
  }
  return PlanQuality::kNone;
}

}  // namespace

class Planner::Search
{
public:
  Search(const PlanningProblem& problem, const Formula& goal, const PlanOptions& options,
         const std::atomic<bool>* cancel)
    : problem_(problem)
    , goal_(goal)
    , options_(options)
    , rules_(problem.domain.groundRules())
    , quality_(qualityOf(problem.description, options.preference, rules_.serial()))
    , limit_{Clock::now() + options.time_limit, cancel}
    , key_(std::to_string(static_cast<int>(quality_)) + " " + toString(goal))
    , reach_(rules_, problem.consequences, problem.now)
  {
  }

  PlanResult run()
  {
    if (std::optional<PlanResult> result = warmAnswer())
    {
      return std::move(*result);
    }
    program_ =
        std::make_unique<PlanProgram>(problem_, goal_, quality_, PlanProgram::Start::kAfterHistory);
    program_->begin(problem_, limit_);
    return answer();
  }

private:
  /// The answer of a program that is kept from question to question; it pays from the second
  /// question about a goal on. Nothing when it needs what only the history tells.
  std::optional<PlanResult> warmAnswer()
  {
    PlanProgramStore& plans = problem_.domain.plans();
    if (!plans.isAskedAgain(key_) || !problem_.description.asp_blocks.empty())
    {
      return std::nullopt;
    }
    program_ = plans.take(key_);
    if (!program_)
    {
      program_ =
          std::make_unique<PlanProgram>(problem_, goal_, quality_, PlanProgram::Start::kAnyState);
    }
    program_->begin(problem_, limit_);
    std::optional<PlanResult> result;
    if (program_->isExact())
    {
      result = answer();
    }
    else if (program_->isDecided() && !options_.all && problem_.description.costs.empty())
    {
      result = sureAnswer();
    }
    if (program_->end())  // not interrupted: it serves for the next question
    {
      plans.keep(key_, std::move(program_));
    }
    return result;
  }

  /// As answer(), of a program that starts from more states than are possible. Nothing when the
  /// first plan that it finds does not work from all of them; a plan that does needs no hypothesis,
  /// and a length that has no plan here has none from the possible states.
  std::optional<PlanResult> sureAnswer()
  {
    if (!program_->goalMayBeFalse())
    {
      result_.goal_entailed = true;
      return std::move(result_);
    }
    const bool any_length = quality_ == PlanQuality::kLeastCostAnyLength;
    for (int length = any_length ? options_.max_horizon : 1;
         length <= options_.max_horizon && program_->isUncovered(); ++length)
    {
      tell(length);
      program_->extendTo(length);
      if (const std::optional<Proposal> proposal = program_->propose(length))
      {
        if (!program_->surelyWorks(proposal->steps))
        {
          return std::nullopt;
        }
        result_.plans.push_back(planOf(*proposal, {}));
        return std::move(result_);
      }
    }
    result_.covers_all = false;
    result_.reason = whyUnsolvable(problem_, goal_, options_.max_horizon, unverified_, limit_);
    return std::move(result_);
  }

  PlanResult answer()
  {
    if (!program_->goalMayBeFalse())
    {
      result_.goal_entailed = true;
      return std::move(result_);
    }
    try
    {
      if (quality_ == PlanQuality::kLeastCostAnyLength)
      {
        tell(options_.max_horizon);
        program_->extendTo(options_.max_horizon);
        findPlans(options_.max_horizon);
      }
      else
      {
        for (int length = 1; length <= options_.max_horizon && program_->isUncovered(); ++length)
        {
          tell(length);
          program_->extendTo(length);
          findPlans(length);
        }
      }
      result_.covers_all = !program_->isUncovered();
    }
    catch (const DeadlineExceeded& e)
    {
      if (result_.plans.empty())
      {
        throw;
      }
      result_.complete = false;
      result_.covers_all = false;
      result_.reason = e.what();
      return std::move(result_);
    }
    if (result_.plans.empty())
    {
      result_.reason = whyUnsolvable(problem_, goal_, options_.max_horizon, unverified_, limit_);
    }
    return std::move(result_);
  }

  void tell(int length) const
  {
    if (options_.on_horizon)
    {
      options_.on_horizon(length);
    }
  }

  /// The plans of a length, one for each hypothesis.
  void findPlans(int length)
  {
    while (std::optional<Proposal> proposal = program_->propose(length))
    {
      const std::optional<std::vector<std::size_t>> hypothesis = hypothesisOf(*proposal);
      if (!hypothesis)
      {
        program_->forbid(proposal->steps, length);
        continue;
      }
      const OpenValues assumed = chosen(proposal->state, *hypothesis);
      std::vector<Plan> plans = {planOf(*proposal, assumed)};
      if (options_.all)
      {
        addOthers(*proposal, assumed, plans);
      }
      result_.plans.insert(result_.plans.end(), std::make_move_iterator(plans.begin()),
                           std::make_move_iterator(plans.end()));
      program_->cover(assumed);
      addAnalogous(*proposal, assumed);
    }
  }

  /// The same plan under other values of the one fluent that it rests on, with their names in it,
  /// where no solver is needed to see that it works, and not without the hypothesis. Places to look
  /// into are often alike.
  void addAnalogous(const Proposal& proposal, const OpenValues& hypothesis)
  {
    if (hypothesis.size() != 1)
    {
      singles_.reset();
    }
    else if (singles_)
    {
      singles_->insert(hypothesis.front());
    }
    const bool same_fluent =
        singles_ && std::all_of(singles_->begin(), singles_->end(), [&](const auto& single) {
          return single.first == hypothesis.front().first;
        });
    if (!same_fluent || options_.all || quality_ != PlanQuality::kNone)
    {
      return;
    }
    const auto& [fluent, value] = hypothesis.front();
    std::vector<OpenValues> covered;
    for (const std::string& other : program_->possibleValues(fluent))
    {
      const OpenValues there = {{fluent, other}};
      if (singles_->count(there.front()) > 0)
      {
        continue;
      }
      Renaming swapped;
      swapped.set(value, other);
      swapped.set(other, value);
      Proposal analogous = proposal;
      for (auto& actions : analogous.steps)
      {
        for (std::string& action : actions)
        {
          action = swapped.ofText(action);
        }
        std::sort(actions.begin(), actions.end());
      }
      if (program_->surelyOpen(there) && program_->surelyWorks(analogous.steps, there) &&
          program_->surelyFails(analogous.steps, hypothesis))
      {
        result_.plans.push_back(planOf(analogous, there));
        singles_->insert(there.front());
        covered.push_back(there);
      }
    }
    program_->coverAll(covered);
  }

  [[nodiscard]] Plan planOf(const Proposal& proposal, const OpenValues& hypothesis)
  {
    Plan plan;
    plan.steps = proposal.steps;
    for (const auto& value : hypothesis)
    {
      plan.hypothesis.push_back(program_->literalText(value));
    }
    plan.cost = static_cast<double>(
                    program_->largestCost(proposal.steps, hypothesis, proposal.cost_milli)) /
                kMilli;
    return plan;
  }

  /// The other plans for a hypothesis that are as good; all of them sorted.
  void addOthers(const Proposal& first, const OpenValues& hypothesis, std::vector<Plan>& plans)
  {
    std::vector<PlanSteps> seen = {first.steps};
    while (std::optional<Proposal> other = program_->proposeAnother(first, hypothesis, seen))
    {
      if (plans.size() == static_cast<std::size_t>(options_.max_plans))
      {
        result_.complete = false;
        break;
      }
      seen.push_back(other->steps);
      if (!counterexample(*other, hypothesis))
      {
        plans.push_back(planOf(*other, hypothesis));
      }
    }
    std::sort(plans.begin(), plans.end(),
              [](const Plan& a, const Plan& b) { return a.steps < b.steps; });
  }

  static OpenValues chosen(const OpenValues& values, const std::vector<std::size_t>& indices)
  {
    OpenValues some;
    for (const std::size_t index : indices)
    {
      some.push_back(values[index]);
    }
    return some;
  }

  /// The state of a model that agrees with the hypothesis and in which the plan is not what it
  /// should be.
  std::optional<OpenValues> counterexample(const Proposal& proposal, const OpenValues& hypothesis)
  {
    const bool surely_works = program_->surelyWorks(proposal.steps, hypothesis);
    if (!surely_works)
    {
      if (auto state = program_->failure(proposal.steps, hypothesis))
      {
        return state;
      }
    }
    if (quality_ == PlanQuality::kLeastCost || quality_ == PlanQuality::kLeastCostAnyLength)
    {
      if (auto state = program_->dearer(proposal.steps, hypothesis, proposal.cost_milli))
      {
        return state;
      }
    }
    if (surely_works)
    {
      return std::nullopt;
    }
    reach_.restart();
    for (std::size_t step = 0; step < proposal.steps.size(); ++step)
    {
      const std::vector<GroundFluent> fluents = reach_.next(proposal.steps[step]);
      if (fluents.empty())
      {
        continue;
      }
      if (auto state = program_->stuck(proposal.steps, step, hypothesis, fluents))
      {
        return state;
      }
    }
    return std::nullopt;
  }

  /// Open fluents (indices) whose values in the proposal's model make the plan work in every model
  /// that agrees with them; nothing when it can fail whatever is assumed.
  std::optional<std::vector<std::size_t>> hypothesisOf(const Proposal& proposal)
  {
    std::vector<std::size_t> hypothesis;
    try
    {
      while (const auto state = counterexample(proposal, chosen(proposal.state, hypothesis)))
      {
        const std::size_t before = hypothesis.size();
        for (std::size_t i = 0; i < state->size(); ++i)
        {
          if (proposal.state[i].second != (*state)[i].second)
          {
            hypothesis.push_back(i);
          }
        }
        if (hypothesis.size() == before)
        {
          return std::nullopt;
        }
      }
      for (std::size_t i = 0; i < hypothesis.size();)
      {
        std::vector<std::size_t> shorter = hypothesis;
        shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(i));
        // Without any there is a counterexample: it was the first.
        if (shorter.empty() || counterexample(proposal, chosen(proposal.state, shorter)))
        {
          ++i;
        }
        else
        {
          hypothesis = std::move(shorter);
        }
      }
    }
    catch (const ResourceExhausted& e)
    {
      unverified_ = e.what();
      return std::nullopt;
    }
    std::sort(hypothesis.begin(), hypothesis.end());
    return hypothesis;
  }

  const PlanningProblem& problem_;
  const Formula& goal_;
  const PlanOptions& options_;
  const GroundRules& rules_;
  PlanQuality quality_;
  SearchLimit limit_;
  std::string key_;  // of the program among those that are kept
  std::unique_ptr<PlanProgram> program_;
  PlanReach reach_;
  PlanResult result_;
  // The hypotheses so far, as long as each is the value of one fluent.
  std::optional<std::set<std::pair<std::string, std::string>>> singles_{std::in_place};
  std::string unverified_;  // why a plan that may be right was not accepted
};

Planner::Planner(DomainKnowledge& domain, const HistoryProgram& program,
                 const std::vector<CheckedRecord>& records, int current_step,
                 const Optimum& optimum, const Consequences& consequences)
  : problem_{domain, domain.description(), program, records, current_step, optimum, consequences}
{
}

PlanResult Planner::plan(const Formula& goal, const PlanOptions& options,
                         const std::atomic<bool>* cancel) const
{
  const std::clock_t start = std::clock();
  PlanResult result = Search(problem_, goal, options, cancel).run();
  result.cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return result;
}

}  // namespace kr3::reasoner
