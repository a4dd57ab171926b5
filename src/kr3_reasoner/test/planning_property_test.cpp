// Plans on random descriptions and histories: against an enumeration of what can happen, and on the
// relevant part against the whole. The number of cases is 12 each, or what KR3_REASONER_CASES says;
// the first seed is 1, or KR3_REASONER_SEED.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/oracle.hpp"
#include "support/random_case.hpp"

namespace kr3::reasoner
{
namespace
{

constexpr int kHorizon = 3;
constexpr std::size_t kMostActions = 6;
constexpr std::uint64_t kGoals = 5;  // a case

long numberFrom(const char* variable, long otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtol(text, nullptr, 10);
}

/// A goal of one or two literals over the domain.
std::string randomGoal(const oracle::GroundDomain& domain, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  const auto below = [&](std::size_t limit) { return static_cast<int>(random() % limit); };
  const auto literal = [&] {
    oracle::GroundLiteral drawn;
    drawn.fluent = below(domain.fluents.size());
    const auto& info = domain.fluents[static_cast<std::size_t>(drawn.fluent)];
    drawn.value = below(info.values.size());
    drawn.equal = info.boolean || below(4) > 0;
    return oracle::toString(drawn, domain);
  };
  static const std::vector<std::string> kConnectives = {" and ", " or ", " and not "};
  const std::string first = literal();
  return below(2) == 0 ? first
                       : first + kConnectives[static_cast<std::size_t>(below(3))] + literal();
}

bool isTrue(const Formula& goal, const oracle::Values& state, const Description& description,
            const oracle::GroundDomain& domain)
{
  const auto operand = [&](const Formula& part) {
    return isTrue(part, state, description, domain);
  };
  switch (goal.kind)
  {
    case Formula::Kind::kLiteral:
    {
      const auto literal = oracle::literalOf(goal.literal, domain);
      return literal ? oracle::holds({*literal}, state)
                     : oracle::staticHolds(goal.literal, description, domain);
    }
    case Formula::Kind::kNot:
      return !operand(goal.operands[0]);
    case Formula::Kind::kAnd:
      return std::all_of(goal.operands.begin(), goal.operands.end(), operand);
    case Formula::Kind::kOr:
      return std::any_of(goal.operands.begin(), goal.operands.end(), operand);
  }
  return false;
}

/// Plans by breadth-first search over sets of states.
class PlanOracle
{
public:
  using Belief = std::set<std::size_t>;

  PlanOracle(const Description& description, const oracle::GroundDomain& domain, Formula goal)
    : description_(description), domain_(domain), diagram_(domain, 3000), goal_(std::move(goal))
  {
    std::vector<int> agent;
    for (std::size_t i = 0; i < domain.actions.size(); ++i)
    {
      if (!domain.actions[i].exogenous)
      {
        agent.push_back(static_cast<int>(i));
      }
    }
    if (agent.size() > kMostActions)
    {
      throw ResourceExhausted("too many actions");
    }
    for (unsigned mask = 1; mask < (1U << agent.size()); ++mask)
    {
      joint_.emplace_back();
      for (std::size_t i = 0; i < agent.size(); ++i)
      {
        if ((mask >> i & 1U) != 0)
        {
          joint_.back().insert(agent[i]);
        }
      }
    }
  }

  [[nodiscard]] std::size_t indexOf(const oracle::Values& state) const
  {
    const auto& states = diagram_.states();
    return static_cast<std::size_t>(std::find(states.begin(), states.end(), state) -
                                    states.begin());
  }

  [[nodiscard]] const oracle::Values& state(std::size_t index) const
  {
    return diagram_.states()[index];
  }

  [[nodiscard]] bool meetsGoal(std::size_t state) const
  {
    return isTrue(goal_, diagram_.states()[state], description_, domain_);
  }

  /// Where a joint action leads from all of some states, or nothing when it may be impossible.
  [[nodiscard]] std::optional<Belief> after(const Belief& belief,
                                            const std::set<int>& actions) const
  {
    Belief next;
    for (const std::size_t state : belief)
    {
      const bool possible = diagram_.possible(diagram_.states()[state], actions);
      if (!possible || diagram_.successors(state, actions).empty())
      {
        return std::nullopt;
      }
      const auto& successors = diagram_.successors(state, actions);
      next.insert(successors.begin(), successors.end());
    }
    return next;
  }

  [[nodiscard]] bool meetsGoal(const Belief& belief) const
  {
    return std::all_of(belief.begin(), belief.end(),
                       [this](std::size_t state) { return meetsGoal(state); });
  }

  /// The length of the shortest plan from one state, up to the horizon; none: 0.
  [[nodiscard]] int shortest(std::size_t state) const
  {
    std::set<Belief> seen = {{state}};
    std::vector<Belief> front = {{state}};
    for (int length = 1; length <= kHorizon; ++length)
    {
      std::vector<Belief> next_front;
      for (const Belief& belief : front)
      {
        for (const std::set<int>& actions : joint_)
        {
          const auto next = after(belief, actions);
          if (next && meetsGoal(*next))
          {
            return length;
          }
          if (next && seen.insert(*next).second)
          {
            next_front.push_back(*next);
          }
        }
      }
      front = std::move(next_front);
    }
    return 0;
  }

  /// Whether a plan is executable and reaches the goal in every one of these states.
  [[nodiscard]] bool works(const Plan& plan, Belief belief) const
  {
    for (const auto& step : plan.steps)
    {
      std::set<int> actions;
      for (const std::string& action : step)
      {
        actions.insert(oracle::actionOf(action, domain_));
      }
      const auto next = after(belief, actions);
      if (!next)
      {
        return false;
      }
      belief = *next;
    }
    return meetsGoal(belief);
  }

private:
  const Description& description_;
  const oracle::GroundDomain& domain_;
  oracle::Diagram diagram_;
  Formula goal_;
  std::vector<std::set<int>> joint_;
};

std::string textOf(const PlanResult& result)
{
  std::string text = result.goal_entailed ? "entailed" : result.reason;
  for (const Plan& plan : result.plans)
  {
    text += "\n ";
    for (const std::string& literal : plan.hypothesis)
    {
      text += " [" + literal + "]";
    }
    for (const auto& step : plan.steps)
    {
      text += " {";
      for (const std::string& action : step)
      {
        text += " " + action;
      }
      text += " }";
    }
  }
  return text;
}

struct Setting
{
  Description description;
  std::vector<Record> records;
  Reasoner reasoner;
  oracle::GroundDomain domain;
  std::vector<std::string> goals;
};

Setting settingOf(const RandomCase& drawn)
{
  Description description = parseDescription(drawn.description, "random");
  std::vector<Record> records = parseHistory(drawn.history, "history", description);
  Reasoner reasoner(description, drawn.options);
  reasoner.setHistory(records);
  oracle::GroundDomain domain = oracle::grounded(description);
  std::vector<std::string> goals;
  for (std::uint64_t i = 0; i < kGoals; ++i)
  {
    goals.push_back(randomGoal(domain, kGoals * drawn.seed + i));
  }
  return {std::move(description), std::move(records), std::move(reasoner), std::move(domain),
          std::move(goals)};
}

/// Nothing when it takes too long: where luck is involved, very many plans may have to be refused.
std::optional<PlanResult> planSoon(const Reasoner& reasoner, const std::string& goal,
                                   bool relevant_only)
{
  PlanOptions options;
  options.max_horizon = kHorizon;
  options.time_limit = std::chrono::milliseconds(500);
  options.relevant_only = relevant_only;
  try
  {
    PlanResult result = reasoner.plan(goal, options);
    const bool timely = result.reason.find("time limit") == std::string::npos;
    return timely ? std::optional<PlanResult>(std::move(result)) : std::nullopt;
  }
  catch (const DeadlineExceeded&)
  {
    return std::nullopt;
  }
}

/// @return whether the case was small enough
bool compareWithEnumeration(const Setting& setting, const std::string& goal,
                            const ReasonerOptions& assumptions, bool relevant_only,
                            std::size_t& num_plans)
{
  oracle::Answers answers;
  std::optional<PlanOracle> plans;
  try
  {
    answers = oracle::answersOf(setting.description, setting.records, assumptions);
    plans.emplace(setting.description, setting.domain, parseGoal(goal, setting.description));
  }
  catch (const ResourceExhausted&)
  {
    return false;
  }
  const std::optional<PlanResult> planned = planSoon(setting.reasoner, goal, relevant_only);
  if (!planned)
  {
    return false;
  }
  const PlanResult& result = *planned;
  SCOPED_TRACE(textOf(result));
  if (!answers.consistent)
  {
    EXPECT_NE(result.reason.find("inconsistent"), std::string::npos);
    return true;
  }
  PlanOracle::Belief now;
  for (const oracle::Model& model : answers.models)
  {
    now.insert(plans->indexOf(model.states.back()));
  }
  EXPECT_EQ(result.goal_entailed, plans->meetsGoal(now));
  if (result.goal_entailed)
  {
    return true;
  }
  std::map<std::size_t, int> found;  // the shortest plan whose hypothesis a state satisfies
  for (const Plan& plan : result.plans)
  {
    oracle::GroundBody hypothesis;
    for (const std::string& literal : plan.hypothesis)
    {
      hypothesis.push_back(
          *oracle::literalOf(parseGroundLiteral(literal, setting.description), setting.domain));
    }
    PlanOracle::Belief assumed;
    for (const std::size_t state : now)
    {
      if (oracle::holds(hypothesis, plans->state(state)))
      {
        assumed.insert(state);
        const int length = static_cast<int>(plan.steps.size());
        const auto [place, fresh] = found.emplace(state, length);
        place->second = std::min(place->second, length);
      }
    }
    EXPECT_FALSE(assumed.empty());
    EXPECT_TRUE(plans->works(plan, assumed));
    ++num_plans;
  }
  for (const std::size_t state : now)
  {
    if (!plans->meetsGoal(state))
    {
      EXPECT_EQ(found[state], plans->shortest(state)) << "from the state " << state;
    }
  }
  return true;
}

TEST(PlanningProperty, PlansAreShortestAndWorkInEveryModelOfTheirHypothesis)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 12);
  std::size_t compared = 0;
  std::size_t num_plans = 0;
  for (long seed = first; seed < first + cases && !HasFailure(); ++seed)
  {
    CaseSize size;
    size.max_places = 2;
    size.max_steps = 1;
    size.max_records = 4;
    const RandomCase drawn = randomCase(static_cast<std::uint64_t>(seed), size);
    SCOPED_TRACE(toString(drawn));
    const Setting setting = settingOf(drawn);
    if (!Reasoner(setting.description, drawn.options).diagnose().consistent)
    {
      continue;  // no state at all: relevance takes descriptions for consistent
    }
    for (const std::string& goal : setting.goals)
    {
      SCOPED_TRACE("goal: " + goal);
      compared +=
          compareWithEnumeration(setting, goal, drawn.options, seed % 2 == 0, num_plans) ? 1 : 0;
    }
  }
  std::cout << compared << " goals compared, with " << num_plans << " plans\n";
  EXPECT_GT(compared, static_cast<std::size_t>(cases));
  EXPECT_GT(num_plans, static_cast<std::size_t>(cases) / 10);
}

/// Literals as a set: the order in which a hypothesis names them means nothing.
using Hypothesis = std::set<std::string>;

/// The hypotheses, each with the length of its plan.
std::set<std::pair<Hypothesis, std::size_t>> hypotheses(const PlanResult& result)
{
  std::set<std::pair<Hypothesis, std::size_t>> found;
  for (const Plan& plan : result.plans)
  {
    found.emplace(Hypothesis(plan.hypothesis.begin(), plan.hypothesis.end()), plan.steps.size());
  }
  return found;
}

/// The current states of the models of a history, as literals; nothing when there are too many.
std::optional<std::set<Hypothesis>> currentStates(const Reasoner& reasoner)
{
  constexpr std::size_t kMostModels = 2000;
  std::set<Hypothesis> states;
  const std::vector<HistoryModel> models = reasoner.models(kMostModels);
  for (const HistoryModel& model : models)
  {
    Hypothesis state;
    for (const Literal& literal : model.states.back())
    {
      state.insert(toString(literal, reasoner.description()));
      state.insert(toString(literal));
    }
    states.insert(std::move(state));
  }
  return models.size() < kMostModels ? std::optional(std::move(states)) : std::nullopt;
}

/// The length of the shortest plan whose hypothesis a state satisfies; 0: there is none.
std::size_t shortestIn(const Hypothesis& state, const PlanResult& result)
{
  std::size_t shortest = 0;
  for (const Plan& plan : result.plans)
  {
    const bool assumed =
        std::all_of(plan.hypothesis.begin(), plan.hypothesis.end(),
                    [&](const std::string& literal) { return state.count(literal); });
    if (assumed && (shortest == 0 || plan.steps.size() < shortest))
    {
      shortest = plan.steps.size();
    }
  }
  return shortest;
}

/// How the answers on the part and on the whole agreed.
struct Agreement
{
  std::size_t cases = 0;
  std::size_t goals = 0;         ///< that both answered in time
  std::size_t plans = 0;         ///< on the whole
  std::size_t hypotheses = 0;    ///< on the whole, that assume something
  std::size_t worded_alike = 0;  ///< goals with hypotheses, all of which are the same literals
  std::size_t worded_otherwise = 0;
  std::size_t smaller = 0;  ///< goals with a part that is smaller than the whole
};

/// The answer on the part is that on the whole: whether the goal is entailed, whether the history
/// is consistent, whether all states are covered, and which hypotheses have plans of which lengths.
///
/// Where unknown fluents depend on each other, a hypothesis can be worded over one or over another;
/// which the solver comes upon first is chance. Two families of hypotheses are therefore equal when
/// in each possible current state the shortest plan of those whose hypothesis is true there is
/// equally long, or there is none in both.
void compareParts(const Reasoner& reasoner, const PlanResult& part, const PlanResult& whole,
                  Agreement& agreement)
{
  EXPECT_EQ(part.goal_entailed, whole.goal_entailed);
  EXPECT_EQ(part.covers_all, whole.covers_all);
  EXPECT_EQ(part.plans.empty(), whole.plans.empty());
  const bool inconsistent = whole.reason.find("inconsistent") != std::string::npos;
  EXPECT_EQ(part.reason.find("inconsistent") != std::string::npos, inconsistent);
  ++agreement.goals;
  agreement.plans += whole.plans.size();
  agreement.smaller += part.considered.fluents < part.whole.fluents ? 1 : 0;
  const auto of_whole = hypotheses(whole);
  const auto assumes = static_cast<std::size_t>(
      std::count_if(of_whole.begin(), of_whole.end(),
                    [](const auto& hypothesis) { return !hypothesis.first.empty(); }));
  agreement.hypotheses += assumes;
  if (hypotheses(part) == of_whole)
  {
    agreement.worded_alike += assumes > 0 ? 1 : 0;
    return;
  }
  ++agreement.worded_otherwise;
  ASSERT_FALSE(inconsistent);
  const std::optional<std::set<Hypothesis>> states = currentStates(reasoner);
  ASSERT_TRUE(states) << "too many models to compare hypotheses";
  for (const Hypothesis& state : *states)
  {
    std::string text;
    for (const std::string& literal : state)
    {
      text += literal + "; ";
    }
    EXPECT_EQ(shortestIn(state, part), shortestIn(state, whole)) << "in the state " << text;
  }
}

TEST(PlanningProperty, TheRelevantPartGivesTheAnswerOfTheWhole)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 12);
  Agreement agreement;
  for (long seed = first; seed < first + cases && !HasFailure(); ++seed)
  {
    CaseSize size;
    size.max_things = 3;
    size.max_records = 4;
    const RandomCase drawn = randomCase(static_cast<std::uint64_t>(seed), size);
    SCOPED_TRACE(toString(drawn));
    const Setting setting = settingOf(drawn);
    if (!Reasoner(setting.description, drawn.options).diagnose().consistent)
    {
      continue;  // no state at all: relevance takes descriptions for consistent
    }
    ++agreement.cases;
    for (const std::string& goal : setting.goals)
    {
      SCOPED_TRACE("goal: " + goal);
      const std::optional<PlanResult> part = planSoon(setting.reasoner, goal, true);
      const std::optional<PlanResult> whole = part ? planSoon(setting.reasoner, goal, false) : part;
      if (part && whole)
      {
        SCOPED_TRACE("part: " + textOf(*part) + "\nwhole: " + textOf(*whole));
        compareParts(setting.reasoner, *part, *whole, agreement);
      }
    }
  }
  std::cout << agreement.goals << " goals of " << agreement.cases << " cases, " << agreement.plans
            << " plans, " << agreement.hypotheses << " hypotheses; worded alike for "
            << agreement.worded_alike << " goals, otherwise for " << agreement.worded_otherwise
            << "; the relevant part was smaller for " << agreement.smaller << " goals\n";
  EXPECT_GT(agreement.smaller, static_cast<std::size_t>(cases) / 4);
  EXPECT_GT(agreement.worded_alike, agreement.worded_otherwise);
}

}  // namespace
}  // namespace kr3::reasoner
