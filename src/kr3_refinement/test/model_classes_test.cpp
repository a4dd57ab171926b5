// Numbers of the models that hold for a class of an action's arguments only.

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "fixtures.hpp"
#include "kr3_refinement/domain_task.hpp"
#include "kr3_refinement/models.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

const char* const kHighLevel = R"(
sorts
  hall = {north, south}.
  cold_hall = {south}.
  bulky = {drum, crate}.
  metal = {drum, bolt}.
  thing = bulky + metal + {paper}.
fluents
  inertial in(thing) : hall.
actions
  shove(thing, hall).
axioms
  shove(X, H) causes in(X) = H.
  impossible A1, A2 if A1 != A2.
)";

const char* const kRefinement = R"(
magnify hall into bay by bay_of.
statics
  beside(bay, bay).
actions
  peek(bay, thing).
axioms
  shove(X, B) causes in(X) = B [there] or in(X) = {Z : beside(Z, B)} [past].
observations
  shove(X, B) observes in(X).
  peek(B, X) observes in(X) = B.
)";

std::string modelsWith(const std::string& of_shove, const std::string& of_peek = "")
{
  return R"(actions:
  shove(X, B):
    outcomes: {probabilities: {there: 0.8, past: 0.2}, source: hand-written}
    observations: {in: exact}
    cost: {base_s: 4.0, impossible_s: 6.0}
)" + of_shove +
         R"(
  peek(B, X):
    observations: {in: {true_positive: 0.9, false_positive: 0.1, source: hand-written}}
    cost: {base_s: 1.0, per_metre_s: 0.5, distance: {from: in(X), to: B}, impossible_s: 2.0}
)" + of_peek;
}

const LowLevelDomain& domain()
{
  static const LowLevelDomain composed =
      test::composed(kHighLevel, kRefinement, gridMap({"north", "south"}, 2, 1.0));
  return composed;
}

Models models(const std::string& of_shove, const std::string& of_peek = "")
{
  return parseModels(modelsWith(of_shove, of_peek), "models.yaml", domain());
}

std::string outcomesFor(const std::string& arguments, double there)
{
  return "      - for: {" + arguments +
         "}\n        outcomes: {probabilities: {there: " + std::to_string(there) +
         ", past: " + std::to_string(1.0 - there) + "}, source: hand-written}\n";
}

double there(const Models& models, const std::string& thing, const std::string& bay = "north_c0")
{
  return models.actions.at("shove").outcomesOf({thing, bay}).probabilities.at("there");
}

TEST(ModelClasses, TheMostSpecificOneCounts)
{
  const Models read = models("    classes:\n" + outcomesFor("X: bulky", 0.5) +
                             outcomesFor("X: crate", 0.25) + outcomesFor("X: paper", 1.0));
  EXPECT_DOUBLE_EQ(there(read, "bolt"), 0.8);
  EXPECT_DOUBLE_EQ(there(read, "drum"), 0.5);
  EXPECT_DOUBLE_EQ(there(read, "crate"), 0.25);
  EXPECT_DOUBLE_EQ(there(read, "paper"), 1.0);
}

// The order in the file does not count.
TEST(ModelClasses, TheirOrderDoesNotCount)
{
  const Models read =
      models("    classes:\n" + outcomesFor("X: crate", 0.25) + outcomesFor("X: bulky", 0.5));
  EXPECT_DOUBLE_EQ(there(read, "drum"), 0.5);
  EXPECT_DOUBLE_EQ(there(read, "crate"), 0.25);
}

// What a class does not say comes from the next one, each kind of number by itself.
TEST(ModelClasses, FallBackKindByKind)
{
  const Models read = models(
      "    classes:\n" + outcomesFor("X: bulky", 0.5) +
      "      - {for: {X: crate}, cost: {base_s: 9.0, counts: {carried_out: 16, impossible: 0}, "
      "stddev_s: 2.0, source: learned}}\n");
  const ActionModel& shove = read.actions.at("shove");
  EXPECT_DOUBLE_EQ(there(read, "crate"), 0.5);
  EXPECT_DOUBLE_EQ(shove.costOf({"crate", "north_c0"}).base_s, 9.0);
  EXPECT_DOUBLE_EQ(shove.costOf({"crate", "north_c0"}).impossible_s, 6.0);
  EXPECT_DOUBLE_EQ(shove.costOf({"drum", "north_c0"}).base_s, 4.0);
  EXPECT_TRUE(shove.observationOf("in", {"crate", "north_c0"}).exact);
}

TEST(ModelClasses, AComponentIsOfItsWholesClass)
{
  const Models read =
      models("    classes:\n" + outcomesFor("B: cold_hall", 0.5) + outcomesFor("B: south_c1", 0.1));
  EXPECT_DOUBLE_EQ(there(read, "bolt", "north_c1"), 0.8);
  EXPECT_DOUBLE_EQ(there(read, "bolt", "south_c0"), 0.5);
  EXPECT_DOUBLE_EQ(there(read, "bolt", "south_c1"), 0.1);
  EXPECT_DOUBLE_EQ(there(read, "bolt", "south"), 0.5);  // as the high level calls it
}

TEST(ModelClasses, AreRefusedWhenNeitherIsWithinTheOther)
{
  expectError(ErrorCode::kInvalidArgument,
              "models.yaml:9: shove, classes: {X: metal} here and {X: bulky} in line 7 both have "
              "the outcomes of shove(drum, north_c0), and neither is within the other; add a class "
              "for what is in both",
              [] {
    (void)models("    classes:\n" + outcomesFor("X: bulky", 0.5) + outcomesFor("X: metal", 0.6));
  });
  expectError(ErrorCode::kInvalidArgument, "{B: cold_hall} here and {X: bulky} in line 7", [] {
    (void)models("    classes:\n" + outcomesFor("X: bulky", 0.5) +
                 outcomesFor("B: cold_hall", 0.6));
  });
  expectError(ErrorCode::kInvalidArgument, "{X: crate} here and {X: crate} in line 7", [] {
    (void)models("    classes:\n" + outcomesFor("X: crate", 0.5) + outcomesFor("X: crate", 0.6));
  });
}

TEST(ModelClasses, AreAcceptedWhenAThirdDecidesOrTheySayDifferentThings)
{
  const Models decided = models("    classes:\n" + outcomesFor("X: bulky", 0.5) +
                                outcomesFor("X: metal", 0.6) + outcomesFor("X: drum", 0.7));
  EXPECT_DOUBLE_EQ(there(decided, "drum"), 0.7);
  EXPECT_DOUBLE_EQ(there(decided, "bolt"), 0.6);
  const Models apart = models("    classes:\n" + outcomesFor("X: bulky", 0.5) +
                              "      - {for: {X: metal}, cost: {base_s: 8.0}}\n");
  EXPECT_DOUBLE_EQ(there(apart, "drum"), 0.5);
  EXPECT_DOUBLE_EQ(apart.actions.at("shove").costOf({"drum", "north_c0"}).base_s, 8.0);
}

struct Bad
{
  std::string classes;
  std::string told;
};

TEST(ModelClasses, AreCheckedLikeTheRest)
{
  for (const Bad& bad : {
           Bad{"    classes: {X: bulky}\n",
               "models.yaml:6: shove, classes: found a map, expected a list, as '- {for: {B: "
               "SORT}"},
           Bad{"    classes:\n      - {for: {Y: bulky}, cost: {base_s: 1.0}}\n",
               "models.yaml:7: shove, classes, for: unknown key 'Y', expected one of 'X', 'B'"},
           Bad{"    classes:\n      - {cost: {base_s: 1.0}}\n", "shove, classes, for: unknown key"},
           Bad{"    classes:\n      - {for: {}, cost: {base_s: 1.0}}\n",
               "models.yaml:7: shove, classes, for: found no parameter, expected one of 'X', 'B'"},
           Bad{"    classes:\n      - {for: {X: bulkey}, cost: {base_s: 1.0}}\n",
               "models.yaml:7: shove, classes, for: X is 'bulkey', expected a sort, or an element "
               "of the sort 'thing'; did you mean 'bulky'?"},
           Bad{"    classes:\n      - {for: {X: hall}, cost: {base_s: 1.0}}\n",
               "no X of shove is of the sort 'hall'; it is of the sort 'thing'"},
           Bad{"    classes:\n      - {for: {X: bulky}}\n",
               "models.yaml:7: shove for {X: bulky}: found no numbers"},
           Bad{"    classes:\n" + outcomesFor("X: bulky", 1.2),
               "models.yaml:8: there: found '1.200000', expected a number from 0 to 1"},
           Bad{"    classes:\n      - {for: {X: bulky}, outcomes: {probabilities: {there: 0.7, "
               "past: 0.2}, source: hand-written}}\n",
               "shove for {X: bulky}, outcomes: the probabilities sum to 0.900000"},
           Bad{"    classes:\n      - {for: {X: bulky}, outcomes: {probabilities: {there: 1.0}, "
               "source: hand-written}}\n",
               "shove for {X: bulky}, outcomes: found no probability of 'past'"},
           Bad{"    classes:\n      - {for: {X: bulky}, observations: {on: exact}}\n",
               "shove for {X: bulky}, observations: unknown key 'on', expected one of 'in'"},
           Bad{"    classes:\n      - {for: {X: bulky}, cost: {base_s: 1.0, per_metre_s: 2.0}}\n",
               "shove for {X: bulky}, cost: per_metre_s, but the cost of shove has no distance"},
           Bad{"    classes:\n      - {for: {X: bulky}, cost: {base_s: 1.0, source: learned}}\n",
               "shove for {X: bulky}, cost: learned without counts"},
           Bad{"    classes:\n      - {for: {X: bulky}, cost: {base_s: 1.0, source: learned, "
               "counts: {carried_out: 3, impossible: 0}}}\n",
               "shove for {X: bulky}, cost: learned without stddev_s"},
           Bad{"    classes:\n      - {for: {X: bulky}, cost: {base_s: 1.0, stddev_s: 1.0}}\n",
               "stddev_s of hand-written seconds; leave it out"},
           Bad{"    classes:\n      - {for: {X: bulky}, outcomes: {probabilities: {there: 0.5, "
               "past: 0.5}, prior: 1, source: hand-written}}\n",
               "shove for {X: bulky}, outcomes: a prior without counts"},
       })
  {
    expectError(ErrorCode::kInvalidArgument, bad.told, [&] { (void)models(bad.classes); });
  }
}

// Dirichlet posterior: (k + a) / (n + L a) for L labels.
TEST(Models, AreHeldAgainstTheirPosterior)
{
  const auto with = [](const std::string& probabilities, const std::string& prior) {
    return models(
        "    classes:\n      - {for: {X: bulky}, outcomes: {probabilities: " + probabilities +
        ", counts: {there: 1, past: 0}, prior: " + prior + ", source: learned}}\n");
  };
  EXPECT_DOUBLE_EQ(there(with("{there: 0.75, past: 0.25}", "0.5"), "drum"), 0.75);
  EXPECT_DOUBLE_EQ(there(with("{there: 0.6, past: 0.4}", "2"), "drum"), 0.6);
  EXPECT_DOUBLE_EQ(there(with("{there: 1.0, past: 0.0}", "0"), "drum"), 1.0);
  expectError(ErrorCode::kInvalidArgument,
              "probability 0.75 contradicts its counts, 1 of 1; expected about 0.6",
              [&] { (void)with("{there: 0.75, past: 0.25}", "2"); });
}

TEST(Models, SayWhereTheirNumbersComeFrom)
{
  const Models read = models(
      "    classes:\n      - for: {X: bulky}\n        outcomes: {probabilities: {there: 0.75, "
      "past: "
      "0.25}, counts: {there: 30, past: 10}, source: learned}\n        cost: {base_s: 7.5, counts: "
      "{carried_out: 16, impossible: 0}, stddev_s: 2.0, source: learned}\n");
  EXPECT_EQ(
      sources(read, "shove", {"drum", "north_c0"}),
      (std::vector<std::string>{
          "outcomes: past 0.25, there 0.75; learned, 40 samples (models.yaml:8)",
          "observation of in: exact (models.yaml:4)",
          "cost: 7.5 s, 6 s where impossible; seconds learned, 16 samples, standard error 0.5 "
          "s, where impossible hand-written (models.yaml:9)"}));
  EXPECT_EQ(sources(read, "peek", {"north_c0", "bolt"}),
            (std::vector<std::string>{
                "observation of in: true positives 0.9, false positives 0.1; hand-written "
                "(models.yaml:12)",
                "cost: 1 s + 0.5 s/m, metres from the map, 2 s where impossible; seconds "
                "hand-written (models.yaml:13)"}));
  expectError(ErrorCode::kNotFound, "the models have no action 'kick'",
              [&] { (void)sources(read, "kick", {}); });
}

/// The classes of the next tests, and what they say.
Models sorted()
{
  return models("    classes:\n" + outcomesFor("X: bulky", 0.5) +
                    "      - {for: {X: bulky}, cost: {base_s: 11.0, impossible_s: 13.0}}\n",
                "    classes:\n      - {for: {X: bulky}, observations: {in: {true_positive: 0.97, "
                "false_positive: 0.02, source: hand-written}}}\n");
}

PomdpTask taskOf(const Models& numbers, const std::string& thing)
{
  const reasoner::Description& high = domain().highLevel();
  const Zoom zoomed =
      zoom(domain(), {reasoner::parseGroundLiteral("in(" + thing + ") = north", high)},
           reasoner::parseGroundAction("shove(" + thing + ", south)", high));
  InitialKnowledge knowledge;
  knowledge.coarse["in(" + thing + ")"] = {{"north", 1.0}};
  return generatePomdp(domain(), numbers, zoomed, knowledge);
}

double probabilityOf(pomdp::SparseRow row, std::size_t index)
{
  for (const pomdp::SparseEntry& entry : row)
  {
    if (entry.index == index)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

// T, O and R of the POMDP of each thing are those of its class.
TEST(ModelClasses, AreThoseOfTheGeneratedPomdp)
{
  const Models numbers = sorted();
  for (const auto& [thing, success, seen, unseen, base_s] :
       {std::make_tuple("bolt", 0.8, 0.9, 0.1, 4.0),
        std::make_tuple("drum", 0.5, 0.97, 0.02, 11.0)})
  {
    const PomdpTask task = taskOf(numbers, thing);
    const pomdp::Model& model = task.model();
    const std::string name = thing;
    const std::size_t start = *model.findState("in(" + name + ")=north_c0");
    const std::size_t target = *model.findState("in(" + name + ")=south_c1");
    const std::size_t shove = *model.findAction("shove(" + name + ",south_c1)");
    EXPECT_NEAR(probabilityOf(model.transitions(shove, start), target), success, 1e-12) << name;
    EXPECT_DOUBLE_EQ(model.reward(shove, start), -base_s) << name;
    const std::size_t peek = *model.findAction("peek(south_c1," + name + ")");
    const std::size_t yes = *model.findObservation("true");
    EXPECT_NEAR(probabilityOf(model.observations(peek, target), yes), seen, 1e-12) << name;
    EXPECT_NEAR(probabilityOf(model.observations(peek, start), yes), unseen, 1e-12) << name;
  }
}

// The task of the whole domain, for the baselines, has the same numbers.
TEST(ModelClasses, AreThoseOfTheWholeDomain)
{
  const Models numbers = sorted();
  for (const std::string thing : {"bolt", "drum"})
  {
    const PomdpTask zoomed = taskOf(numbers, thing);
    DomainTask whole(domain(), numbers,
                     {thing, "north", "south", "north_c0", "north_c1", "south_c0", "south_c1"});
    for (std::size_t state = 0; state < zoomed.boundaryState(); ++state)
    {
      const reasoner::GroundFluent& fluent = zoomed.fluents().front();
      const auto value = static_cast<std::size_t>(zoomed.physicalState(state).front());
      if (fluent.values[value] == kElsewhere)
      {
        continue;
      }
      const auto same = whole.space().find({fluent.values[value]});
      ASSERT_TRUE(same);
      for (std::size_t action = 0; action < whole.numActions(); ++action)
      {
        std::string name = whole.space().actions()[action].text;
        name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
        const std::size_t other = *zoomed.model().findAction(name);
        const DomainTask::Transition& transition = whole.transition(*same, action);
        EXPECT_DOUBLE_EQ(-transition.cost_s, zoomed.model().reward(other, state)) << name;
        for (const DomainTask::Next& next : transition.next)
        {
          const std::size_t target =
              *zoomed.model().findState("in(" + thing + ")=" + whole.space().value(next.state, 0));
          EXPECT_NEAR(probabilityOf(zoomed.model().transitions(other, state), target),
                      next.probability, 1e-12);
          for (const auto& [told, probability] :
               whole.told(action, next.state, transition.executable))
          {
            EXPECT_NEAR(probabilityOf(zoomed.model().observations(other, target),
                                      *zoomed.model().findObservation(told)),
                        probability, 1e-12)
                << name << " " << told;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace kr3::refinement
