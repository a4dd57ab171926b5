#include <algorithm>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

/// Rooms and books; the robot's hand is known to be empty.
Reasoner library(int num_rooms, int num_books, const std::string& more)
{
  std::string rooms;
  std::string books;
  std::string history = "init(loc(rob1) = r3, true). ";
  for (int i = 0; i < num_rooms; ++i)
  {
    rooms += (i == 0 ? "r" : ", r") + std::to_string(i);
  }
  for (int i = 0; i < num_books; ++i)
  {
    books += (i == 0 ? "b" : ", b") + std::to_string(i);
    history += "init(in_hand(rob1, b" + std::to_string(i) + "), false). ";
  }
  const std::string text = readText(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3");
  const std::size_t fluents = text.find("\nfluents");
  const std::size_t defaults = text.find("\ndefaults");
  Reasoner reasoner(parseDescription("sorts\n place = {" + rooms +
                                         "}.\n robot = {rob1}.\n textbook = {" + books +
                                         "}.\n object = textbook.\n thing = robot + object.\n" +
                                         text.substr(fluents, defaults - fluents) +
                                         "\ndefaults\n d1(X): loc(X) = r0 if textbook(X).\n"
                                         " d2(X): loc(X) = r1 if textbook(X), loc(X) != r0.\n",
                                     "library"));
  reasoner.setHistory(parseHistory(history + more, "history", reasoner.description()));
  return reasoner;
}

const char* const kGoal = "loc(b1) = r2 and not in_hand(rob1, b1)";

std::vector<std::string> names(const std::vector<RelevantItem>& items)
{
  std::vector<std::string> names;
  for (const RelevantItem& item : items)
  {
    names.push_back(item.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Relevance, OtherBooksDoNotMatterToAFetchPlan)
{
  const Reasoner reasoner = library(30, 20, "init(loc(b7) = r5, true).");
  const RelevantPart part = reasoner.relevant(kGoal);
  EXPECT_EQ(names(part.fluents),
            (std::vector<std::string>{"in_hand(rob1, b1)", "loc(b1)", "loc(rob1)"}));
  EXPECT_EQ(names(part.actions),
            (std::vector<std::string>{"grasp(rob1, b1)", "move(rob1, _)", "putdown(rob1, b1)"}));
  EXPECT_EQ(part.records.size(), 2U);
  EXPECT_LT(part.considered.constants, 15U);
  EXPECT_EQ(part.whole.constants, 51U);
  for (const RelevantItem& item : part.fluents)
  {
    ASSERT_FALSE(item.why.empty());
    EXPECT_NE(item.why.front().find("the goal mentions it"), std::string::npos);
    EXPECT_EQ(item.why.back().substr(0, item.name.size()), item.name);
  }
}

TEST(Relevance, ABookInTheHandMatters)
{
  const Reasoner reasoner = library(6, 4, "hpd(move(rob1, r0), 0). hpd(grasp(rob1, b2), 1). ");
  const auto fluents = names(reasoner.relevant(kGoal).fluents);
  EXPECT_TRUE(std::binary_search(fluents.begin(), fluents.end(), "in_hand(rob1, b2)"));
  const PlanResult result = reasoner.plan(kGoal);
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(result.plans[0].steps.size(), 4U);  // puts b2 down first; b1 is here
}

TEST(Relevance, TheSizeOfWhatIsPlannedWithDoesNotGrow)
{
  const PlanResult small = library(12, 10, "").plan(kGoal);
  const PlanResult large = library(60, 200, "").plan(kGoal);
  ASSERT_EQ(small.plans.size(), 1U);
  ASSERT_EQ(large.plans.size(), 1U);
  EXPECT_EQ(small.plans[0].steps, large.plans[0].steps);
  EXPECT_EQ(large.considered.fluents, 3U);
  EXPECT_LE(large.considered.constants, small.considered.constants);
}

TEST(Relevance, AllIsPlannedWithWhenAskedFor)
{
  const Reasoner reasoner = library(6, 5, "");
  PlanOptions options;
  options.relevant_only = false;
  const PlanResult all = reasoner.plan(kGoal, options);
  EXPECT_EQ(all.considered.fluents, all.whole.fluents);
  options.relevant_only = true;
  options.extra_share = 0.4;
  const PlanResult more = reasoner.plan(kGoal, options);
  EXPECT_GT(more.considered.fluents, 3U);
  EXPECT_LT(more.considered.fluents, all.whole.fluents);
  ASSERT_EQ(all.plans.size(), 1U);
  ASSERT_EQ(more.plans.size(), 1U);
  EXPECT_EQ(all.plans[0].steps.size(), more.plans[0].steps.size());
}

// Every room may hold the book: there is a plan for each, though nothing tells the rooms apart.
TEST(Relevance, WidensToEveryRoomThatMayHoldTheBook)
{
  const Reasoner reasoner = library(
      20, 3,
      "obs(loc(b1) = r0, false, 0). obs(loc(b1) = r1, false, 0). obs(loc(b1) = r2, false, 0).");
  const PlanResult result = reasoner.plan(kGoal);
  EXPECT_EQ(result.widened, 1);
  EXPECT_EQ(result.plans.size(), 17U);
}

TEST(Relevance, NoticesAnInconsistencyElsewhere)
{
  const Reasoner reasoner = library(6, 4, "init(loc(b3) = r4, true). init(loc(b3) = r5, true).");
  const PlanResult result = reasoner.plan(kGoal);
  EXPECT_TRUE(result.plans.empty());
  EXPECT_NE(result.reason.find("inconsistent"), std::string::npos);
  EXPECT_NE(result.reason.find("b3"), std::string::npos);
}

// Such an action touches no fluent at all.
TEST(Relevance, NoticesARecordedActionThatIsNeverPossible)
{
  Reasoner reasoner(parseDescription(R"(
sorts
  lamp = {red, green}.
statics
  wired(lamp).
facts
  wired(red).
fluents
  inertial on(lamp).
actions
  press(lamp).
  look(lamp).
axioms
  press(L) causes on(L).
  impossible look(L) if -wired(L).
)",
                                     "lamps"));
  reasoner.setHistory(parseHistory("init(on(red), false). hpd(look(green), 0).", "history",
                                   reasoner.description()));
  EXPECT_NE(reasoner.plan("on(red)").reason.find("inconsistent"), std::string::npos);
}

TEST(Relevance, ASurpriseElsewhereChangesNothing)
{
  const Reasoner reasoner = library(6, 4, "hpd(move(rob1, r0), 0). obs(loc(b3) = r0, false, 1).");
  const PlanResult result = reasoner.plan(kGoal);
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_TRUE(result.plans[0].hypothesis.empty());
  EXPECT_EQ(result.plans[0].steps.front(), (std::vector<std::string>{"grasp(rob1, b1)"}));
}

}  // namespace
}  // namespace kr3::reasoner
