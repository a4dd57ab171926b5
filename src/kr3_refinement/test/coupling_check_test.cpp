#include "kr3_refinement/coupling_check.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::composed;
using test::expectError;

const std::string kDelivery = R"(
sorts
  place = {hall, shop, yard}.
  robot = {carrier}.
  parcel = {p1, p2}.
  thing = robot + parcel.
fluents
  inertial at(thing) : place.
  inertial holds(robot, parcel).
actions
  go(robot, place).
  take(robot, parcel).
axioms
  go(R, P) causes at(R) = P.
  take(R, O) causes holds(R, O).
  at(O) = P if at(R) = P, holds(R, O).
  impossible go(R, P) if at(R) = P.
  impossible take(R, O) if at(R) = P, at(O) = P2, P != P2.
  impossible take(R, O) if holds(R, O2).
)";

const std::string kSteps = R"(
magnify place into spot by in_place.
statics
  beside(spot, spot).
  trap(spot).
axioms
  go(R, S) causes at(R) = S [there] or at(R) = {Z : beside(Z, S)} [slipped].
)";

/// @param facts  of the map, over its spots
ComponentMap spots(std::size_t per_place, const std::vector<std::string>& facts = {})
{
  const ComponentMap grid = gridMap({"hall", "shop", "yard"}, per_place, 1.0);
  ComponentMapData data;
  data.components = grid.components();
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    data.neighbors.push_back(grid.neighbors(i));
    for (std::size_t j = 0; j < grid.size(); ++j)
    {
      data.distances_m.push_back(grid.distance(i, j));
    }
  }
  data.facts = facts;
  return ComponentMap(data);
}

CouplingReport checked(const std::string& refinement, const ComponentMap& map = spots(4),
                       const CouplingCheckOptions& options = {})
{
  return checkCoupling(composed(kDelivery, refinement, map), options);
}

TEST(CouplingCheck, DomainsThatShipPass)
{
  for (const CouplingReport& report :
       {checkCoupling(test::office().low_level), checkCoupling(test::workbench().low_level)})
  {
    EXPECT_TRUE(report.passed()) << toString(report);
    EXPECT_GT(report.num_transitions, 0U);
    EXPECT_GT(report.num_low_level_states, report.num_transitions);
    EXPECT_TRUE(report.never_executable.empty());
  }
}

TEST(CouplingCheck, PassesWhereEveryTransitionHasAPath)
{
  const CouplingReport report = checked(kSteps);
  EXPECT_TRUE(report.passed()) << toString(report);
  EXPECT_EQ(report.num_ground_actions, 5U);
  EXPECT_EQ(report.num_checked_actions, 2U);
  EXPECT_EQ(report.changes.at("go"), (std::set<std::string>{"at"}));
  EXPECT_EQ(report.changes.at("take"), (std::set<std::string>{"holds"}));
}

TEST(CouplingCheck, ShowsAStateFromWhichTheLowLevelCannotFollow)
{
  // Only steps to the next spot, and no spot of one place is beside one of another.
  ComponentMapData data;
  for (const std::string place : {"hall", "shop", "yard"})
  {
    for (const std::string end : {"_0", "_1"})
    {
      data.components.push_back({place + end, place});
    }
  }
  data.neighbors = {{1}, {0}, {3}, {2}, {5}, {4}};
  data.distances_m.assign(36, 1.0);
  const LowLevelDomain domain =
      composed(kDelivery, kSteps + "  impossible go(R, S) if at(R) = Z, -beside(Z, S).\n",
               ComponentMap(data));
  const CouplingReport report = checkCoupling(domain);
  EXPECT_FALSE(report.passed());
  ASSERT_FALSE(report.counterexamples.empty());
  const CouplingCounterexample& example = report.counterexamples.front();
  EXPECT_EQ(example.action.substr(0, 3), "go(");
  EXPECT_EQ(example.num_failing, example.num_compatible);
  ASSERT_EQ(example.reachable.size(), 1U);  // it never leaves its place
  EXPECT_EQ(example.reachable.front(), example.before);
  const std::string text = toString(report);
  EXPECT_NE(text.find("do not fit"), std::string::npos);
  EXPECT_NE(text.find(example.low_level_state.front()), std::string::npos);
}

TEST(CouplingCheck, FindsTheOneStateThatFails)
{
  // Nothing leads away from hall_c3, but the other spots of the hall are fine.
  const CouplingReport report = checked(kSteps + "  impossible go(R, S) if at(R) = Z, trap(Z).\n",
                                        spots(4, {"trap(hall_c3)"}));
  EXPECT_FALSE(report.passed());
  for (const CouplingCounterexample& example : report.counterexamples)
  {
    EXPECT_LT(example.num_failing, example.num_compatible);
    EXPECT_NE(std::find(example.low_level_state.begin(), example.low_level_state.end(),
                        "at(carrier) = hall_c3"),
              example.low_level_state.end())
        << toString(report);
  }
}

TEST(CouplingCheck, SaysWhenNoLowLevelStateIsCompatible)
{
  const CouplingReport report =
      checked(kSteps + "  at(R) != Z if trap(Z).\n", spots(1, {"trap(yard_c0)"}));
  ASSERT_FALSE(report.passed());
  const bool none = std::any_of(report.counterexamples.begin(), report.counterexamples.end(),
                                [](const CouplingCounterexample& example) {
    return example.num_compatible == 0 && example.low_level_state.empty();
  });
  EXPECT_TRUE(none) << toString(report);
}

TEST(CouplingCheck, SymmetryLosesNoFailure)
{
  const std::vector<std::string> laws{
      "",
      "  impossible go(R, S) if at(R) = Z, trap(Z).\n",
      "  impossible go(R, S) if trap(S).\n",
      "  impossible take(R, O) if at(R) = S, at(O) = S2, S != S2.\n",
      "  impossible take(R, p2).\n",
      "  impossible take(R, O) if at(R) = S, trap(S).\n  impossible go(R, S) if trap(S).\n",
      "  impossible take(R, O) if at(O) = S, trap(S).\n",
  };
  for (const std::vector<std::string>& traps :
       {std::vector<std::string>{}, {"trap(yard_c0)"}, {"trap(hall_c0)", "trap(hall_c1)"}})
  {
    for (const std::string& law : laws)
    {
      CouplingCheckOptions all;
      all.up_to_symmetry = false;
      const CouplingReport every = checked(kSteps + law, spots(2, traps), all);
      const CouplingReport representatives = checked(kSteps + law, spots(2, traps));
      EXPECT_EQ(every.passed(), representatives.passed()) << law << traps.size();
      EXPECT_LE(representatives.num_checked_actions, every.num_checked_actions);
      EXPECT_EQ(every.num_checked_actions, every.num_ground_actions);
    }
  }
}

TEST(CouplingCheck, DirectPathsStayWithinTheTwoStates)
{
  // What is sold must be on the scale then, and the high level sees whether it is.
  const std::string high_level = R"(
sorts
  tray = {left, right}.
  item = {a}.
fluents
  inertial weighed(item).
  inertial sold(item).
  inertial on(item) : tray.
actions
  weigh(item).
  unweigh(item).
  sell(item).
axioms
  weigh(X) causes weighed(X).
  unweigh(X) causes -weighed(X).
  sell(X) causes sold(X).
  impossible sell(X) if sold(X).
)";
  const std::string refinement = R"(
magnify tray into slot by of_tray.
axioms
  impossible sell(X) if -weighed(X).
)";
  const LowLevelDomain domain =
      composed(high_level, refinement, gridMap({"left", "right"}, 1, 1.0));
  EXPECT_TRUE(checkCoupling(domain).passed());
  CouplingCheckOptions options;
  options.direct = true;
  const CouplingReport report = checkCoupling(domain, options);
  ASSERT_EQ(report.num_failures, 1U) << toString(report);
  EXPECT_EQ(report.counterexamples.front().action, "sell(a)");
  options.action = "weigh";
  EXPECT_TRUE(checkCoupling(domain, options).passed());
}

TEST(CouplingCheck, RefusesWhatItCannotCheck)
{
  CouplingCheckOptions options;
  options.action = "fly";
  expectError(ErrorCode::kInvalidArgument, "'fly' is no agent action",
              [&] { (void)checked(kSteps, spots(4), options); });
  options.action.clear();
  options.max_states = 3;
  expectError(ErrorCode::kResourceExhausted, "more than 3",
              [&] { (void)checked(kSteps, spots(4), options); });
}

TEST(CouplingCheck, LetsTheLowLevelHaveFluentsOfItsOwn)
{
  const std::string high_level = test::textOf(test::domainFile("waterworks", "domain.kr3"));
  std::string refinement = test::textOf(test::domainFile("waterworks", "refinement.kr3"));
  const ComponentMap map = readComponentMap(test::domainFile("waterworks", "map.yaml"));
  CouplingCheckOptions options;
  options.direct = true;
  const CouplingReport report = checkCoupling(composed(high_level, refinement, map), options);
  EXPECT_TRUE(report.passed()) << toString(report);
  EXPECT_EQ(report.changes.at("shut"), std::set<std::string>{"shut_off"});

  // Mending under water impossible, and shutting it off useless: no path from where it runs.
  const auto exchange = [&](const std::string& from, const std::string& to) {
    const std::size_t at = refinement.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    refinement.replace(at, from.size(), to);
  };
  exchange("if -shut_off(J)", "if -shut_off(J), shut_off(J)");
  exchange("impossible shut(C, J) if shut_off(J)", "impossible shut(C, J) if -shut_off(J)");
  options.action = "mend";
  const CouplingReport broken = checkCoupling(composed(high_level, refinement, map), options);
  ASSERT_FALSE(broken.passed());
  const std::vector<std::string>& state = broken.counterexamples.front().low_level_state;
  EXPECT_TRUE(std::any_of(state.begin(), state.end(), [](const std::string& literal) {
    return literal.rfind("-shut_off", 0) == 0;
  }));
}

}  // namespace
}  // namespace kr3::refinement
