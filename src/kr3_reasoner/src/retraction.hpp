#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "models.hpp"

namespace kr3::reasoner
{

/// Sets of doubtful records without which the history has a model in which none
/// of `excluded` holds at `step`, in the order of their log-odds. Private to
/// the package.
///
/// @param excluded   literals; none: consistency is all that is asked
/// @param exogenous  whether models may have exogenous actions that nothing
/// records
/// @param accept     whether a set really serves, which the search alone does
/// not know: minimal
///                   explanations change with the records. No superset of an
///                   accepted set follows.
std::vector<std::vector<std::size_t>> retractionSets(
    const Description& description, const HistoryProgram& program,
    const std::vector<CheckedRecord>& records, int current_step,
    const std::vector<Literal>& excluded, int step, bool exogenous, std::size_t max_sets,
    const std::function<bool(const std::vector<std::size_t>&)>& accept);

}  // namespace kr3::reasoner
