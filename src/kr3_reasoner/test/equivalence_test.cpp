// The reasoner against the definitions, on random descriptions and histories. The number of cases
// is 60, or what KR3_REASONER_CASES says; the first seed is 1, or KR3_REASONER_SEED.

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/expectations.hpp"
#include "support/oracle.hpp"
#include "support/random_case.hpp"
#include "support/reference_program.hpp"
#include "support/runs.hpp"

namespace kr3::reasoner
{
namespace
{

TEST(Equivalence, TheReasonerHasTheModelsOfTheDefinitions)
{
  const Seeds seeds = seedsOfRun(60);
  const auto cases = static_cast<long>(seeds.count);
  long compared = 0;
  long consistent = 0;
  long explained = 0;
  std::set<std::string> kinds;
  forEachCase(seeds, {}, [&](const RandomCase& drawn, std::uint64_t) {
    const Description description = parseDescription(drawn.description, "random");
    const std::vector<Record> records = parseHistory(drawn.history, "history", description);
    const bool small = expectSameAsDefinitions(description, records, drawn.options);
    compared += small ? 1 : 0;
    Reasoner reasoner(description, drawn.options);
    reasoner.setHistory(records);
    const Diagnosis diagnosis = reasoner.diagnose();
    consistent += small && diagnosis.consistent ? 1 : 0;
    explained += small && diagnosis.cost > 0 ? 1 : 0;
    for (const auto& explanation : diagnosis.explanations)
    {
      for (const std::string& statement : explanation)
      {
        kinds.insert(statement.substr(0, statement.find('(')));
      }
    }
  });
  std::cout << cases << " random cases, " << compared << " compared, " << consistent
            << " of them consistent, " << explained << " with a price\n";
  for (const char* kind : {"init", "failed", "wrong", "push"})
  {
    if (cases < 200)
    {
      break;  // too few to find each kind of assumption
    }
    EXPECT_EQ(kinds.count(kind), 1U) << "no case assumes " << kind;
  }
  EXPECT_GT(compared, cases * 3 / 4);
  EXPECT_GT(consistent, cases / 3);
  EXPECT_GT(explained, cases / 20);
}

// Three ways to the same models: the fast program, the slow one, and the enumeration.
TEST(Equivalence, TheSlowProgramHasTheModelsOfTheDefinitionsToo)
{
  Seeds seeds = seedsOfRun(60);
  seeds.count /= 2;
  forEachCase(seeds, {}, [](const RandomCase& drawn, std::uint64_t) {
    const Description description = parseDescription(drawn.description, "random");
    const std::vector<Record> records = parseHistory(drawn.history, "history", description);
    try
    {
      const oracle::Answers expected = oracle::answersOf(description, records, drawn.options);
      const oracle::Answers found = oracle::referenceAnswers(description, records, drawn.options);
      EXPECT_EQ(found.consistent, expected.consistent);
      EXPECT_EQ(found.cost, expected.cost);
      EXPECT_TRUE(found.models == expected.models)
          << found.models.size() << " models, expected " << expected.models.size();
    }
    catch (const ResourceExhausted&)  // too large to enumerate
    {
    }
  });
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
  const Seeds seeds = seedsOfRun(60);
  const std::uint64_t count = std::max<std::uint64_t>(4, seeds.count / 10);
  for (std::uint64_t seed = seeds.first; seed < seeds.first + count; ++seed)
  {
    for (const std::string& path : shippedDomains())
    {
      compareWithReference(path, seed);
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
