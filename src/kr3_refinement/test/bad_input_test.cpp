// What users get wrong, and what they are told: file, line, what was found, how to mend it.

#include <string>
#include <vector>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::composed;
using test::expectError;

const char* const kHighLevel = R"(sorts
  tank = {t1, t2}.
  valve = {v1, v2}.
  thing = tank + valve.
  level = {low, high}.
statics
  joined(tank, tank).
fluents
  inertial feeds(valve) : tank.
  inertial shut(valve).
  inertial rusty(tank).
  inertial pressure(valve, level).
actions
  turn(valve, tank).
  close(valve).
  exogenous burst(tank).
axioms
  turn(V, T) causes feeds(V) = T, -shut(V).
  close(V) causes shut(V).
  burst(T) causes rusty(T).
)";

const char* const kRefinement = R"(magnify tank into port by port_of.
statics
  beside(port, port).
fluents
  knowledge looked(valve).
  defined sure(valve).
actions
  look(valve, port).
axioms
  turn(V, P) causes feeds(V) = P, -shut(V) [good] or feeds(V) = {Q : beside(Q, P)} [off].
  look(V, P) causes looked(V).
  sure(V) if looked(V), shut(V).
observations
  look(V, P) observes feeds(V) = P.
)";

const char* const kMap = R"(components:
  - {name: p1, part_of: t1, at: [0, 0]}
  - {name: p2, part_of: t1, at: [1, 0]}
  - {name: p3, part_of: t2, at: [3, 0]}
neighbors:
  - [p1, p2]
)";

const char* const kModels = R"(discount: 0.95
threshold: 0.9
rewards: {success: 50, given_up: 5, wrong_finish: -50}
actions:
  turn(V, P):
    outcomes:
      probabilities: {good: 0.9, off: 0.1}
      counts: {good: 90, off: 10}
      source: learned
    cost: {base_s: 2.0, per_metre_s: 1.0, distance: {from: feeds(V), to: P}, impossible_s: 5.0}
  close(V):
    cost: {base_s: 2.0, impossible_s: 5.0}
  look(V, P):
    observations:
      feeds:
        true_positive: 0.9
        false_positive: 0.1
        source: hand-written
    cost: {base_s: 1.0, impossible_s: 5.0}
)";

/// A mistake: a part of a good text, what a user made of it, and what the message must say.
struct Mistake
{
  std::string name;
  std::string from;
  std::string to;
  std::vector<std::string> told;
};

std::string nameOf(const testing::TestParamInfo<Mistake>& mistake)
{
  return mistake.param.name;
}

std::string changed(std::string text, const Mistake& mistake)
{
  const std::size_t position = text.find(mistake.from);
  EXPECT_NE(position, std::string::npos) << mistake.from;
  return text.replace(position, mistake.from.size(), mistake.to);
}

ComponentMap mapFrom(const std::string& text)
{
  const std::string path = ::testing::TempDir() + "bad_input_map.yaml";
  std::ofstream(path) << text;
  return readComponentMap(path);
}

LowLevelDomain good()
{
  return composed(kHighLevel, kRefinement, mapFrom(kMap));
}

template <typename Run>
void expectTold(const Mistake& mistake, Run run)
{
  for (const std::string& part : mistake.told)
  {
    expectError(ErrorCode::kInvalidArgument, part, run);
  }
}

TEST(BadInput, TheTextsBeforeTheMistakesAreGood)
{
  const LowLevelDomain domain = good();
  EXPECT_EQ(parseModels(kModels, "models.yaml", domain).actions.size(), 3U);
  EXPECT_EQ(domain.map().size(), 3U);
}

class BadRefinement : public testing::TestWithParam<Mistake>
{
};

TEST_P(BadRefinement, IsRefusedWithPlaceAndMend)
{
  expectTold(GetParam(),
             [] { (void)composed(kHighLevel, changed(kRefinement, GetParam()), mapFrom(kMap)); });
}

const std::string kMagnify = "magnify tank into port by port_of.\n";
const std::string kAfterLook = "  look(V, P) causes looked(V).\n";

INSTANTIATE_TEST_SUITE_P(
    Mistakes, BadRefinement,
    testing::Values(
        Mistake{"UnknownCoarseSort",
                "magnify tank",
                "magnify tnak",
                {"refinement.kr3:1:1: unknown sort 'tnak'; did you mean 'tank'?"}},
        Mistake{
            "MagnifiedTwice",
            kMagnify,
            kMagnify + "magnify tank into pipe by pipe_of.\n",
            {"refinement.kr3:2:1: the sort 'tank' is magnified twice, as in line 1; leave one"}},
        Mistake{"OverlappingSorts",
                kMagnify,
                kMagnify + "magnify thing into pipe by pipe_of.\n",
                {"refinement.kr3:2:1: 't1' is magnified twice, as in line 1 by the sort 'tank'; "
                 "magnify disjoint sorts"}},
        Mistake{"SameFineSort",
                kMagnify,
                kMagnify + "magnify level into port by level_of.\n",
                {"refinement.kr3:2:1: the components of 'level' are named 'port', as in line 1",
                 "expected a sort of components of its own"}},
        Mistake{"SameStatic",
                kMagnify,
                kMagnify + "magnify level into notch by port_of.\n",
                {"refinement.kr3:2:1: 'port_of' relates the components of 'level', as in line 1, "
                 "expected a static of its own"}},
        Mistake{"IntoSortOfTheHighLevel",
                "into port by",
                "into valve by",
                {"refinement.kr3:1:1: 'tank' is magnified into 'valve', a name of the high "
                 "level (domain.kr3:3), expected a new name"}},
        Mistake{"FineSortDeclared",
                kMagnify,
                kMagnify + "sorts\n  port = {p1, p2, p3}.\n",
                {"refinement.kr3:3:3: the sort 'port' is declared here, but its elements are the "
                 "components that the map lists; leave the declaration out"}},
        Mistake{
            "StaticIsNameOfTheHighLevel",
            "by port_of",
            "by joined",
            {"refinement.kr3:1:1: 'joined' is a name of the high level (domain.kr3:7), expected "
             "a new one for the static"}},
        Mistake{"StaticWithWrongTypes",
                "  beside(port, port).\n",
                "  beside(port, port).\n  port_of(tank) : port.\n",
                {"refinement.kr3:4:3: 'port_of' relates components to their wholes, expected the "
                 "static 'port_of(port) : tank'"}},
        Mistake{"FactsOfTheStatic",
                "fluents\n",
                "facts\n  port_of(some_port) = t1.\nfluents\n",
                {"refinement.kr3:5:3: found a fact about 'port_of', expected it in the map"}},
        Mistake{"MagnifiedAgain",
                kMagnify,
                kMagnify + "magnify port into thread by thread_of.\n",
                {"refinement.kr3:2:1: 'port' is a sort of components, expected a sort of the high "
                 "level"}},
        Mistake{
            "RedeclaredAction",
            "  look(valve, port).\n",
            "  look(valve, port).\n  turn(valve).\n",
            {"refinement.kr3:9:3: 'turn' is a name of the high level (domain.kr3:14), expected a "
             "new name: what the high level declares is used here without declaring it again"}},
        Mistake{"RedeclaredFluent",
                "  defined sure(valve).\n",
                "  defined sure(valve).\n  inertial shut(valve).\n",
                {"refinement.kr3:7:3: 'shut' is a name of the high level (domain.kr3:10)"}},
        Mistake{"CoarseEffect",
                "[off].",
                "[off].\n  close(V) causes feeds(V) = t1.",
                {"refinement.kr3:11:19: found 't1', expected an element of the sort port"}},
        Mistake{
            "EffectLost",
            "feeds(V) = P, -shut(V) [good]",
            "feeds(V) = P [good]",
            {"refinement.kr3:10:3: the refinement's laws of turn replace that of domain.kr3:18, "
             "but say nothing about its effect on shut; add the effect here"}},
        Mistake{"OutcomesWithoutLabels",
                "[good]",
                "",
                {"refinement.kr3:10:", "found several outcomes without a label"}},
        Mistake{"UselessAction",
                "  look(valve, port).\n",
                "  look(valve, port).\n  wait(valve).\n",
                {"refinement.kr3:9:3: the action wait has no effect and tells nothing, expected a "
                 "law 'causes' or 'observes'"}},
        Mistake{"ChoiceOnKnowledge",
                kAfterLook,
                kAfterLook + "  look(V, P) causes feeds(V) = {Q : beside(Q, P), looked(V)}.\n",
                {"the choice of an effect of look rests on what the robot knows"}},
        Mistake{
            "EffectOnKnowledge",
            kAfterLook,
            kAfterLook + "  look(V, P) causes shut(V) if sure(V).\n",
            {"refinement.kr3:12:3: an effect of look on the world rests on what the robot knows"}},
        Mistake{"ObservesUnknownFluent",
                "observes feeds(V)",
                "observes fedes(V)",
                {"refinement.kr3:14:23: unknown fluent, static or sort 'fedes'; did you mean "
                 "'feeds'?"}},
        Mistake{"ObservesStatic",
                "observes feeds(V) = P",
                "observes port_of(P)",
                {"refinement.kr3:14:3: look observes port_of, a static that everybody knows"}},
        Mistake{"ObservesKnowledge",
                "observes feeds(V) = P",
                "observes looked(V)",
                {"refinement.kr3:14:3: look observes looked, which is about what the robot knows"}},
        Mistake{"ObservesDefinedByKnowledge",
                "observes feeds(V) = P",
                "observes sure(V)",
                {"refinement.kr3:14:3: look observes sure, which is about what the robot knows"}},
        Mistake{"ObservesOpenVariable",
                "observes feeds(V) = P",
                "observes feeds(V2) = P",
                {"refinement.kr3:14:3: look observes feeds with the variable V2, which is no "
                 "argument of the action"}},
        Mistake{"LawOfExogenousAction",
                kAfterLook,
                kAfterLook + "  burst(P) causes rusty(P).\n",
                {"refinement.kr3:12:3: found a law of the exogenous action burst (domain.kr3:16), "
                 "expected none in a refinement"}},
        Mistake{"ExogenousAction",
                "  look(valve, port).\n",
                "  look(valve, port).\n  exogenous leak(port).\n",
                {"refinement.kr3:9:3: found the exogenous action leak, expected none"}},
        Mistake{"Default",
                "observations\n",
                "defaults\n  d(V): shut(V) if valve(V).\nobservations\n",
                {"refinement.kr3:14:3: found the default d, expected none in a refinement"}},
        Mistake{"Cost",
                "observations\n",
                "cost look(V, P) = 3.\nobservations\n",
                {"refinement.kr3:13:1: found a cost of look, expected none in a refinement: what "
                 "low-level actions cost stands in the models file"}}),
    nameOf);

class BadMap : public testing::TestWithParam<Mistake>
{
};

TEST_P(BadMap, IsRefusedWithPlaceAndMend)
{
  expectTold(GetParam(),
             [] { (void)composed(kHighLevel, kRefinement, mapFrom(changed(kMap, GetParam()))); });
}

const std::string kLastPart = "  - {name: p3, part_of: t2, at: [3, 0]}\n";

INSTANTIATE_TEST_SUITE_P(
    Mistakes, BadMap,
    testing::Values(
        Mistake{"NoParts",
                kLastPart,
                "",
                {"refinement.kr3:1:1: 't2' of sort 'tank' has no components in the map; add some"}},
        Mistake{"PartOfUnknown",
                "part_of: t2",
                "part_of: t3",
                {"bad_input_map.yaml:4: component 'p3' of the map is part of 't3', which no "
                 "magnified sort has; add it",
                 "did you mean 't1'?"}},
        Mistake{
            "PartOfTwoWholes",
            "name: p3",
            "name: p1",
            {"bad_input_map.yaml:4: the map has two components named 'p1', parts of 't1' and of "
             "'t2'; a component is part of one whole"}},
        Mistake{"NameOfTheHighLevel",
                "name: p3",
                "name: v2",
                {"bad_input_map.yaml:4: 'v2' is a component of the map and also an element of sort "
                 "'valve'; rename one of them"}},
        Mistake{"NotANumber",
                "at: [3, 0]",
                "at: [.nan, 0]",
                {"bad_input_map.yaml:4: at, x: found '.nan', expected a number"}},
        Mistake{"NoPoint",
                "at: [3, 0]",
                "at: 3",
                {"bad_input_map.yaml:4: at: found '3', expected [x, y] in m"}},
        Mistake{"OneWithoutPlace",
                ", at: [3, 0]",
                "",
                {"bad_input_map.yaml:4: 'p3' does not say where it is, but others do; add"}},
        Mistake{"OwnNeighbour",
                "[p1, p2]",
                "[p1, p1]",
                {"bad_input_map.yaml:6: neighbors: 'p1' is its own neighbour"}},
        Mistake{"NeighboursTwice",
                "  - [p1, p2]",
                "  - [p1, p2]\n  - [p2, p1]",
                {"bad_input_map.yaml:7: neighbors: 'p2' and 'p1' a second time; a pair counts both "
                 "ways"}},
        Mistake{"UnknownNeighbour",
                "[p1, p2]",
                "[p1, pp2]",
                {"bad_input_map.yaml:6: neighbors: 'pp2' is no component of the map; did you mean "
                 "'p2'?"}},
        Mistake{
            "NeighboursAreNoList",
            "neighbors:\n  - [p1, p2]",
            "neighbors: p1",
            {"bad_input_map.yaml:5: neighbors: found 'p1', expected a list, as [[m1, m2], ...]"}},
        Mistake{"UnknownKey",
                "neighbors:",
                "neighbours:",
                {"bad_input_map.yaml:5: the map: unknown key 'neighbours'",
                 "did you mean 'neighbors'?"}},
        Mistake{"KeyTwice",
                "neighbors:",
                "facts: []\nfacts: []\nneighbors:",
                {"bad_input_map.yaml:6: the map: key 'facts' a second time"}},
        Mistake{"ComponentsAreNoList",
                kMap,
                "components: {p1: t1}\n",
                {"bad_input_map.yaml:1: components: found a map, expected a list"}},
        Mistake{
            "Empty", kMap, "", {"bad_input_map.yaml:1: the map: found nothing, expected a map"}},
        Mistake{"NoYaml", "components:", "components: [", {"bad_input_map.yaml:", "found no YAML"}},
        Mistake{"FactThatDoesNotFit",
                "neighbors:",
                "facts: [\"besides(p1, p3)\"]\nneighbors:",
                {"fact 'besides(p1, p3)' of the map:", "did you mean 'beside'?"}}),
    nameOf);

TEST(BadMapOfARobot, IsRefusedToo)
{
  ComponentMapData data{{{"p1", "t1"}, {"p2", "t1"}, {"p3", "t2"}}, {{1}, {}, {2}}, {}, {}};
  expectError(ErrorCode::kInvalidArgument,
              "the map: 'p2' is a neighbour of 'p1', but not the other way round",
              [&] { ComponentMap map(data); });
  expectError(ErrorCode::kInvalidArgument, "the map: 'p3' is its own neighbour",
              [&] { ComponentMap map(data); });
}

class BadModelsFile : public testing::TestWithParam<Mistake>
{
};

TEST_P(BadModelsFile, IsRefusedWithPlaceAndMend)
{
  const LowLevelDomain domain = good();
  expectTold(GetParam(),
             [&] { (void)parseModels(changed(kModels, GetParam()), "models.yaml", domain); });
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, BadModelsFile,
    testing::Values(
        Mistake{"NoProbability",
                ", off: 0.1}",
                "}",
                {"models.yaml:7: turn, outcomes: found no probability of 'off', expected one for "
                 "each of 'good', 'off'"}},
        Mistake{"UnknownLabel",
                "off: 0.1}",
                "of: 0.1}",
                {"models.yaml:7: turn, outcomes, probabilities: unknown key 'of'",
                 "did you mean 'off'?"}},
        Mistake{"SumOffOne",
                "good: 0.9",
                "good: 0.8",
                {"models.yaml:7: turn, outcomes: the probabilities sum to 0.900000, expected 1"}},
        Mistake{"NotANumber",
                "good: 0.9,",
                "good: .nan,",
                {"models.yaml:7: good: found '.nan', expected a number from 0 to 1"}},
        Mistake{"CountsContradict",
                "good: 90, off: 10",
                "good: 50, off: 50",
                {"models.yaml:8: turn, outcomes, good: probability 0.9 contradicts its counts, 50 "
                 "of 100; expected about 0.5"}},
        Mistake{"CountMissing",
                ", off: 10}",
                "}",
                {"models.yaml:8: turn, outcomes: found no count of 'off'"}},
        Mistake{"CountNegative",
                "off: 10",
                "off: -10",
                {"models.yaml:8: turn, outcomes, counts, off: found '-10', a count must be a whole "
                 "number"}},
        Mistake{"LearnedWithoutCounts",
                "      counts: {good: 90, off: 10}\n",
                "",
                {"models.yaml:7: turn, outcomes: learned without counts; give the sample sizes, or "
                 "say 'source: hand-written'"}},
        Mistake{"LearnedFromNothing",
                "{good: 90, off: 10}",
                "{good: 0, off: 0}",
                {"models.yaml:7: turn, outcomes: learned without counts"}},
        Mistake{"HandWrittenWithCounts",
                "source: learned",
                "source: hand-written",
                {"models.yaml:9: turn, outcomes: hand-written, but there are counts"}},
        Mistake{"UnknownSource",
                "source: learned",
                "source: learnt",
                {"models.yaml:9: turn, outcomes: source 'learnt', expected 'learned' or "
                 "'hand-written'; did you mean 'learned'?"}},
        Mistake{"OutcomesOfACertainAction",
                "  close(V):\n",
                "  close(V):\n    outcomes: {probabilities: {ok: 1.0}, source: hand-written}\n",
                {"models.yaml:12: close, outcomes: the laws of close have no labelled outcomes"}},
        Mistake{"NoOutcomes",
                "    outcomes:\n      probabilities: {good: 0.9, off: 0.1}\n"
                "      counts: {good: 90, off: 10}\n      source: learned\n",
                "",
                {"models.yaml:5: turn, outcomes: found no probabilities, expected one for each of "
                 "'good', 'off'"}},
        Mistake{"NoObservationModel",
                "      feeds:\n",
                "      shut:\n",
                {"look: found no observation model of 'feeds'",
                 "models.yaml:15: look, observations: unknown key 'shut'"}},
        Mistake{"NoFalsePositive",
                "        false_positive: 0.1\n",
                "",
                {"models.yaml:16: look, observation of feeds: found no false_positive"}},
        Mistake{"InvertedSensor",
                "true_positive: 0.9",
                "true_positive: 0.05",
                {"true_positive 0.050000 is below false_positive 0.100000"}},
        Mistake{
            "DistanceFromTruth",
            "from: feeds(V)",
            "from: shut(V)",
            {"models.yaml:10: turn, cost: distance from 'shut(V)', which has no component as its "
             "value"}},
        Mistake{"DistanceFromUnknown",
                "from: feeds(V)",
                "from: fedes(V)",
                {"models.yaml:10: turn, cost: distance from 'fedes(V)'", "did you mean 'feeds'?"}},
        Mistake{"DistanceToNoComponent",
                "to: P}",
                "to: V}",
                {"models.yaml:10: turn, cost: distance to 'v1' of the sort 'valve', which is no "
                 "component of the map"}},
        Mistake{"DistanceToUnknown",
                "to: P}",
                "to: Q}",
                {"models.yaml:10: turn, cost: distance to 'Q', expected one of the action's "
                 "parameters 'V', 'P'"}},
        Mistake{"DistanceWithoutSpeed",
                "per_metre_s: 1.0, ",
                "",
                {"models.yaml:10: turn, cost: per_metre_s and distance go together"}},
        Mistake{"NegativeCost",
                "base_s: 1.0",
                "base_s: -1.0",
                {"models.yaml:19: base_s: found '-1.0', expected a number from 0"}},
        Mistake{"NoCost",
                "    cost: {base_s: 1.0, impossible_s: 5.0}\n",
                "",
                {"models.yaml:13: look: found no 'cost'"}},
        Mistake{"ThresholdOne",
                "threshold: 0.9",
                "threshold: 1",
                {"models.yaml:2: threshold: found '1', expected a number between 0.5 and 1, both "
                 "excluded"}},
        Mistake{"ThresholdHalf",
                "threshold: 0.9",
                "threshold: 0.5",
                {"models.yaml:2: threshold: found '0.5'"}},
        Mistake{"RewardsUpsideDown",
                "given_up: 5",
                "given_up: 60",
                {"models.yaml:3: rewards: expected success above given_up"}},
        Mistake{"KeyTwice",
                "threshold: 0.9",
                "discount: 0.9",
                {"models.yaml:2: the models: key 'discount' a second time"}},
        Mistake{"ActionTwice",
                "  close(V):\n    cost",
                "  turn(V, P):\n    cost",
                {"models.yaml:11: actions: 'turn' a second time", "found none for 'close'"}},
        Mistake{"ParameterTwice",
                "look(V, P)",
                "look(V, V)",
                {"models.yaml:13: look: two parameters are named 'V'"}},
        Mistake{"TooFewParameters",
                "look(V, P)",
                "look(V)",
                {"models.yaml:13: actions: 'look(V)' has 1 parameters, expected 2, of the sorts "
                 "'valve', 'port'"}},
        Mistake{"UnknownAction",
                "close(V)",
                "clsoe(V)",
                {"models.yaml:11: actions: 'clsoe(V)' is no action of the low level",
                 "did you mean 'close'?", "found none for 'close'"}},
        Mistake{"ExogenousAction",
                "  close(V):",
                "  burst(P): {}\n  close(V):",
                {"models.yaml:11: actions: 'burst(P)' is no action of the low level"}},
        Mistake{"ActionsAreNoMap",
                kModels,
                "actions: [turn]\n",
                {"models.yaml:1: found no map 'actions'"}},
        Mistake{"KeyThatIsAList",
                "threshold: 0.9",
                "? [a, b]\n: 0.9",
                {"models.yaml:2: the models: found a key that is no text"}},
        Mistake{"MapForANumber",
                "discount: 0.95",
                "discount: {of: 0.95}",
                {"models.yaml:1: discount: found a map, expected a number from 0 to 1"}}),
    nameOf);

TEST(BadModelsFile, AMapWithoutPlacesHasNoDistances)
{
  std::string map = kMap;
  for (const char* at : {", at: [0, 0]", ", at: [1, 0]", ", at: [3, 0]"})
  {
    map.erase(map.find(at), std::string(at).size());
  }
  const LowLevelDomain domain = composed(kHighLevel, kRefinement, mapFrom(map));
  expectError(ErrorCode::kInvalidArgument,
              "models.yaml:10: turn, cost: the map says of no component where it is; add 'at: [x, "
              "y]' to each",
              [&] { (void)parseModels(kModels, "models.yaml", domain); });
}

TEST(BadModelsFile, TellsAValueWithoutFalsePositives)
{
  const std::string refinement =
      changed(kRefinement, {"", "observes feeds(V) = P", "observes feeds(V)", {}});
  const LowLevelDomain domain = composed(kHighLevel, refinement, mapFrom(kMap));
  expectError(ErrorCode::kInvalidArgument,
              "models.yaml:17: look, observation of feeds: the action tells a value",
              [&] { (void)parseModels(kModels, "models.yaml", domain); });
}

TEST(BadInput, IsToldAllAtOnce)
{
  const std::string refinement = kMagnify +
                                 "actions\n  wait(valve).\n  exogenous leak(valve).\n"
                                 "observations\n  close(V) observes shut(V2).\n";
  const std::string map = "components:\n  - {name: p1, part_of: t3}\n  - {name: v2, part_of: t1}\n";
  for (const char* part :
       {"refinement.kr3:1:1: 't2' of sort 'tank' has no components",
        "refinement.kr3:3:3: the action wait", "refinement.kr3:4:3: found the exogenous",
        "refinement.kr3:6:3: close observes shut with the variable V2",
        "bad_input_map.yaml:2: component 'p1' of the map",
        "bad_input_map.yaml:3: 'v2' is a component"})
  {
    expectError(ErrorCode::kInvalidArgument, part,
                [&] { (void)composed(kHighLevel, refinement, mapFrom(map)); });
  }
}

TEST(LearnedModels, CanBeRequired)
{
  const LowLevelDomain domain = good();
  const Models models = parseModels(kModels, "models.yaml", domain);
  EXPECT_EQ(handWritten(models),
            (std::vector<std::string>{
                "models.yaml:12: cost of close", "models.yaml:16: observation of feeds of look",
                "models.yaml:19: cost of look", "models.yaml:10: cost of turn"}));
  expectError(ErrorCode::kInvalidArgument,
              "models.yaml:16: look, observation of feeds is hand-written, but learned values are "
              "required",
              [&] { (void)parseModels(kModels, "models.yaml", domain, {true}); });
  std::string learned = kModels;
  const std::string source = "source: hand-written";
  learned.replace(learned.find(source), source.size(),
                  "counts: {true_positive: 45, false_negative: 5, false_positive: 4, "
                  "true_negative: 36}\n        source: learned");
  for (std::size_t at = 0; (at = learned.find("impossible_s: 5.0}", at)) != std::string::npos; ++at)
  {
    learned.insert(at,
                   "counts: {carried_out: 50, impossible: 5}, stddev_s: 0.5, source: learned, ");
    at = learned.find("impossible_s: 5.0}", at);
  }
  EXPECT_TRUE(handWritten(parseModels(learned, "models.yaml", domain, {true})).empty());
}

TEST(Models, SumToOneForEachLawThatIsDrawnAlone)
{
  const std::string refinement =
      changed(kRefinement, {"",
                            kAfterLook,
                            kAfterLook + "  close(V) causes shut(V) [easy] or nothing [hard] if "
                                         "-shut(V).\n  close(V) causes -shut(V) [back] if "
                                         "shut(V).\n",
                            {}});
  const LowLevelDomain domain = composed(kHighLevel, refinement, mapFrom(kMap));
  const auto with = [](const std::string& probabilities) {
    return changed(kModels, {"",
                             "  close(V):\n",
                             "  close(V):\n    outcomes: {probabilities: " + probabilities +
                                 ", source: hand-written}\n",
                             {}});
  };
  (void)parseModels(with("{easy: 0.8, hard: 0.2, back: 1.0}"), "models.yaml", domain);
  (void)parseModels(with("{easy: 0.5, hard: 0.2, back: 0.3}"), "models.yaml", domain);
  expectError(ErrorCode::kInvalidArgument, "close, outcomes: the probabilities sum to", [&] {
    (void)parseModels(with("{easy: 0.8, hard: 0.3, back: 1.0}"), "models.yaml", domain);
  });
}

}  // namespace
}  // namespace kr3::refinement
