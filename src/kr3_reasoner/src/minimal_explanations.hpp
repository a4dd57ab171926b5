#pragma once

#include <vector>

#include "optimum.hpp"

namespace kr3::reasoner
{

/// What explains one part of a history, each a sorted list of the X that are assumed at a price.
struct PartExplanations
{
  Price price;
  std::vector<std::vector<Clingo::Symbol>> alternatives;
  bool complete = true;  ///< there are no others
};

/// The minimal explanations of a history: one of the alternatives of every part.
struct MinimalExplanations
{
  std::vector<PartExplanations> parts;              ///< none when nothing is assumed
  std::vector<std::vector<Clingo::Symbol>> wholes;  ///< put together, sorted
  bool complete = true;                             ///< there are no other wholes
};

[[nodiscard]] MinimalExplanations explanationsOf(const HistoryProgram& program,
                                                 const std::vector<CheckedRecord>& records,
                                                 int current_step, const Optimum& optimum);

}  // namespace kr3::reasoner
