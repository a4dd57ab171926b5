#include "expectations.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "oracle.hpp"

namespace kr3::reasoner
{

namespace
{

using ModelTexts = std::set<std::string>;

std::string textOf(const oracle::Model& model, const oracle::GroundDomain& domain)
{
  std::string text;
  for (const std::string& assumed : model.assumed)
  {
    text += assumed + "; ";
  }
  for (const oracle::Values& state : model.states)
  {
    text += "\n    ";
    for (std::size_t i = 0; i < state.size(); ++i)
    {
      text += oracle::toString(oracle::GroundLiteral{static_cast<int>(i), state[i], true}, domain) +
              ", ";
    }
  }
  return text;
}

ModelTexts textsOf(const std::set<oracle::Model>& models, const oracle::GroundDomain& domain)
{
  ModelTexts texts;
  for (const oracle::Model& model : models)
  {
    texts.insert(textOf(model, domain));
  }
  return texts;
}

std::string textOf(const HistoryModel& model)
{
  std::vector<std::string> sorted = model.assumed;
  std::sort(sorted.begin(), sorted.end());
  std::string text;
  for (const std::string& assumed : sorted)
  {
    text += assumed + "; ";
  }
  for (const auto& state : model.states)
  {
    text += "\n    ";
    for (const Literal& literal : state)
    {
      text += toString(literal) + ", ";
    }
  }
  return text;
}

std::string difference(const ModelTexts& expected, const ModelTexts& found)
{
  constexpr int kMost = 3;
  std::string text;
  int shown = 0;
  for (const std::string& model : expected)
  {
    if (found.count(model) == 0 && shown++ < kMost)
    {
      text += "  missing: " + model + "\n";
    }
  }
  for (const std::string& model : found)
  {
    if (expected.count(model) == 0 && shown++ < 2 * kMost)
    {
      text += "  too much: " + model + "\n";
    }
  }
  return text;
}

void expectSameLiterals(const Reasoner& reasoner, const oracle::Answers& answers,
                        const oracle::GroundDomain& domain)
{
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    for (std::size_t f = 0; f < domain.fluents.size(); ++f)
    {
      for (int value = 0; value < static_cast<int>(domain.fluents[f].values.size()); ++value)
      {
        const auto count = std::count_if(answers.models.begin(), answers.models.end(),
                                         [&](const oracle::Model& model) {
          return model.states[static_cast<std::size_t>(step)][f] == value;
        });
        const Answer expected = count == 0 ? Answer::kFalse
                                : count == static_cast<long>(answers.models.size())
                                    ? Answer::kTrue
                                    : Answer::kUnknown;
        const std::string literal = oracle::toString({static_cast<int>(f), value, true}, domain);
        EXPECT_EQ(reasoner.entails(literal, step), expected) << literal << " at " << step;
        EXPECT_EQ(reasoner.possible(literal, step), count > 0) << literal << " at " << step;
      }
    }
  }
}

/// The conflicting records are inconsistent, and no longer when any of them is left out.
void expectMinimalConflict(const Diagnosis& diagnosis, const Description& description,
                           const std::vector<Record>& records, const ReasonerOptions& options)
{
  std::vector<Record> conflict;
  for (const std::size_t i : diagnosis.conflict_records)
  {
    conflict.push_back(records[i]);
  }
  EXPECT_FALSE(oracle::answersOf(description, conflict, options).consistent);
  for (std::size_t i = 0; i < conflict.size(); ++i)
  {
    std::vector<Record> fewer = conflict;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_TRUE(oracle::answersOf(description, fewer, options).consistent)
        << toString(conflict[i]) << " is superfluous in the conflict";
  }
}

/// Checks one line of expectations but `because`.
void expectLine(const Reasoner& reasoner, const Diagnosis& diagnosis, const std::string& line)
{
  const std::string word = line.substr(0, line.find(' '));
  const std::string rest = line.size() > word.size() ? line.substr(word.size() + 1) : "";
  if (word == "inconsistent")
  {
    EXPECT_FALSE(diagnosis.consistent);
    return;
  }
  ASSERT_TRUE(diagnosis.consistent) << line;
  if (word == "cost")
  {
    EXPECT_EQ(diagnosis.cost, std::stoi(rest));
  }
  else if (word == "models")
  {
    EXPECT_EQ(reasoner.models(0).size(), std::stoul(rest));
  }
  else
  {
    const std::size_t at = rest.rfind(" at ");
    const Answer expected = word == "true"    ? Answer::kTrue
                            : word == "false" ? Answer::kFalse
                                              : Answer::kUnknown;
    ASSERT_TRUE(word == "true" || word == "false" || word == "unknown") << "bad line: " << line;
    EXPECT_EQ(reasoner.entails(rest.substr(0, at), std::stoi(rest.substr(at + 4))), expected)
        << line;
  }
}

}  // namespace

Reasoner reasonerOfTexts(const std::string& description, const std::string& history,
                         const ReasonerOptions& options)
{
  Reasoner reasoner(parseDescription(description, "description"), options);
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

void expectOfHistory(const std::string& description, const std::string& history,
                     const std::vector<std::string>& expectations, const ReasonerOptions& options)
{
  SCOPED_TRACE(description + "---- history\n" + history);
  const Reasoner reasoner = reasonerOfTexts(description, history, options);
  const Diagnosis diagnosis = reasoner.diagnose();
  std::set<std::string> reasons;
  for (const std::string& line : expectations)
  {
    if (line.rfind("because ", 0) == 0)
    {
      reasons.insert(line.substr(8));
    }
    else
    {
      expectLine(reasoner, diagnosis, line);
    }
  }
  if (!reasons.empty())
  {
    std::set<std::string> found;
    for (std::vector<std::string> explanation : diagnosis.explanations)
    {
      std::sort(explanation.begin(), explanation.end());
      std::string text;
      for (const std::string& statement : explanation)
      {
        text += (text.empty() ? "" : "; ") + statement;
      }
      found.insert(text);
    }
    EXPECT_EQ(found, reasons);
  }
  expectSameAsDefinitions(reasoner.description(), reasoner.history(), options);
}

bool expectSameAsDefinitions(const Description& description, const std::vector<Record>& records,
                             const ReasonerOptions& options)
{
  oracle::Answers answers;
  try
  {
    answers = oracle::answersOf(description, records, options);
  }
  catch (const ResourceExhausted&)
  {
    return false;
  }
  const oracle::GroundDomain domain = oracle::grounded(description);
  Reasoner reasoner(description, options);
  reasoner.setHistory(records);
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.consistent, answers.consistent);
  if (!diagnosis.consistent || !answers.consistent)
  {
    expectMinimalConflict(diagnosis, description, records, options);
    return true;
  }
  EXPECT_EQ(diagnosis.cost, answers.cost);
  const ModelTexts expected = textsOf(answers.models, domain);
  ModelTexts expected_explanations;
  for (const oracle::Model& model : answers.models)
  {
    expected_explanations.insert(textOf(oracle::Model{model.assumed, {}}, domain));
  }
  ModelTexts found;
  for (const HistoryModel& model : reasoner.models(0))
  {
    found.insert(textOf(model));
  }
  ModelTexts explanations;
  for (const auto& explanation : diagnosis.explanations)
  {
    explanations.insert(textOf(HistoryModel{explanation, {}}));
  }
  EXPECT_EQ(difference(expected, found), "");
  EXPECT_EQ(difference(expected_explanations, explanations), "");
  expectSameLiterals(reasoner, answers, domain);
  return true;
}

}  // namespace kr3::reasoner
