#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "kr3_executive/low_level_memory.hpp"

// The low level's memory as JSON, in recordings and in the file of what is known.
namespace kr3::executive
{

[[nodiscard]] inline nlohmann::json toJson(const LowLevelMemory& memory)
{
  nlohmann::json item = nlohmann::json::object();
  for (const auto& [fluent, remembered] : memory)
    item[fluent] = {
        {"values", remembered.values}, {"assumed", remembered.assumed}, {"odds", remembered.odds}};
  return item;
}

/// @param source  where it is from, for messages
/// @throws InvalidArgument            odds out of range
/// @throws nlohmann::json::exception  a key is missing or of another type
[[nodiscard]] inline LowLevelMemory memoryFromJson(const nlohmann::json& item,
                                                   const std::string& source)
{
  LowLevelMemory memory;
  for (const auto& [fluent, remembered] : item.items())
  {
    const double odds = remembered.value("odds", 1.0);  // recordings of before have none
    if (!(odds > 0.0 && odds <= 1.0))
      throw InvalidArgument(source + ": odds " + std::to_string(odds) + " of " + fluent +
                            " in the memory, expected (0, 1]");
    memory[fluent] = {remembered.at("values").get<refinement::Distribution>(),
                      remembered.at("assumed").get<std::string>(), odds};
  }
  return memory;
}

}  // namespace kr3::executive
