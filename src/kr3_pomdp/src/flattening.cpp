#include "flattening.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "factor_product.hpp"

namespace kr3::pomdp
{

namespace
{

template <typename Variables>
std::vector<std::string> joinedNames(const Variables& variables, const Combinations& combinations)
{
  std::vector<std::string> names(combinations.count());
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    for (std::size_t v = 0; v < variables.size(); ++v)
    {
      names[i] += (v == 0 ? "" : ",") + variables[v].values[combinations.value(i, v)];
    }
  }
  return names;
}

/// Walks through the combinations of some variables, with their values in an assignment.
class Walk
{
public:
  template <typename Variables>
  Walk(const FactoredModel& model, const Variables& variables, VariableRole role,
       Assignment& assignment)
    : first_(Assignment::slot(model, {role, 0})), assignment_(assignment)
  {
    for (const Variable& variable : variables)
    {
      sizes_.push_back(variable.values.size());
      assignment_.set(first_ + sizes_.size() - 1, 0);
    }
  }

  /// To the next combination, from the last one to the first.
  void advance()
  {
    for (std::size_t v = sizes_.size(); v-- > 0;)
    {
      const std::size_t next = assignment_[first_ + v] + 1;
      if (next < sizes_[v])
      {
        assignment_.set(first_ + v, next);
        return;
      }
      assignment_.set(first_ + v, 0);
    }
  }

private:
  std::size_t first_;
  std::vector<std::size_t> sizes_;
  Assignment& assignment_;
};

// A short description can ask for any amount of memory and time.
constexpr std::size_t kMaxRows = std::size_t{1} << 27;
constexpr std::size_t kMaxEntries = std::size_t{1} << 31;
constexpr std::size_t kMaxRewardTerms = std::size_t{1} << 31;

void checkCount(std::size_t count, std::size_t limit, const char* what)
{
  if (count > limit)
  {
    throw ResourceExhausted("a flat model of more than " + std::to_string(limit) + " " + what);
  }
}

/// Sorts a row by index.
void tidy(std::vector<SparseEntry>& row)
{
  std::sort(row.begin(), row.end(),
            [](const SparseEntry& a, const SparseEntry& b) { return a.index < b.index; });
}

/// Builds the flat model, see FactoredModel::flattened.
class Flattening
{
public:
  Flattening(const FactoredModel& model, double tolerance)
    : model_(model)
    , assignment_(model)
    , states_(model.state, "states")
    , actions_(model.actions, "actions")
    , observations_(model.observations, "observations")
    , initial_(model, model.initial, VariableRole::kPrevious, states_, tolerance)
    , transitions_(model, model.transitions, VariableRole::kCurrent, states_, tolerance)
    , observing_(model, model.observing, VariableRole::kObservation, observations_, tolerance)
  {
    for (std::size_t v = 0; v < model.state.size(); ++v)
    {
      if (model.state[v].observed)
      {
        seen_.push_back(v);
        num_seen_ *= model.state[v].values.size();
      }
    }
  }

  ModelParts parts()
  {
    checkCount(actions_.count() * states_.count(), kMaxRows, "rows (actions times states)");
    ModelParts parts;
    parts.states = joinedNames(model_.state, states_);
    parts.actions = joinedNames(model_.actions, actions_);
    parts.discount = model_.discount;
    nameObservations(parts);
    addInitialBelief(parts);
    addTransitions(parts);
    addObservations(parts);
    addRewards(parts);
    return parts;
  }

private:
  /// The number of the values of the seen variables in a state.
  [[nodiscard]] std::uint32_t seenIn(std::size_t state) const
  {
    std::size_t seen = 0;
    for (const std::size_t v : seen_)
    {
      seen = seen * model_.state[v].values.size() + states_.value(state, v);
    }
    return static_cast<std::uint32_t>(seen);
  }

  void nameObservations(ModelParts& parts) const
  {
    if (observations_.count() * num_seen_ > Combinations::kMaxCombinations)
    {
      throw ResourceExhausted("more than " + std::to_string(Combinations::kMaxCombinations) +
                              " observations");
    }
    std::vector<Variable> seen;
    for (const std::size_t v : seen_)
    {
      seen.push_back(model_.state[v]);
    }
    const std::vector<std::string> made = joinedNames(model_.observations, observations_);
    const std::vector<std::string> values = joinedNames(seen, Combinations(seen, "observations"));
    for (const std::string& observation : made)
    {
      for (const std::string& value : values)
      {
        const bool both = !observation.empty() && !value.empty();
        const std::string name = observation + (both ? "," : "") + value;
        parts.observations.push_back(name.empty() ? "none" : name);
      }
    }
  }

  void addInitialBelief(ModelParts& parts)
  {
    parts.initial_belief.assign(states_.count(), 0.0);
    initial_.forEach(assignment_, [&](std::size_t state, double probability) {
      parts.initial_belief[state] += probability;
    });
    if (!seen_.empty())
    {
      for (std::size_t s = 0; s < states_.count(); ++s)
      {
        parts.initial_labels.push_back(seenIn(s));
      }
    }
  }

  void addTransitions(ModelParts& parts)
  {
    parts.transitions =
        rowsOf(transitions_, VariableRole::kPrevious, 1, [](std::size_t /*state*/) { return 0U; });
  }

  void addObservations(ModelParts& parts)
  {
    parts.observation_rows = rowsOf(observing_, VariableRole::kCurrent, num_seen_,
                                    [this](std::size_t state) { return seenIn(state); });
  }

  /// A row for each action and state, the state's variables in this role.
  /// @param offset_of  of a state; a combination's place in its row is combination * stride +
  ///                   offset
  template <typename OffsetOf>
  SharedRows rowsOf(const Product& product, VariableRole role, std::size_t stride,
                    const OffsetOf& offset_of)
  {
    SharedRowsBuilder rows;
    rows.reserve(actions_.count() * states_.count());
    std::vector<SparseEntry> row;
    std::size_t num_entries = 0;
    Walk actions(model_, model_.actions, VariableRole::kAction, assignment_);
    Walk states(model_, model_.state, role, assignment_);
    for (std::size_t a = 0; a < actions_.count(); ++a, actions.advance())
    {
      for (std::size_t s = 0; s < states_.count(); ++s, states.advance())
      {
        const std::uint32_t offset = offset_of(s);
        row.clear();
        product.forEach(assignment_, [&](std::size_t combination, double probability) {
          row.push_back({static_cast<std::uint32_t>(combination * stride + offset), probability});
        });
        num_entries += row.size();
        checkCount(num_entries, kMaxEntries, "entries of T and O");
        tidy(row);
        rows.append(row);
      }
    }
    return rows.take();
  }

  /// The terms of the expectation of one reward over next states, and over observations.
  [[nodiscard]] std::size_t numRewardTerms(const ModelParts& parts, bool on_observation) const
  {
    std::size_t num_terms = 0;
    for (std::size_t row = 0; row < parts.transitions.numRows(); ++row)
    {
      const std::size_t first = row - row % states_.count();  // of the action
      for (const SparseEntry& next : parts.transitions.row(row))
      {
        num_terms += on_observation ? parts.observation_rows.row(first + next.index).size() : 1;
      }
    }
    return num_terms;
  }

  void addRewards(ModelParts& parts)
  {
    parts.rewards.assign(actions_.count() * states_.count(), 0.0);
    std::size_t num_terms = 0;
    for (const Factor& factor : model_.rewards)
    {
      if (!factor.of.empty() || factor.values.size() != model_.sizeOf(factor))
      {
        throw InvalidArgument("a reward with " + std::to_string(factor.values.size()) +
                              " entries, expected " + std::to_string(model_.sizeOf(factor)));
      }
      const FactorTable table(model_, factor, 0.0);
      const auto depends = [&factor](VariableRole role) {
        return std::any_of(factor.parents.begin(), factor.parents.end(),
                           [role](const VariableRef& ref) { return ref.role == role; });
      };
      const bool on_observation = depends(VariableRole::kObservation);
      const bool on_next = on_observation || depends(VariableRole::kCurrent);
      num_terms += on_next ? numRewardTerms(parts, on_observation) : 0;
      checkCount(num_terms, kMaxRewardTerms, "terms of expected rewards");
      const auto value = [&] { return table.value(table.row(assignment_)); };
      Walk actions(model_, model_.actions, VariableRole::kAction, assignment_);
      Walk states(model_, model_.state, VariableRole::kPrevious, assignment_);
      for (std::size_t a = 0; a < actions_.count(); ++a, actions.advance())
      {
        for (std::size_t s = 0; s < states_.count(); ++s, states.advance())
        {
          double& sum = parts.rewards[a * states_.count() + s];
          if (!on_next)
          {
            sum += value();
            continue;
          }
          transitions_.forEach(assignment_, [&](std::size_t /*next*/, double p) {
            if (!on_observation)
            {
              sum += p * value();
              return;
            }
            observing_.forEach(assignment_,
                               [&](std::size_t /*seen*/, double q) { sum += p * q * value(); });
          });
        }
      }
    }
  }

  const FactoredModel& model_;
  Assignment assignment_;
  Combinations states_;
  Combinations actions_;
  Combinations observations_;
  Product initial_;
  Product transitions_;
  Product observing_;
  std::vector<std::size_t> seen_;  // state variables
  std::size_t num_seen_ = 1;
};

}  // namespace

ModelParts flattened(const FactoredModel& model, double sum_tolerance)
{
  return Flattening(model, sum_tolerance).parts();
}

}  // namespace kr3::pomdp
