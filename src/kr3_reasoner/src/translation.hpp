#pragma once

#include <string>
#include <vector>

#include "history_program.hpp"
#include "models.hpp"

namespace kr3::reasoner
{

/// A plan that a printed program shall look for.
struct TranslatedGoal
{
  Formula formula;
  int length = 0;  ///< steps of the plan
};

/// The program of a history as one text that plain clingo solves: parts with a step for their
/// parameter become rules over all steps, and the minimal price becomes a bound. Private to the
/// package.
/// @param goal  or nullptr
[[nodiscard]] std::string translationOf(const Description& description,
                                        const HistoryProgram& program,
                                        const std::vector<CheckedRecord>& records, int current_step,
                                        const Optimum& optimum, const TranslatedGoal* goal);

/// A part's rules with a variable in place of its parameter: `h(F,V,t) :- b(t-1).` of `t` over
/// `time` becomes `h(F,V,_Step) :- b(_Step-1); time(_Step).` Comments stay where they are.
[[nodiscard]] std::string overAllSteps(const std::string& rules, const std::string& parameter,
                                       const std::string& range);

}  // namespace kr3::reasoner
