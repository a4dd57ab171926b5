#include "kr3_pomdp/model_builder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

// A short text with wildcards can ask for any amount of time.
constexpr std::size_t kMaxRewardTerms = std::size_t{1} << 31;

struct Range
{
  std::size_t first;
  std::size_t last;  // one past
};

Range rangeOf(std::size_t index, const NameTable& names, const char* what)
{
  if (index == kAny)
  {
    return {0, names.size()};
  }
  if (index >= names.size())
  {
    throw InvalidArgument(std::string(what) + " " + std::to_string(index) + " of " +
                          std::to_string(names.size()));
  }
  return {index, index + 1};
}

void checkFinite(double value, const char* what)
{
  if (!std::isfinite(value))
  {
    throw InvalidArgument(std::string(what) + " " + std::to_string(value) +
                          ", expected a finite number");
  }
}

std::size_t indexOf(const NameTable& names, std::string_view name, const char* what)
{
  const auto found = names.find(name);
  if (!found)
  {
    throw NotFound(std::string("no ") + what + " is called '" + std::string(name) + "'");
  }
  return *found;
}

double sumOf(const std::vector<SparseEntry>& row)
{
  double sum = 0.0;
  for (const SparseEntry& entry : row)
  {
    sum += entry.probability;
  }
  return sum;
}

/// Divides `row` by its sum. `describe` names the row when it is wrong.
template <typename Describe>
std::vector<SparseEntry> normalised(std::vector<SparseEntry> row, double tolerance,
                                    const Describe& describe)
{
  const double sum = sumOf(row);
  for (const SparseEntry& entry : row)
  {
    if (entry.probability < 0.0 || entry.probability > 1.0 + tolerance)
    {
      throw InvalidArgument(describe() + " has the entry " + std::to_string(entry.probability) +
                            ", expected a probability");
    }
  }
  if (std::abs(sum - 1.0) > tolerance)
  {
    throw InvalidArgument(describe() + " sums to " + std::to_string(sum) + ", expected 1");
  }
  row.erase(std::remove_if(row.begin(), row.end(),
                           [](const SparseEntry& entry) { return entry.probability == 0.0; }),
            row.end());
  if (std::abs(sum - 1.0) > 1e-12)  // keep what is exact to the last bits, so that files round-trip
  {
    for (SparseEntry& entry : row)
    {
      entry.probability /= sum;
    }
  }
  return row;
}

SharedRows shared(const std::vector<std::vector<SparseEntry>>& rows)
{
  SharedRowsBuilder builder;
  builder.reserve(rows.size());
  for (const std::vector<SparseEntry>& row : rows)
  {
    builder.append(row);
  }
  return builder.take();
}

}  // namespace

ModelBuilder::ModelBuilder(std::vector<std::string> states, std::vector<std::string> actions,
                           std::vector<std::string> observations)
  : states_("state", std::move(states))
  , actions_("action", std::move(actions))
  , observations_("observation", std::move(observations))
  , initial_belief_(states_.size(), 1.0 / static_cast<double>(states_.size()))
  , transitions_(actions_.size() * states_.size())
  , observation_rows_(actions_.size() * states_.size())
{
}

std::size_t ModelBuilder::state(std::string_view name) const
{
  return indexOf(states_, name, "state");
}

std::size_t ModelBuilder::action(std::string_view name) const
{
  return indexOf(actions_, name, "action");
}

std::size_t ModelBuilder::observation(std::string_view name) const
{
  return indexOf(observations_, name, "observation");
}

void ModelBuilder::setDiscount(double discount)
{
  if (!(discount > 0.0 && discount <= 1.0))
  {
    throw InvalidArgument("discount " + std::to_string(discount) + ", expected it in (0, 1]");
  }
  discount_ = discount;
}

void ModelBuilder::setInitialBelief(std::vector<double> probabilities)
{
  if (probabilities.size() != states_.size())
  {
    throw InvalidArgument("initial belief over " + std::to_string(probabilities.size()) +
                          " states, expected " + std::to_string(states_.size()));
  }
  initial_belief_ = std::move(probabilities);
}

void ModelBuilder::setEntry(Rows& rows, const NameTable& columns, const char* what,
                            std::size_t action, std::size_t state, std::size_t column,
                            double probability, bool add)
{
  checkFinite(probability, "probability");
  const Range action_range = rangeOf(action, actions_, "action");
  const Range state_range = rangeOf(state, states_, "state");
  const Range column_range = rangeOf(column, columns, what);
  for (std::size_t a = action_range.first; a < action_range.last; ++a)
  {
    for (std::size_t s = state_range.first; s < state_range.last; ++s)
    {
      std::vector<SparseEntry>& row = rows[a * states_.size() + s];
      if (column == kAny && !add)
      {
        row.clear();
        if (probability == 0.0)
        {
          continue;
        }
      }
      auto place = row.begin();
      for (std::size_t c = column_range.first; c < column_range.last; ++c)
      {
        const auto index = static_cast<std::uint32_t>(c);
        // Files and generators write rows in order, so the end is the usual place.
        if (row.empty() || row.back().index < index)
        {
          place = row.end();
        }
        else
        {
          place =
              std::lower_bound(row.begin(), row.end(), index,
                               [](const SparseEntry& e, std::uint32_t i) { return e.index < i; });
        }
        if (place != row.end() && place->index == index)
        {
          place->probability = add ? place->probability + probability : probability;
        }
        else if (probability != 0.0)
        {
          row.insert(place, SparseEntry{index, probability});
        }
      }
    }
  }
}

void ModelBuilder::setTransition(std::size_t action, std::size_t state, std::size_t next_state,
                                 double probability)
{
  setEntry(transitions_, states_, "next state", action, state, next_state, probability, false);
}

void ModelBuilder::addTransition(std::size_t action, std::size_t state, std::size_t next_state,
                                 double probability)
{
  setEntry(transitions_, states_, "next state", action, state, next_state, probability, true);
}

void ModelBuilder::setObservation(std::size_t action, std::size_t next_state,
                                  std::size_t observation, double probability)
{
  setEntry(observation_rows_, observations_, "observation", action, next_state, observation,
           probability, false);
}

void ModelBuilder::addObservation(std::size_t action, std::size_t next_state,
                                  std::size_t observation, double probability)
{
  setEntry(observation_rows_, observations_, "observation", action, next_state, observation,
           probability, true);
}

void ModelBuilder::setReward(std::size_t action, std::size_t state, double value)
{
  setReward(action, state, kAny, kAny, value);
}

namespace
{

/// Packs the indices that are not wildcards; `mask` has a bit for each that is.
std::uint64_t rewardKey(const std::array<std::size_t, 4>& index,
                        const std::array<std::size_t, 4>& size, unsigned mask)
{
  std::uint64_t key = 0;
  for (unsigned i = 0; i < 4; ++i)
  {
    key = key * size[i] + ((mask & (1U << i)) == 0U ? index[i] : 0);
  }
  return key;
}

}  // namespace

void ModelBuilder::setReward(std::size_t action, std::size_t state, std::size_t next_state,
                             std::size_t observation, double value)
{
  checkFinite(value, "reward");
  rangeOf(action, actions_, "action");
  rangeOf(state, states_, "state");
  rangeOf(next_state, states_, "next state");
  rangeOf(observation, observations_, "observation");
  const std::array<std::size_t, 4> index{action, state, next_state, observation};
  unsigned mask = 0;
  for (unsigned i = 0; i < 4; ++i)
  {
    mask |= index[i] == kAny ? 1U << i : 0U;
  }
  const std::uint64_t key = rewardKey(
      index, {actions_.size(), states_.size(), states_.size(), observations_.size()}, mask);
  rewards_[mask][key] = {++num_reward_rules_, value};
}

namespace
{

/// Of the expectations of rewards over next states and observations.
/// @throws ResourceExhausted  too many terms
void checkRewardTerms(std::size_t num_states,
                      const std::vector<std::vector<SparseEntry>>& transitions,
                      const std::vector<std::vector<SparseEntry>>& observations)
{
  std::size_t num_terms = 0;
  for (std::size_t row = 0; row < transitions.size(); ++row)
  {
    const std::size_t first = row - row % num_states;  // of the action
    for (const SparseEntry& next : transitions[row])
    {
      num_terms += observations[first + next.index].size();
    }
  }
  if (num_terms > kMaxRewardTerms)
  {
    throw ResourceExhausted("expected rewards of " + std::to_string(num_terms) +
                            " terms, expected at most " + std::to_string(kMaxRewardTerms));
  }
}

}  // namespace

std::vector<double> ModelBuilder::expectedRewards(const Rows& transitions,
                                                  const Rows& observations) const
{
  const std::array<std::size_t, 4> size{actions_.size(), states_.size(), states_.size(),
                                        observations_.size()};
  constexpr unsigned kNextBit = 1U << 2;
  constexpr unsigned kObservationBit = 1U << 3;
  bool depends_on_next = false;
  bool depends_on_observation = false;
  for (unsigned mask = 0; mask < rewards_.size(); ++mask)
  {
    depends_on_next |= !rewards_[mask].empty() && (mask & kNextBit) == 0U;
    depends_on_observation |= !rewards_[mask].empty() && (mask & kObservationBit) == 0U;
  }
  const auto rewardOf = [&](const std::array<std::size_t, 4>& index) {
    RewardRule latest{0, 0.0};
    for (unsigned mask = 0; mask < rewards_.size(); ++mask)
    {
      if (rewards_[mask].empty())
      {
        continue;
      }
      const auto found = rewards_[mask].find(rewardKey(index, size, mask));
      if (found != rewards_[mask].end() && found->second.order > latest.order)
      {
        latest = found->second;
      }
    }
    return latest.value;
  };
  if (depends_on_observation)
  {
    checkRewardTerms(states_.size(), transitions, observations);
  }
  std::vector<double> expected(actions_.size() * states_.size(), 0.0);
  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    for (std::size_t s = 0; s < states_.size(); ++s)
    {
      double& sum = expected[a * states_.size() + s];
      if (!depends_on_next && !depends_on_observation)
      {
        sum = rewardOf({a, s, 0, 0});
        continue;
      }
      for (const SparseEntry& next : transitions[a * states_.size() + s])
      {
        if (!depends_on_observation)
        {
          sum += next.probability * rewardOf({a, s, next.index, 0});
          continue;
        }
        for (const SparseEntry& seen : observations[a * states_.size() + next.index])
        {
          sum += next.probability * seen.probability * rewardOf({a, s, next.index, seen.index});
        }
      }
    }
  }
  return expected;
}

double ModelBuilder::transitionSum(std::size_t action, std::size_t state) const
{
  rangeOf(action, actions_, "action");
  rangeOf(state, states_, "state");
  return sumOf(transitions_.at(action * states_.size() + state));
}

double ModelBuilder::observationSum(std::size_t action, std::size_t next_state) const
{
  rangeOf(action, actions_, "action");
  rangeOf(next_state, states_, "next state");
  return sumOf(observation_rows_.at(action * states_.size() + next_state));
}

Model ModelBuilder::build(double sum_tolerance) const
{
  Rows transitions;
  Rows observations;
  transitions.reserve(transitions_.size());
  observations.reserve(observation_rows_.size());
  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    for (std::size_t s = 0; s < states_.size(); ++s)
    {
      const std::size_t i = a * states_.size() + s;
      transitions.push_back(normalised(transitions_[i], sum_tolerance, [&] {
        return "T(. | state '" + states_[s] + "', action '" + actions_[a] + "')";
      }));
      observations.push_back(normalised(observation_rows_[i], sum_tolerance, [&] {
        return "O(. | action '" + actions_[a] + "', next state '" + states_[s] + "')";
      }));
    }
  }
  ModelParts parts;
  parts.states = states_.names();
  parts.actions = actions_.names();
  parts.observations = observations_.names();
  parts.discount = discount_;
  parts.initial_belief = initial_belief_;
  parts.rewards = expectedRewards(transitions, observations);
  parts.transitions = shared(transitions);
  parts.observation_rows = shared(observations);
  return Model(std::move(parts));
}

}  // namespace kr3::pomdp
