// Local programs that differ in names and order only share one table, which says the same of each.

#include "../src/local_table.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "../src/canonical_program.hpp"

namespace kr3::reasoner
{
namespace
{

constexpr TableLimits kLimits{1000, 16};

/// A fluent of several values that a move may change: unless it is lost it goes where it is sent,
/// and stays where it is when that fails, which costs.
LocalProgram moveProgram(std::size_t num_values)
{
  LocalProgram program;
  const auto n = static_cast<Clingo::atom_t>(num_values);
  const auto before = [](Clingo::atom_t value) { return static_cast<SolverLiteral>(1 + value); };
  const auto after = [n](Clingo::atom_t value) {
    return static_cast<SolverLiteral>(1 + n + value);
  };
  const auto failed = static_cast<SolverLiteral>(1 + 2 * n);
  const auto rule = [&](bool choice, SolverLiteral head, std::vector<SolverLiteral> body) {
    LocalProgram::Rule added{choice, true, static_cast<std::int32_t>(body.size()), {}, {}};
    if (head != kFalseLiteral)
    {
      added.heads.push_back(static_cast<Clingo::atom_t>(head));
    }
    for (const SolverLiteral literal : body)
    {
      added.body.emplace_back(literal, 1);
    }
    program.rules.push_back(std::move(added));
  };
  program.num_atoms = 1 + 2 * n;
  program.fluents.emplace_back();
  LocalProgram::Rule several{false, false, 2, {}, {}};
  std::vector<SolverLiteral> none;
  for (Clingo::atom_t value = 0; value < n; ++value)
  {
    rule(true, before(value), {});
    several.body.emplace_back(before(value), 1);
    none.push_back(-before(value));
    rule(false, after(value), {before(value), failed});
    rule(false, after(0), {before(value), -failed});
    program.fluents.back().push_back(after(value));
  }
  rule(true, failed, {});
  rule(false, kFalseLiteral, none);
  program.rules.push_back(several);
  program.assumptions.push_back({failed, 3, false});
  return program;
}

/// The same program under other names and in another order.
struct Shuffled
{
  LocalProgram program;
  std::vector<std::size_t> values;  // of the first fluent: where each one is now
};

Shuffled shuffled(const LocalProgram& program, std::mt19937& random)
{
  std::vector<Clingo::atom_t> names(program.num_atoms);
  std::iota(names.begin(), names.end(), 1U);
  std::shuffle(names.begin(), names.end(), random);
  const auto renamed = [&](SolverLiteral literal) {
    const auto name =
        static_cast<SolverLiteral>(names[static_cast<std::size_t>(std::abs(literal)) - 1]);
    return literal < 0 ? -name : name;
  };
  Shuffled result{program, {}};
  for (auto& rule : result.program.rules)
  {
    for (auto& head : rule.heads)
    {
      head = static_cast<Clingo::atom_t>(renamed(static_cast<SolverLiteral>(head)));
    }
    for (auto& literal : rule.body)
    {
      literal = Clingo::WeightedLiteral(renamed(literal.literal()), literal.weight());
    }
    std::shuffle(rule.body.begin(), rule.body.end(), random);
  }
  std::shuffle(result.program.rules.begin(), result.program.rules.end(), random);
  for (auto& assumption : result.program.assumptions)
  {
    assumption.literal = renamed(assumption.literal);
  }
  auto& literals = result.program.fluents.front();
  result.values.resize(literals.size());
  std::iota(result.values.begin(), result.values.end(), 0);
  std::shuffle(result.values.begin(), result.values.end(), random);
  for (std::size_t value = 0; value < result.values.size(); ++value)
  {
    literals[result.values[value]] = renamed(program.fluents.front()[value]);
  }
  return result;
}

TEST(LocalTables, SayWhatEachValueCosts)
{
  LocalTables tables(kLimits);
  const LocalTable table = tables.of(moveProgram(4), {});
  EXPECT_TRUE(table.complete);
  ASSERT_EQ(table.rows.size(), 4U);
  for (std::size_t value = 0; value < 4; ++value)
  {
    using Explanations = std::vector<std::vector<std::size_t>>;
    EXPECT_EQ(table.rows[value].values, std::vector<std::size_t>{value});
    EXPECT_EQ(table.rows[value].explanations, value == 0 ? Explanations{{}} : Explanations{{0}});
  }
}

TEST(LocalTables, ManyCombinationsHaveTheRowsOfFew)
{
  // 30 values, and a doubtful choice for each that all but multiplies the combinations.
  LocalProgram program = moveProgram(30);
  for (int i = 0; i < 30; ++i)
  {
    ++program.num_atoms;
    program.rules.push_back({true, true, 0, {program.num_atoms}, {}});
    program.assumptions.push_back({static_cast<SolverLiteral>(program.num_atoms), 1, true});
  }
  LocalTables tables(kLimits);
  const LocalTable few = tables.of(moveProgram(30), {});
  const LocalTable many = tables.of(program, {});
  ASSERT_EQ(many.rows.size(), few.rows.size());
  for (std::size_t i = 0; i < few.rows.size(); ++i)
  {
    EXPECT_EQ(many.rows[i].values, few.rows[i].values);
    EXPECT_EQ(many.rows[i].explanations, few.rows[i].explanations);
  }
}

TEST(CanonicalProgram, IsTheSameWhateverTheNamesAndTheOrder)
{
  std::mt19937 random(7);
  for (const std::size_t num_values : {1U, 2U, 5U, 20U})
  {
    const LocalProgram program = moveProgram(num_values);
    LocalTables tables(kLimits);
    const LocalTable table = tables.of(program, {});
    for (int i = 0; i < 20; ++i)
    {
      const Shuffled other = shuffled(program, random);
      EXPECT_EQ(CanonicalProgram(other.program).program().key(),
                CanonicalProgram(program).program().key());
      std::map<std::vector<std::size_t>, std::vector<std::vector<std::size_t>>> expected;
      for (const auto& row : table.rows)
      {
        expected[{other.values[row.values.front()]}] = row.explanations;
      }
      const LocalTable found = tables.of(other.program, {});
      ASSERT_EQ(found.rows.size(), expected.size());
      for (const auto& row : found.rows)
      {
        EXPECT_EQ(expected.at(row.values), row.explanations);
      }
    }
  }
}

TEST(CanonicalProgram, KeepsProgramsApart)
{
  LocalProgram dearer = moveProgram(5);
  dearer.assumptions.front().price = 4;
  LocalProgram laxer = moveProgram(5);
  laxer.rules.pop_back();
  std::set<std::string> keys;
  for (const LocalProgram& program : {moveProgram(5), moveProgram(6), dearer, laxer})
  {
    keys.insert(CanonicalProgram(program).program().key());
  }
  EXPECT_EQ(keys.size(), 4U);
}

}  // namespace
}  // namespace kr3::reasoner
