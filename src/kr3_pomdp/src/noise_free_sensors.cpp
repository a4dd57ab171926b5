#include "noise_free_sensors.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace kr3::pomdp
{

Model withNoiseFreeSensors(const Model& model)
{
  SharedRowsBuilder rows;
  rows.reserve(model.numActions() * model.numStates());
  std::size_t num_groups = 0;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    std::unordered_map<const SparseEntry*, std::uint32_t> groups;  // equal rows are one in memory
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      const auto next = static_cast<std::uint32_t>(groups.size());
      const auto group = groups.emplace(model.observations(a, s).begin(), next).first->second;
      rows.append({{group, 1.0}});
    }
    num_groups = std::max(num_groups, groups.size());
  }
  std::vector<std::string> names;
  names.reserve(num_groups);
  for (std::size_t i = 0; i < num_groups; ++i)
  {
    names.push_back("group" + std::to_string(i));
  }
  return model.withObservations(std::move(names), rows.take());
}

}  // namespace kr3::pomdp
