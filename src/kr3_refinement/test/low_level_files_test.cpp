#include "kr3_refinement/low_level_files.hpp"

#include <string>
#include <vector>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

const char* const kHighLevel = R"(sorts
  table = {desk, bar}.
  cup = {mug}.
fluents
  inertial on(cup) : table.
  inertial dirty(cup).
actions
  wash(cup).
axioms
  wash(C) causes -dirty(C).
)";

std::string refinementWith(const std::string& axiom)
{
  return "magnify table into spot by spot_of.\nactions\n  look(spot, cup).\naxioms\n  " + axiom +
         "\nobservations\n  look(S, C) observes on(C) = S.\n";
}

const char* const kModels = R"(actions:
  wash(C): {cost: {base_s: 1.0, impossible_s: 2.0}}
  look(S, C):
    observations: {on: {true_positive: 0.9, false_positive: 0.1, source: hand-written}}
    cost: {base_s: 1.0, impossible_s: 2.0}
)";

TEST(RefinementFile, SaysWhatTheTheoryOfObservationsIsFor)
{
  const reasoner::Description high = reasoner::parseDescription(kHighLevel, "domain.kr3");
  for (const std::string name : {"tested_on", "observed_on", "found_on", "failure_on"})
  {
    expectError(ErrorCode::kInvalidArgument,
                "it belongs to the theory of observations, which is made from the refinement: "
                "POMDPs keep a belief about 'on' in its place",
                [&] {
      (void)parseRefinementText(refinementWith("impossible wash(C) if -" + name + "(C, S)."),
                                "refinement.kr3", high);
    });
  }
  try
  {
    (void)parseRefinementText(refinementWith("impossible wash(C) if found_gold(C)."),
                              "refinement.kr3", high);
    FAIL() << "expected an error";
  }
  catch (const InvalidArgument& error)
  {
    EXPECT_EQ(std::string(error.what()).find("theory"), std::string::npos) << error.what();
  }
}

TEST(RefinementFile, SaysHowAComponentIsMeant)
{
  const reasoner::Description high = reasoner::parseDescription(kHighLevel, "domain.kr3");
  expectError(ErrorCode::kInvalidArgument,
              "found 'bar', expected an element of the sort spot; 'bar' is a whole, and here a "
              "component is meant: write a variable, as X, and add 'spot_of(X) = bar' to the "
              "conditions",
              [&] {
    (void)parseRefinementText(refinementWith("impossible wash(C) if on(C) = bar."),
                              "refinement.kr3", high);
  });
  (void)parseRefinementText(refinementWith("impossible wash(C) if on(C) = X, spot_of(X) = bar."),
                            "refinement.kr3", high);
}

// The names that models and bindings need are those of the composed description.
TEST(NamesOfLowLevel, AreThoseOfTheComposedDescription)
{
  for (const std::string domain : {"office", "workbench", "waterworks"})
  {
    const reasoner::Description high =
        reasoner::readDescription(test::domainFile(domain, "domain.kr3"));
    const reasoner::Description fine =
        refinement::readRefinementFile(test::domainFile(domain, "refinement.kr3"), high);
    const ComponentMap map = domain == "office"
                                 ? test::office().low_level.map()
                                 : readComponentMap(test::domainFile(domain, "map.yaml"));
    const reasoner::Description names = namesOfLowLevel(high, fine, map);
    const std::string models = test::textOf(test::domainFile(domain, "models.yaml"));
    const Models loose = parseModels(models, "models.yaml", names);
    const Models composed = parseModels(models, "models.yaml", LowLevelDomain(high, fine, map));
    EXPECT_EQ(handWritten(loose), handWritten(composed)) << domain;
    EXPECT_EQ(loose.actions.size(), composed.actions.size()) << domain;
  }
}

TEST(Refusals, TellOfAllFilesAtOnce)
{
  const reasoner::Description high = reasoner::parseDescription(kHighLevel, "domain.kr3");
  const reasoner::Description fine = parseRefinementText(
      "magnify table into spot by spot_of.\nactions\n  look(spot, cup).\n"
      "observations\n  look(S, C) observes on(C2) = S.\n",
      "refinement.kr3", high);
  const ComponentMap map = gridMap({"desk"}, 2, 1.0);
  std::string models = kModels;
  models.replace(models.find("0.9"), 3, "1.9");
  Refusals refusals;
  EXPECT_TRUE(refusals.empty());
  EXPECT_FALSE(refusals.attempt([&] { (void)LowLevelDomain(high, fine, map); }));
  EXPECT_FALSE(refusals.attempt(
      [&] { (void)parseModels(models, "models.yaml", namesOfLowLevel(high, fine, map)); }));
  EXPECT_TRUE(refusals.attempt([] {}));
  for (const char* part : {"'bar' of sort 'table' has no components", "with the variable C2",
                           "models.yaml:4: true_positive: found '1.9'"})
  {
    expectError(ErrorCode::kInvalidArgument, part, [&] { refusals.throwIfAny(); });
  }
}

}  // namespace
}  // namespace kr3::refinement
