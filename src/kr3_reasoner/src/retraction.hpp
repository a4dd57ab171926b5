#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "kr3_reasoner/explanation.hpp"
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

/// Whether what a record says is against a literal. Both normalized.
[[nodiscard]] bool contradicts(const Literal& recorded, const Literal& wanted);

/// Records that are given up, with their log-odds and in words.
/// @param opens  what becomes possible; empty: the history is consistent
[[nodiscard]] Retraction retractionOf(const std::vector<Record>& history,
                                      std::vector<std::size_t> records, std::string opens);

}  // namespace kr3::reasoner
