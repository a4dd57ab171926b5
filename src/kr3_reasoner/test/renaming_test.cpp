// The names of a domain mean nothing: renaming every symbol at random changes no answer but its
// names.

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "support.hpp"
#include "support/expectations.hpp"
#include "support/ground_domain.hpp"
#include "support/random_case.hpp"
#include "support/runs.hpp"

namespace kr3::reasoner
{
namespace
{

using Names = std::map<std::string, std::string>;

/// Replaces whole words.
std::string renamed(const std::string& text, const Names& names)
{
  const auto isWord = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  std::string result;
  for (std::size_t i = 0; i < text.size();)
  {
    std::size_t end = i;
    while (end < text.size() && isWord(text[end]))
    {
      ++end;
    }
    const std::string word = text.substr(i, end - i);
    const auto found = names.find(word);
    result += found == names.end() ? word : found->second;
    i = end;
    if (i < text.size())
    {
      result += text[i++];
    }
  }
  return result;
}

/// A new name for every sort, element, fluent, action, default and outcome. Some new names differ
/// only in where an underscore stands.
Names freshNames(const Description& description, std::uint64_t seed)
{
  std::set<std::string> old;
  for (const Sort& sort : description.sorts)
  {
    old.insert(sort.name);
    old.insert(sort.elements.begin(), sort.elements.end());
  }
  for (const FluentDeclaration& fluent : description.fluents)
  {
    old.insert(fluent.name);
  }
  for (const ActionDeclaration& action : description.actions)
  {
    old.insert(action.name);
  }
  for (const Default& rule : description.defaults)
  {
    old.insert(rule.name.name);
  }
  for (const CausalLaw& law : description.causal_laws)
  {
    for (const Outcome& outcome : law.outcomes)
    {
      old.insert(outcome.label);
    }
  }
  std::mt19937_64 random(seed);
  std::vector<std::string> fresh;
  for (std::size_t i = 0; i < old.size(); ++i)
  {
    std::string name = "n" + std::to_string(i / 2);
    name.insert(i % 2 == 0 ? 1 : name.size(), "_");
    fresh.push_back(name + "z");
  }
  std::shuffle(fresh.begin(), fresh.end(), random);
  Names names;
  for (const std::string& name : old)
  {
    const bool is_number = name.find_first_not_of("0123456789") == std::string::npos;
    if (!name.empty() && !is_number)
    {
      names[name] = fresh.back();
    }
    fresh.pop_back();
  }
  return names;
}

/// Statements with their old names, in a canonical order.
std::string listOf(const std::vector<std::string>& statements, const Names& old)
{
  std::set<std::string> sorted;
  for (const std::string& statement : statements)
  {
    sorted.insert(renamed(statement, old));
  }
  std::string text;
  for (const std::string& statement : sorted)
  {
    text += statement + "; ";
  }
  return text;
}

/// Everything that a reasoner says about its history, with the old names.
std::set<std::string> answersOf(const Reasoner& reasoner, const Names& old)
{
  const Diagnosis diagnosis = reasoner.diagnose();
  std::set<std::string> answers = {"cost " + std::to_string(diagnosis.cost)};
  for (const auto& explanation : diagnosis.explanations)
  {
    answers.insert("because " + listOf(explanation, old));
  }
  for (int step = 0; diagnosis.consistent && step <= reasoner.currentStep(); ++step)
  {
    for (const Literal& literal : reasoner.entailedAt(step))
    {
      answers.insert(std::to_string(step) + ": " + renamed(toString(literal), old));
    }
  }
  return answers;
}

/// What the plans for a goal have in common, however ties are broken.
std::set<std::string> plansOf(const Reasoner& reasoner, const std::string& goal, const Names& old)
{
  PlanOptions options;
  options.max_horizon = 3;
  const PlanResult result = reasoner.plan(goal, options);
  std::set<std::string> answers = {result.goal_entailed ? "entailed" : "not entailed"};
  for (const Plan& plan : result.plans)
  {
    answers.insert(std::to_string(plan.steps.size()) + " steps if " + listOf(plan.hypothesis, old));
  }
  return answers;
}

void compareRenamed(const Description& description, const std::string& history, std::uint64_t seed,
                    const std::vector<std::string>& goals)
{
  const Names names = freshNames(description, seed);
  const std::string other = renamed(toString(description), names);
  SCOPED_TRACE(other + "---- history\n" + history);
  const Reasoner original = reasonerOfTexts(toString(description), history);
  const Reasoner copy = reasonerOfTexts(other, renamed(history, names));
  Names old;
  for (const auto& [name, fresh] : names)
  {
    old[fresh] = name;
  }
  EXPECT_EQ(answersOf(original, {}), answersOf(copy, old));
  if (original.diagnose().consistent)
  {
    for (const std::string& goal : goals)
    {
      EXPECT_EQ(plansOf(original, goal, {}), plansOf(copy, renamed(goal, names), old)) << goal;
    }
  }
}

/// A few values of fluents, as goals.
std::vector<std::string> someGoals(const Description& description, std::uint64_t seed, int count)
{
  const oracle::GroundDomain domain = oracle::grounded(description);
  std::mt19937_64 random(seed);
  std::vector<std::string> goals;
  for (int i = 0; i < count; ++i)
  {
    const std::size_t fluent = random() % domain.fluents.size();
    const auto value = static_cast<int>(random() % domain.fluents[fluent].values.size());
    goals.push_back(
        oracle::toString(oracle::GroundLiteral{static_cast<int>(fluent), value, true}, domain));
  }
  return goals;
}

class Renaming : public testing::TestWithParam<std::string>
{
};

TEST_P(Renaming, ChangesNothingButTheNames)
{
  const Description description = readDescription(GetParam());
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
  {
    compareRenamed(description, randomHistory(description, seed, 1, 4), seed,
                   someGoals(description, seed, 2));
  }
}

INSTANTIATE_TEST_SUITE_P(ShippedDomains, Renaming, testing::ValuesIn(shippedDomains()));

TEST(RenamingOfRandomDomains, ChangesNothingButTheNames)
{
  forEachCase({1, 10}, {}, [](const RandomCase& drawn, std::uint64_t seed) {
    const Description description = parseDescription(drawn.description, "random");
    compareRenamed(description, drawn.history, seed, someGoals(description, seed, 1));
  });
}

}  // namespace
}  // namespace kr3::reasoner
