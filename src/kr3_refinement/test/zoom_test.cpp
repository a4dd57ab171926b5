#include "kr3_refinement/zoom.hpp"

#include <algorithm>
#include <limits>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

std::vector<std::string> names(const Zoom& zoom)
{
  std::vector<std::string> result;
  for (const RelevantConstant& constant : zoom.relevant)
  {
    result.push_back(constant.name);
    EXPECT_FALSE(constant.reason.empty());
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::string> texts(const std::vector<reasoner::Literal>& literals)
{
  std::vector<std::string> result;
  std::transform(literals.begin(), literals.end(), std::back_inserter(result),
                 [](const reasoner::Literal& literal) { return toString(literal); });
  return result;
}

using Names = std::vector<std::string>;

TEST(Zoom, KeepsWhatTheActionNames)
{
  const Zoom zoom =
      test::office().zoomOn("move(rob1, office)", {"loc(rob1) = kitchen", "loc(tb1) = kitchen"});
  EXPECT_EQ(names(zoom), (Names{"kitchen", "office", "rob1"}));
  EXPECT_EQ(texts(zoom.effects), Names{"loc(rob1) = office"});
  EXPECT_EQ(zoom.constants.size(), 3U + 8U);
}

TEST(Zoom, KeepsWhatTheActionDependsOn)
{
  const Zoom zoom = test::office().zoomOn(
      "grasp(rob1, tb1)",
      {"loc(rob1) = main_library", "loc(tb1) = main_library", "loc(tb2) = office"});
  EXPECT_EQ(names(zoom), (Names{"main_library", "rob1", "tb1"}));
  EXPECT_EQ(texts(zoom.effects), Names{"in_hand(rob1, tb1)"});
}

TEST(Zoom, MayHaveNoPlaceAtAll)
{
  const test::Domain office = test::office();
  const Zoom zoom = office.zoomOn(
      "putdown(rob1, tb1)", {"loc(rob1) = office", "loc(tb1) = office", "in_hand(rob1, tb1)"});
  EXPECT_EQ(names(zoom), (Names{"rob1", "tb1"}));
  EXPECT_TRUE(zoomedDescription(office.low_level, zoom).findSort("cell")->elements.empty());
}

TEST(Zoom, KeepsWhatIsCarried)
{
  const Zoom zoom = test::office().zoomOn(
      "move(rob1, office)", {"loc(rob1) = kitchen", "loc(mug1) = kitchen", "in_hand(rob1, mug1)"});
  EXPECT_EQ(names(zoom), (Names{"kitchen", "mug1", "office", "rob1"}));
  EXPECT_EQ(texts(zoom.effects), (Names{"loc(rob1) = office", "loc(mug1) = office"}));
}

TEST(Zoom, WorksWhereNothingIsAPlace)
{
  const Zoom zoom =
      test::workbench().zoomOn("replace(tech1, psu, hum)", {"opened(psu)", "cause(hum) = psu"});
  EXPECT_EQ(names(zoom), (Names{"hum", "psu", "tech1"}));
  EXPECT_EQ(texts(zoom.effects), Names{"resolved(hum)"});
}

/// Clause 2 of the definition is about all literals, those of defined fluents among them.
TEST(Zoom, KeepsWhatDefinedFluentsAreAbout)
{
  const LowLevelDomain hospital = test::composed(
      test::textOf(test::domainFile("hospital", "domain.kr3")), "", ComponentMap({}));
  const test::Domain domain{hospital, {}};
  const Zoom zoom = domain.zoomOn(
      "unload(hob, morphine)",
      {"at(hob) = surgery", "at(pat) = pharmacy", "kept(morphine) = surgery",
       "kept(insulin) = pharmacy", "kept(antibiotic) = pharmacy", "carries(hob, morphine)"});
  EXPECT_EQ(names(zoom), (Names{"hob", "morphine", "surgery"}));
  EXPECT_EQ(texts(zoom.effects), Names{"-carries(hob, morphine)"});
  // A condition on a defined fluent counts where the whole state is known.
  expectError(ErrorCode::kFailedPrecondition, "is impossible in the state given", [&] {
    (void)domain.zoomOn(
        "load(pat, morphine)",
        {"at(hob) = surgery", "at(pat) = surgery", "kept(morphine) = surgery",
         "kept(insulin) = pharmacy", "kept(antibiotic) = pharmacy", "carries(hob, morphine)"});
  });
}

TEST(Zoom, SaysWhyThereIsNone)
{
  const test::Domain office = test::office();
  const auto rejects = [&](const std::string& part, const std::string& action, const Names& state) {
    expectError(ErrorCode::kFailedPrecondition, part, [&] { (void)office.zoomOn(action, state); });
  };
  rejects("grasp(rob1, tb1) is impossible in the state given, by domain.kr3:", "grasp(rob1, tb1)",
          {"loc(rob1) = office", "loc(tb1) = kitchen"});
  rejects("grasp(rob1, tb1) depends on loc(tb1), which has no value", "grasp(rob1, tb1)",
          {"loc(rob1) = office"});
  expectError(ErrorCode::kInvalidArgument, "the state gives loc(rob1) two values", [&] {
    (void)office.zoomOn("move(rob1, office)", {"loc(rob1) = kitchen", "loc(rob1) = corridor"});
  });
}

TEST(Zoom, KeepsEverythingWhenAsked)
{
  const test::Domain office = test::office();
  const std::vector<reasoner::Literal> state = office.state({"loc(rob1) = kitchen"});
  const Zoom zoom = wholeDomain(office.low_level, state, office.state({"loc(tb1) = office"}));
  EXPECT_EQ(zoom.relevant.size(), 6U + 1U + 8U);
  EXPECT_EQ(zoom.constants.size(), 6U + 24U + 1U + 8U);
}

TEST(Successor, FollowsTheHighLevel)
{
  const test::Domain office = test::office();
  const Names after = texts(
      successor(office.low_level.highLevel(),
                office.state({"loc(rob1) = kitchen", "loc(mug1) = kitchen", "in_hand(rob1, mug1)"}),
                office.action("move(rob1, office)")));
  EXPECT_NE(std::find(after.begin(), after.end(), "loc(mug1) = office"), after.end());
  EXPECT_NE(std::find(after.begin(), after.end(), "in_hand(rob1, mug1)"), after.end());
  EXPECT_EQ(std::find(after.begin(), after.end(), "loc(mug1) = kitchen"), after.end());
}

}  // namespace
}  // namespace kr3::refinement
