#include "kr3_refinement/low_level_domain.hpp"

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::composed;
using test::expectError;

const char* const kHighLevel = R"(
sorts
  tank = {t1, t2}.
  valve = {v1}.
  spot = tank + valve.
statics
  joined(tank, tank).
fluents
  inertial feeds(valve) : tank.
  inertial seat(valve) : spot.
  inertial full(tank).
actions
  turn(valve, tank).
  drain(tank).
  park(valve).
axioms
  turn(V, T) causes feeds(V) = T.
  drain(T) causes -full(T).
  park(V) causes feeds(V) = t1.
  impossible turn(V, T) if feeds(V) = T2, -joined(T2, T).
  impossible park(V) if feeds(V) = t2.
facts
  joined(t1, t2).
)";

const char* const kRefinement = R"(
magnify tank into port by port_of.
statics
  beside(port, port).
axioms
  turn(V, P) causes feeds(V) = P [good] or feeds(V) = {Q : beside(Q, P)} [off].
observations
  turn(V, P) observes feeds(V).
)";

ComponentMap ports()
{
  return gridMap({"t1", "t2"}, 2, 1.0);
}

bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

TEST(LowLevelDomain, PutsComponentsIntoSignatures)
{
  const LowLevelDomain domain = composed(kHighLevel, kRefinement, ports());
  const reasoner::Description& low = domain.description();
  EXPECT_EQ(low.findFluent("feeds")->value_sort, "port");
  EXPECT_EQ(low.findFluent("full")->argument_sorts, std::vector<std::string>{"port"});
  EXPECT_EQ(low.findAction("turn")->argument_sorts, (std::vector<std::string>{"valve", "port"}));
  EXPECT_EQ(low.findFluent("joined")->argument_sorts, (std::vector<std::string>{"tank", "tank"}));
  const reasoner::Sort* spot = low.findSort(*low.findFluent("seat")->value_sort);
  EXPECT_EQ(spot->elements, (std::vector<std::string>{"t1_c0", "t1_c1", "t2_c0", "t2_c1", "v1"}));
}

TEST(LowLevelDomain, ReadsAxiomsOverComponents)
{
  const std::string low = toString(composed(kHighLevel, kRefinement, ports()).description());
  EXPECT_TRUE(contains(low, "drain(T) causes -full(T).")) << low;
  EXPECT_TRUE(contains(low, "port_of(T2) = T2_whole")) << low;
  EXPECT_TRUE(contains(low, "-joined(T2_whole, T_whole)")) << low;
  EXPECT_TRUE(contains(low, "port_of(t2_c1) = t2.")) << low;
  EXPECT_TRUE(contains(low, "beside(t1_c0, t1_c1).")) << low;
  EXPECT_FALSE(contains(low, "turn(V, T) causes feeds(V) = T.")) << low;  // replaced
}

TEST(LowLevelDomain, MakesSomeComponentOfANamedWhole)
{
  const reasoner::Description low = composed(kHighLevel, kRefinement, ports()).description();
  for (const reasoner::CausalLaw& law : low.causal_laws)
  {
    if (law.action.name == "park")
    {
      const reasoner::Effect& effect = law.outcomes.front().effects.front();
      EXPECT_TRUE(effect.is_choice);
      EXPECT_EQ(effect.choice.size(), 1U);
    }
  }
}

TEST(LowLevelDomain, SeesFineLiteralsFromTheHighLevel)
{
  const LowLevelDomain domain = composed(kHighLevel, kRefinement, ports());
  const auto coarse = [&](const std::string& literal) {
    return toString(domain.coarse(reasoner::parseGroundLiteral(literal, domain.description())));
  };
  EXPECT_EQ(coarse("feeds(v1) = t2_c1"), "feeds(v1) = t2");
  EXPECT_EQ(coarse("-full(t1_c0)"), "-full(t1)");
  EXPECT_EQ(domain.components("t1"), (std::vector<std::string>{"t1_c0", "t1_c1"}));
  EXPECT_EQ(domain.components("v1"), std::vector<std::string>{"v1"});
}

TEST(LowLevelDomain, SaysWhatIsWrongAndHowToMendIt)
{
  const auto rejects =
      [](const std::string& part, const std::string& refinement, const ComponentMap& map) {
    expectError(ErrorCode::kInvalidArgument, part, [&] { composed(kHighLevel, refinement, map); });
  };
  rejects("refinement.kr3:2:", kRefinement, gridMap({"t1"}, 2, 1.0));
  rejects("'t2' of sort 'tank' has no components in the map; add some", kRefinement,
          gridMap({"t1"}, 2, 1.0));
  rejects("part of 't9', which no magnified sort has", kRefinement,
          gridMap({"t1", "t2", "t9"}, 2, 1.0));
  rejects("'v1' is a component of the map and also an element", kRefinement,
          ComponentMap({{{"v1", "t1"}, {"p2", "t2"}}, {}, {}, {}}));
  rejects("fact 'heavy(t1_c0)' of the map", kRefinement,
          ComponentMap({{{"p1", "t1"}, {"p2", "t2"}}, {}, {"heavy(t1_c0)"}, {}}));
  rejects(
      "could be the map's neighbour relation",
      "magnify tank into port by port_of.\nstatics\n  beside(port, port).\n  above(port, port).\n",
      ports());
}

}  // namespace
}  // namespace kr3::refinement
