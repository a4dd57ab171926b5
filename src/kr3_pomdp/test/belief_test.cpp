#include "kr3_pomdp/belief.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

double sum(const Belief& belief)
{
  return std::accumulate(belief.probabilities().begin(), belief.probabilities().end(), 0.0);
}

TEST(Belief, RejectsWhatIsNoDistribution)
{
  EXPECT_THROW(Belief({}), InvalidArgument);
  EXPECT_THROW(Belief({0.5, 0.4}), InvalidArgument);
  EXPECT_THROW(Belief({1.5, -0.5}), InvalidArgument);
  EXPECT_THROW(Belief({1.0, std::numeric_limits<double>::quiet_NaN()}), InvalidArgument);
  EXPECT_THROW(Belief({std::numeric_limits<double>::infinity()}), InvalidArgument);
}

TEST(Belief, NormalisesRoundingAndKeepsWhatIsExact)
{
  EXPECT_NEAR(sum(Belief({0.3333333, 0.3333333, 0.3333333})), 1.0, 1e-15);
  EXPECT_EQ(Belief({0.25, 0.75})[1], 0.75);
}

TEST(BeliefUpdate, ListeningOnceGivesTheAccuracyOfTheEar)
{
  const Model model = test::tiger();
  const BeliefUpdate update = updated(model, model.initialBelief(), 0, 0);
  EXPECT_NEAR(update.posterior[0], 0.85, 1e-15);
  EXPECT_NEAR(update.probability, 0.5, 1e-15);
  // Bayes by hand: 0.85^2 / (0.85^2 + 0.15^2).
  EXPECT_NEAR(updated(model, update.posterior, 0, 0).posterior[0], 0.7225 / 0.745, 1e-15);
}

TEST(BeliefUpdate, TotalProbabilityHolds)
{
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
  {
    const Model model = test::randomModel({5, 3, 4, 0.9}, seed);
    const Belief& prior = model.initialBelief();
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      std::vector<double> predicted(model.numStates(), 0.0);
      for (std::size_t s = 0; s < model.numStates(); ++s)
      {
        for (const SparseEntry& next : model.transitions(a, s))
        {
          predicted[next.index] += prior[s] * next.probability;
        }
      }
      const std::vector<double> chances = observationProbabilities(model, prior, a);
      EXPECT_NEAR(std::accumulate(chances.begin(), chances.end(), 0.0), 1.0, 1e-12);
      std::vector<double> mixed(model.numStates(), 0.0);
      for (std::size_t o = 0; o < chances.size(); ++o)
      {
        if (chances[o] == 0.0)
        {
          EXPECT_THROW((void)updated(model, prior, a, o), FailedPrecondition);
          continue;
        }
        const BeliefUpdate update = updated(model, prior, a, o);
        EXPECT_NEAR(update.probability, chances[o], 1e-12);
        EXPECT_NEAR(sum(update.posterior), 1.0, 1e-12);
        for (std::size_t s = 0; s < mixed.size(); ++s)
        {
          mixed[s] += update.probability * update.posterior[s];
        }
      }
      for (std::size_t s = 0; s < mixed.size(); ++s)
      {
        EXPECT_NEAR(mixed[s], predicted[s], 1e-12);
      }
    }
  }
}

TEST(BeliefUpdate, NamesAnImpossibleObservation)
{
  const Model model = test::roomSearch(2);
  try
  {
    (void)updated(model, model.initialBelief(), *model.findAction("search"),
                  *model.findObservation("at3"));
    FAIL() << "no error";
  }
  catch (const FailedPrecondition& e)
  {
    EXPECT_EQ(std::string(e.what()),
              "observation 'at3' is impossible after action 'search' at this belief");
  }
}

TEST(BeliefUpdate, RejectsWrongShapesAndIndices)
{
  const Model model = test::tiger();
  EXPECT_THROW((void)updated(model, Belief({1.0}), 0, 0), InvalidArgument);
  EXPECT_THROW((void)updated(model, model.initialBelief(), 3, 0), InvalidArgument);
  EXPECT_THROW((void)updated(model, model.initialBelief(), 0, 2), InvalidArgument);
  EXPECT_THROW((void)observationProbabilities(model, model.initialBelief(), 3), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
