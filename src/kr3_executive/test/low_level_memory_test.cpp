// Sightings and doubtful observations as Bayes' rule has them.

#include "kr3_executive/low_level_memory.hpp"

#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_refinement/zoom.hpp>

#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/low_level_task.hpp"

namespace kr3::executive
{
namespace
{

using refinement::Distribution;
using refinement::kElsewhere;

class LowLevelBelief : public testing::Test
{
protected:
  static LoadedDomain office()
  {
    const std::string path = std::string(KR3_DOMAINS_DIR) + "/office";
    return load(readDomainFiles(path + "/domain.kr3", path + "/refinement.kr3",
                                path + "/models.yaml", path + "/bindings.yaml",
                                refinement::gridMap({"office", "main_library", "aux_library",
                                                     "kitchen", "study_corner", "corridor"},
                                                    2, 2.0)));
  }

  [[nodiscard]] Distribution after(const Distribution& prior, const std::string& literal,
                                   double confidence) const
  {
    return SightingLikelihood(*office_.domain, {literal, confidence}).applied(prior);
  }

  /// The grasp in a place with even odds, the robot in its first cell.
  [[nodiscard]] LowLevelTask grasp(const std::string& place = "main_library") const
  {
    std::vector<reasoner::Literal> state;
    for (const std::string& text : {"loc(rob1) = " + place, "loc(tb1) = " + place})
      state.push_back(reasoner::parseGroundLiteral(text, office_.domain->highLevel()));
    const auto zoom = refinement::zoom(
        *office_.domain, state,
        reasoner::parseGroundAction("grasp(rob1, tb1)", office_.domain->highLevel()));
    refinement::InitialKnowledge knowledge;
    knowledge.fine["loc(rob1)"] = {{place + "_c0", 1.0}};
    knowledge.coarse["loc(tb1)"] = {{place, 0.5}};
    return {*office_.domain,
            std::make_shared<const refinement::PomdpTask>(
                refinement::generatePomdp(*office_.domain, office_.models, zoom, knowledge)),
            knowledge};
  }

  [[nodiscard]] static std::size_t indexOf(const LowLevelTask& task, const std::string& action)
  {
    for (std::size_t i = 0; i < task.pomdp().model().numActions(); ++i)
    {
      if (task.pomdp().actionText(i) == action)
        return i;
    }
    throw NotFound(action);
  }

  LoadedDomain office_ = office();
};

TEST_F(LowLevelBelief, ASightingAloneIsBelievedWithItsConfidence)
{
  const Distribution seen = after(unknownValue(), "loc(tb1) = kitchen_c1", 0.8);
  EXPECT_NEAR(seen.at("kitchen_c1"), 0.8, 1e-12);
  EXPECT_NEAR(seen.at(kElsewhere), 0.2, 1e-12);
}

TEST_F(LowLevelBelief, SightingsAddUpAndContradictEachOther)
{
  const Distribution once = after(unknownValue(), "loc(tb1) = kitchen_c1", 0.8);
  const Distribution twice = after(once, "loc(tb1) = kitchen_c1", 0.8);
  // Odds against each of the 11 others multiply.
  EXPECT_NEAR(twice.at("kitchen_c1"), 0.64 / (0.64 + 0.2 * 0.2 / 11.0), 1e-9);
  const Distribution torn = after(once, "loc(tb1) = office_c0", 0.8);
  EXPECT_NEAR(torn.at("kitchen_c1"), torn.at("office_c0"), 1e-12);
  EXPECT_LT(torn.at("kitchen_c1"), 0.5);
}

TEST_F(LowLevelBelief, ANegativeSightingSpeaksForTheRest)
{
  const Distribution prior{{"kitchen_c0", 0.5}, {"kitchen_c1", 0.5}};
  const Distribution seen = after(prior, "loc(tb1) != kitchen_c0", 0.9);
  EXPECT_LT(seen.at("kitchen_c0"), seen.at("kitchen_c1"));
  const Distribution empty = after(unknownValue(), "-in_hand(rob1, tb1)", 0.9);
  EXPECT_NEAR(empty.at("false"), 0.9, 1e-12);
}

TEST_F(LowLevelBelief, SightingsThatMakeNoSenseAreRefused)
{
  EXPECT_THROW(static_cast<void>(after(unknownValue(), "loc(tb1) = moon", 0.9)), InvalidArgument);
  EXPECT_THROW(static_cast<void>(after(unknownValue(), "loc(tb1) = office_c0", 0.0)),
               InvalidArgument);
  EXPECT_THROW(static_cast<void>(after(unknownValue(), "neighbor(office_c0, office_c1)", 0.9)),
               InvalidArgument);
}

TEST_F(LowLevelBelief, ASightingInTheZoomMovesTheBelief)
{
  LowLevelTask task = grasp();
  task.notice({*office_.domain, {"loc(tb1) = main_library_c1", 0.9}});
  const auto belief = task.pomdp().fineMarginal(task.belief(), "loc(tb1)");
  // Likelihoods: 0.9 in that cell, 0.1 / 11 in every other one.
  const double other = 0.1 / 11.0;
  const double sum = 0.25 * 0.9 + 0.25 * other + 0.5 * other;
  EXPECT_NEAR(belief.at("main_library_c1"), 0.25 * 0.9 / sum, 1e-9);
  EXPECT_NEAR(belief.at(kElsewhere), 0.5 * other / sum, 1e-9);
}

TEST_F(LowLevelBelief, ASightingOutsideTheZoomSpeaksForElsewhere)
{
  LowLevelTask task = grasp();
  task.notice({*office_.domain, {"loc(tb1) = kitchen_c1", 0.9}});
  const auto belief = task.pomdp().fineMarginal(task.belief(), "loc(tb1)");
  const double other = 0.1 / 11.0;
  const double outside = (0.9 + 9.0 * other) / 10.0;
  EXPECT_NEAR(belief.at(kElsewhere), 0.5 * outside / (0.5 * outside + 0.5 * other), 1e-9);
  LowLevelMemory memory;
  task.remember(memory);
  EXPECT_GT(memory.at("loc(tb1)").values.at("kitchen_c1"), 0.5);
  const auto shares = probabilitiesOf(*office_.domain, memory, "loc(tb1)", {"kitchen", "corridor"});
  EXPECT_GT(shares[0], 0.85);
}

TEST_F(LowLevelBelief, AFullyTrustedObservationIsTheExactUpdate)
{
  LowLevelTask task = grasp();
  const std::size_t look = indexOf(task, "search(rob1, main_library_c0, tb1)");
  ASSERT_TRUE(task.update(look, {"false"}, 1.0));
  const auto belief = task.pomdp().fineMarginal(task.belief(), "loc(tb1)");
  const double sum = 0.25 * 0.1 + 0.25 * 0.95 + 0.5 * 0.95;
  EXPECT_NEAR(belief.at(kElsewhere), 0.5 * 0.95 / sum, 1e-9);
}

TEST_F(LowLevelBelief, ADoubtfulObservationCountsLess)
{
  const auto elsewhere = [this](double confidence) {
    LowLevelTask task = grasp();
    EXPECT_TRUE(
        task.update(indexOf(task, "search(rob1, main_library_c0, tb1)"), {"false"}, confidence));
    return task.pomdp().fineMarginal(task.belief(), "loc(tb1)").at(kElsewhere);
  };
  EXPECT_GT(elsewhere(1.0), elsewhere(0.6));
  EXPECT_GT(elsewhere(0.6), elsewhere(0.1));
  EXPECT_NEAR(elsewhere(1e-9), 0.5, 1e-6);
  // Two observations are possible: c O + (1 - c) / 2.
  const double here = 0.6 * 0.1 + 0.2;
  const double not_here = 0.6 * 0.95 + 0.2;
  EXPECT_NEAR(elsewhere(0.6), 0.5 * not_here / (0.25 * here + 0.75 * not_here), 1e-9);
  LowLevelTask task = grasp();
  EXPECT_THROW(static_cast<void>(task.update(0, {"false"}, 0.0)), InvalidArgument);
}

TEST_F(LowLevelBelief, DoubtLeavesKnownWhatExactSensorsTell)
{
  LowLevelTask task = grasp();
  EXPECT_TRUE(task.update(indexOf(task, "move(rob1, main_library_c1)"), {"main_library_c1"}, 0.6));
  const auto place = task.pomdp().fineMarginal(task.belief(), "loc(rob1)");
  EXPECT_EQ(place.at("main_library_c1"), 1.0);
}

TEST_F(LowLevelBelief, AnImpossibleObservationIsNotExplainedByDoubt)
{
  LowLevelTask task = grasp();
  const auto before = task.belief().probabilities();
  EXPECT_FALSE(task.update(indexOf(task, "move(rob1, main_library_c1)"), {"corridor_c0"}, 0.5));
  EXPECT_EQ(task.belief().probabilities(), before);
}

TEST_F(LowLevelBelief, HypothesesShareWhatTheMemoryLeavesOpen)
{
  LowLevelMemory memory;
  const std::vector<std::string> places{"kitchen", "corridor", "office"};
  for (const double share : probabilitiesOf(*office_.domain, memory, "loc(tb1)", places))
    EXPECT_NEAR(share, 1.0 / 3.0, 1e-12);
  memory["loc(tb1)"] = {{{"kitchen_c0", 0.05}, {"kitchen_c1", 0.15}, {kElsewhere, 0.8}}, "kitchen"};
  const auto shares = probabilitiesOf(*office_.domain, memory, "loc(tb1)", places);
  EXPECT_NEAR(shares[0], 5.0 / 13.0, 1e-12);  // five of six places share 0.8
  EXPECT_NEAR(shares[1], 4.0 / 13.0, 1e-12);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
  forget(*office_.domain, memory, "loc(tb1)", "kitchen");
  for (const double share : probabilitiesOf(*office_.domain, memory, "loc(tb1)", places))
    EXPECT_NEAR(share, 1.0 / 3.0, 1e-12);
}

// Six places are alike; a task begins with even odds for one of them, for the sake of the plan.
TEST_F(LowLevelBelief, WhatATaskBeganWithIsNoEvidence)
{
  const std::vector<std::string> places{"main_library", "kitchen",      "corridor",
                                        "office",       "study_corner", "aux_library"};
  LowLevelMemory memory;
  const auto expectOdds = [&](double in_main_library) {
    const auto shares = probabilitiesOf(*office_.domain, memory, "loc(tb1)", places);
    EXPECT_NEAR(shares.front(), in_main_library / (in_main_library + 5.0), 1e-9);
    for (std::size_t i = 1; i < places.size(); ++i)
      EXPECT_NEAR(shares[i], 1.0 / (in_main_library + 5.0), 1e-9) << places[i];
  };
  LowLevelTask first = grasp();
  first.remember(memory);
  expectOdds(1.0);
  ASSERT_TRUE(first.update(indexOf(first, "search(rob1, main_library_c0, tb1)"), {"false"}));
  first.remember(memory);
  const double likelihood = (0.5 * 0.1 + 0.5 * 0.95) / 0.95;  // it has two cells
  expectOdds(likelihood);
  LowLevelTask second = grasp();  // begins with even odds again
  second.remember(memory);
  expectOdds(likelihood);
}

TEST_F(LowLevelBelief, PlacesThatWereLookedAtAlikeStayAlike)
{
  const std::vector<std::string> places{"main_library", "kitchen",      "corridor",
                                        "office",       "study_corner", "aux_library"};
  LowLevelMemory memory;
  for (int round = 0; round < 3; ++round)
  {
    for (const std::string& place : places)
    {
      LowLevelTask task = grasp(place);
      ASSERT_TRUE(task.update(indexOf(task, "search(rob1, " + place + "_c0, tb1)"), {"false"}));
      task.remember(memory);
    }
    for (const double share : probabilitiesOf(*office_.domain, memory, "loc(tb1)", places))
      EXPECT_NEAR(share, 1.0 / 6.0, 1e-9) << "round " << round;
  }
  // What is asked of a few of them is the same.
  const auto three =
      probabilitiesOf(*office_.domain, memory, "loc(tb1)", {places.begin(), places.begin() + 3});
  EXPECT_NEAR(three[1], 1.0 / 3.0, 1e-9);
}

}  // namespace
}  // namespace kr3::executive
