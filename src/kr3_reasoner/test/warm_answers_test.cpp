#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

struct Story
{
  const char* name;
  std::string domain;
  std::string history;
  std::string goal;
};

std::vector<Story> stories()
{
  const std::string office = std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3";
  const std::string lamps = std::string(KR3_TEST_DIR) + "/data/lamps.kr3";
  return {{"surprises", office,
           "init(loc(rob1) = office, true). init(in_hand(rob1, tb1), false). "
           "hpd(move(rob1, main_library), 0). obs(loc(tb1) = main_library, false, 1). "
           "hpd(move(rob1, aux_library), 1). obs(loc(tb1) = aux_library, true, 2). "
           "attempt(grasp(rob1, tb1), 2). obs(in_hand(rob1, tb1), false, 3).",
           "in_hand(rob1, tb1)"},
          {"moved", office,
           "init(loc(rob1) = office, true). init(in_hand(rob1, mug1), false). "
           "obs(loc(mug1) = office, true, 0). hpd(move(rob1, kitchen), 0). "
           "hpd(move(rob1, office), 1). obs(loc(mug1) = office, false, 2).",
           "loc(rob1) = kitchen"},
          {"defined fluents", lamps,
           "init(on(left), true). init(on(right), false). hpd(flip(right), 0). "
           "obs(lit(green), false, 1). hpd(repair(green), 1). hpd(roll(d), 2). "
           "obs(shows(d) = 1, false, 3).",
           "on(left) and not on(right)"}};
}

std::string literals(const std::vector<Literal>& entailed)
{
  std::set<std::string> sorted;
  for (const Literal& literal : entailed)
  {
    sorted.insert(toString(literal));
  }
  std::string text;
  for (const std::string& literal : sorted)
  {
    text += literal + "; ";
  }
  return text;
}

/// Everything that can be asked about a history, as text.
std::string answers(const Reasoner& reasoner, const std::string& goal)
{
  std::string text;
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    text += "\nstep " + std::to_string(step) + ": " + literals(reasoner.entailedAt(step));
  }
  const Diagnosis diagnosis = reasoner.diagnose();
  text += "\ncost " + std::to_string(diagnosis.cost);
  for (const auto& explanation : diagnosis.explanations)
  {
    text += "\n  because";
    for (const std::string& statement : explanation)
    {
      text += " " + statement + ";";
    }
  }
  std::set<std::string> plans;
  PlanOptions options;
  options.max_horizon = 5;
  for (const Plan& plan : reasoner.plan(goal, options).plans)
  {
    std::string line = std::to_string(plan.steps.size()) + " steps if";
    for (const std::string& literal : plan.hypothesis)
    {
      line += " " + literal;
    }
    plans.insert(line);
  }
  for (const std::string& plan : plans)
  {
    text += "\n" + plan;
  }
  return text;
}

class WarmAnswers : public testing::TestWithParam<std::size_t>
{
protected:
  const Story story_ = stories()[GetParam()];
};

TEST_P(WarmAnswers, AreTheSameForAHistoryRecordByRecordAndAtOnce)
{
  Reasoner warm(readDescription(story_.domain));
  const std::vector<Record> records = parseHistory(story_.history, "history", warm.description());
  std::vector<Record> known;
  for (const Record& record : records)
  {
    warm.addRecords({record});
    known.push_back(record);
    Reasoner cold(readDescription(story_.domain));
    cold.setHistory(known);
    EXPECT_EQ(answers(warm, story_.goal), answers(cold, story_.goal)) << toString(record);
  }
}

TEST_P(WarmAnswers, AreTheSameAfterAHistoryIsReplacedAndComesBack)
{
  Reasoner reasoner(readDescription(story_.domain));
  const std::vector<Record> records =
      parseHistory(story_.history, "history", reasoner.description());
  reasoner.setHistory(records);
  const std::string before = answers(reasoner, story_.goal);
  reasoner.setHistory({records.front()});
  EXPECT_NE(answers(reasoner, story_.goal), before);
  reasoner.setHistory(records);
  EXPECT_EQ(answers(reasoner, story_.goal), before);
}

INSTANTIATE_TEST_SUITE_P(Stories, WarmAnswers, testing::Values(0, 1, 2));

}  // namespace
}  // namespace kr3::reasoner
