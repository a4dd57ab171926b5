// The reasoner against the definitions, on random descriptions and histories. The number of cases
// is 60, or what KR3_REASONER_CASES says; the first seed is 1, or KR3_REASONER_SEED.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/oracle.hpp"
#include "support/random_case.hpp"
#include "support/reference_program.hpp"

namespace kr3::reasoner
{
namespace
{

long numberFrom(const char* variable, long otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtol(text, nullptr, 10);
}

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

/// The descriptions that come with the repository, and those of the tests.
std::vector<std::string> shippedDomains()
{
  std::vector<std::string> paths = {std::string(KR3_TEST_DIR) + "/data/lamps.kr3"};
  for (const auto& entry : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    const std::filesystem::path path = entry.path() / "domain.kr3";
    if (std::filesystem::exists(path))
    {
      paths.push_back(path.string());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
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

/// @return whether the case was small enough to enumerate, and consistent
enum class Outcome
{
  kConsistent,
  kInconsistent,
  kTooLarge
};

Outcome compareWithOracle(const RandomCase& drawn)
{
  const Description description = parseDescription(drawn.description, "random");
  const std::vector<Record> records = parseHistory(drawn.history, "history", description);
  oracle::Answers answers;
  try
  {
    answers = oracle::answersOf(description, records, drawn.options);
  }
  catch (const ResourceExhausted&)
  {
    return Outcome::kTooLarge;
  }
  const oracle::GroundDomain domain = oracle::grounded(description);
  Reasoner reasoner(description, drawn.options);
  reasoner.setHistory(records);
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.consistent, answers.consistent);
  if (!diagnosis.consistent || !answers.consistent)
  {
    return Outcome::kInconsistent;
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
  return Outcome::kConsistent;
}

TEST(Equivalence, TheReasonerHasTheModelsOfTheDefinitions)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 60);
  long consistent = 0;
  long inconsistent = 0;
  for (long seed = first; seed < first + cases; ++seed)
  {
    const RandomCase drawn = randomCase(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(toString(drawn));
    const Outcome outcome = compareWithOracle(drawn);
    consistent += outcome == Outcome::kConsistent ? 1 : 0;
    inconsistent += outcome == Outcome::kInconsistent ? 1 : 0;
  }
  std::cout << cases << " random cases: " << consistent << " consistent, " << inconsistent
            << " inconsistent, " << cases - consistent - inconsistent
            << " too large to enumerate\n";
  EXPECT_GT(consistent, cases / 3);
  EXPECT_GT(consistent + inconsistent, cases * 3 / 4);
}

// Three ways to the same models: the fast program, the slow one, and the enumeration.
TEST(Equivalence, TheSlowProgramHasTheModelsOfTheDefinitionsToo)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 60) / 2;
  for (long seed = first; seed < first + cases; ++seed)
  {
    const RandomCase drawn = randomCase(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(toString(drawn));
    const Description description = parseDescription(drawn.description, "random");
    const std::vector<Record> records = parseHistory(drawn.history, "history", description);
    const oracle::GroundDomain domain = oracle::grounded(description);
    try
    {
      const oracle::Answers expected = oracle::answersOf(description, records, drawn.options);
      const oracle::Answers found = oracle::referenceAnswers(description, records, drawn.options);
      EXPECT_EQ(found.consistent, expected.consistent);
      EXPECT_EQ(found.cost, expected.cost);
      EXPECT_EQ(difference(textsOf(expected.models, domain), textsOf(found.models, domain)), "");
    }
    catch (const ResourceExhausted&)
    {
      continue;
    }
  }
}

/// The reasoner against the slow program on a domain that is too large to enumerate.
void compareWithReference(const std::string& path, std::uint64_t seed)
{
  const Description description = readDescription(path);
  const std::string history =
      randomHistory(description, seed, static_cast<int>(seed % 4), static_cast<int>(seed % 7));
  SCOPED_TRACE(path + ", seed " + std::to_string(seed) + "\n" + history);
  const std::vector<Record> records = parseHistory(history, "history", description);
  ReasonerOptions options;
  options.diagnose_exogenous = seed % 2 == 0;
  Reasoner reasoner(description, options);
  reasoner.setHistory(records);
  const oracle::Consequences expected =
      oracle::referenceConsequences(description, records, options);
  const Diagnosis diagnosis = reasoner.diagnose();
  ASSERT_EQ(diagnosis.consistent, expected.consistent);
  if (!expected.consistent)
  {
    return;
  }
  EXPECT_EQ(diagnosis.cost, expected.cost);
  const oracle::GroundDomain domain = oracle::grounded(description);
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    for (std::size_t f = 0; f < domain.fluents.size(); ++f)
    {
      const std::set<int>& possible = expected.possible[static_cast<std::size_t>(step)][f];
      for (int value = 0; value < static_cast<int>(domain.fluents[f].values.size()); ++value)
      {
        const Answer answer = possible.count(value) == 0 ? Answer::kFalse
                              : possible.size() == 1     ? Answer::kTrue
                                                         : Answer::kUnknown;
        const std::string literal =
            oracle::toString(oracle::GroundLiteral{static_cast<int>(f), value, true}, domain);
        EXPECT_EQ(reasoner.entails(literal, step), answer) << literal << " at " << step;
      }
    }
  }
}

TEST(Equivalence, TheShippedDomainsMeanWhatTheSlowProgramSays)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = std::max(4L, numberFrom("KR3_REASONER_CASES", 60) / 10);
  for (long seed = first; seed < first + cases; ++seed)
  {
    for (const std::string& path : shippedDomains())
    {
      compareWithReference(path, static_cast<std::uint64_t>(seed));
    }
  }
}

TEST(Equivalence, RandomCasesAreReproducible)
{
  EXPECT_EQ(toString(randomCase(7)), toString(randomCase(7)));
  EXPECT_NE(toString(randomCase(7)), toString(randomCase(8)));
}

}  // namespace
}  // namespace kr3::reasoner
