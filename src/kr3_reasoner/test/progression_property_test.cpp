// Histories that are progressed, against the same histories as a whole, on random descriptions with
// random continuations (docs/semantics_tests.md, row 11). The number of cases is 30, or what
// KR3_REASONER_CASES says; the first seed is 1, or KR3_REASONER_SEED.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/ground_domain.hpp"
#include "support/random_case.hpp"

namespace kr3::reasoner
{
namespace
{

long numberFrom(const char* variable, long otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtol(text, nullptr, 10);
}

/// A description with a history, and the steps to which it is progressed on the way.
struct Mission
{
  Description description;
  std::vector<Record> records;
  ReasonerOptions options;
  std::vector<int> stops;
  std::string text;
};

Mission randomMission(std::uint64_t seed)
{
  CaseSize size;
  size.max_steps = 4;
  size.max_records = 6;
  const RandomCase drawn = randomCase(seed, size);
  std::mt19937_64 random(seed);
  const auto below = [&](std::size_t limit) { return static_cast<int>(random() % limit); };
  Mission mission{parseDescription(drawn.description, "random"), {}, drawn.options, {}, ""};
  // Attempts seldom contradict each other, which leaves more histories that mean something.
  const std::string history =
      below(3) == 0 ? drawn.history
                    : randomHistory(mission.description, random(), 1 + below(4), below(9));
  mission.records = parseHistory(history, "history", mission.description);
  mission.options.max_carried_explanations = 1000;
  Reasoner reasoner(mission.description, mission.options);
  reasoner.setHistory(mission.records);
  for (int step = 1; step <= reasoner.currentStep(); ++step)
  {
    if (below(2) == 0)
    {
      mission.stops.push_back(step);
    }
  }
  if (mission.stops.empty() && reasoner.currentStep() > 0)
  {
    mission.stops.push_back(1 + below(static_cast<std::size_t>(reasoner.currentStep())));
  }
  mission.text = toString(drawn) + "\n" + history + "\nprogressed to";
  for (const int stop : mission.stops)
  {
    mission.text += " " + std::to_string(stop);
  }
  return mission;
}

/// The history as it is lived: what is about earlier steps comes first, and on the way the history
/// is progressed. Nothing when a part of it is inconsistent, so that it cannot be.
std::unique_ptr<Reasoner> livedThrough(const Mission& mission)
{
  auto reasoner = std::make_unique<Reasoner>(mission.description, mission.options);
  std::vector<Record> rest = mission.records;
  const auto tell = [&](int step) {
    const auto due = std::stable_partition(rest.begin(), rest.end(), [&](const Record& record) {
      return record.step > step || (record.step == step && record.statement.size() % 2 == 0);
    });
    reasoner->addRecords({due, rest.end()});
    rest.erase(due, rest.end());
  };
  for (const int stop : mission.stops)
  {
    const auto due = std::stable_partition(
        rest.begin(), rest.end(), [&](const Record& record) { return record.step >= stop; });
    reasoner->addRecords({due, rest.end()});
    rest.erase(due, rest.end());
    tell(stop);  // some of what is about the step itself
    if (reasoner->currentStep() < stop)
    {
      continue;
    }
    try
    {
      const Progress progress = reasoner->progress(stop);
      EXPECT_EQ(progress.first_step, stop);
      EXPECT_TRUE(progress.kept_because.empty());
    }
    catch (const FailedPrecondition&)
    {
      EXPECT_FALSE(reasoner->diagnose().consistent);
      return nullptr;
    }
  }
  reasoner->addRecords(rest);
  return reasoner;
}

using Trajectories = std::set<std::pair<std::vector<std::string>, std::vector<std::string>>>;

/// What models assume and how they go on from a step.
Trajectories trajectories(const Reasoner& reasoner, int from)
{
  Trajectories found;
  for (const HistoryModel& model : reasoner.models(0))
  {
    std::vector<std::string> path;
    const auto skipped = static_cast<std::size_t>(from - reasoner.firstStep());
    for (std::size_t i = skipped; i < model.states.size(); ++i)
    {
      for (const Literal& literal : model.states[i])
      {
        path.push_back(toString(literal));
      }
      if (i < model.actions.size())
      {
        path.insert(path.end(), model.actions[i].begin(), model.actions[i].end());
      }
      path.emplace_back("");
    }
    std::vector<std::string> assumed = model.assumed;
    std::sort(assumed.begin(), assumed.end());
    found.emplace(assumed, path);
  }
  return found;
}

std::set<std::set<std::string>> explanationsOf(const Diagnosis& diagnosis)
{
  std::set<std::set<std::string>> sets;
  for (const auto& explanation : diagnosis.explanations)
  {
    sets.emplace(explanation.begin(), explanation.end());
  }
  return sets;
}

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
  const std::string first = literal();
  return below(2) == 0 ? first : first + (below(2) == 0 ? " and " : " or ") + literal();
}

/// The plans as people would compare them: lengths, costs and what is assumed.
std::multiset<std::string> summaryOf(const PlanResult& result)
{
  std::multiset<std::string> plans;
  for (const Plan& plan : result.plans)
  {
    std::vector<std::string> hypothesis = plan.hypothesis;
    std::sort(hypothesis.begin(), hypothesis.end());
    std::string text = std::to_string(plan.steps.size()) + " steps";
    for (const std::string& literal : hypothesis)
    {
      text += ", " + literal;
    }
    plans.insert(text);
  }
  return plans;
}

void expectSamePlans(const Reasoner& whole, const Reasoner& progressed,
                     const oracle::GroundDomain& domain, std::uint64_t seed)
{
  const std::string goal = randomGoal(domain, seed);
  SCOPED_TRACE("goal " + goal);
  for (const bool relevant_only : {false, true})
  {
    PlanOptions options;
    options.max_horizon = 2;
    options.relevant_only = relevant_only;
    options.time_limit = std::chrono::milliseconds(20000);
    PlanResult expected;
    PlanResult found;
    try
    {
      expected = whole.plan(goal, options);
      found = progressed.plan(goal, options);
    }
    catch (const DeadlineExceeded&)
    {
      return;  // too much for a test of many cases
    }
    EXPECT_EQ(found.goal_entailed, expected.goal_entailed) << relevant_only;
    EXPECT_EQ(found.covers_all, expected.covers_all) << relevant_only;
    ASSERT_EQ(found.plans.empty(), expected.plans.empty())
        << relevant_only << found.reason << expected.reason;
    // Which hypotheses are found first may differ; the whole set for a length may not.
    if (!expected.plans.empty())
    {
      const auto shorter = [](const Plan& a, const Plan& b) {
        return a.steps.size() < b.steps.size();
      };
      EXPECT_EQ(
          std::min_element(found.plans.begin(), found.plans.end(), shorter)->steps.size(),
          std::min_element(expected.plans.begin(), expected.plans.end(), shorter)->steps.size());
    }
    if (expected.plans.size() == 1 && expected.plans[0].hypothesis.empty())
    {
      EXPECT_EQ(summaryOf(found), summaryOf(expected)) << relevant_only;
    }
  }
}

void expectSameAnswers(const Reasoner& whole, const Reasoner& progressed, const Mission& mission,
                       std::uint64_t seed)
{
  const oracle::GroundDomain domain = oracle::grounded(mission.description);
  const int first = progressed.firstStep();
  ASSERT_EQ(progressed.currentStep(), whole.currentStep());
  for (int step = first; step <= whole.currentStep(); ++step)
  {
    for (std::size_t f = 0; f < domain.fluents.size(); ++f)
    {
      for (std::size_t value = 0; value < domain.fluents[f].values.size(); ++value)
      {
        const std::string literal = oracle::toString(
            oracle::GroundLiteral{static_cast<int>(f), static_cast<int>(value), true}, domain);
        EXPECT_EQ(progressed.entails(literal, step), whole.entails(literal, step))
            << literal << " at " << step;
        EXPECT_EQ(progressed.possible(literal, step), whole.possible(literal, step))
            << literal << " at " << step;
      }
    }
  }
  EXPECT_TRUE(trajectories(progressed, first) == trajectories(whole, first));
  expectSamePlans(whole, progressed, domain, seed);
}

TEST(Progression, RandomContinuationsMeanWhatTheWholeHistoryMeans)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 30);
  long progressed = 0;
  long priced = 0;
  long refuted = 0;
  for (long seed = first; seed < first + cases && !HasFailure(); ++seed)
  {
    const Mission mission = randomMission(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(mission.text);
    Reasoner whole(mission.description, mission.options);
    whole.setHistory(mission.records);
    const auto lived = livedThrough(mission);
    if (!lived || lived->firstStep() == 0)
    {
      continue;
    }
    ++progressed;
    const Diagnosis expected = whole.diagnose();
    const Diagnosis found = lived->diagnose();
    ASSERT_EQ(found.consistent, expected.consistent);
    ASSERT_EQ(found.cost, expected.cost);
    if (!expected.consistent)
    {
      ++refuted;
      continue;
    }
    priced += expected.cost > 0 ? 1 : 0;
    EXPECT_EQ(explanationsOf(found), explanationsOf(expected));
    expectSameAnswers(whole, *lived, mission, static_cast<std::uint64_t>(seed));
  }
  std::cout << cases << " random cases, " << progressed << " progressed, " << priced
            << " of them with a price, " << refuted << " inconsistent\n";
  EXPECT_GT(progressed, cases / 3);
}

}  // namespace
}  // namespace kr3::reasoner
