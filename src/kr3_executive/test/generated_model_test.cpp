// A generated POMDP against the low-level description itself. The description is carried out by
// AbstractWorld, which interprets the laws and knows no zoom and no POMDP; both must show the same
// observations and states, as far as chance lets one tell.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "model_comparison.hpp"

namespace kr3::executive
{
namespace
{

using namespace test;

std::string textOf(const std::string& path)
{
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Loaded
{
  LowLevelDomain domain;
  Models models;
};

Loaded composed(const std::string& high, const std::string& fine, const std::string& models,
                const refinement::ComponentMap& map)
{
  const auto description = reasoner::parseDescription(high, "domain.kr3");
  LowLevelDomain domain(description, reasoner::parseRefinement(fine, "refinement.kr3", description),
                        map);
  Models numbers = refinement::parseModels(models, "models.yaml", domain.description());
  return {std::move(domain), std::move(numbers)};
}

/// A domain of the repository with only some of its constants, so that the world is quick.
Loaded shipped(const std::string& name, const std::set<std::string>& keep,
               const refinement::ComponentMap& map)
{
  const std::string directory = std::string(KR3_DOMAINS_DIR) + "/" + name;
  const auto whole = reasoner::readDescription(directory + "/domain.kr3");
  return composed(reasoner::toString(reasoner::restricted(whole, keep)),
                  textOf(directory + "/refinement.kr3"), textOf(directory + "/models.yaml"), map);
}

/// Three rooms of three cells in one row: a slip can end in the next room, outside a zoom.
refinement::ComponentMap corridorMap()
{
  refinement::ComponentMapData data;
  for (const std::string room : {"office", "main_library", "kitchen"})
  {
    for (int cell = 0; cell < 3; ++cell)
      data.components.push_back({room + "_c" + std::to_string(cell), room});
  }
  const std::size_t size = data.components.size();
  for (std::size_t i = 0; i < size; ++i)
  {
    std::vector<std::size_t>& beside = data.neighbors.emplace_back();
    if (i > 0)
      beside.push_back(i - 1);
    if (i + 1 < size)
      beside.push_back(i + 1);
    for (std::size_t j = 0; j < size; ++j)
      data.distances_m.push_back(std::abs(static_cast<double>(i) - static_cast<double>(j)));
  }
  return refinement::ComponentMap(std::move(data));
}

const Loaded& office()
{
  static const Loaded loaded =
      shipped("office", {"rob1", "tb1", "office", "main_library", "kitchen"}, corridorMap());
  return loaded;
}

Case grasping()
{
  const FluentValues robot{{"loc(rob1)", "main_library_c1"}};
  const auto with = [](const std::string& place) {
    return FluentValues{{"loc(rob1)", "main_library"}, {"loc(tb1)", place}};
  };
  return {"grasp",
          &office().domain,
          &office().models,
          {"loc(rob1) = main_library", "loc(tb1) = main_library"},
          "grasp(rob1, tb1)",
          {{{"loc(rob1)", {{"main_library_c1", 1.0}}}}, {{"loc(tb1)", {{"main_library", 0.7}}}}},
          {{0.7, with("main_library"), robot},
           {0.2, with("kitchen"), robot},
           {0.1, with("office"), robot}}};
}

Case carrying()
{
  const FluentValues at{
      {"loc(rob1)", "office"}, {"loc(tb1)", "office"}, {"in_hand(rob1, tb1)", "true"}};
  return {"carry",
          &office().domain,
          &office().models,
          {"loc(rob1) = office", "loc(tb1) = office", "in_hand(rob1, tb1)"},
          "move(rob1, main_library)",
          {{{"loc(rob1)", {{"office_c1", 1.0}}}}, {}},
          {{1.0, at, {{"loc(rob1)", "office_c1"}, {"loc(tb1)", "office_c1"}}}}};
}

const Loaded& workbench()
{
  static const Loaded loaded =
      shipped("workbench", {"psu", "amplifier", "tuner", "display", "tech1", "hum"},
              refinement::readComponentMap(std::string(KR3_DOMAINS_DIR) + "/workbench/map.yaml"));
  return loaded;
}

Case repairing()
{
  const FluentValues covers{{"opened(mains_switch)", "true"},
                            {"opened(transformer)", "false"},
                            {"opened(rectifier)", "true"}};
  InitialKnowledge knowledge{{}, {{"cause(hum)", {{"psu", 0.6}}}}};
  for (const auto& [fluent, value] : covers)
    knowledge.fine[fluent] = {{value, 1.0}};
  return {"repair",
          &workbench().domain,
          &workbench().models,
          {"opened(psu)", "cause(hum) = psu"},
          "replace(tech1, psu, hum)",
          std::move(knowledge),
          {{0.6, {{"cause(hum)", "psu"}}, covers},
           {0.3, {{"cause(hum)", "amplifier"}}, covers},
           {0.1, {{"cause(hum)", "display"}}, covers}}};
}

const char* const kRacks = R"(
sorts
  rack = {near, far}.
  thing = {box, crate}.
fluents
  inertial on(thing) : rack.
  inertial tagged(thing).
  inertial sealed(thing).
actions
  push(thing, rack).
  tag(thing).
axioms
  push(X, K) causes on(X) = K.
  tag(X) causes tagged(X) if -sealed(X).
  tag(X) causes sealed(X) if tagged(X).
  -tagged(X) if sealed(X).
  impossible tag(X) if on(X) = K, sealed(X).
  impossible push(X, K) if sealed(X).
)";

const char* const kShelves = R"(
magnify rack into shelf by of_rack.
statics
  beside(shelf, shelf).
actions
  gauge(thing).
axioms
  push(X, S) causes on(X) = S [placed] or on(X) = {Z : beside(Z, S)} [slid].
  impossible gauge(X) if sealed(X).
observations
  gauge(X) observes on(X).
  gauge(X) observes tagged(X).
  tag(X) observes tagged(X).
)";

const char* const kRackNumbers = R"(
actions:
  push(X, S):
    outcomes: {probabilities: {placed: 0.7, slid: 0.3}, source: hand-written}
    cost: {base_s: 1.0, impossible_s: 2.0}
  tag(X):
    observations: {tagged: {true_positive: 0.9, false_positive: 0.2, source: hand-written}}
    cost: {base_s: 1.0, impossible_s: 2.0}
  gauge(X):
    observations:
      on: {true_positive: 0.8, source: hand-written}
      tagged: {true_positive: 0.85, false_positive: 0.1, source: hand-written}
    cost: {base_s: 1.0, impossible_s: 2.0}
)";

/// Sensors for values that err, a constraint between fluents, laws under conditions.
const Loaded& racks()
{
  static const Loaded loaded =
      composed(kRacks, kShelves, kRackNumbers, refinement::gridMap({"near", "far"}, 3, 1.0));
  return loaded;
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
  return text.replace(text.find(from), from.size(), to);
}

/// The racks with numbers of their own for light things, near shelves and one shelf.
const Loaded& sortedRacks()
{
  static const Loaded loaded = composed(
      replaced(kRacks, "thing = {box, crate}.", "light = {box}.\n  thing = light + {crate}."),
      kShelves,
      replaced(replaced(kRackNumbers, "  tag(X):",
                        R"(    classes:
      - for: {X: light}
        outcomes: {probabilities: {placed: 0.5, slid: 0.5}, source: hand-written}
      - for: {X: light, S: near_c1}
        outcomes: {probabilities: {placed: 0.9, slid: 0.1}, source: hand-written}
  tag(X):)"),
               "  gauge(X):",
               R"(    classes:
      - for: {X: box}
        observations: {tagged: {true_positive: 0.75, false_positive: 0.3, source: hand-written}}
  gauge(X):
    classes:
      - for: {X: light}
        observations: {on: {true_positive: 0.6, source: hand-written}}
        cost: {base_s: 2.0})"),
      refinement::gridMap({"near", "far"}, 3, 1.0));
  return loaded;
}

Case tagging()
{
  return {"tag",
          &racks().domain,
          &racks().models,
          {"on(box) = near", "on(crate) = far"},
          "tag(box)",
          {{}, {{"on(box)", {{"near", 0.75}}}}},
          {{0.75, {{"on(box)", "near"}, {"on(crate)", "far"}}, {}},
           {0.25, {{"on(box)", "far"}, {"on(crate)", "far"}}, {}}}};
}

Case sorting()
{
  Case c = tagging();
  c.name = "sort";
  c.domain = &sortedRacks().domain;
  c.models = &sortedRacks().models;
  return c;
}

/// With the false-positive or outcome probabilities changed by a little.
Models perturbed(Models models, const std::string& action, const std::string& outcome,
                 const std::string& other, double probability)
{
  auto& probabilities = models.actions.at(action).outcomes.probabilities;
  probabilities.at(outcome) = probability;
  probabilities.at(other) = 1.0 - probability;
  return models;
}

Models withFalsePositive(Models models, const std::string& action, const std::string& fluent,
                         double probability)
{
  models.actions.at(action).observations.at(fluent).false_positive = probability;
  return models;
}

// Counted work: the world's samples are taken once and held against several models.
constexpr int kSequences = 3;
constexpr int kPolicyTrials = 600;

struct SampledCase
{
  Case c;
  Sample sample;
};

const std::vector<SampledCase>& cases()
{
  static const std::vector<SampledCase> all = [] {
    std::vector<SampledCase> result;
    result.push_back({grasping(), sampled(grasping(), kSequences, 4500, 11)});
    result.push_back({carrying(), sampled(carrying(), kSequences, 1000, 11)});
    result.push_back({repairing(), sampled(repairing(), kSequences, 1500, 11)});
    result.push_back({tagging(), sampled(tagging(), kSequences, 2500, 11)});
    result.push_back({sorting(), sampled(sorting(), kSequences, 1500, 11)});
    return result;
  }();
  return all;
}

const SampledCase& caseOf(const std::string& name)
{
  return *std::find_if(cases().begin(), cases().end(),
                       [&](const SampledCase& sampled) { return sampled.c.name == name; });
}

std::string summaryOf(const Comparison& comparison)
{
  char p[32];
  std::snprintf(p, sizeof(p), "%.3g", comparison.least);
  return std::string("p = ") + p + ", the least of " + std::to_string(comparison.tests) + ", at " +
         comparison.where;
}

TEST(GeneratedModel, ShowsWhatTheDescriptionShowsUnderRandomActions)
{
  for (const auto& [c, sample] : cases())
  {
    const Comparison comparison = compareSequences(c, *c.models, sample);
    EXPECT_FALSE(comparison.rejected()) << c.name << ": " << summaryOf(comparison);
  }
}

TEST(GeneratedModel, ShowsWhatTheDescriptionShowsToAPolicy)
{
  for (const auto& [c, sample] : cases())
  {
    const Comparison comparison = comparePolicy(c, *c.models, kPolicyTrials, 12);
    EXPECT_FALSE(comparison.rejected()) << c.name << ": " << summaryOf(comparison);
  }
}

// The same tests of the same samples must notice a model that is a little wrong.
TEST(GeneratedModel, IsRejectedWhenItsNumbersAreALittleWrong)
{
  const auto expectRejected =
      [](const std::string& name, const Models& models, const std::string& what) {
    const SampledCase& sampled = caseOf(name);
    const Comparison comparison = compareSequences(sampled.c, models, sampled.sample);
    EXPECT_TRUE(comparison.rejected()) << what << ": " << summaryOf(comparison);
  };
  const Models& own = office().models;
  expectRejected("grasp", perturbed(own, "move", "slipped", "reached", 0.10), "slip 0.05 as 0.10");
  expectRejected("carry", perturbed(own, "move", "slipped", "reached", 0.10), "slip 0.05 as 0.10");
  expectRejected("grasp", withFalsePositive(own, "search", "loc", 0.08),
                 "false positives 0.05 as 0.08");
  expectRejected("repair", perturbed(workbench().models, "unscrew", "stuck", "loose", 0.27),
                 "stuck screws 0.20 as 0.27");
  expectRejected("tag", perturbed(racks().models, "push", "slid", "placed", 0.40),
                 "sliding 0.30 as 0.40");
}

// A generator that looks at the numbers of the action only, or at one class too few.
TEST(GeneratedModel, IsRejectedWhenItDoesNotSeeTheClasses)
{
  const SampledCase& sorted = caseOf("sort");
  for (const char* const action : {"push", "tag", "gauge"})
  {
    Models models = sortedRacks().models;
    models.actions.at(action).classes.pop_back();
    const Comparison comparison = compareSequences(sorted.c, models, sorted.sample);
    EXPECT_TRUE(comparison.rejected()) << action << ": " << summaryOf(comparison);
  }
}

TEST(GeneratedModel, IsRejectedByAPolicysRunsWhenItsNumbersAreWrong)
{
  EXPECT_TRUE(comparePolicy(grasping(), withFalsePositive(office().models, "search", "loc", 0.15),
                            kPolicyTrials, 12)
                  .rejected());
}

// A model whose start is a little wrong: the share of `elsewhere`.
TEST(GeneratedModel, IsRejectedWhenItsStartIsALittleWrong)
{
  SampledCase grasp = caseOf("grasp");
  grasp.c.knowledge.coarse["loc(tb1)"] = {{"main_library", 0.78}};
  EXPECT_TRUE(compareSequences(grasp.c, *grasp.c.models, grasp.sample).rejected());
}

// What leaves the zoom ends in the boundary, as often as it does in the world.
TEST(GeneratedModel, LeavesTheZoomAsOftenAsTheWorldDoes)
{
  const Case c = grasping();
  const PomdpTask task = c.task(*c.models);
  const std::size_t edge = task.model().findAction("move(rob1,main_library_c2)").value();
  const std::vector<Counts> model = predicted(task, *c.domain, {edge});
  EXPECT_NEAR(model[0].at("outside | boundary"), 0.025, 1e-9);  // half of the slips at the edge
  const std::vector<Counts> world = counted(c, task, {edge}, 4000, 13);
  EXPECT_GT(fitP(world[0], model[0], 4000), kSignificance);
  EXPECT_GT(world[0].at("outside | boundary"), 0.0);
}

// The tests themselves: known quantiles, and a result that cannot be.
TEST(ChiSquared, HasItsKnownTails)
{
  EXPECT_NEAR(chiSquaredTail(3.841459, 2), 0.05, 1e-6);
  EXPECT_NEAR(chiSquaredTail(18.307038, 11), 0.05, 1e-6);
  EXPECT_EQ(fitP({{"never", 1.0}, {"always", 99.0}}, {{"always", 1.0}}, 100.0), 0.0);
  EXPECT_NEAR(fitP({{"a", 60.0}, {"b", 40.0}}, {{"a", 0.5}, {"b", 0.5}}, 100.0), 0.0455, 1e-4);
  EXPECT_NEAR(sameP({{"a", 60.0}, {"b", 40.0}}, {{"a", 60.0}, {"b", 40.0}}), 1.0, 1e-12);
}

}  // namespace
}  // namespace kr3::executive
