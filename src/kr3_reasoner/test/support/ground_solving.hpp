#pragma once

#include <random>
#include <set>
#include <vector>

#include "../../src/ground_program.hpp"

namespace kr3::reasoner
{

/// Atoms that are true in an answer set.
using TrueAtoms = std::set<GroundProgram::AtomId>;

/// Ground programs solved by plain clingo.
class GroundSolving
{
public:
  explicit GroundSolving(std::uint64_t seed = 0);

  void add(const GroundProgram& program);
  void addFact(GroundProgram::AtomId atom);
  /// The atom may be true or false; or, as an input, it is what assumptions make it.
  void addChoice(GroundProgram::AtomId atom);
  /// Exactly one of these is true.
  void addExactlyOne(const std::vector<GroundProgram::AtomId>& atoms);

  /// The answer sets, each restricted to these atoms.
  /// @param assumed  literals that hold
  /// @param limit    the largest number of answer sets, 0 for all
  std::set<TrueAtoms> solve(const std::vector<GroundProgram::AtomId>& shown,
                            const std::vector<std::int32_t>& assumed = {}, std::size_t limit = 0);

private:
  Clingo::Control control_;
};

}  // namespace kr3::reasoner
