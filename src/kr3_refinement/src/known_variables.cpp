#include "known_variables.hpp"

#include <map>
#include <unordered_map>

namespace kr3::refinement
{
namespace
{

using Labels = std::vector<std::vector<std::uint32_t>>;

/// Removes from `known` what two states that look alike differ in. @return whether anything was
bool removeDifferences(const Labels& labels, std::size_t a, std::size_t b, std::vector<bool>& known)
{
  bool removed = false;
  for (std::size_t variable = 0; variable < known.size(); ++variable)
  {
    if (known[variable] && labels[a][variable] != labels[b][variable])
    {
      known[variable] = false;
      removed = true;
    }
  }
  return removed;
}

/// Numbers states by the values of the known variables.
std::vector<std::uint64_t> classes(const Labels& labels, const std::vector<bool>& known)
{
  std::map<std::vector<std::uint32_t>, std::uint64_t> numbers;
  std::vector<std::uint64_t> result;
  for (const std::vector<std::uint32_t>& of_state : labels)
  {
    std::vector<std::uint32_t> key;
    for (std::size_t variable = 0; variable < known.size(); ++variable)
    {
      if (known[variable])
      {
        key.push_back(of_state[variable]);
      }
    }
    result.push_back(numbers.try_emplace(std::move(key), numbers.size()).first->second);
  }
  return result;
}

}  // namespace

std::vector<bool> reachableStates(const pomdp::Model& model)
{
  std::vector<bool> reached(model.numStates(), false);
  std::vector<std::size_t> open;
  const auto reach = [&](std::size_t state) {
    if (!reached[state])
    {
      reached[state] = true;
      open.push_back(state);
    }
  };
  for (std::size_t state = 0; state < model.numStates(); ++state)
  {
    if (model.initialBelief()[state] > 0.0)
    {
      reach(state);
    }
  }
  while (!open.empty())
  {
    const std::size_t state = open.back();
    open.pop_back();
    for (std::size_t action = 0; action < model.numActions(); ++action)
    {
      for (const pomdp::SparseEntry& next : model.transitions(action, state))
      {
        reach(next.index);
      }
    }
  }
  return reached;
}

std::vector<bool> knownVariables(const pomdp::Model& model, const Labels& labels)
{
  std::vector<bool> known(labels.front().size(), true);
  std::size_t first = model.numStates();
  for (std::size_t state = 0; state < model.numStates(); ++state)
  {
    if (model.initialBelief()[state] > 0.0)
    {
      first = first == model.numStates() ? state : first;
      removeDifferences(labels, first, state, known);
    }
  }
  const std::vector<bool> reached = reachableStates(model);
  for (bool changed = true; changed;)
  {
    changed = false;
    const std::vector<std::uint64_t> class_of = classes(labels, known);
    for (std::size_t action = 0; action < model.numActions(); ++action)
    {
      std::unordered_map<std::uint64_t, std::size_t> seen;  // a state for each class, observation
      for (std::size_t state = 0; state < model.numStates(); ++state)
      {
        if (!reached[state])
        {
          continue;
        }
        for (const pomdp::SparseEntry& next : model.transitions(action, state))
        {
          for (const pomdp::SparseEntry& observed : model.observations(action, next.index))
          {
            const std::uint64_t key = class_of[state] * model.numObservations() + observed.index;
            const std::size_t like = seen.try_emplace(key, next.index).first->second;
            changed = removeDifferences(labels, like, next.index, known) || changed;
          }
        }
      }
    }
  }
  return known;
}

}  // namespace kr3::refinement
