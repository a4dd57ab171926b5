// The histories of test/histories with what is required of them. A file is a history; its lines
// that begin with `%!` say the domain, the options, and what has to be answered:
//
//   domain FILE                          of domains/ or of test/data/
//   options exogenous exception_weight=2 exogenous_weight=3 default_weight=d1:2
//   cost, because, true, false, unknown, models, inconsistent    as in expectOfHistory
//   conflict RECORD; RECORD              the records of a minimal conflict
//   says TEXT                            some minimal explanation has it in its words
//   explain LITERAL at N => RECORD; RECORD        what the explanation rests on
//   plan GOAL => [HYPOTHESIS; ...] ACTION + ACTION; ACTION    one line for each plan of the goal
//   entailed GOAL                        nothing to do
//   no plan GOAL => TEXT                 there is none, and the reason has the text

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support.hpp"
#include "support/expectations.hpp"

namespace kr3::reasoner
{
namespace
{

namespace fs = std::filesystem;

const fs::path kHistories = fs::path(KR3_TEST_DIR) / "histories";

/// A history file, taken apart.
struct Case
{
  std::string domain;  ///< the text of the description
  std::string history;
  ReasonerOptions options;
  std::vector<std::string> expectations;                       ///< for expectOfHistory
  std::vector<std::pair<std::string, std::string>> questions;  ///< word and rest of the others
};

std::string joined(const std::vector<std::string>& items, const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

std::string domainText(const std::string& name)
{
  const fs::path shipped = fs::path(KR3_DOMAINS_DIR) / name;
  const fs::path file = fs::exists(shipped) ? shipped : fs::path(KR3_TEST_DIR) / "data" / name;
  EXPECT_TRUE(fs::exists(file)) << file;
  return readText(file.string());
}

void addOption(const std::string& option, ReasonerOptions& options)
{
  const std::size_t sign = option.find('=');
  const std::string name = option.substr(0, sign);
  const std::string value = sign == std::string::npos ? "" : option.substr(sign + 1);
  if (name == "exogenous")
  {
    options.diagnose_exogenous = true;
  }
  else if (name == "exception_weight")
  {
    options.exception_weight = std::stoi(value);
  }
  else if (name == "exogenous_weight")
  {
    options.exogenous_weight = std::stoi(value);
  }
  else if (name == "default_weight")
  {
    options.default_weights[value.substr(0, value.find(':'))] =
        std::stoi(value.substr(value.find(':') + 1));
  }
  else
  {
    ADD_FAILURE() << "unknown option " << option;
  }
}

Case readCase(const fs::path& file)
{
  Case found;
  std::istringstream lines(readText(file.string()));
  for (std::string line; std::getline(lines, line);)
  {
    found.history += line + "\n";
    if (line.rfind("%! ", 0) != 0)
    {
      continue;
    }
    std::istringstream words(line.substr(3));
    std::string word;
    words >> word;
    if (word == "no")
    {
      words >> word;
      word = "no plan";
    }
    std::string rest;
    std::getline(words >> std::ws, rest);
    static const std::set<std::string> kAnswers = {"cost",    "because", "true",        "false",
                                                   "unknown", "models",  "inconsistent"};
    if (word == "domain")
    {
      found.domain = domainText(rest);
    }
    else if (word == "options")
    {
      std::istringstream options(rest);
      for (std::string option; options >> option;)
      {
        addOption(option, found.options);
      }
    }
    else if (kAnswers.count(word) > 0)
    {
      found.expectations.push_back(rest.empty() ? word : word + " " + rest);
    }
    else
    {
      found.questions.emplace_back(word, rest);
    }
  }
  return found;
}

/// `[loc(tb1) = office] move(rob1, office); grasp(rob1, tb1)`.
std::string textOf(const Plan& plan)
{
  std::vector<std::string> steps;
  for (const auto& step : plan.steps)
  {
    steps.push_back(joined(step, " + "));
  }
  return "[" + joined(plan.hypothesis, "; ") + "] " + joined(steps, "; ");
}

std::set<std::string> plansOf(const Reasoner& reasoner, const std::string& goal)
{
  std::set<std::string> texts;
  for (const Plan& plan : reasoner.plan(goal).plans)
  {
    texts.insert(textOf(plan));
  }
  return texts;
}

/// Checks a question that expectOfHistory does not know, but for `plan`.
void expectAnswer(const Reasoner& reasoner, const std::string& word, const std::string& rest)
{
  const std::size_t arrow = rest.find(" =>");
  const std::string asked = rest.substr(0, arrow);
  const std::string expected = rest.size() <= arrow + 4 ? "" : rest.substr(arrow + 4);
  SCOPED_TRACE(word + " " + rest);
  if (word == "conflict")
  {
    EXPECT_EQ(joined(reasoner.diagnose().conflict, "; "), rest);
  }
  else if (word == "says")
  {
    EXPECT_NE(joined(reasoner.diagnose().in_words, "\n").find(rest), std::string::npos)
        << joined(reasoner.diagnose().in_words, "\n");
  }
  else if (word == "explain")
  {
    const std::size_t at = asked.rfind(" at ");
    const Explanation why = reasoner.explain(asked.substr(0, at), std::stoi(asked.substr(at + 4)));
    EXPECT_TRUE(why.entailed);
    EXPECT_EQ(joined(why.records, "; "), expected);
  }
  else if (word == "entailed")
  {
    EXPECT_TRUE(reasoner.plan(rest).goal_entailed);
  }
  else if (word == "no plan")
  {
    PlanOptions options;
    options.max_horizon = 4;
    const PlanResult result = reasoner.plan(asked, options);
    EXPECT_TRUE(result.plans.empty());
    EXPECT_FALSE(result.goal_entailed);
    EXPECT_NE(result.reason.find(expected), std::string::npos) << result.reason;
  }
  else
  {
    ADD_FAILURE() << "unknown expectation";
  }
}

class Histories : public testing::TestWithParam<fs::path>
{
};

TEST_P(Histories, AreAnsweredAsRequired)
{
  const Case given = readCase(kHistories / GetParam());
  ASSERT_FALSE(given.domain.empty()) << "no domain";
  ASSERT_FALSE(given.expectations.empty() && given.questions.empty()) << "nothing is required";
  expectOfHistory(given.domain, given.history, given.expectations, given.options);
  const Reasoner reasoner = reasonerOfTexts(given.domain, given.history, given.options);
  std::map<std::string, std::set<std::string>> plans;
  for (const auto& [word, rest] : given.questions)
  {
    if (word == "plan")
    {
      const std::size_t arrow = rest.find(" => ");
      plans[rest.substr(0, arrow)].insert(rest.substr(arrow + 4));
    }
    else
    {
      expectAnswer(reasoner, word, rest);
    }
  }
  for (const auto& [goal, expected] : plans)
  {
    EXPECT_EQ(plansOf(reasoner, goal), expected) << goal;
  }
}

std::vector<fs::path> files()
{
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(kHistories))
  {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Files, Histories, testing::ValuesIn(files()),
                         [](const testing::TestParamInfo<fs::path>& file) {
  return file.param.stem().string();
});

}  // namespace
}  // namespace kr3::reasoner
