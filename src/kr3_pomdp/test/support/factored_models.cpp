#include "support/factored_models.hpp"

#include <random>
#include <string>
#include <utility>
#include <vector>

namespace kr3::pomdp::test
{

namespace
{

double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

Variable variable(const std::string& name, std::size_t num_values)
{
  Variable result{name, {}};
  for (std::size_t i = 0; i < num_values; ++i)
  {
    result.values.push_back(name.substr(0, 1) + std::to_string(i));
  }
  return result;
}

Factor randomFactor(const FactoredModel& model, std::vector<VariableRef> parents, VariableRef of,
                    std::mt19937_64& random)
{
  Factor factor{std::move(parents), {of}, {}};
  const std::size_t width = model.variable(of).values.size();
  const std::size_t rows = model.sizeOf(factor) / width;
  for (std::size_t row = 0; row < rows; ++row)
  {
    std::vector<double> weights(width);
    double sum = 0.0;
    for (double& weight : weights)
    {
      weight = uniform(random) < 0.3 ? 0.0 : uniform(random);
      sum += weight;
    }
    if (sum == 0.0)
    {
      weights[random() % width] = sum = 1.0;
    }
    for (const double weight : weights)
    {
      factor.values.push_back(weight / sum);
    }
  }
  return factor;
}

Factor randomReward(const FactoredModel& model, std::vector<VariableRef> parents,
                    std::mt19937_64& random)
{
  Factor factor{std::move(parents), {}, {}};
  factor.values.resize(model.sizeOf(factor));
  for (double& value : factor.values)
  {
    value = 2.0 * uniform(random) - 1.0;
  }
  return factor;
}

}  // namespace

FactoredModel randomFactored(std::uint64_t seed)
{
  constexpr VariableRole kBefore = VariableRole::kPrevious;
  constexpr VariableRole kAfter = VariableRole::kCurrent;
  constexpr VariableRef kAct{VariableRole::kAction, 0};
  std::mt19937_64 random(seed);
  FactoredModel model;
  model.discount = 0.8;
  model.state = {{variable("place", 2), true},
                 {variable("mood", 3), false},
                 {variable("tool", 3), true},
                 {variable("goal", 2), false}};
  model.actions = {variable("act", 3)};
  model.observations = {variable("hear", 2), variable("feel", 3)};
  for (std::size_t v = 0; v < model.state.size(); ++v)
  {
    model.initial.push_back(randomFactor(model, {}, {kBefore, v}, random));
    model.transitions.push_back(randomFactor(
        model, {kAct, {kBefore, v}, {kBefore, (v + 1) % model.state.size()}}, {kAfter, v}, random));
  }
  model.observing = {
      randomFactor(model, {kAct, {kAfter, 1}}, {VariableRole::kObservation, 0}, random),
      randomFactor(model, {{kAfter, 3}, {kAfter, 0}}, {VariableRole::kObservation, 1}, random)};
  model.rewards = {randomReward(model, {kAct, {kBefore, 1}}, random),
                   randomReward(model, {{kBefore, 2}, {kBefore, 3}}, random)};
  return model;
}

}  // namespace kr3::pomdp::test
