#include "observation_channels.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace kr3::refinement
{
namespace
{

/// The part of an observation's name that one law tells.
std::string partOf(const std::string& observation, std::size_t part)
{
  std::size_t begin = 0;
  for (; part > 0; --part)
  {
    begin = observation.find(',', begin) + 1;
  }
  return observation.substr(begin, observation.find(',', begin) - begin);
}

}  // namespace

ObservationChannel::ObservationChannel(const PomdpTask& task, std::string name,
                                       const std::vector<std::size_t>& part)
  : task_(&task), variable_{std::move(name), {kNoObservation}}
{
  const pomdp::Model& model = task.model();
  std::map<std::string, std::size_t> numbers{{kNoObservation, 0}};
  for (std::size_t action = 0; action < model.numActions(); ++action)
  {
    std::vector<std::size_t>& values = value_of_.emplace_back(model.numObservations(), 0);
    if (part[action] == kSilent)
    {
      continue;
    }
    for (const std::size_t observation : task.observationsOf(action))
    {
      const std::string told = partOf(model.observationName(observation), part[action]);
      const auto [entry, is_new] = numbers.try_emplace(told, variable_.values.size());
      if (is_new)
      {
        variable_.values.push_back(told);
      }
      values[observation] = entry->second;
    }
  }
}

std::vector<double> ObservationChannel::told(std::size_t action, std::size_t state) const
{
  std::vector<double> result(variable_.values.size(), 0.0);
  for (const pomdp::SparseEntry& entry : task_->model().observations(action, state))
  {
    const bool silent = state == task_->doneState();
    result[silent ? 0 : value_of_[action][entry.index]] += entry.probability;
  }
  return result;
}

std::vector<ObservationChannel> observationChannels(const PomdpTask& task)
{
  const std::size_t num_actions = task.model().numActions();
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::size_t>> parts;
  for (std::size_t action = 0; action < num_actions; ++action)
  {
    std::map<std::string, std::size_t> uses;
    const std::vector<std::string>& fluents = task.observedFluents(action);
    for (std::size_t part = 0; part < fluents.size(); ++part)
    {
      std::string name = "seen_" + fluents[part];
      name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
      const std::size_t use = ++uses[name];
      name += use > 1 ? "_" + std::to_string(use) : "";
      const auto [entry, is_new] =
          parts.try_emplace(name, num_actions, ObservationChannel::kSilent);
      if (is_new)
      {
        names.push_back(name);
      }
      entry->second[action] = part;
    }
  }
  std::vector<ObservationChannel> result;
  for (const std::string& name : names)
  {
    result.emplace_back(task, name, parts.at(name));
  }
  return result;
}

}  // namespace kr3::refinement
