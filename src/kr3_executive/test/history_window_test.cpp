// Long histories: the reasoner keeps a window of them, and answers as if it had the whole.

#include "kr3_executive/history_window.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/language.hpp>

#include "kr3_executive/in_process.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

/// The robot goes back and forth; at one step it does not find the book.
std::vector<Record> wandering(int from, int to)
{
  std::vector<Record> records;
  for (int step = from; step < to; ++step)
  {
    if (step == 0)
      records.push_back({RecordKind::kInitially, "loc(rob1) = office", true, 0, 1.0, "scenario"});
    const std::string place = step % 2 == 0 ? "main_library" : "office";
    records.push_back({RecordKind::kHappened, "move(rob1, " + place + ")", true, step, 1.0});
    if (step == 4)
      records.push_back({RecordKind::kObserved, "loc(tb1) = main_library", false, 5, 0.9});
  }
  return records;
}

constexpr int kSteps = 60;

TEST(HistoryWindow, IsDueWhenTheHistoryIsHalfAsLongAgain)
{
  HistoryWindow window(kSteps);
  window.reset(wandering(0, 90));
  EXPECT_FALSE(window.due().has_value());
  window.add(wandering(90, 91));
  ASSERT_TRUE(window.due().has_value());
  EXPECT_EQ(*window.due(), 91 - kSteps);
  window.beginsAt(*window.due());
  EXPECT_FALSE(window.due().has_value());
}

TEST(HistoryWindow, OfNoStepsKeepsAll)
{
  HistoryWindow window(0);
  window.reset(wandering(0, 500));
  EXPECT_FALSE(window.due().has_value());
}

TEST(HistoryWindow, FindsTheRecordsThatAreKept)
{
  HistoryWindow window(kSteps);
  window.reset(wandering(0, 91));
  EXPECT_EQ(window.amongAll({0, 3}), (std::vector<std::size_t>{0, 3}));
  window.beginsAt(31);
  const auto first = window.amongAll({0}).front();
  EXPECT_EQ(window.all()[first].step, 31);
  EXPECT_EQ(window.all()[first - 1].step, 30);
  EXPECT_THROW(static_cast<void>(window.amongAll({500})), InternalError);
}

TEST(HistoryWindow, AnswersAreThoseOfTheWholeHistory)
{
  const auto description =
      reasoner::readDescription(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3");
  const int end = kSteps * 3 / 2 + 4;
  InProcessReasoner windowed(description, {});
  reasoner::Reasoner whole(description);
  windowed.setHistory(wandering(0, end - 4));
  windowed.addRecords(wandering(end - 4, end));
  whole.setHistory(wandering(0, end));
  for (const char* literal : {"loc(tb1) = aux_library", "loc(tb1) = main_library",
                              "loc(rob1) = office", "loc(mug1) = kitchen"})
    EXPECT_EQ(windowed.entails(literal, end), whole.entails(literal, end)) << literal;
  const Record later{RecordKind::kObserved, "loc(tb1) = aux_library", false, end, 0.9};
  windowed.addRecords({later});
  whole.addRecords({later});
  EXPECT_EQ(windowed.entails("loc(tb1) = office", end), whole.entails("loc(tb1) = office", end));
  EXPECT_EQ(windowed.diagnose().cost, whole.diagnose().cost);
}

}  // namespace
}  // namespace kr3::executive
