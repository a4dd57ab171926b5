#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// A reasoner for two texts in the language.
[[nodiscard]] Reasoner reasonerOfTexts(const std::string& description, const std::string& history,
                                       const ReasonerOptions& options = {});

/// Checks what a history means, a line for each expectation; failures are reported to gtest.
///
/// `cost 1`: the price of a minimal explanation. `because init(p, false); burst at 0`: one of the
/// minimal explanations; all are to be given. `true p at 0`, `false p at 0`, `unknown p at 0`: the
/// answer to a literal. `models 4`: their number. `inconsistent`. Whatever is expected, the answers
/// are compared with the enumeration of the definitions too, where the domain is small enough.
void expectOfHistory(const std::string& description, const std::string& history,
                     const std::vector<std::string>& expectations,
                     const ReasonerOptions& options = {});

/// Compares consistency, price, explanations, models and all answers of a reasoner with the
/// enumeration. @return false when the domain or the history is too large to enumerate
bool expectSameAsDefinitions(const Description& description, const std::vector<Record>& records,
                             const ReasonerOptions& options);

}  // namespace kr3::reasoner
