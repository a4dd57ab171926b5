#include "ground_solving.hpp"

#include <string>

namespace kr3::reasoner
{

namespace
{

std::vector<std::string> argumentsFor(std::uint64_t seed)
{
  constexpr std::uint64_t kSeeds = 1000000;
  return {"0", "--warn=none", "--project=project", "--rand-freq=" + std::string(seed ? "0.5" : "0"),
          "--seed=" + std::to_string(seed % kSeeds)};
}

Clingo::Control controlFor(std::uint64_t seed)
{
  const std::vector<std::string> arguments = argumentsFor(seed);
  std::vector<const char*> pointers;
  for (const std::string& argument : arguments)
  {
    pointers.push_back(argument.c_str());
  }
  return Clingo::Control({pointers.data(), pointers.size()});
}

}  // namespace

GroundSolving::GroundSolving(std::uint64_t seed) : control_(controlFor(seed)) {}

void GroundSolving::add(const GroundProgram& program)
{
  Clingo::Backend backend = control_.backend();
  for (const GroundProgram::Rule& rule : program.rules())
  {
    const auto heads = program.heads(rule);
    if (rule.conjunction)
    {
      std::vector<Clingo::literal_t> body;
      for (const auto& literal : program.body(rule))
      {
        body.push_back(literal.literal);
      }
      backend.rule(rule.choice, {heads.begin(), heads.size()}, {body.data(), body.size()});
      continue;
    }
    std::vector<Clingo::WeightedLiteral> body;
    for (const auto& literal : program.body(rule))
    {
      body.emplace_back(literal.literal, literal.weight);
    }
    backend.weight_rule(rule.choice, {heads.begin(), heads.size()}, rule.bound,
                        {body.data(), body.size()});
  }
}

void GroundSolving::addFact(GroundProgram::AtomId atom)
{
  control_.backend().rule(false, {&atom, 1}, {});
}

void GroundSolving::addChoice(GroundProgram::AtomId atom)
{
  control_.backend().rule(true, {&atom, 1}, {});
}

void GroundSolving::addExactlyOne(const std::vector<GroundProgram::AtomId>& atoms)
{
  Clingo::Backend backend = control_.backend();
  std::vector<Clingo::literal_t> none;
  std::vector<Clingo::WeightedLiteral> weighted;
  for (const GroundProgram::AtomId atom : atoms)
  {
    none.push_back(-static_cast<Clingo::literal_t>(atom));
    weighted.emplace_back(static_cast<Clingo::literal_t>(atom), 1);
  }
  backend.rule(false, {}, {none.data(), none.size()});
  backend.weight_rule(false, {}, 2, {weighted.data(), weighted.size()});
}

std::set<TrueAtoms> GroundSolving::solve(const std::vector<GroundProgram::AtomId>& shown,
                                         const std::vector<std::int32_t>& assumed,
                                         std::size_t limit)
{
  control_.with_backend([&](Clingo::Backend& backend) {
    backend.project({shown.data(), shown.size()});
  });
  std::set<TrueAtoms> found;
  for (const Clingo::Model& model :
       control_.solve(Clingo::LiteralSpan(assumed.data(), assumed.size())))
  {
    TrueAtoms atoms;
    for (const GroundProgram::AtomId atom : shown)
    {
      if (model.is_true(static_cast<Clingo::literal_t>(atom)))
      {
        atoms.insert(atom);
      }
    }
    found.insert(std::move(atoms));
    if (found.size() == limit)
    {
      break;
    }
  }
  return found;
}

}  // namespace kr3::reasoner
