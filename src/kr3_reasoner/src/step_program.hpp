#pragma once

#include <vector>

#include "ground_program.hpp"

namespace kr3::reasoner
{

/// What a description says of one state and of one transition, ground: rules over atoms for the
/// state before, the actions and the state now. That every fluent has one value, that it keeps it,
/// and that what is impossible does not occur are left to the user of it. Private to the package.
struct StepProgram
{
  using AtomId = GroundProgram::AtomId;

  /// An occurrence of the action costs at least this much when the atom is true.
  struct Price
  {
    long cost_milli;
    AtomId atom;
  };

  /// The atom of a nondeterministic law's outcome being taken for an instance of its action.
  struct OutcomeAtom
  {
    std::size_t law;
    std::size_t outcome;
    int action;
    AtomId atom;
  };

  GroundProgram state;          ///< constraints and definitions, of the state now
  GroundProgram effects;        ///< causal laws and joint executability conditions
  GroundProgram executability;  ///< of the state before
  GroundProgram prices;         ///< of the state before

  /// By number of the value in Signature, then further atoms that last from step to step; 0: none.
  std::vector<AtomId> before;
  std::vector<AtomId> now;
  /// By number of the action; 0: nothing speaks of it.
  std::vector<AtomId> occurs;
  std::vector<AtomId> impossible;
  std::vector<std::vector<Price>> prices_of;
  std::vector<OutcomeAtom> outcomes;
};

}  // namespace kr3::reasoner
