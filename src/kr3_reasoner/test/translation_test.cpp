#include "../src/translation.hpp"

#include <set>
#include <string>
#include <vector>

#include <clingo.hh>
#include <gtest/gtest.h>

#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3";
const std::string kLamps = std::string(KR3_TEST_DIR) + "/data/lamps.kr3";

/// A trajectory: what is true at each step, what occurs, and how much is assumed.
using Facts = std::set<std::string>;

Reasoner reasonerOf(const std::string& path, const std::string& history)
{
  Reasoner reasoner(readDescription(path));
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

std::string withoutSpaces(std::string text)
{
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  return text;
}

/// What a fresh clingo finds, given the text as one file: all answer sets, or the occurrences only.
std::set<Facts> answerSets(const std::string& program, bool occurrences_only = false)
{
  Clingo::Control control({"0", "--project=show", "--warn=none"});
  control.add("base", {}, program.c_str());
  control.ground({{"base", {}}});
  std::set<Facts> answers;
  for (const Clingo::Model& model : control.solve())
  {
    Facts facts;
    std::size_t num_assumed = 0;
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      const Clingo::SymbolSpan parts = symbol.arguments();
      if (symbol.match("occ", 2))
      {
        facts.insert(parts[1].to_string() + ">" + parts[0].to_string());
      }
      else if (symbol.match("h", 3) && parts[1].to_string() != "false" && !occurrences_only)
      {
        const std::string value = parts[1].to_string();
        facts.insert(parts[2].to_string() + ":" + parts[0].to_string() +
                     (value == "true" ? "" : "=" + value));
      }
      num_assumed += symbol.match("assumed", 1) ? 1 : 0;
    }
    facts.insert("assumed " + std::to_string(num_assumed));
    answers.insert(facts);
  }
  return answers;
}

std::set<Facts> modelsOf(const Reasoner& reasoner)
{
  std::set<Facts> answers;
  const std::vector<HistoryModel> models = reasoner.models(0);
  for (const HistoryModel& model : models)
  {
    Facts facts = {"assumed " + std::to_string(model.assumed.size())};
    for (std::size_t step = 0; step < model.states.size(); ++step)
    {
      for (const Literal& literal : model.states[step])
      {
        if (literal.value.name != "false")
        {
          facts.insert(std::to_string(step) + ":" + withoutSpaces(toString(literal)));
        }
      }
    }
    for (std::size_t step = 0; step < model.actions.size(); ++step)
    {
      for (const std::string& action : model.actions[step])
      {
        facts.insert(std::to_string(step) + ">" + withoutSpaces(action));
      }
    }
    answers.insert(facts);
  }
  EXPECT_EQ(answers.size(), models.size()) << "a model was listed twice";
  return answers;
}

struct Case
{
  std::string name;
  std::string path;
  std::string history;
};

class TranslatedHistory : public testing::TestWithParam<Case>
{
};

// The printed text alone has the models of the history, without any part of ours around it.
TEST_P(TranslatedHistory, HasTheModelsOfTheHistoryInPlainClingo)
{
  const Reasoner reasoner = reasonerOf(GetParam().path, GetParam().history);
  const std::set<Facts> models = modelsOf(reasoner);
  EXPECT_FALSE(models.empty());
  EXPECT_EQ(answerSets(reasoner.translation()), models);
}

INSTANTIATE_TEST_SUITE_P(
    Translation, TranslatedHistory,
    testing::Values(
        Case{"Empty", kLamps, ""},
        Case{"Initial", kOffice, "init(loc(tb1) = main_library, false)."},
        Case{"Exception", kOffice, "obs(loc(tb1) = main_library, false, 1)."},
        Case{"Exogenous", kOffice,
             "init(loc(rob1) = office, true). init(loc(tb1) = main_library, true).\n"
             "hpd(move(rob1, kitchen), 0). obs(loc(tb1) = kitchen, true, 1)."},
        Case{"Attempt", kLamps,
             "init(on(left), false). attempt(flip(left), 0). obs(lit(red), false, 1)."},
        Case{"Outcomes", kLamps, "init(broken(red), true). hpd(repair(red), 0). hpd(roll(d), 1)."},
        Case{"Doubt", kLamps,
             "obs(on(left), true, 0). obs(on(left), false, 0) [0.7]. hpd(flip(right), 0)."}),
    [](const testing::TestParamInfo<Case>& tested) { return tested.param.name; });

TEST(Translation, PointsToTheLinesOfItsSources)
{
  const Reasoner reasoner = reasonerOf(kLamps, "\n\nobs(lit(red), true, 1).");
  const std::string program = reasoner.translation();
  EXPECT_NE(program.find(kLamps + ":33"), std::string::npos);
  EXPECT_NE(program.find("% history:3\n% obs(lit(red), true, 1)"), std::string::npos);
}

const char* const kKnown =
    "init(on(left), false). init(on(right), false). init(shows(d) = 1, true).";

TEST(Translation, FindsTheShortestPlansInPlainClingo)
{
  const Reasoner reasoner = reasonerOf(kLamps, kKnown);
  const std::string goal = "lit(red) and lit(green)";
  const std::set<Facts> expected = {{"0>flip(left)", "1>flip(right)", "assumed 0"},
                                    {"0>flip(right)", "1>flip(left)", "assumed 0"}};
  EXPECT_EQ(answerSets(reasoner.translation(goal, 2), true), expected);
  EXPECT_TRUE(answerSets(reasoner.translation(goal, 1), true).empty());
}

TEST(Translation, TakesGoalsThatAreFormulas)
{
  const Reasoner reasoner = reasonerOf(kLamps, kKnown);
  EXPECT_EQ(answerSets(reasoner.translation("not (dark or lit(green))", 1), true),
            std::set<Facts>({{"0>flip(left)", "assumed 0"}}));
  EXPECT_EQ(answerSets(reasoner.translation("dark and shows(d) != 2", 0), true).size(), 1U);
  EXPECT_TRUE(answerSets(reasoner.translation("not dark", 0), true).empty());
  EXPECT_EQ(errorOf([&] { (void)reasoner.translation("dark", -1); }),
            "found a plan of -1 steps to translate, expected at least 0");
}

TEST(Translation, RefusesAnInconsistentHistory)
{
  const Reasoner reasoner =
      reasonerOf(kLamps, "obs(on(left), true, 0). obs(on(left), false, 0). obs(dark, true, 0).");
  const std::string error = errorOf([&] { (void)reasoner.translation(); });
  EXPECT_NE(error.find("inconsistent"), std::string::npos) << error;
  EXPECT_EQ(errorOf([&] { (void)reasoner.models(5); }), error);
}

TEST(Translation, ToleratesConstantsCalledAsItsParts)
{
  // A part's parameter replaces a constant of its name.
  Reasoner reasoner(
      parseDescription("sorts\n box = {t, n, r, a}.\nfluents\n inertial on(box).\n"
                       "actions\n turn(box).\naxioms\n turn(X) causes on(X).\n"
                       " impossible turn(X) if on(X).\n",
                       "boxes"));
  reasoner.setHistory(
      parseHistory("init(on(t), false). init(on(n), true). init(on(r), false). "
                   "init(on(a), false). hpd(turn(t), 0).",
                   "history", reasoner.description()));
  const std::set<Facts> models = modelsOf(reasoner);
  EXPECT_EQ(models, (std::set<Facts>{{"assumed 0", "0:on(n)", "0>turn(t)", "1:on(n)", "1:on(t)"}}));
  EXPECT_EQ(answerSets(reasoner.translation()), models);
}

TEST(OverAllSteps, ReplacesTheParameterAndKeepsComments)
{
  EXPECT_EQ(
      overAllSteps("% t. about t\nh(X,t) :- b(at,t-1), 1..2.\n#defined t/1.\nf(\"t.\",t).\ng.", "t",
                   "time"),
      "% t. about t\nh(X,_Step) :- b(at,_Step-1), 1..2; time(_Step).\n#defined _Step/1.\n"
      "f(\"t.\",_Step) :- time(_Step).\ng.");
}

// Several files are one description: each uses what the others declare, and errors name their file.
TEST(Description, MayStandInSeveralFiles)
{
  const SourceText domain{"domain",
                          "actions\n flip(switch).\naxioms\n flip(S) causes on(S).\n"
                          "fluents\n inertial on(switch).\ndefaults\n d(S): on(S) if "
                          "old(S).\n"};
  const SourceText objects{"objects", "sorts\n old = {a}.\n new = {b}.\n switch = old + new.\n"};
  const Description description = parseDescription({domain, objects});
  EXPECT_EQ(description.findSort("switch")->elements, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(description.defaults.size(), 1U);
  EXPECT_EQ(toString(parseDescription({objects, domain})), toString(description));
  const SourceText wrong{"wrong", "facts\n  bright(a).\n"};
  const std::string error = errorOf([&] { (void)parseDescription({domain, objects, wrong}); });
  EXPECT_EQ(error.rfind("wrong:2:3: ", 0), 0U) << error;
  const std::string twice = errorOf([&] { (void)parseDescription({domain, objects, objects}); });
  EXPECT_NE(twice.find("objects:2:2: "), std::string::npos) << twice;
}

}  // namespace
}  // namespace kr3::reasoner
