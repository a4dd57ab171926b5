#pragma once

#include <string>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>

namespace kr3::executive
{

/// What the executive reads of a domain's scenario.yaml. Other keys are other programs' business.
struct Scenario
{
  std::vector<reasoner::Record> initial_records;
  std::string goal;    ///< the default goal; may be empty
  std::string target;  ///< the object that the goal is about; may be empty
};

/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  one line "file:line: message" for each problem
[[nodiscard]] Scenario readScenario(const std::string& path,
                                    const reasoner::Description& high_level);
[[nodiscard]] Scenario parseScenario(const std::string& text, const std::string& file,
                                     const reasoner::Description& high_level);

}  // namespace kr3::executive
