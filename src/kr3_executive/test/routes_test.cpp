// Ways round an action, on a ring of rooms with a chord.

#include "kr3_executive/routes.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_reasoner/language.hpp>

namespace kr3::executive
{
namespace
{

using Way = std::vector<std::vector<std::string>>;

const char kFloor[] = R"(
sorts
  place = {hall, east, west, attic, cellar}.
  robot = {rob1}.
  thing = {book, lamp}.
statics
  door(place, place).
facts
  door(hall, attic).
  door(hall, east).
  door(hall, west).
  door(east, attic).
  door(west, attic).
  door(attic, cellar).
fluents
  inertial loc(robot) : place.
  inertial holds(robot, thing).
  inertial lit(place).
actions
  move(robot, place).
  take(robot, thing).
  light(robot, place).
axioms
  move(R, P) causes loc(R) = P.
  take(R, T) causes holds(R, T).
  light(R, P) causes lit(P).
  impossible move(R, P) if loc(R) = P1, -door(P1, P).
  impossible take(R, T) if holds(R, T).
)";

const Forbidden kNothing = [](const FluentValues&, const std::string&) { return false; };

class Routes : public testing::Test
{
protected:
  Routes() : laws_(reasoner::parseDescription(kFloor, "floor.kr3")) {}

  std::vector<Way> from(const std::string& place, const std::string& action,
                        const Forbidden& forbidden = kNothing, std::size_t most = 10)
  {
    return detours(laws_, {{"loc(rob1)", place}}, action, forbidden, most);
  }

  RuleInterpreter laws_;
};

TEST_F(Routes, AllTheShortestWaysRoundAreFound)
{
  EXPECT_EQ(from("hall", "move(rob1, attic)"),
            (std::vector<Way>{{{"move(rob1, east)"}, {"move(rob1, attic)"}},
                              {{"move(rob1, west)"}, {"move(rob1, attic)"}}}));
}

TEST_F(Routes, NoMoreThanAskedFor)
{
  EXPECT_EQ(from("hall", "move(rob1, attic)", kNothing, 1).size(), 1U);
  EXPECT_TRUE(from("hall", "move(rob1, attic)", kNothing, 0).empty());
}

TEST_F(Routes, WhatIsForbiddenWhereItBeginsIsLeftOut)
{
  const Forbidden no_way_up = [](const FluentValues& state, const std::string& action) {
    return action == "move(rob1, attic)" && state.at("loc(rob1)") == "east";
  };
  EXPECT_EQ(from("hall", "move(rob1, attic)", no_way_up),
            (std::vector<Way>{{{"move(rob1, west)"}, {"move(rob1, attic)"}}}));
}

TEST_F(Routes, AnActionWithoutAnotherWayHasNone)
{
  EXPECT_TRUE(from("attic", "move(rob1, cellar)").empty());
  EXPECT_TRUE(from("hall", "take(rob1, book)").empty());
}

TEST_F(Routes, AnActionThatIsImpossibleHasNone)
{
  EXPECT_TRUE(from("hall", "move(rob1, cellar)").empty());
}

TEST_F(Routes, NothingElseChangesOnTheWay)
{
  const FluentValues start{{"loc(rob1)", "hall"}, {"holds(rob1, lamp)", "true"}};
  for (const auto& way : detours(laws_, start, "move(rob1, attic)", kNothing, 10))
  {
    for (const auto& step : way)
      EXPECT_EQ(step.front().substr(0, 5), "move(");
  }
}

TEST_F(Routes, ASituationIsWhatTheActionIsAbout)
{
  const FluentValues state{{"loc(rob1)", "hall"},
                           {"holds(rob1, book)", "true"},
                           {"holds(rob1, lamp)", "false"},
                           {"lit(attic)", "true"}};
  EXPECT_EQ(situationOf(state, "move(rob1, attic)"), "lit(attic) = true, loc(rob1) = hall");
  EXPECT_EQ(situationOf(state, "take(rob1, lamp)"), "loc(rob1) = hall");
  EXPECT_EQ(situationOf(state, "take(rob1, book)"), "holds(rob1, book) = true, loc(rob1) = hall");
}

}  // namespace
}  // namespace kr3::executive
