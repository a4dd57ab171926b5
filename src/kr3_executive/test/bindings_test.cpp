#include "kr3_executive/bindings.hpp"

#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

reasoner::Description description()
{
  return reasoner::parseDescription(
      "sorts\n"
      "  spot = {s1, s2}.\n"
      "  robot = {rob1}.\n"
      "  thing = {cup}.\n"
      "fluents\n"
      "  inertial at(robot) : spot.\n"
      "  inertial seen(thing).\n"
      "  defined near(thing).\n"
      "actions\n"
      "  go(robot, spot).\n"
      "  look(robot, thing).\n"
      "axioms\n"
      "  go(R, S) causes at(R) = S.\n"
      "  look(R, T) causes seen(T) [yes] or nothing [no].\n"
      "  near(T) if seen(T).\n"
      "observations\n"
      "  go(R, S) observes at(R).\n"
      "  look(R, T) observes seen(T).\n",
      "test.kr3");
}

const std::string kGood =
    "actions:\n"
    "  - {action: 'go(R, S)', server: drive, skill: go, arguments: [S], outcomes: {ok: []}}\n"
    "  - {action: 'look(R, T)', server: eye, skill: look, arguments: [T, '${at(R)}', \"'slow'\"],\n"
    "     outcomes: {yes: ['true'], no: ['false']}}\n";

std::string problemOf(const std::string& text)
{
  try
  {
    static_cast<void>(Bindings::parse(text, "bindings.yaml", description()));
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return {};
}

TEST(Bindings, FillInParametersFluentsAndTexts)
{
  const auto bindings = Bindings::parse(kGood, "bindings.yaml", description());
  const LowLevelAction look{"look(rob1,cup)", "look", {"rob1", "cup"}};
  const auto call = bindings.call(
      look, [](const std::string& fluent) { return fluent == "at(rob1)" ? "s2" : ""; });
  EXPECT_EQ(call.server, "eye");
  EXPECT_EQ(call.arguments, (std::vector<std::string>{"cup", "s2", "slow"}));
  EXPECT_THROW(
      static_cast<void>(bindings.call(look, [](const std::string&) { return std::string(); })),
      FailedPrecondition);
}

TEST(Bindings, ATruthComesFromTheOutcomeAndAValueFromTheSkill)
{
  const auto bindings = Bindings::parse(kGood, "bindings.yaml", description());
  const LowLevelAction look{"look(rob1,cup)", "look", {"rob1", "cup"}};
  const LowLevelAction go{"go(rob1,s1)", "go", {"rob1", "s1"}};
  EXPECT_EQ(bindings.observation(look, "no", {}), std::vector<std::string>{"false"});
  EXPECT_EQ(bindings.observation(go, "ok", {"s2"}), std::vector<std::string>{"s2"});
  EXPECT_THROW(static_cast<void>(bindings.observation(go, "ok", {})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(bindings.observation(look, "maybe", {})), InvalidArgument);
}

TEST(Bindings, NamesEveryProblemWithItsLine)
{
  const std::string problem = problemOf(
      "actions:\n"
      "  - {action: 'look(R, T)', server: eye, skill: look, arguments: [X],\n"
      "     outcomes: {yes: ['perhaps']}}\n"
      "  - {action: 'jump(R)', server: legs, skill: jump, outcomes: {ok: []}}\n");
  EXPECT_NE(problem.find("bindings.yaml:2: argument 'X'"), std::string::npos) << problem;
  EXPECT_NE(problem.find("bindings.yaml:3: 'perhaps'"), std::string::npos) << problem;
  EXPECT_NE(problem.find("bindings.yaml:4: 'jump'"), std::string::npos) << problem;
  EXPECT_NE(problem.find("action 'go' has no binding"), std::string::npos) << problem;
}

/// kGood with a part exchanged, and what must be said about it.
struct Mistake
{
  std::string from;
  std::string to;
  std::string told;
};

TEST(Bindings, SaysOfEachMistakeWhereItIsAndHowToMendIt)
{
  const std::vector<Mistake> mistakes = {
      {"'go(R, S)'", "'goo(R, S)'", "bindings.yaml:2: 'goo', expected an action of the low level"},
      {"'go(R, S)'", "'goo(R, S)'", "did you mean 'go'?"},
      {"'go(R, S)'", "'go(R)'", "bindings.yaml:2: 1 parameters of 'go', expected 2, of the sorts"},
      {"'go(R, S)'", "'go(S, S)'", "bindings.yaml:2: two parameters of 'go' have the same name"},
      {"server: drive", "server: ''", "bindings.yaml:2: an empty 'server', expected a name"},
      {"skill: go", "skil: go", "bindings.yaml:2: unknown key 'skil'; did you mean 'skill'?"},
      {"skill: go", "skill: go, skill: run", "bindings.yaml:2: key 'skill' a second time"},
      {"outcomes: {ok: []}", "outcomes: {ok: ['true']}",
       "bindings.yaml:2: outcome 'ok' of 'go' tells 1 truths, expected 0, one for each 'observes'"},
      {"{ok: []}", "{}", "bindings.yaml:2: no outcomes of 'go'"},
      {"{ok: []}", "{ok: []}, expected_duration_s: .nan",
       "bindings.yaml:2: 'expected_duration_s' is no number"},
      {"{ok: []}", "{ok: []}, time_limit_s: -1", "bindings.yaml:2: a negative duration"},
      {"yes: ['true'],", "",
       "bindings.yaml:4: no outcome 'yes' of 'look', which its laws have; say "
       "what it tells, as 'yes: [...]'"},
      {"${at(R)}", "${att(R)}", "fluent 'att' is not declared; did you mean 'at'?"},
      {"${at(R)}", "${at(R, T)}", "2 arguments of 'at', expected 1"},
      {"${at(R)}", "${at(X)}", "'X' in ${at(X)}, expected one of"},
      {"${at(R)}", "${near(T)}", "the value of 'near' is no belief of the robot"},
  };
  for (const Mistake& mistake : mistakes)
  {
    std::string text = kGood;
    const std::size_t at = text.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << mistake.from;
    const std::string problem = problemOf(text.replace(at, mistake.from.size(), mistake.to));
    EXPECT_NE(problem.find(mistake.told), std::string::npos) << mistake.told << "\n" << problem;
  }
}

TEST(Bindings, ChecksThePlaceholdersOfPhrases)
{
  const auto with = [](const std::string& phrase) {
    return problemOf(kGood + "phrases:\n" + phrase);
  };
  EXPECT_EQ(with("  at: {holds: '{1} at {value}'}\n"), "");
  EXPECT_NE(with("  at: {holds: '{2} at {value}'}\n").find("'{2}' in the phrase of at"),
            std::string::npos);
  EXPECT_NE(with("  seen: {holds: '{1} is {value}'}\n").find("'{value}' in the phrase of seen"),
            std::string::npos);
  EXPECT_NE(with("  sen: {holds: '{1}'}\n").find("did you mean 'seen'?"), std::string::npos);
  EXPECT_NE(with("  - at\n").find("found no map 'phrases'"), std::string::npos);
}

TEST(Bindings, RejectsUnknownKeysAndBadYaml)
{
  EXPECT_NE(problemOf("actions: []\nphrase: {}\n").find("unknown key 'phrase'"), std::string::npos);
  EXPECT_NE(problemOf("actions: [").find("bindings.yaml:"), std::string::npos);
}

const std::string kForCups =
    "  - {action: 'look(R, T)', for: {T: thing}, server: hand, skill: feel, arguments: [T],\n"
    "     outcomes: {yes: ['true'], dark: ['false']}}\n";

TEST(Bindings, OfASortGoBeforeTheOthers)
{
  const LowLevelAction look{"look(rob1,cup)", "look", {"rob1", "cup"}};
  const auto nowhere = [](const std::string&) { return std::string("s1"); };
  const auto bindings = Bindings::parse(kGood + kForCups, "bindings.yaml", description());
  EXPECT_EQ(bindings.call(look, nowhere).server, "hand");
  EXPECT_EQ(bindings.observation(look, "dark", {}), std::vector<std::string>{"false"});
  EXPECT_THROW(static_cast<void>(bindings.observation(look, "no", {})), InvalidArgument);
  EXPECT_EQ(bindings.servers(), (std::vector<std::string>{"drive", "eye", "hand"}));
  // The same for a sort without the argument changes nothing.
  std::string other = kForCups;
  other.replace(other.find("{T: thing}"), 10, "{T: spot}");
  EXPECT_EQ(
      Bindings::parse(kGood + other, "bindings.yaml", description()).call(look, nowhere).server,
      "eye");
}

TEST(Bindings, WatchEveryInstanceOfALiteral)
{
  const auto bindings = Bindings::parse(
      kGood +
          "sightings:\n  seen: 'at(${object}) = ${cell}'\n  watches:\n"
          "    - {topic: eye/open, becomes: false, literal: '-seen(T)', confidence: 0.9}\n",
      "bindings.yaml", description());
  ASSERT_EQ(bindings.watches().size(), 1U);
  const Watch& watch = bindings.watches().front();
  EXPECT_EQ(watch.topic, "eye/open");
  EXPECT_FALSE(watch.becomes);
  EXPECT_FALSE(watch.holds);
  EXPECT_EQ(watch.fluents, std::vector<std::string>{"seen(cup)"});
  EXPECT_DOUBLE_EQ(watch.confidence, 0.9);
}

TEST(Bindings, NameWhatIsWrongWithSortsAndSightings)
{
  const auto expectProblem = [](const std::string& text, const std::string& problem) {
    EXPECT_NE(problemOf(text).find(problem), std::string::npos) << problemOf(text);
  };
  std::string bad = kForCups;
  bad.replace(bad.find("{T: thing}"), 10, "{X: thing}");
  expectProblem(kGood + bad, "bindings.yaml:5: 'X', expected one of R and T");
  bad = kForCups;
  bad.replace(bad.find("{T: thing}"), 10, "{T: thong}");
  expectProblem(kGood + bad, "bindings.yaml:5: 'thong' is no sort");
  expectProblem(kGood + "sightings: {seen: 'at(${object})'}\n", "with ${object} and ${cell}");
  expectProblem(kGood + "sightings: {watches: [{topic: t, literal: 'at(R) = s1'}]}\n",
                "expected a boolean fluent");
  expectProblem(kGood + "sightings: {watches: [{topic: t, literal: 'seen(R, T)'}]}\n",
                "2 arguments of 'seen', expected 1");
  expectProblem(kGood + "sightings: {watches: [{topic: t, literal: 'seen(T)', confidence: 0}]}\n",
                "confidence outside (0, 1]");
}

}  // namespace
}  // namespace kr3::executive
