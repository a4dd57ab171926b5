#pragma once

#include <kr3_reasoner/reasoner.hpp>

#include "yaml_reader.hpp"

namespace kr3::executive
{

/// One record of a list `initial_records`: kind, statement, value, step, confidence. What is wrong
/// with it becomes a problem of the reader.
[[nodiscard]] reasoner::Record readRecord(YamlReader& reader, const YAML::Node& node,
                                          const reasoner::Description& high_level);

}  // namespace kr3::executive
