#include <algorithm>
#include <sstream>
#include <utility>

#include "kr3_pomdp/model_builder.hpp"
#include "models.hpp"

namespace kr3::pomdp::test
{

namespace
{

std::vector<std::string> names(const std::string& prefix, std::size_t count)
{
  std::vector<std::string> result;
  for (std::size_t i = 0; i < count; ++i)
  {
    result.push_back(prefix + std::to_string(i));
  }
  return result;
}

/// Draws the numbers of a model.
class Draw
{
public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double uniform() { return uniform_(random_); }
  double between(double least, double greatest) { return least + (greatest - least) * uniform(); }

  /// Over the entries `first`, `first + stride`, ... of `size`.
  std::vector<double> distribution(std::size_t size, double zeros, std::size_t first = 0,
                                   std::size_t stride = 1)
  {
    std::vector<double> result(size, 0.0);
    double sum = 0.0;
    for (std::size_t i = first; i < size; i += stride)
    {
      result[i] = uniform() < zeros ? 0.0 : uniform();
      sum += result[i];
    }
    if (sum == 0.0)
    {
      result[first] = sum = 1.0;
    }
    for (double& p : result)
    {
      p /= sum;
    }
    return result;
  }

private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

void setRows(ModelBuilder& builder, const RandomShape& shape, std::size_t a, std::size_t s,
             Draw& draw)
{
  std::vector<double> next = draw.distribution(shape.num_states, shape.zeros);
  if (shape.deterministic)
  {
    const auto top = std::max_element(next.begin(), next.end());
    std::fill(next.begin(), top, 0.0);
    std::fill(top + 1, next.end(), 0.0);
    *top = 1.0;
  }
  if (shape.absorbing && s + 1 == shape.num_states)
  {
    next.assign(shape.num_states, 0.0);
    next.back() = 1.0;
  }
  for (std::size_t i = 0; i < next.size(); ++i)
  {
    builder.setTransition(a, s, i, next[i]);
  }
  const std::vector<double> seen = draw.distribution(shape.num_observations, shape.zeros,
                                                     s % shape.num_classes, shape.num_classes);
  for (std::size_t i = 0; i < seen.size(); ++i)
  {
    builder.setObservation(a, s, i, seen[i]);
  }
}

void setRewards(ModelBuilder& builder, const RandomShape& shape, std::size_t a, std::size_t s,
                Draw& draw)
{
  const auto reward = [&] { return draw.between(shape.least_reward, shape.greatest_reward); };
  if (shape.absorbing && s + 1 == shape.num_states)
  {
    return;
  }
  builder.setReward(a, s, reward());
  if (shape.outcome_rewards)
  {
    for (std::size_t next = 0; next < shape.num_states; ++next)
    {
      for (std::size_t o = 0; o < shape.num_observations; ++o)
      {
        builder.setReward(a, s, next, o, reward());
      }
    }
  }
}

}  // namespace

Model randomModel(const RandomShape& shape, std::uint64_t seed)
{
  Draw draw(seed);
  ModelBuilder builder(names("s", shape.num_states), names("a", shape.num_actions),
                       names("o", shape.num_observations));
  builder.setDiscount(shape.discount);
  builder.setInitialBelief(draw.distribution(shape.num_states, shape.zeros));
  for (std::size_t a = 0; a < shape.num_actions; ++a)
  {
    for (std::size_t s = 0; s < shape.num_states; ++s)
    {
      setRows(builder, shape, a, s, draw);
      setRewards(builder, shape, a, s, draw);
    }
  }
  Model model = builder.build();
  if (!shape.labelled)
  {
    return model;
  }
  std::vector<std::uint32_t> labels;
  for (std::uint32_t s = 0; s < shape.num_states; ++s)
  {
    labels.push_back(s % 2);
  }
  return withLabels(model, std::move(labels));
}

RandomShape randomShape(std::uint64_t seed)
{
  std::mt19937_64 random(seed * 7919 + 1);
  const auto among = [&random](std::uint64_t count) { return random() % count; };
  RandomShape shape;
  shape.num_states = 2 + among(4);
  shape.num_actions = 2 + among(3);
  shape.num_classes = among(3) == 0 ? 2 : 1;
  shape.num_observations = shape.num_classes * (1 + among(3));
  shape.discount = 0.5 + 0.1 * static_cast<double>(among(5));
  shape.zeros = among(2) == 0 ? 0.3 : 0.75;
  shape.deterministic = among(4) == 0;
  shape.absorbing = among(4) == 0;
  shape.labelled = among(4) == 0;
  shape.outcome_rewards = among(4) == 0;
  const std::uint64_t range = among(4);
  shape.least_reward = range == 0 ? -100.0 : range == 1 ? 5.0 : -1.0;
  shape.greatest_reward = range == 0 ? -10.0 : range == 1 ? 6.0 : 1.0;
  return shape;
}

Model randomSearch(std::uint64_t seed)
{
  Draw draw(seed);
  const std::size_t cells = 1 + static_cast<std::size_t>(2.0 * draw.uniform());
  const std::size_t places = 2 + static_cast<std::size_t>(2.0 * draw.uniform());
  const double drift = draw.uniform() < 0.25 ? 0.1 * draw.uniform() : 0.0;
  const std::size_t done = cells * places;
  const std::size_t over = 2 * cells;  // observations: a signal in each cell, and this
  const std::size_t look = cells;
  const std::size_t take = cells + 1;
  const std::size_t quit = cells + 2;
  ModelBuilder builder(names("s", done + 1), names("a", cells + 3), names("o", over + 1));
  builder.setDiscount(draw.between(0.6, 0.9));
  std::vector<double> start = draw.distribution(places, 0.2);
  start.resize(done + 1, 0.0);
  builder.setInitialBelief(start);  // in the first cell
  builder.setTransition(kAny, done, done, 1.0);
  builder.setObservation(kAny, done, over, 1.0);
  for (std::size_t cell = 0; cell < cells; ++cell)
  {
    for (std::size_t place = 0; place < places; ++place)
    {
      const std::size_t s = cell * places + place;
      const auto go = [&](std::size_t a, std::size_t to_cell, double probability) {
        builder.addTransition(a, s, to_cell * places + place, probability * (1.0 - drift));
        builder.addTransition(a, s, to_cell * places + (place + 1) % places, probability * drift);
      };
      for (std::size_t a = 0; a < cells; ++a)
      {
        const double slip = draw.uniform() < 0.5 ? 0.0 : 0.3;
        go(a, a, 1.0 - slip);
        go(a, cell, slip);
        builder.setReward(a, s, -1.0);
      }
      go(look, cell, 1.0);
      builder.setReward(look, s, -0.5);
      const double caught = place % cells == cell ? draw.uniform() : 0.0;
      go(take, cell, 1.0 - caught);
      builder.addTransition(take, s, done, caught);
      builder.setReward(take, s, caught > 0.0 ? draw.between(5.0, 20.0) : -10.0);
      builder.addTransition(quit, s, done, 1.0);
      builder.setReward(quit, s, draw.between(-20.0, 3.0));
      for (std::size_t a = 0; a < cells + 3; ++a)
      {
        // Only a look says much.
        const double yes = a == look ? draw.uniform() : draw.uniform() < 0.5 ? 0.5 : 0.6;
        builder.setObservation(a, s, 2 * cell, yes);
        builder.setObservation(a, s, 2 * cell + 1, 1.0 - yes);
      }
    }
  }
  return builder.build();
}

std::string toString(const RandomShape& shape)
{
  std::ostringstream out;
  out << shape.num_states << " states, " << shape.num_actions << " actions, "
      << shape.num_observations << " observations, discount " << shape.discount << ", zeros "
      << shape.zeros << (shape.deterministic ? ", deterministic" : "") << ", " << shape.num_classes
      << " classes" << (shape.absorbing ? ", absorbing" : "")
      << (shape.labelled ? ", labelled" : "")
      << (shape.outcome_rewards ? ", rewards of outcomes" : "") << ", rewards ["
      << shape.least_reward << ", " << shape.greatest_reward << "]";
  return out.str();
}

Belief randomBelief(std::size_t num_states, std::mt19937_64& random)
{
  std::vector<double> result(num_states);
  double sum = 0.0;
  const std::uint64_t sparsity = random() % 3;
  for (double& p : result)
  {
    p = random() % 4 < sparsity ? 0.0 : static_cast<double>(random() >> 11) * 0x1.0p-53;
    sum += p;
  }
  if (sum == 0.0)
  {
    result.back() = sum = 1.0;
  }
  for (double& p : result)
  {
    p /= sum;
  }
  return Belief(std::move(result));
}

ModelParts partsOf(const Model& model)
{
  ModelParts parts;
  SharedRowsBuilder transitions;
  SharedRowsBuilder observations;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    parts.actions.push_back(model.actionName(a));
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      const SparseRow next = model.transitions(a, s);
      const SparseRow seen = model.observations(a, s);
      transitions.append({next.begin(), next.end()});
      observations.append({seen.begin(), seen.end()});
      parts.rewards.push_back(model.reward(a, s));
    }
  }
  for (std::size_t s = 0; s < model.numStates(); ++s)
  {
    parts.states.push_back(model.stateName(s));
  }
  for (std::size_t o = 0; o < model.numObservations(); ++o)
  {
    parts.observations.push_back(model.observationName(o));
  }
  parts.discount = model.discount();
  parts.initial_belief = model.initialBelief().probabilities();
  parts.initial_labels = model.initialLabels();
  parts.transitions = transitions.take();
  parts.observation_rows = observations.take();
  return parts;
}

SolverLimits backups(std::uint64_t count, double precision)
{
  SolverLimits limits;
  limits.precision = precision;
  limits.max_backups = count;
  return limits;
}

Model withDiscount(const Model& model, double discount)
{
  ModelParts parts = partsOf(model);
  parts.discount = discount;
  return Model(std::move(parts));
}

Model withLabels(const Model& model, std::vector<std::uint32_t> labels)
{
  ModelParts parts = partsOf(model);
  parts.initial_labels = std::move(labels);
  return Model(std::move(parts));
}

}  // namespace kr3::pomdp::test
