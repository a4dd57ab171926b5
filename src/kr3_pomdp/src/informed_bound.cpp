#include "informed_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "paced_question.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr int kMaxSweeps = 4000;
constexpr int kMaxSweepsFromBelow = 50;  // where they converge at all soon, far fewer
constexpr int kMaxInformedSweeps = 400;
constexpr int kMaxBlindSweeps = 300;
constexpr double kTolerance = 1e-6;  // relative to the range of rewards, as the next
constexpr double kInformedTolerance = 1e-4;
constexpr double kBlindTolerance = 1e-4;

struct RewardRange
{
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double scale() const
  {
    return std::max({1e-12, std::abs(least), std::abs(greatest)});
  }
};

RewardRange rewardRange(const ObservedModel& model)
{
  RewardRange range;
  for (const StateClass& state_class : model.classes())
  {
    for (const ClassAction& action : state_class.actions)
    {
      for (const double reward : action.rewards)
      {
        range.least = std::min(range.least, reward);
        range.greatest = std::max(range.greatest, reward);
      }
    }
  }
  return range;
}

/// Whether the action keeps the state for ever.
bool absorbs(const StateClass& state_class, std::size_t c, std::size_t a, std::size_t s)
{
  double stays = 0.0;
  for (const Branch& branch : state_class.actions[a].branches)
  {
    for (const SparseEntry& next : branch.joint.row(s))
    {
      stays += branch.target_class == c && next.index == s ? next.probability : 0.0;
    }
  }
  return stays > 1.0 - 1e-12;
}

/// Whether nothing that is done leaves the state.
bool isKept(const ObservedModel& model, std::size_t c, std::size_t s)
{
  const StateClass& state_class = model.classes()[c];
  for (std::size_t a = 0; a < state_class.actions.size(); ++a)
  {
    if (!absorbs(state_class, c, a, s))
    {
      return false;
    }
  }
  return true;
}

InformedVectors filled(const ObservedModel& model, double value)
{
  InformedVectors vectors(model.classes().size());
  for (std::size_t c = 0; c < vectors.size(); ++c)
  {
    vectors[c].assign(model.numActions(),
                      std::vector<double>(model.classes()[c].states.size(), value));
  }
  return vectors;
}

double greatestAt(const std::vector<std::vector<double>>& vectors, std::size_t state)
{
  double greatest = -std::numeric_limits<double>::infinity();
  for (const std::vector<double>& vector : vectors)
  {
    greatest = std::max(greatest, vector[state]);
  }
  return greatest;
}

/// Q of the fully observed model, in place (each new value is used at once,
/// which stays above).
double observedSweep(const ObservedModel& model, std::vector<std::vector<double>>& values,
                     InformedVectors& vectors, PacedQuestion& keep_going)
{
  double change = 0.0;
  for (std::size_t c = model.classes().size(); c-- > 0;)
  {
    const StateClass& state_class = model.classes()[c];
    for (std::size_t a = 0; a < state_class.actions.size(); ++a)
    {
      const ClassAction& action = state_class.actions[a];
      if (!keep_going(state_class.states.size() * action.branches.size()))
      {
        return 0.0;
      }
      for (std::size_t s = 0; s < state_class.states.size(); ++s)
      {
        double sum = 0.0;
        for (const Branch& branch : action.branches)
        {
          for (const SparseEntry& next : branch.joint.row(s))
          {
            sum += next.probability * values[branch.target_class][next.index];
          }
        }
        vectors[c][a][s] = std::min(vectors[c][a][s], action.rewards[s] + model.discount() * sum);
      }
    }
    for (std::size_t s = 0; s < state_class.states.size(); ++s)
    {
      const double value = greatestAt(vectors[c], s);
      change = std::max(change, values[c][s] - value);
      values[c][s] = value;
    }
  }
  return change;
}

/// The best that one step brings in the fully observed model, with these values after it.
double bestStep(const ObservedModel& model, const StateClass& state_class, std::size_t s,
                const std::vector<std::vector<double>>& values)
{
  double best = -std::numeric_limits<double>::infinity();
  for (const ClassAction& action : state_class.actions)
  {
    double sum = 0.0;
    for (const Branch& branch : action.branches)
    {
      for (const SparseEntry& next : branch.joint.row(s))
      {
        sum += next.probability * values[branch.target_class][next.index];
      }
    }
    best = std::max(best, action.rewards[s] + model.discount() * sum);
  }
  return best;
}

/// Lowers bounds of the fully observed model's values to what values from below show: where runs
/// are short these are exact after a few sweeps, whereas bounds from above fall by the discount
/// only. With V <= TV <= V + r no value exceeds V + r / (1 - discount).
/// @param upper  bounds, [class][state]; stay as they are when it is stopped
/// @param least  no reward is less
void lowerToValuesFromBelow(const ObservedModel& model, double least, double enough,
                            std::vector<std::vector<double>>& upper, PacedQuestion& keep_going)
{
  const double rest = 1.0 / (1.0 - model.discount());
  std::vector<std::vector<double>> values = upper;
  for (std::size_t c = 0; c < values.size(); ++c)
  {
    for (std::size_t s = 0; s < values[c].size(); ++s)
    {
      values[c][s] = isKept(model, c, s) ? upper[c][s] : least * rest;
    }
  }
  double rise = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxSweepsFromBelow && rise * rest > enough; ++i)
  {
    rise = 0.0;
    for (std::size_t c = values.size(); c-- > 0;)
    {
      const StateClass& state_class = model.classes()[c];
      if (!keep_going(values[c].size() * model.numActions()))
      {
        return;
      }
      for (std::size_t s = 0; s < values[c].size(); ++s)
      {
        const double value = bestStep(model, state_class, s, values);
        rise = std::max(rise, value - values[c][s]);
        values[c][s] = std::max(values[c][s], value);
      }
    }
  }
  rise = 0.0;
  for (std::size_t c = 0; c < values.size(); ++c)
  {
    if (!keep_going(values[c].size() * model.numActions()))
    {
      return;
    }
    for (std::size_t s = 0; s < values[c].size(); ++s)
    {
      rise = std::max(rise, bestStep(model, model.classes()[c], s, values) - values[c][s]);
    }
  }
  for (std::size_t c = 0; c < values.size(); ++c)
  {
    std::transform(
        upper[c].begin(), upper[c].end(), values[c].begin(), upper[c].begin(),
        [&](double above, double below) { return std::min(above, below + rise * rest); });
  }
}

double informedSweep(const ObservedModel& model, InformedVectors& vectors,
                     PacedQuestion& keep_going)
{
  double change = 0.0;
  for (std::size_t c = model.classes().size(); c-- > 0;)
  {
    const StateClass& state_class = model.classes()[c];
    for (std::size_t a = 0; a < state_class.actions.size(); ++a)
    {
      const ClassAction& action = state_class.actions[a];
      // Each row meets the vectors of all actions.
      if (!keep_going(state_class.states.size() * action.branches.size() * model.numActions()))
      {
        return 0.0;
      }
      for (std::size_t s = 0; s < state_class.states.size(); ++s)
      {
        double sum = 0.0;
        for (const Branch& branch : action.branches)
        {
          const SparseRow row = branch.joint.row(s);
          if (row.size() == 0)
          {
            continue;
          }
          double greatest = -std::numeric_limits<double>::infinity();
          for (const std::vector<double>& vector : vectors[branch.target_class])
          {
            double value = 0.0;
            for (const SparseEntry& next : row)
            {
              value += next.probability * vector[next.index];
            }
            greatest = std::max(greatest, value);
          }
          sum += greatest;
        }
        double& entry = vectors[c][a][s];
        const double value = std::min(entry, action.rewards[s] + model.discount() * sum);
        change = std::max(change, entry - value);
        entry = value;
      }
    }
  }
  return change;
}

/// One action for ever, in place (each new value is used at once, which stays below).
double blindSweep(const ObservedModel& model, std::size_t a, InformedVectors& vectors,
                  PacedQuestion& keep_going)
{
  double change = 0.0;
  for (std::size_t c = model.classes().size(); c-- > 0;)
  {
    const StateClass& state_class = model.classes()[c];
    if (!keep_going(state_class.states.size()))
    {
      return 0.0;
    }
    const ClassAction& action = state_class.actions[a];
    for (std::size_t s = 0; s < state_class.states.size(); ++s)
    {
      double sum = 0.0;
      for (const Branch& branch : action.branches)
      {
        for (const SparseEntry& next : branch.joint.row(s))
        {
          sum += next.probability * vectors[branch.target_class][a][next.index];
        }
      }
      double& entry = vectors[c][a][s];
      const double value = std::max(entry, action.rewards[s] + model.discount() * sum);
      change = std::max(change, value - entry);
      entry = value;
    }
  }
  return change;
}

/// One action, then the base plan: together these plans are supported by each other, because the
/// base plan does one of the actions, or each of them at times.
InformedVectors firstThenBase(const ObservedModel& model, const UndiscountedBounds& first)
{
  InformedVectors vectors = filled(model, 0.0);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    const std::vector<double> values = thenBasePlan(model.model(), first, a);
    for (std::size_t c = 0; c < vectors.size(); ++c)
    {
      const std::vector<std::uint32_t>& states = model.classes()[c].states;
      std::transform(states.begin(), states.end(), vectors[c][a].begin(),
                     [&values](std::uint32_t s) { return values[s]; });
    }
  }
  return vectors;
}

}  // namespace

InformedVectors informedBound(const ObservedModel& model, const std::function<bool()>& keep_going,
                              const UndiscountedBounds* first)
{
  const RewardRange range = rewardRange(model);
  const double top = first == nullptr ? range.greatest / (1.0 - model.discount()) : 0.0;
  InformedVectors vectors = filled(model, top);
  std::vector<std::vector<double>> values;
  for (const StateClass& state_class : model.classes())
  {
    values.emplace_back(state_class.states.size(), top);
    for (std::size_t s = 0; s < state_class.states.size(); ++s)
    {
      if (first != nullptr)
      {
        values.back()[s] = first->upper[state_class.states[s]];
        for (std::vector<double>& vector : vectors[values.size() - 1])
        {
          vector[s] = values.back()[s];
        }
        continue;
      }
      if (isKept(model, values.size() - 1, s))
      {
        double greatest = -std::numeric_limits<double>::infinity();
        for (const ClassAction& action : state_class.actions)
        {
          greatest = std::max(greatest, action.rewards[s]);
        }
        values.back()[s] = greatest / (1.0 - model.discount());
      }
    }
  }
  const double enough = kTolerance * range.scale();
  PacedQuestion paced(keep_going);
  if (first == nullptr)
  {
    lowerToValuesFromBelow(model, range.least, enough, values, paced);
  }
  for (int i = 0; i < kMaxSweeps && paced(1); ++i)
  {
    if (observedSweep(model, values, vectors, paced) < enough)
    {
      break;
    }
  }
  for (int i = 0; i < kMaxInformedSweeps && paced(1); ++i)
  {
    if (informedSweep(model, vectors, paced) < kInformedTolerance * range.scale())
    {
      break;
    }
  }
  return vectors;
}

InformedVectors blindBound(const ObservedModel& model, const std::function<bool()>& keep_going,
                           const UndiscountedBounds* first)
{
  if (first != nullptr)
  {
    return firstThenBase(model, *first);
  }
  const RewardRange range = rewardRange(model);
  InformedVectors vectors = filled(model, 0.0);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    double least = std::numeric_limits<double>::infinity();
    for (const StateClass& state_class : model.classes())
    {
      const std::vector<double>& rewards = state_class.actions[a].rewards;
      least = std::min(least, *std::min_element(rewards.begin(), rewards.end()));
    }
    for (std::vector<std::vector<double>>& of_class : vectors)
    {
      std::fill(of_class[a].begin(), of_class[a].end(), least / (1.0 - model.discount()));
    }
  }
  PacedQuestion paced(keep_going);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t c = 0; c < vectors.size(); ++c)
    {
      const StateClass& state_class = model.classes()[c];
      for (std::size_t s = 0; s < state_class.states.size(); ++s)
      {
        if (absorbs(state_class, c, a, s))
        {
          vectors[c][a][s] = state_class.actions[a].rewards[s] / (1.0 - model.discount());
        }
      }
    }
    for (int i = 0; i < kMaxBlindSweeps && paced(1); ++i)
    {
      if (blindSweep(model, a, vectors, paced) < kBlindTolerance * range.scale())
      {
        break;
      }
    }
  }
  return vectors;
}

}  // namespace kr3::pomdp
