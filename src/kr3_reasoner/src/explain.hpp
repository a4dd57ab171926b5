#pragma once

#include <vector>

#include "models.hpp"

namespace kr3::reasoner
{

/// Why an entailed literal holds at a step. The records cited are a minimal set that suffices.
[[nodiscard]] Explanation explained(const Description& description, const ReasonerOptions& options,
                                    const HistoryProgram& program,
                                    const std::vector<CheckedRecord>& records,
                                    const Optimum& optimum, const Literal& literal, int step);

}  // namespace kr3::reasoner
