// A history that is summed up entails what it entailed.

#include "kr3_executive/history_summary.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_executive/in_process.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

Record observed(const std::string& literal, bool value, int step, double confidence = 0.95)
{
  return {RecordKind::kObserved, literal, value, step, confidence};
}

Record happened(const std::string& action, int step)
{
  return {RecordKind::kHappened, action, true, step};
}

const auto kSure = [](const std::string&) { return 0.9; };

class HistorySummary : public testing::Test
{
protected:
  HistorySummary()
    : description_(reasoner::readDescription(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3"))
    , reasoner_(description_, {}, {{}, 0})
  {
  }

  /// The book is looked for in vain, found, carried and put down; then the robot goes about.
  static std::vector<Record> errand()
  {
    return {{RecordKind::kInitially, "loc(rob1) = office", true, 0},
            {RecordKind::kInitially, "in_hand(rob1, tb1)", false, 0},
            happened("move(rob1, main_library)", 0),
            observed("loc(tb1) = main_library", false, 1),
            observed("loc(tb2) = main_library", false, 1),
            happened("move(rob1, aux_library)", 1),
            happened("grasp(rob1, tb1)", 2),
            observed("in_hand(rob1, tb1)", true, 3),
            happened("move(rob1, kitchen)", 3),
            happened("putdown(rob1, tb1)", 4),
            observed("in_hand(rob1, tb1)", false, 5),
            happened("move(rob1, corridor)", 5),
            happened("move(rob1, office)", 6)};
  }

  std::vector<std::string> entailed(int step)
  {
    auto literals = reasoner_.entailedAt(step);
    std::sort(literals.begin(), literals.end());
    return literals;
  }

  reasoner::Description description_;
  InProcessReasoner reasoner_;
};

TEST_F(HistorySummary, EntailsTheSameThenAndNow)
{
  const auto history = errand();
  for (const int first : {5, 6, 7})
  {
    reasoner_.setHistory(history);
    const auto then_known = entailed(first);
    const auto now_known = entailed(7);
    const auto shorter = summarised(history, first, reasoner_, kSure);
    ASSERT_TRUE(shorter.has_value()) << first;
    EXPECT_EQ(entailed(0), then_known) << first;
    EXPECT_EQ(entailed(7 - first), now_known) << first;
    EXPECT_EQ(currentStep(*shorter), 7 - first);
  }
}

TEST_F(HistorySummary, KeepsWhereAThingIsNotWhileNobodyKnowsWhereItIs)
{
  reasoner_.setHistory(errand());
  const auto shorter = summarised(errand(), 6, reasoner_, kSure);
  ASSERT_TRUE(shorter.has_value());
  const auto kept = std::count_if(shorter->begin(), shorter->end(), [](const Record& record) {
    return record.statement == "loc(tb2) = main_library" && !record.value;
  });
  EXPECT_EQ(kept, 1);
  EXPECT_EQ(reasoner_.entails("loc(tb2) = aux_library", 1), reasoner::Answer::kTrue);
  EXPECT_EQ(reasoner_.entails("loc(tb1) = kitchen", 1), reasoner::Answer::kTrue);
}

TEST_F(HistorySummary, CarriesConfidencesOfWhatWasObserved)
{
  reasoner_.setHistory(errand());
  const auto shorter = summarised(errand(), 6, reasoner_, [](const std::string&) { return 0.75; });
  ASSERT_TRUE(shorter.has_value());
  const auto found = std::find_if(shorter->begin(), shorter->end(), [](const Record& record) {
    return record.statement == "in_hand(rob1, tb1)";
  });
  ASSERT_NE(found, shorter->end());
  EXPECT_FALSE(found->value);
  EXPECT_EQ(found->confidence, 0.75);
  EXPECT_EQ(found->source, kSummarySource);
}

TEST_F(HistorySummary, OfAnyWanderingIsBoundedAndEntailsTheSame)
{
  const std::vector<std::string> places{"office", "main_library", "aux_library", "kitchen"};
  std::mt19937_64 random(7);
  int summed_up = 0;
  for (int run = 0; run < 4; ++run)
  {
    std::vector<Record> history{{RecordKind::kInitially, "loc(rob1) = office", true, 0}};
    std::string at = "office";
    const int steps = 24;
    for (int step = 0; step < steps; ++step)
    {
      const std::string to = places[random() % places.size()];
      if (to == at)
        continue;
      history.push_back(happened("move(rob1, " + to + ")", step));
      at = to;
      const std::string thing = "tb" + std::to_string(1 + random() % 3);
      const Record look = observed("loc(" + thing + ") = " + to, false, step + 1);
      reasoner_.setHistory(history);
      if (reasoner_.possible("loc(" + thing + ") != " + to, currentStep(history)))
        history.push_back(look);
    }
    reasoner_.setHistory(history);
    if (!reasoner_.diagnose().consistent)
      continue;
    const int now = currentStep(history);
    const auto now_known = entailed(now);
    const auto shorter = summarised(history, now - 5, reasoner_, kSure);
    if (!shorter)
      continue;
    EXPECT_EQ(entailed(5), now_known) << run;
    EXPECT_LT(shorter->size(), history.size()) << run;
    ++summed_up;
  }
  EXPECT_GT(summed_up, 1);
}

}  // namespace
}  // namespace kr3::executive
