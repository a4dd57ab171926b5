// Policies for a number of steps, and their text.

#include <algorithm>
#include <istream>
#include <numeric>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/finite_horizon.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr const char* kMagic = "kr3_horizon_policy";
constexpr int kVersion = 1;
/// The value of a plan where it says nothing.
constexpr double kNoValue = -1e300;

/// The vectors of a policy for overHorizon(), by step.
std::vector<std::vector<AlphaVector>> byStep(const Policy& staged, std::size_t horizon,
                                             std::size_t num_states)
{
  std::vector<std::vector<AlphaVector>> result(horizon);
  for (AlphaVector& vector : staged.alphaVectors())
  {
    if (vector.states.empty())
    {
      for (std::size_t step = 0; step < horizon; ++step)
      {
        const auto first = vector.values.begin() + static_cast<std::ptrdiff_t>(step * num_states);
        std::vector<double> values(first, first + static_cast<std::ptrdiff_t>(num_states));
        if (std::any_of(values.begin(), values.end(), [](double v) { return v > kNoValue; }))
        {
          result[step].push_back({vector.action, {}, std::move(values)});
        }
      }
      continue;
    }
    const std::size_t step = vector.states.front() / num_states;
    if (step != vector.states.back() / num_states)
    {
      throw InvalidArgument("a vector over states of steps " + std::to_string(step) + " and " +
                            std::to_string(vector.states.back() / num_states) +
                            ", expected one step");
    }
    if (step < horizon)
    {
      for (std::uint32_t& s : vector.states)
      {
        s -= static_cast<std::uint32_t>(step * num_states);
      }
      if (vector.states.size() == num_states)
      {
        vector.states.clear();
      }
      result[step].push_back(std::move(vector));
    }
  }
  return result;
}

}  // namespace

HorizonPolicy::HorizonPolicy(std::vector<Policy> steps) : steps_(std::move(steps))
{
  if (steps_.empty())
  {
    throw InvalidArgument("a policy for no steps, expected at least one");
  }
  for (const Policy& step : steps_)
  {
    if (step.numStates() != numStates())
    {
      throw InvalidArgument("policies of " + std::to_string(numStates()) + " and " +
                            std::to_string(step.numStates()) + " states for steps of one run");
    }
  }
}

HorizonPolicy::HorizonPolicy(const Policy& staged, std::size_t horizon)
{
  if (horizon == 0 || staged.numStates() <= horizon || (staged.numStates() - 1) % horizon != 0)
  {
    throw InvalidArgument("a policy over " + std::to_string(staged.numStates()) +
                          " states, expected some states for each of " + std::to_string(horizon) +
                          " steps, and one");
  }
  const std::size_t num_states = (staged.numStates() - 1) / horizon;
  for (const std::vector<AlphaVector>& vectors : byStep(staged, horizon, num_states))
  {
    steps_.emplace_back(num_states, vectors);
  }
}

HorizonPolicy::HorizonPolicy(const ExactSolution& solution)
  : HorizonPolicy(std::vector<Policy>(solution.stages.rbegin(), solution.stages.rend()))
{
}

Policy::Choice HorizonPolicy::bestAt(const Belief& belief, std::size_t step) const
{
  if (step >= horizon())
  {
    throw InvalidArgument("step " + std::to_string(step) + " of " + std::to_string(horizon()));
  }
  return steps_[step].bestAt(belief);
}

Policy HorizonPolicy::staged() const
{
  const std::size_t num_states = numStates();
  const std::size_t num_staged = num_states * horizon() + 1;
  // A policy has a vector over all states; no belief is spread over several steps, so it is not
  // used.
  std::vector<AlphaVector> vectors{{0, {}, std::vector<double>(num_staged, kNoValue)}};
  vectors.front().values.back() = 0.0;
  for (std::size_t step = 0; step < horizon(); ++step)
  {
    for (AlphaVector& vector : steps_[step].alphaVectors())
    {
      if (vector.states.empty())
      {
        vector.states.resize(num_states);
        std::iota(vector.states.begin(), vector.states.end(), 0U);
      }
      for (std::uint32_t& s : vector.states)
      {
        s += static_cast<std::uint32_t>(step * num_states);
      }
      vectors.push_back(std::move(vector));
    }
  }
  return Policy(num_staged, vectors);
}

void HorizonPolicy::write(std::ostream& out) const
{
  out << kMagic << ' ' << kVersion << "\nhorizon " << horizon() << '\n';
  staged().write(out);
}

HorizonPolicy HorizonPolicy::read(std::istream& in, const std::string& name)
{
  const auto header = [&](const std::string& key, int line_number) {
    std::string line;
    std::getline(in, line);
    std::istringstream words(line);
    std::string found;
    std::string rest;
    std::size_t value = 0;
    if (!(words >> found >> value) || found != key || words >> rest)
    {
      throw InvalidArgument(name + ":" + std::to_string(line_number) + ": found '" + line +
                            "', expected '" + key + "' and a number");
    }
    return value;
  };
  const std::size_t version = header(kMagic, 1);
  if (version != static_cast<std::size_t>(kVersion))
  {
    throw InvalidArgument(name + ":1: version " + std::to_string(version) + ", expected " +
                          std::to_string(kVersion));
  }
  const std::size_t horizon = header("horizon", 2);
  const Policy staged = Policy::read(in, name + " after line 2");
  try
  {
    return HorizonPolicy(staged, horizon);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(name + ": " + e.what());
  }
}

}  // namespace kr3::pomdp
