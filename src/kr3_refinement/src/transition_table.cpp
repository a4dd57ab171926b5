#include "transition_table.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{
namespace
{

struct ValuesHash
{
  std::size_t operator()(const Values& values) const
  {
    std::size_t hash = values.size();
    for (const int value : values)
    {
      hash = hash * 1000003U + static_cast<std::size_t>(value + 1);
    }
    return hash;
  }
};

using StateIndex = std::unordered_map<Values, std::uint32_t, ValuesHash>;

/// How far an action moves, by the value of the fluent from which it starts.
class Distance
{
public:
  Distance(const LowLevelDomain& domain, const ActionModel& model, const CostModel& cost,
           const Semantics& semantics, const GroundAction& action)
  {
    if (!cost.from)
    {
      return;
    }
    const Vocabulary& vocabulary = semantics.vocabulary();
    std::unordered_map<std::string, std::string> arguments;
    for (std::size_t i = 0; i < action.arguments.size(); ++i)
    {
      arguments.emplace(model.parameters[i], vocabulary.name(action.arguments[i]));
    }
    reasoner::Atom from = *cost.from;
    for (reasoner::Term& argument : from.arguments)
    {
      argument = {false, arguments.at(argument.name)};
    }
    fluent_ = semantics.signature().findFluent(reasoner::toString(from));
    const std::optional<std::size_t> end = domain.map().find(arguments.at(cost.to));
    if (!fluent_ || !end)
    {
      fluent_.reset();
      return;
    }
    for (const int value : semantics.fluents()[*fluent_].values)
    {
      if (const std::optional<std::size_t> start = domain.map().find(vocabulary.name(value)))
      {
        metres_.emplace(value, domain.map().distance(*start, *end));
      }
    }
    if (semantics.signature().elsewhere() != Vocabulary::kNone)
    {
      metres_.emplace(semantics.signature().elsewhere(), fromOutside(domain, semantics, *end));
    }
  }

  /// m; infinity when there is no way.
  [[nodiscard]] double from(const Values& state) const
  {
    const auto entry = fluent_ ? metres_.find(state[*fluent_]) : metres_.end();
    return entry == metres_.end() ? 0.0 : entry->second;
  }

private:
  /// The mean way from the values outside the zoom that have one; 0 where there is none.
  [[nodiscard]] double fromOutside(const LowLevelDomain& domain, const Semantics& semantics,
                                   std::size_t end) const
  {
    const PhysicalFluent& fluent = semantics.fluents()[*fluent_];
    const Symbol& symbol = semantics.signature().symbols()[fluent.symbol];
    double total = 0.0;
    double count = 0.0;
    for (const int value : symbol.full_value_sort->elements())
    {
      const bool inside =
          std::find(fluent.values.begin(), fluent.values.end(), value) != fluent.values.end();
      const auto start = domain.map().find(semantics.vocabulary().name(value));
      const double metres = !inside && start ? domain.map().distance(*start, end)
                                             : std::numeric_limits<double>::infinity();
      if (metres < std::numeric_limits<double>::infinity())
      {
        total += metres;
        count += 1.0;
      }
    }
    return count > 0.0 ? total / count : 0.0;
  }

  std::optional<std::size_t> fluent_;
  std::unordered_map<int, double> metres_;
};

/// The outcomes of one action, state by state.
class OutcomeFinder
{
public:
  OutcomeFinder(const LowLevelDomain& domain, const ActionModel& model, const Semantics& semantics,
                const StateIndex& index, const GroundAction& action)
    : probabilities_(model.outcomesOf(argumentNames(semantics.vocabulary(), action)).probabilities)
    , cost_(model.costOf(argumentNames(semantics.vocabulary(), action)))
    , semantics_(semantics)
    , index_(index)
    , action_(action)
    , distance_(domain, model, cost_, semantics, action)
  {
  }

  [[nodiscard]] Outcomes find(const Values& state, std::uint32_t number) const
  {
    const double distance_m = distance_.from(state);
    Outcomes outcomes{true, cost_.base_s + cost_.per_metre_s * distance_m, {}};
    if (distance_m < std::numeric_limits<double>::infinity() &&
        !semantics_.forbidden(state, action_))
    {
      outcomes.next = distribution(state);
    }
    if (outcomes.next.empty())
    {
      return {false, cost_.impossible_s, {{number, 1.0}}};
    }
    return outcomes;
  }

private:
  /// Where the action leads; what outcomes that are impossible here leave over goes to the others.
  [[nodiscard]] std::vector<pomdp::SparseEntry> distribution(const Values& state) const
  {
    std::vector<pomdp::SparseEntry> next;
    double total = 0.0;
    for (const Result& result : semantics_.results(state, action_))
    {
      const double probability =
          result.share * (result.label.empty() ? 1.0 : probabilities_.at(result.label));
      if (probability > 0.0)
      {
        next.push_back({numberOf(result), probability});
        total += probability;
      }
    }
    std::sort(next.begin(), next.end(),
              [](const auto& a, const auto& b) { return a.index < b.index; });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < next.size(); ++i)
    {
      if (i > 0 && next[i].index == next[kept - 1].index)
      {
        next[kept - 1].probability += next[i].probability;
      }
      else
      {
        next[kept++] = next[i];
      }
    }
    next.resize(kept, {0, 0.0});
    for (pomdp::SparseEntry& entry : next)
    {
      entry.probability /= total;
    }
    return next;
  }

  [[nodiscard]] std::uint32_t numberOf(const Result& result) const
  {
    if (result.outside)
    {
      return static_cast<std::uint32_t>(index_.size());
    }
    const auto entry = index_.find(result.values);
    if (entry == index_.end())
    {
      throw InternalError("a successor by " + action_.name +
                          " is no state of the zoomed description");
    }
    return entry->second;
  }

  const std::map<std::string, double>& probabilities_;
  const CostModel& cost_;
  const Semantics& semantics_;
  const StateIndex& index_;
  const GroundAction& action_;
  Distance distance_;
};

}  // namespace

TransitionTable::TransitionTable(const LowLevelDomain& domain, const Models& models,
                                 const Semantics& semantics, const std::vector<Values>& states,
                                 const std::vector<GroundAction>& actions)
  : num_states_(states.size())
{
  StateIndex index(states.size());
  for (std::size_t state = 0; state < states.size(); ++state)
  {
    index.emplace(states[state], static_cast<std::uint32_t>(state));
  }
  outcomes_.reserve(actions.size());
  for (const GroundAction& action : actions)
  {
    const OutcomeFinder finder(domain, models.actions.at(action.symbol), semantics, index, action);
    std::vector<Outcomes>& row = outcomes_.emplace_back();
    row.reserve(states.size());
    for (std::size_t state = 0; state < states.size(); ++state)
    {
      row.push_back(finder.find(states[state], static_cast<std::uint32_t>(state)));
    }
  }
}

std::vector<bool> TransitionTable::arrivals(std::size_t action) const
{
  std::vector<bool> result(num_states_ + 1, false);
  for (const Outcomes& outcomes : outcomes_[action])
  {
    for (const pomdp::SparseEntry& entry : outcomes.next)
    {
      result[entry.index] = result[entry.index] || outcomes.executable;
    }
  }
  return result;
}

std::vector<bool> TransitionTable::canReach(const std::vector<bool>& targets) const
{
  std::vector<std::vector<std::uint32_t>> before(num_states_ + 1);
  for (const std::vector<Outcomes>& of_action : outcomes_)
  {
    for (std::size_t state = 0; state < of_action.size(); ++state)
    {
      for (const pomdp::SparseEntry& entry : of_action[state].next)
      {
        if (entry.index != state)
        {
          before[entry.index].push_back(static_cast<std::uint32_t>(state));
        }
      }
    }
  }
  std::vector<bool> result = targets;
  std::vector<std::size_t> open;
  for (std::size_t state = 0; state < num_states_; ++state)
  {
    if (targets[state])
    {
      open.push_back(state);
    }
  }
  while (!open.empty())
  {
    const std::size_t state = open.back();
    open.pop_back();
    for (const std::uint32_t previous : before[state])
    {
      if (!result[previous])
      {
        result[previous] = true;
        open.push_back(previous);
      }
    }
  }
  return result;
}

}  // namespace kr3::refinement
