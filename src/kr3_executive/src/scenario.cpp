#include "kr3_executive/scenario.hpp"

#include "record_reader.hpp"
#include "yaml_reader.hpp"

namespace kr3::executive
{
Scenario readScenario(const std::string& path, const reasoner::Description& high_level)
{
  return parseScenario(readTextFile(path), path, high_level);
}

Scenario parseScenario(const std::string& text, const std::string& file,
                       const reasoner::Description& high_level)
{
  YamlReader reader(text, file);
  Scenario scenario;
  reader.checkKeys(reader.root(), {"initial_records", "goal", "target", "placements"});
  scenario.goal = reader.optionalText(reader.root(), "goal");
  if (reader.root()["target"])
    scenario.target = reader.optionalText(reader.root()["target"], "object");
  for (const auto& node : reader.root()["initial_records"])
    scenario.initial_records.push_back(readRecord(reader, node, high_level));
  reader.finish();
  return scenario;
}

}  // namespace kr3::executive
