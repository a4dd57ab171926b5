// Several laws with labels that apply at once: the interpreter of the world and the generated model
// draw one event.

#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_reasoner/language.hpp>

#include "model_comparison.hpp"

namespace kr3::executive
{
namespace
{

using namespace test;

constexpr char kHighLevel[] = R"(
sorts
  bay = {near, far}.
  cart = {cart1}.
fluents
  inertial at(cart) : bay.
  inertial dented(cart).
  inertial smeared(cart).
  inertial wet(cart).
actions
  push(cart, bay).
axioms
  push(C, B) causes at(C) = B.
  impossible push(C, B) if at(C) = B.
)";

constexpr char kLowLevel[] = R"(
magnify bay into slot by of_bay.
statics
  beside(slot, slot).
actions
  inspect(cart).
axioms
  push(C, S) causes at(C) = S [placed] or nothing [hit].
  push(C, S) causes dented(C) [hit] or -dented(C) [placed].
  push(C, S) causes smeared(C) [splashed] or -smeared(C) [wiped] if wet(C).
observations
  push(C, S) observes at(C).
  inspect(C) observes dented(C).
  inspect(C) observes smeared(C).
)";

constexpr char kNumbers[] = R"(
actions:
  push(C, S):
    outcomes:
      probabilities: {placed: 0.7, hit: 0.3, splashed: 0.4, wiped: 0.6}
      source: hand-written
    observations: {at: exact}
    cost: {base_s: 1.0, impossible_s: 2.0}
  inspect(C):
    observations:
      dented: {true_positive: 0.9, false_positive: 0.1, source: hand-written}
      smeared: {true_positive: 0.8, false_positive: 0.2, source: hand-written}
    cost: {base_s: 1.0, impossible_s: 2.0}
)";

struct Carts
{
  LowLevelDomain domain;
  Models models;
};

const Carts& carts()
{
  static const Carts loaded = [] {
    const auto high = reasoner::parseDescription(kHighLevel, "domain.kr3");
    LowLevelDomain domain(high, reasoner::parseRefinement(kLowLevel, "refinement.kr3", high),
                          refinement::gridMap({"near", "far"}, 2, 1.0));
    Models models = refinement::parseModels(kNumbers, "models.yaml", domain.description());
    return Carts{std::move(domain), std::move(models)};
  }();
  return loaded;
}

/// The states that pushing a cart to far_c0 can lead to, by event.
std::map<std::string, FluentValues> eventsOfPushing(bool wet)
{
  const RuleInterpreter laws(carts().domain.description());
  const FluentValues start{{"at(cart1)", "near_c0"}, {"wet(cart1)", wet ? "true" : "false"}};
  const reasoner::Atom push{"push", {{false, "cart1"}, {false, "far_c0"}}, {}};
  std::map<std::string, FluentValues> events;
  std::size_t count = 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    std::string label;
    const OutcomeChooser chooser{[&](const std::string&, const std::vector<std::string>& labels) {
      count = labels.size();
      return i;
                                 },
                                 [](std::size_t) { return std::size_t{0}; }};
    FluentValues next = laws.successor(start, push, chooser, &label);
    EXPECT_TRUE(events.emplace(label, std::move(next)).second) << label;
  }
  return events;
}

TEST(JointOutcomes, LawsWithTheSameLabelsHaveOneEvent)
{
  const auto events = eventsOfPushing(false);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events.at("placed").at("at(cart1)"), "far_c0");
  EXPECT_EQ(events.at("placed").at("dented(cart1)"), "false");
  EXPECT_EQ(events.at("hit").at("at(cart1)"), "near_c0");
  EXPECT_EQ(events.at("hit").at("dented(cart1)"), "true");
}

TEST(JointOutcomes, LawsWithOtherLabelsShareTheEvent)
{
  const auto events = eventsOfPushing(true);
  ASSERT_EQ(events.size(), 4U);
  EXPECT_EQ(events.at("splashed").at("smeared(cart1)"), "true");
  EXPECT_EQ(events.at("splashed").at("at(cart1)"), "near_c0");
  EXPECT_EQ(events.at("splashed").count("dented(cart1)"), 0U);
  EXPECT_EQ(events.at("placed").count("smeared(cart1)"), 0U);
}

/// A push in which everything may happen: the labels of three laws, or of two.
Case pushing(const std::string& name, bool wet)
{
  const std::string truth = wet ? "true" : "false";
  const FluentValues coarse{{"at(cart1)", "near"},
                            {"dented(cart1)", "false"},
                            {"smeared(cart1)", "false"},
                            {"wet(cart1)", truth}};
  return {
      name,
      &carts().domain,
      &carts().models,
      {"at(cart1) = near", "-dented(cart1)", "-smeared(cart1)", wet ? "wet(cart1)" : "-wet(cart1)"},
      "push(cart1, far)",
      {},
      {{1.0, coarse, {}}}};
}

TEST(JointOutcomes, TheGeneratedModelShowsTheSame)
{
  for (const bool wet : {false, true})
  {
    const Case c = pushing(wet ? "wet" : "dry", wet);
    const Sample sample = sampled(c, 3, 1500, 11);
    const Comparison comparison = compareSequences(c, *c.models, sample);
    EXPECT_FALSE(comparison.rejected()) << c.name << ": " << comparison.where;
    Models wrong = carts().models;
    wrong.actions.at("push").outcomes.probabilities.at("placed") = 0.5;
    wrong.actions.at("push").outcomes.probabilities.at("hit") = 0.5;
    EXPECT_TRUE(compareSequences(c, wrong, sample).rejected()) << c.name;
  }
}

}  // namespace
}  // namespace kr3::executive
