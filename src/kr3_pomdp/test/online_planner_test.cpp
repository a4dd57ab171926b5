#include "kr3_pomdp/online_planner.hpp"

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/particle_belief.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

OnlineOptions counted(std::uint64_t expansions)
{
  OnlineOptions options;
  options.time_s = 0.0;
  options.max_expansions = expansions;
  return options;
}

TEST(OnlinePlanner, ListensToTheTigerUntilItIsSure)
{
  const Model tiger = test::tiger();
  const SampledModel model(tiger);
  const OnlinePlanner planner(model, counted(50));
  EXPECT_EQ(tiger.actionName(planner.plan(sampler(Belief({0.5, 0.5})), 1).action), "listen");
  EXPECT_EQ(tiger.actionName(planner.plan(sampler(Belief({0.99, 0.01})), 1).action), "open_right");
  EXPECT_EQ(tiger.actionName(planner.plan(sampler(Belief({0.01, 0.99})), 1).action), "open_left");
}

/// Discounted return of planning anew at each step.
double simulatedReturn(const Model& model, const OnlinePlanner& planner, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  Belief belief = model.initialBelief();
  std::size_t state = sampleState(belief, random);
  double sum = 0.0;
  for (double weight = 1.0; weight > 0.02; weight *= model.discount())
  {
    const std::size_t action = planner.plan(sampler(belief), random()).action;
    sum += weight * model.reward(action, state);
    const SampledStep step = sampleStep(model, state, action, random);
    belief = updated(model, belief, action, step.observation).posterior;
    state = step.next_state;
  }
  return sum;
}

TEST(OnlinePlanner, EarnsWhatTheBestPolicyEarns)
{
  const Model tiger = test::tiger(0.75);
  SolverLimits limits;
  limits.max_backups = 100000;
  const double optimum = solve(tiger, limits).lower;
  const SampledModel model(tiger);
  OnlineOptions options = counted(15);
  options.num_scenarios = 60;
  options.max_depth = 12;
  const OnlinePlanner planner(model, options);
  constexpr int kTrials = 60;
  double mean = 0.0;
  double squares = 0.0;
  for (int trial = 0; trial < kTrials; ++trial)
  {
    const double value = simulatedReturn(tiger, planner, static_cast<std::uint64_t>(trial));
    mean += value / kTrials;
    squares += value * value / kTrials;
  }
  const double error = std::sqrt((squares - mean * mean) / kTrials);
  EXPECT_NEAR(mean, optimum, 4.0 * error + 0.05 * std::abs(optimum)) << "s.e. " << error;
}

TEST(OnlinePlanner, ManyScenariosBracketTheOptimum)
{
  for (std::uint64_t seed = 0; seed < 5; ++seed)
  {
    const Model random = test::randomModel({3, 2, 2, 0.6}, seed);
    SolverLimits limits;
    limits.precision = 1e-4;
    limits.max_backups = 100000;
    const double optimum = solve(random, limits).lower;
    const SampledModel model(random);
    OnlineOptions options = counted(300);
    options.num_scenarios = 2000;
    options.max_depth = 15;
    options.regularisation = 0.0;
    const OnlineDecision decision =
        OnlinePlanner(model, options).plan(sampler(random.initialBelief()), seed);
    EXPECT_LE(decision.lower, decision.upper + 1e-9);
    EXPECT_LE(decision.lower, optimum + 0.1) << seed;
    EXPECT_GE(decision.upper, optimum - 0.1) << seed;
  }
}

TEST(OnlinePlanner, CountedWorkRepeatsExactly)
{
  const Model room = test::roomSearch(2);
  const SampledModel model(room);
  const OnlinePlanner planner(model, counted(50));
  const OnlineDecision first = planner.plan(sampler(room.initialBelief()), 7);
  const OnlineDecision second = planner.plan(sampler(room.initialBelief()), 7);
  EXPECT_EQ(first.action, second.action);
  EXPECT_EQ(first.lower, second.lower);
  EXPECT_EQ(first.upper, second.upper);
  EXPECT_EQ(first.num_nodes, second.num_nodes);
  EXPECT_NE(first.lower, planner.plan(sampler(room.initialBelief()), 8).lower);
}

TEST(OnlinePlanner, AnOfflinePolicyIsTheFirstLowerBound)
{
  const Model room = test::roomSearch(2);
  SolverLimits limits;
  limits.max_backups = 20000;
  const SolveResult offline = solve(room, limits);
  const SampledModel informed(room, &offline.policy);
  OnlineOptions options = counted(1);
  options.num_scenarios = 1000;
  const OnlineDecision decision =
      OnlinePlanner(informed, options).plan(sampler(room.initialBelief()), 3);
  EXPECT_NEAR(decision.lower, offline.lower, 4.0);  // sampling: s.e. of about 1.3
}

/// A number in [0, 2^40) is hidden; asking compares it with a limit of its own that halves the
/// interval, which the state holds; there are far too many states to list.
class Guess : public GenerativeModel
{
public:
  static constexpr std::uint64_t kStates = std::uint64_t{1} << 40U;
  enum Action : std::size_t
  {
    kAsk,   // costs 1; tells the highest bit
    kLow,   // earns 10 if that bit is 0, else -10; ends
    kHigh,  // the other way round
  };
  [[nodiscard]] std::size_t numActions() const override { return 3; }
  [[nodiscard]] double discount() const override { return 0.95; }
  [[nodiscard]] GenerativeStep step(std::uint64_t state, std::size_t action,
                                    double random) const override
  {
    const bool high = state >= kStates / 2;
    if (action == kAsk)
    {
      return {state, static_cast<std::uint64_t>(high != (random < 0.1)), -1.0, false};
    }
    return {state, 0, high == (action == kHigh) ? 10.0 : -10.0, true};
  }
  [[nodiscard]] double upperBound(std::uint64_t /*state*/) const override { return 10.0; }
  [[nodiscard]] std::size_t defaultAction(const std::vector<std::uint64_t>& states) const override
  {
    std::size_t high = 0;
    for (const std::uint64_t state : states)
    {
      high += state >= kStates / 2 ? 1U : 0U;
    }
    return 2 * high > states.size() ? kHigh : kLow;
  }
};

TEST(OnlinePlanner, PlansOnModelsThatAreOnlySampled)
{
  const Guess model;
  const OnlinePlanner planner(model, counted(300));
  const auto anywhere = [](double u) {
    return static_cast<std::uint64_t>(u * static_cast<double>(Guess::kStates));
  };
  const OnlineDecision unsure = planner.plan(anywhere, 1);
  EXPECT_EQ(unsure.action, Guess::kAsk);
  // Asking twice and more makes it worth about 7; guessing at once is worth 0.
  EXPECT_GT(unsure.lower, 5.0);
  EXPECT_LT(unsure.upper, 9.0);
  const auto high = [](double u) {
    return static_cast<std::uint64_t>((0.5 + 0.5 * u) * static_cast<double>(Guess::kStates));
  };
  EXPECT_EQ(planner.plan(high, 1).action, Guess::kHigh);
}

/// The same, which tells how likely its answers are.
class FrankGuess : public Guess
{
public:
  [[nodiscard]] std::optional<double> observationProbability(
      std::size_t action, std::uint64_t next_state, std::uint64_t observation) const override
  {
    const std::uint64_t high = next_state >= kStates / 2 ? 1 : 0;
    return action == kAsk ? (high == observation ? 0.9 : 0.1)
                          : static_cast<double>(observation == 0);
  }
};

double shareOfHigh(const ParticleBelief& belief)
{
  double high = 0.0;
  for (const std::uint64_t state : belief.states())
  {
    high += state >= Guess::kStates / 2 ? 1.0 : 0.0;
  }
  return high / static_cast<double>(belief.states().size());
}

TEST(ParticleBelief, FollowsBayesRule)
{
  std::vector<std::uint64_t> states;
  for (std::uint64_t i = 0; i < 1000; ++i)
  {
    states.push_back(i * (Guess::kStates / 1000));
  }
  const Guess plain;
  const FrankGuess frank;
  ParticleOptions options;
  options.num_particles = 4000;
  for (const GenerativeModel* model :
       {static_cast<const GenerativeModel*>(&plain), static_cast<const GenerativeModel*>(&frank)})
  {
    std::mt19937_64 random(3);
    ParticleBelief belief(states);
    belief = updated(*model, belief, Guess::kAsk, 1, options, random);
    EXPECT_EQ(belief.states().size(), options.num_particles);
    EXPECT_NEAR(shareOfHigh(belief), 0.9, 0.03);
    belief = updated(*model, belief, Guess::kAsk, 1, options, random);
    EXPECT_NEAR(shareOfHigh(belief), 81.0 / 82.0, 0.02);
  }
}

TEST(ParticleBelief, SaysWhenTheObservationContradictsAll)
{
  const FrankGuess model;
  std::mt19937_64 random(1);
  const ParticleBelief belief({1, 2, 3});
  EXPECT_THROW(static_cast<void>(updated(model, belief, Guess::kLow, 1, {}, random)),
               FailedPrecondition);
  EXPECT_THROW(static_cast<void>(updated(model, belief, 9, 1, {}, random)), InvalidArgument);
  EXPECT_THROW(ParticleBelief({}), InvalidArgument);
}

TEST(OnlinePlanner, RefusesOptionsOutOfRange)
{
  const Guess model;
  OnlineOptions options = counted(0);
  EXPECT_THROW(OnlinePlanner(model, options), InvalidArgument);
  options = counted(1);
  options.num_scenarios = 0;
  EXPECT_THROW(OnlinePlanner(model, options), InvalidArgument);
  options = counted(1);
  options.target = 1.0;
  EXPECT_THROW(OnlinePlanner(model, options), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
