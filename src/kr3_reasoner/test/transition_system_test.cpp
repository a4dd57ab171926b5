#include "kr3_reasoner/transition_system.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

/// "a=x b=y" for the fluents asked for.
std::string valuesOf(const TransitionSystem& system, std::size_t state,
                     const std::set<std::string>& fluents)
{
  std::string text;
  for (std::size_t i = 0; i < system.fluents().size(); ++i)
  {
    const GroundFluent& fluent = system.fluents()[i];
    if (fluents.count(fluent.name) > 0)
    {
      text += (text.empty() ? "" : " ") + fluent.name + "=" +
              fluent.values[static_cast<std::size_t>(system.states()[state][i])];
    }
  }
  return text;
}

std::size_t find(const TransitionSystem& system, const std::string& values,
                 const std::set<std::string>& fluents)
{
  for (std::size_t i = 0; i < system.states().size(); ++i)
  {
    if (valuesOf(system, i, fluents) == values)
    {
      return i;
    }
  }
  ADD_FAILURE() << "no state with " << values;
  return 0;
}

std::size_t action(const TransitionSystem& system, const std::string& name)
{
  const auto found = std::find(system.actions().begin(), system.actions().end(), name);
  EXPECT_NE(found, system.actions().end()) << name;
  return static_cast<std::size_t>(found - system.actions().begin());
}

Description office(const std::set<std::string>& constants)
{
  return restricted(readDescription(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3"),
                    constants);
}

TEST(TransitionSystem, CarriesWhatIsInTheHand)
{
  const TransitionSystem system(office({"rob1", "tb1", "office", "kitchen"}));
  const std::set<std::string> all = {"loc(rob1)", "loc(tb1)", "in_hand(rob1, tb1)"};
  EXPECT_EQ(system.states().size(),
            6U);  // 2 x 2 places, and in the hand only where both are together
  EXPECT_EQ(system.actions().size(), 4U);
  const std::size_t held =
      find(system, "loc(rob1)=office loc(tb1)=office in_hand(rob1, tb1)=true", all);
  const auto& moved = system.successors(held, action(system, "move(rob1, kitchen)"));
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(valuesOf(system, moved[0].state, all),
            "loc(rob1)=kitchen loc(tb1)=kitchen in_hand(rob1, tb1)=true");
  EXPECT_FALSE(system.executable(held, action(system, "move(rob1, office)")));
  EXPECT_TRUE(system.successors(held, action(system, "grasp(rob1, tb1)")).empty());
}

TEST(TransitionSystem, AllowsEmptiedSorts)
{
  const TransitionSystem system(office({"rob1", "tb1"}));
  EXPECT_EQ(system.states().size(), 2U);
  EXPECT_EQ(system.actions().size(), 2U);  // no place to move to
}

TEST(TransitionSystem, TakesEachOutcomeOfANoisyMove)
{
  const Description description = parseDescription(
      "sorts\n robot = {r}.\n cell = {a, b, c}.\n"
      "statics\n neighbor(cell, cell).\n"
      "facts\n neighbor(a, b).\n neighbor(b, a).\n neighbor(b, c).\n neighbor(c, b).\n"
      "fluents\n inertial loc(robot) : cell.\n defined at_end.\n"
      "actions\n move(robot, cell).\n"
      "axioms\n move(R, C) causes loc(R) = C [reached] or loc(R) = {Z : neighbor(Z, C)} "
      "[slipped].\n"
      " at_end if loc(R) = c.\n",
      "f");
  const TransitionSystem system(description);
  ASSERT_EQ(system.states().size(), 3U);
  const std::size_t start = find(system, "loc(r)=a at_end=false", {"loc(r)", "at_end"});
  std::set<std::string> outcomes;
  for (const auto& successor : system.successors(start, action(system, "move(r, b)")))
  {
    outcomes.insert(successor.outcomes.at("move(r, b)") + " " +
                    valuesOf(system, successor.state, {"loc(r)", "at_end"}));
  }
  EXPECT_EQ(outcomes,
            (std::set<std::string>{"reached loc(r)=b at_end=false", "slipped loc(r)=a at_end=false",
                                   "slipped loc(r)=c at_end=true"}));
}

TEST(TransitionSystem, LeavesOutAnOutcomeWhoseSetIsEmpty)
{
  const Description description = parseDescription(
      "sorts\n robot = {r}.\n cell = {a, b}.\n"
      "statics\n neighbor(cell, cell).\n"
      "fluents\n inertial loc(robot) : cell.\n"
      "actions\n move(robot, cell).\n"
      "axioms\n move(R, C) causes loc(R) = C [reached] or loc(R) = {Z : neighbor(Z, C)} "
      "[slipped].\n",
      "f");
  const TransitionSystem system(description);
  const auto& successors = system.successors(0, action(system, "move(r, b)"));
  ASSERT_EQ(successors.size(), 1U);
  EXPECT_EQ(successors[0].outcomes.at("move(r, b)"), "reached");
}

TEST(TransitionSystem, HasConditionalEffectsAndLabels)
{
  const TransitionSystem system(readDescription(std::string(KR3_TEST_DIR) + "/data/lamps.kr3"));
  EXPECT_EQ(system.states().size(), 48U);  // 2 switches, 2 lamps, 3 faces
  const std::set<std::string> shown = {"on(left)", "broken(red)", "lit(red)"};
  const std::size_t broken = find(system, "on(left)=true broken(red)=true lit(red)=false", shown);
  const auto& repaired = system.successors(broken, action(system, "repair(red)"));
  ASSERT_EQ(repaired.size(), 2U);
  for (const auto& successor : repaired)
  {
    EXPECT_EQ(valuesOf(system, successor.state, shown),
              successor.outcomes.at("repair(red)") == "failed"
                  ? "on(left)=true broken(red)=true lit(red)=false"
                  : "on(left)=true broken(red)=false lit(red)=true");
  }
  EXPECT_EQ(system.successors(broken, action(system, "roll(d)")).size(), 2U);
}

TEST(TransitionSystem, RefusesTooManyStates)
{
  EXPECT_NE(errorOf([] {
              const TransitionSystem system(office({"rob1", "tb1", "office", "kitchen"}), 5);
            }).find("more than 5 states"),
            std::string::npos);
}

TEST(Executability, ListsTheGroundBodies)
{
  const Description description = office({"rob1", "tb1", "office", "kitchen"});
  std::set<std::string> bodies;
  for (const auto& body :
       executabilityBodies(description, parseGroundAction("grasp(rob1, tb1)", description)))
  {
    std::string text;
    for (const Literal& literal : body)
    {
      text += toString(literal) + ";";
    }
    bodies.insert(text);
  }
  EXPECT_EQ(bodies, (std::set<std::string>{"loc(rob1) = office;loc(tb1) = kitchen;",
                                           "loc(rob1) = kitchen;loc(tb1) = office;",
                                           "in_hand(rob1, tb1);"}));
}

}  // namespace
}  // namespace kr3::reasoner
