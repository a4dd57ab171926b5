// Instances of small random programs have the answer sets that clingo finds for the program with
// its inputs fixed, whether the inputs are constants or left to the solver.

#include "../src/partial_evaluator.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "support/ground_solving.hpp"

namespace kr3::reasoner
{
namespace
{

using AtomId = GroundProgram::AtomId;
using Body = std::vector<std::int32_t>;

std::uint64_t environment(const char* name, std::uint64_t otherwise)
{
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoull(text);
}

GroundProgram::Range<AtomId> oneAtom(const AtomId& atom)
{
  return {&atom, &atom + 1};
}

GroundProgram::Range<std::int32_t> range(const Body& body)
{
  return {body.data(), body.data() + body.size()};
}

/// A program over inputs, groups of which exactly one atom is true, and further atoms.
struct RandomProgram
{
  explicit RandomProgram(std::uint64_t seed) : random(seed)
  {
    const AtomId num_free = between(1, 3);
    num_inputs = num_free;
    const AtomId num_groups = between(0, 2);
    for (AtomId g = 0; g < num_groups; ++g)
    {
      groups.emplace_back(between(2, 3));
      befores.emplace_back();
      for (std::size_t i = 0; i < groups.back().size(); ++i)
      {
        befores.back().push_back(++num_inputs);
      }
    }
    num_atoms = num_inputs;
    for (auto& group : groups)
    {
      for (AtomId& atom : group)
      {
        atom = ++num_atoms;
      }
    }
    num_atoms += between(1, 4);
    for (AtomId r = between(2, 10); r > 0; --r)
    {
      addRule();
    }
    frame_begin = program.rules().size();
    for (std::size_t g = 0; g < groups.size(); ++g)
    {
      for (std::size_t i = 0; i < groups[g].size(); ++i)
      {
        program.addRule(true, oneAtom(groups[g][i]),
                        range({static_cast<std::int32_t>(befores[g][i])}));
      }
    }
    // so that the program knows all atoms
    program.addRule(
        false, {nullptr, nullptr},
        range({static_cast<std::int32_t>(num_atoms), -static_cast<std::int32_t>(num_atoms)}));
  }

  AtomId between(AtomId low, AtomId high)
  {
    return low + static_cast<AtomId>(random() % (high - low + 1));
  }
  bool chance(double probability)
  {
    return static_cast<double>(random() % 1000) < probability * 1e3;
  }

  std::int32_t literal()
  {
    const auto atom = static_cast<std::int32_t>(between(1, num_atoms));
    return chance(0.35) ? -atom : atom;
  }

  void addRule()
  {
    Body body;
    for (AtomId i = between(0, 3); i > 0; --i)
    {
      body.push_back(literal());
    }
    const AtomId head = between(num_inputs + 1, num_atoms);
    if (chance(0.15))
    {
      program.addRule(false, {nullptr, nullptr}, range(body));
    }
    else if (chance(0.15) && !body.empty())
    {
      std::vector<GroundProgram::BodyLiteral> weighted;
      for (const std::int32_t each : body)
      {
        weighted.push_back({each, static_cast<std::int32_t>(between(1, 2))});
      }
      // No choices: clasp loses answer sets where such a choice is in a positive cycle.
      program.addWeightRule(false, oneAtom(head), static_cast<std::int32_t>(between(1, 3)),
                            {weighted.data(), weighted.data() + weighted.size()});
    }
    else
    {
      program.addRule(chance(0.3), oneAtom(head), range(body));
    }
  }

  std::mt19937_64 random;
  AtomId num_inputs = 0;
  AtomId num_atoms = 0;
  std::size_t frame_begin = 0;
  std::vector<std::vector<AtomId>> groups;
  std::vector<std::vector<AtomId>> befores;  // by group: inputs of which one is true
  GroundProgram program;
};

std::vector<AtomId> atomsOf(const RandomProgram& drawn)
{
  std::vector<AtomId> atoms;
  for (AtomId atom = 1; atom <= drawn.num_atoms; ++atom)
  {
    atoms.push_back(atom);
  }
  return atoms;
}

std::set<TrueAtoms> expected(const RandomProgram& drawn, const std::vector<SolverLiteral>& inputs)
{
  GroundSolving solving;
  solving.add(drawn.program);
  for (AtomId input = 1; input <= drawn.num_inputs; ++input)
  {
    if (inputs[input] == kTrueLiteral)
    {
      solving.addFact(input);
    }
    else if (inputs[input] != kFalseLiteral)
    {
      solving.addChoice(input);
    }
  }
  for (const auto* sets : {&drawn.groups, &drawn.befores})
  {
    for (const auto& group : *sets)
    {
      solving.addExactlyOne(group);
    }
  }
  return solving.solve(atomsOf(drawn));
}

/// @param inputs  by atom: a constant, or kOpen for one that the solver chooses
std::set<TrueAtoms> instantiated(const RandomProgram& drawn, PartialEvaluator& evaluator,
                                 const std::vector<SolverLiteral>& inputs)
{
  Clingo::Control control{{"0", "--warn=none", "--project=project"}};
  std::vector<SolverLiteral> values(evaluator.program().numAtoms() + 1, PartialEvaluator::kOpen);
  {
    RuleSink sink(control);
    for (AtomId input = 1; input <= drawn.num_inputs; ++input)
    {
      values[input] = inputs[input] == PartialEvaluator::kOpen ? sink.newChoice() : inputs[input];
    }
    for (const auto& before : drawn.befores)
    {
      RuleSink::Body literals;
      for (const AtomId input : before)
      {
        literals.push_back(values[input]);
      }
      if (values[before.front()] != kTrueLiteral && values[before.front()] != kFalseLiteral)
      {
        sink.atLeastOne(literals);
        sink.atMostOne(literals);
      }
    }
    evaluator.instantiate(values, sink);
  }
  std::vector<Clingo::atom_t> shown;
  for (AtomId atom = 1; atom <= drawn.num_atoms; ++atom)
  {
    if (!isConstant(values[atom]))
    {
      shown.push_back(static_cast<Clingo::atom_t>(std::abs(values[atom])));
    }
  }
  control.with_backend([&](Clingo::Backend& backend) {
    backend.project({shown.data(), shown.size()});
  });
  std::set<TrueAtoms> found;
  for (const Clingo::Model& model : control.solve())
  {
    TrueAtoms atoms;
    for (AtomId atom = 1; atom <= drawn.num_atoms; ++atom)
    {
      if (values[atom] == kTrueLiteral ||
          (values[atom] != kFalseLiteral && model.is_true(values[atom])))
      {
        atoms.insert(atom);
      }
    }
    found.insert(std::move(atoms));
  }
  return found;
}

/// The program for messages, a rule a line.
std::string toString(const RandomProgram& drawn)
{
  std::string text = std::to_string(drawn.num_inputs) + " inputs";
  for (std::size_t g = 0; g < drawn.groups.size(); ++g)
  {
    text += ", exactly one of";
    for (std::size_t i = 0; i < drawn.groups[g].size(); ++i)
    {
      text += " " + std::to_string(drawn.groups[g][i]) + " (before " +
              std::to_string(drawn.befores[g][i]) + ")";
    }
  }
  for (const GroundProgram::Rule& rule : drawn.program.rules())
  {
    text += rule.choice ? "\n{" : "\n";
    for (const AtomId head : drawn.program.heads(rule))
    {
      text += std::to_string(head);
    }
    text += (rule.choice ? "} :- " : " :- ") + std::to_string(rule.bound) + " <=";
    for (const auto& literal : drawn.program.body(rule))
    {
      text += " " + std::to_string(literal.literal) + "*" + std::to_string(literal.weight);
    }
  }
  return text;
}

TEST(PartialEvaluator, KeepsTheAnswerSetsOfRandomPrograms)
{
  const std::uint64_t first = environment("KR3_REASONER_SEED", 1);
  const std::uint64_t cases = environment("KR3_REASONER_CASES", 60) * 10;
  for (std::uint64_t seed = first; seed < first + cases && !HasFatalFailure(); ++seed)
  {
    RandomProgram drawn(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + toString(drawn));
    PartialEvaluator evaluator(drawn.program, drawn.frame_begin, drawn.groups);
    for (int round = 0; round < 4; ++round)  // the same evaluator, other inputs
    {
      std::vector<SolverLiteral> inputs(drawn.num_inputs + 1, PartialEvaluator::kOpen);
      for (AtomId input = 1; input <= drawn.num_inputs; ++input)
      {
        const bool open = round == 3 || (round == 2 && drawn.chance(0.5));
        inputs[input] = open                ? PartialEvaluator::kOpen
                        : drawn.chance(0.5) ? kTrueLiteral
                                            : kFalseLiteral;
      }
      for (const auto& before : drawn.befores)
      {
        const bool open = round == 3 || (round == 2 && drawn.chance(0.5));
        const std::size_t held = drawn.random() % before.size();
        for (std::size_t i = 0; i < before.size(); ++i)
        {
          inputs[before[i]] = open        ? PartialEvaluator::kOpen
                              : i == held ? kTrueLiteral
                                          : kFalseLiteral;
        }
      }
      ASSERT_EQ(instantiated(drawn, evaluator, inputs), expected(drawn, inputs));
    }
  }
}

TEST(PartialEvaluator, WritesNothingWhenTheInputsDecide)
{
  // 1, 2: inputs; 3 follows from both, 4 from the absence of 3.
  GroundProgram program;
  const AtomId three = 3;
  const AtomId four = 4;
  program.addRule(false, oneAtom(three), range({1, 2}));
  program.addRule(false, oneAtom(four), range({-3}));
  PartialEvaluator evaluator(program, program.rules().size(), {});
  Clingo::Control control;
  RuleSink sink(control);
  std::vector<SolverLiteral> values = {0, kTrueLiteral, kFalseLiteral, 0, 0};
  evaluator.instantiate(values, sink);
  EXPECT_EQ(values[three], kFalseLiteral);
  EXPECT_EQ(values[four], kTrueLiteral);
  EXPECT_EQ(sink.numRules(), 0U);
  EXPECT_EQ(sink.numAtoms(), 0U);
}

TEST(PartialEvaluator, RenamesWhatOnlyInertiaSupports)
{
  // 1, 2: the values before, of which one holds; 3, 4: the values now.
  GroundProgram program;
  const AtomId three = 3;
  const AtomId four = 4;
  program.addRule(true, oneAtom(three), range({1}));
  program.addRule(true, oneAtom(four), range({2}));
  PartialEvaluator evaluator(program, 0, {{three, four}});
  Clingo::Control control;
  RuleSink sink(control);
  const SolverLiteral before = sink.newChoice();
  std::vector<SolverLiteral> values = {0, before, -before, 0, 0};
  evaluator.instantiate(values, sink);
  EXPECT_EQ(values[three], before);
  EXPECT_EQ(values[four], -before);
}

}  // namespace
}  // namespace kr3::reasoner
