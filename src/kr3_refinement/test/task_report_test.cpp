#include "kr3_refinement/task_report.hpp"

#include <algorithm>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using Names = std::vector<std::string>;
using test::Domain;

const Names kInLibrary{"loc(rob1) = main_library", "loc(tb1) = main_library"};

/// A lamp with some actions of its own; peeking tells whether it is broken.
struct LampText
{
  std::string actions;
  std::string axioms;
  std::string observations;
  std::string models;
};

Domain lamp(const LampText& text)
{
  LowLevelDomain low_level = test::composed(R"(
sorts
  corner = {north, south}.
  lamp = {tall}.
fluents
  inertial at(lamp) : corner.
  inertial lit(lamp).
  inertial broken(lamp).
actions
  light(lamp).
)" + text.actions + R"(
axioms
  light(L) causes lit(L).
  impossible light(L) if broken(L).
)" + text.axioms,
                                            "magnify corner into tile by tile_of.\nactions\n"
                                            "  peek(lamp).\nobservations\n"
                                            "  peek(L) observes broken(L).\n" +
                                                text.observations,
                                            gridMap({"north", "south"}, 2, 1.0));
  Models models = parseModels(R"(
actions:
  peek(L):
    observations: {broken: exact}
    cost: {base_s: 1.0, impossible_s: 2.0}
)" + text.models,
                              "models.yaml", low_level.description());
  return {std::move(low_level), std::move(models)};
}

const std::string kPlainLight = "  light(L): {cost: {base_s: 1.0, impossible_s: 2.0}}\n";

TEST(Validate, FindsNothingWrongWithAnOrdinaryTask)
{
  const TaskReport report = validate(test::office().task(
      "grasp(rob1, tb1)", kInLibrary,
      {{{"loc(rob1)", {{"main_library_c0", 1.0}}}}, {{"loc(tb1)", {{"main_library", 0.8}}}}}));
  EXPECT_TRUE(report.usable()) << report.text();
  EXPECT_EQ(report.num_states, 24U);
  EXPECT_EQ(report.num_reachable, 24U);
  EXPECT_TRUE(report.unreachable_states.empty());
  EXPECT_TRUE(report.impossible_actions.empty());
  EXPECT_EQ(report.impossible_observations, Names{"outside"});  // no cell beside leads out
  EXPECT_TRUE(report.misleading_observations.empty());
}

TEST(Validate, NamesStatesThatNeverComeAbout)
{
  // No action moves the cause, and nothing is said to be elsewhere.
  const TaskReport report = validate(
      test::workbench().task("replace(tech1, psu, hum)", {"opened(psu)", "cause(hum) = psu"},
                             {{{"cause(hum)", {{"rectifier", 1.0}}}}, {}}));
  EXPECT_EQ(report.num_states, 3U * 8U * 2U);
  EXPECT_EQ(report.num_reachable, 1U * 8U * 2U);
  EXPECT_EQ(report.unreachable_states.size(), 32U);
  EXPECT_TRUE(std::all_of(report.unreachable_states.begin(), report.unreachable_states.end(),
                          [](const std::string& name) {
    return name.find("cause(hum)=rectifier") == std::string::npos;
  }));
  EXPECT_NE(report.text(2).find("and 30 more"), std::string::npos) << report.text(2);
}

// Nothing ever breaks the lamp, so there is nothing to mend, and peeking never shows it broken.
TEST(Validate, NamesActionsThatAreNeverPossibleAndObservationsThatAreNeverMade)
{
  const Domain domain = lamp(
      {"  mend(lamp).\n", "  mend(L) causes -broken(L).\n  impossible mend(L) if -broken(L).\n", "",
       kPlainLight + "  mend(L): {cost: {base_s: 1.0, impossible_s: 2.0}}\n"});
  const TaskReport report = validate(domain.task("light(tall)", {}, {}));
  EXPECT_TRUE(report.usable());
  EXPECT_EQ(report.impossible_actions, Names{"mend(tall)"});
  EXPECT_EQ(report.impossible_observations, Names{"true"});
  EXPECT_EQ(report.unreachable_states,
            (Names{"lit(tall)=false,broken(tall)=true", "lit(tall)=true,broken(tall)=true"}));
  // Where it may be broken, all of that can be; but a broken lamp is not lit.
  const TaskReport broken = validate(
      domain.task("light(tall)", {}, {{{"broken(tall)", {{"true", 0.5}, {"false", 0.5}}}}, {}}));
  EXPECT_TRUE(broken.impossible_actions.empty());
  EXPECT_TRUE(broken.impossible_observations.empty());
  EXPECT_EQ(broken.unreachable_states, Names{"lit(tall)=true,broken(tall)=true"});
}

TEST(Validate, SaysThatNothingLeadsToTheEffects)
{
  const TaskReport report =
      validate(lamp({"", "", "", kPlainLight})
                   .task("light(tall)", {}, {{{"broken(tall)", {{"true", 1.0}}}}, {}}));
  EXPECT_TRUE(report.unachievable);
  EXPECT_FALSE(report.usable());
  EXPECT_EQ(report.impossible_actions, Names{"light(tall)"});
  EXPECT_NE(report.text().find("can only give up"), std::string::npos);
}

// Lighting a lamp that is lit is impossible, but leads where lighting another leads: what it tells
// of the lamp then is what lighting tells.
TEST(Validate, NamesObservationsThatCannotTellWhetherTheActionWasPossible)
{
  const Domain domain =
      lamp({"", "  impossible light(L) if lit(L).\n", "  light(L) observes broken(L).\n",
            "  light(L):\n    observations: {broken: exact}\n"
            "    cost: {base_s: 1.0, impossible_s: 2.0}\n"});
  const TaskReport report = validate(domain.task("light(tall)", {}, {}));
  EXPECT_TRUE(report.usable());
  EXPECT_EQ(report.misleading_observations,
            Names{"light(tall) in lit(tall)=true,broken(tall)=false"});
}

TEST(RowProblem, SaysWhatIsWrongWithARow)
{
  const auto problem = [](const std::vector<pomdp::SparseEntry>& row) {
    return rowProblem({row.data(), row.data() + row.size()});
  };
  EXPECT_EQ(problem({{0, 0.25}, {3, 0.75}}), "");
  EXPECT_EQ(problem({{0, 0.25}, {3, 0.73}}), "0.98 in all");
  EXPECT_EQ(problem({{0, -0.25}, {3, 1.25}}), "-0.25 among them");
  EXPECT_EQ(problem({}), "0 in all");
}

}  // namespace
}  // namespace kr3::refinement
