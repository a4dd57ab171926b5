#include "kr3_pomdp/factored_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxFactorSize = std::size_t{1} << 27;
constexpr std::size_t kMaxStates = std::size_t{1} << 24;

/// Combinations of values of some variables, numbered; the last variable changes fastest.
class Combinations
{
public:
  template <typename Variables>
  Combinations(const Variables& variables, const char* what)
  {
    for (const Variable& variable : variables)
    {
      if (variable.values.empty())
      {
        throw InvalidArgument("variable '" + variable.name + "' has no values");
      }
      count_ *= variable.values.size();
      if (count_ > kMaxStates)
      {
        throw ResourceExhausted(std::string("more than ") + std::to_string(kMaxStates) + " " +
                                what);
      }
    }
    std::size_t stride = count_;
    for (const Variable& variable : variables)
    {
      sizes_.push_back(variable.values.size());
      stride /= variable.values.size();
      strides_.push_back(stride);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t stride(std::size_t variable) const { return strides_[variable]; }
  [[nodiscard]] std::size_t value(std::size_t combination, std::size_t variable) const
  {
    return combination / strides_[variable] % sizes_[variable];
  }

private:
  std::size_t count_ = 1;
  std::vector<std::size_t> sizes_;
  std::vector<std::size_t> strides_;
};

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

/// The values of all variables at one place of the enumeration.
struct Assignment
{
  const std::vector<std::size_t>& of(VariableRole role) const
  {
    return values[static_cast<std::size_t>(role)];
  }
  std::vector<std::size_t>& of(VariableRole role) { return values[static_cast<std::size_t>(role)]; }
  std::size_t operator[](const VariableRef& ref) const { return of(ref.role)[ref.index]; }

  std::vector<std::size_t> values[4];
};

/// A factor ready to be looked up.
class Table
{
public:
  Table(const FactoredModel& model, const Factor& factor) : factor_(&factor)
  {
    std::size_t stride = 1;
    for (auto of = factor.of.rbegin(); of != factor.of.rend(); ++of)
    {
      stride *= model.variable(*of).values.size();
    }
    num_outcomes_ = stride;
    for (auto parent = factor.parents.rbegin(); parent != factor.parents.rend(); ++parent)
    {
      parent_strides_.push_back(stride);
      stride *= model.variable(*parent).values.size();
    }
    std::reverse(parent_strides_.begin(), parent_strides_.end());
  }

  [[nodiscard]] const Factor& factor() const { return *factor_; }
  [[nodiscard]] std::size_t numOutcomes() const { return num_outcomes_; }
  [[nodiscard]] std::size_t offset(const Assignment& assignment) const
  {
    std::size_t offset = 0;
    for (std::size_t i = 0; i < parent_strides_.size(); ++i)
    {
      offset += assignment[factor_->parents[i]] * parent_strides_[i];
    }
    return offset;
  }

private:
  const Factor* factor_;
  std::size_t num_outcomes_ = 1;
  std::vector<std::size_t> parent_strides_;
};

std::string described(const FactoredModel& model, const Factor& factor)
{
  std::string text;
  for (const VariableRef& ref : factor.of)
  {
    text += (text.empty() ? "" : ", ") + model.variable(ref).name;
  }
  return "P(" + text + " | ...)";
}

/// Which rows hold no distribution, in words: the values of the parents.
std::string rowNamed(const FactoredModel& model, const Factor& factor, std::size_t row)
{
  std::string text;
  for (auto parent = factor.parents.rbegin(); parent != factor.parents.rend(); ++parent)
  {
    const Variable& variable = model.variable(*parent);
    text = (variable.name + " = ")
               .append(variable.values[row % variable.values.size()])
               .append(text.empty() ? "" : ", ")
               .append(text);
    row /= variable.values.size();
  }
  return text;
}

/// The factors normalised, in an order in which what they depend on comes first.
std::vector<Factor> checkedFactors(const FactoredModel& model, const std::vector<Factor>& factors,
                                   VariableRole role, std::size_t num_variables, double tolerance)
{
  std::vector<int> defined(num_variables, 0);
  for (const Factor& factor : factors)
  {
    if (factor.values.size() != model.sizeOf(factor))
    {
      throw InvalidArgument(described(model, factor) + " has " +
                            std::to_string(factor.values.size()) + " entries, expected " +
                            std::to_string(model.sizeOf(factor)));
    }
    for (const VariableRef& ref : factor.of)
    {
      if (ref.role != role || ++defined.at(ref.index) > 1)
      {
        throw InvalidArgument(described(model, factor) + ": '" + model.variable(ref).name +
                              "' has another factor already, or none of this kind");
      }
    }
  }
  for (std::size_t i = 0; i < num_variables; ++i)
  {
    if (defined[i] == 0)
    {
      throw InvalidArgument("no probabilities are given for '" + model.variable({role, i}).name +
                            "'");
    }
  }
  std::vector<Factor> ordered;
  std::vector<bool> known(num_variables, false);
  std::vector<bool> taken(factors.size(), false);
  for (bool progress = true; progress;)
  {
    progress = false;
    for (std::size_t f = 0; f < factors.size(); ++f)
    {
      const auto ready = [&](const VariableRef& ref) {
        return ref.role != role || known[ref.index];
      };
      if (taken[f] || !std::all_of(factors[f].parents.begin(), factors[f].parents.end(), ready))
      {
        continue;
      }
      taken[f] = true;
      progress = true;
      for (const VariableRef& ref : factors[f].of)
      {
        known[ref.index] = true;
      }
      ordered.push_back(factors[f]);
    }
  }
  if (ordered.size() != factors.size())
  {
    const std::size_t f =
        static_cast<std::size_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
    throw InvalidArgument(described(model, factors[f]) + " depends on itself");
  }
  for (Factor& factor : ordered)
  {
    const Table table(model, factor);
    const std::size_t width = table.numOutcomes();
    for (std::size_t start = 0; start < factor.values.size(); start += width)
    {
      double sum = 0.0;
      bool valid = true;
      for (std::size_t i = start; i < start + width; ++i)
      {
        valid = valid && factor.values[i] >= 0.0;
        sum += factor.values[i];
      }
      if (!valid || !(std::abs(sum - 1.0) <= tolerance))
      {
        const std::string given = rowNamed(model, factor, start / width);
        throw InvalidArgument(described(model, factor) + (given.empty() ? "" : " given " + given) +
                              " sums to " + std::to_string(sum) +
                              (valid ? "" : " and has a negative entry") + ", expected 1");
      }
      for (std::size_t i = start; i < start + width && std::abs(sum - 1.0) > 1e-12; ++i)
      {
        factor.values[i] /= sum;
      }
    }
  }
  return ordered;
}

/// Calls `found` with the index and the probability of each combination that factors allow.
class Product
{
public:
  Product(const FactoredModel& model, const std::vector<Factor>& factors,
          const Combinations& combinations)
    : model_(&model), combinations_(&combinations)
  {
    for (const Factor& factor : factors)
    {
      tables_.emplace_back(model, factor);
    }
  }

  template <typename Found>
  void forEach(Assignment& assignment, const Found& found) const
  {
    descend(0, 1.0, 0, assignment, found);
  }

private:
  template <typename Found>
  void descend(std::size_t depth, double probability, std::size_t combination,
               Assignment& assignment, const Found& found) const
  {
    if (depth == tables_.size())
    {
      found(combination, probability);
      return;
    }
    const Table& table = tables_[depth];
    const double* values = table.factor().values.data() + table.offset(assignment);
    for (std::size_t outcome = 0; outcome < table.numOutcomes(); ++outcome)
    {
      if (values[outcome] == 0.0)
      {
        continue;
      }
      std::size_t rest = outcome;
      std::size_t next = combination;
      for (auto ref = table.factor().of.rbegin(); ref != table.factor().of.rend(); ++ref)
      {
        const std::size_t size = model_->variable(*ref).values.size();
        assignment.of(ref->role)[ref->index] = rest % size;
        next += rest % size * combinations_->stride(ref->index);
        rest /= size;
      }
      descend(depth + 1, probability * values[outcome], next, assignment, found);
    }
  }

  const FactoredModel* model_;
  const Combinations* combinations_;
  std::vector<Table> tables_;
};

void assign(const Combinations& combinations, std::size_t combination,
            std::vector<std::size_t>& values)
{
  for (std::size_t v = 0; v < values.size(); ++v)
  {
    values[v] = combinations.value(combination, v);
  }
}

/// From one combination to the next.
template <typename Variables>
void advance(const Variables& variables, std::vector<std::size_t>& values)
{
  for (std::size_t v = values.size(); v-- > 0;)
  {
    if (++values[v] < variables[v].values.size())
    {
      return;
    }
    values[v] = 0;
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
    , states_(model.state, "states")
    , actions_(model.actions, "actions")
    , observations_(model.observations, "observations")
    , initial_(checkedFactors(model, model.initial, VariableRole::kPrevious, model.state.size(),
                              tolerance))
    , transitions_(checkedFactors(model, model.transitions, VariableRole::kCurrent,
                                  model.state.size(), tolerance))
    , observing_(checkedFactors(model, model.observing, VariableRole::kObservation,
                                model.observations.size(), tolerance))
  {
    assignment_.of(VariableRole::kPrevious).resize(model.state.size());
    assignment_.of(VariableRole::kCurrent).resize(model.state.size());
    assignment_.of(VariableRole::kAction).resize(model.actions.size());
    assignment_.of(VariableRole::kObservation).resize(model.observations.size());
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
    if (observations_.count() * num_seen_ > kMaxStates)
    {
      throw ResourceExhausted("more than " + std::to_string(kMaxStates) + " observations");
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
    Product(model_, initial_, states_)
        .forEach(assignment_, [&](std::size_t state, double probability) {
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
    const Product product(model_, transitions_, states_);
    parts.transitions =
        rowsOf(product, VariableRole::kPrevious, 1, [](std::size_t /*state*/) { return 0U; });
  }

  void addObservations(ModelParts& parts)
  {
    const Product product(model_, observing_, observations_);
    parts.observation_rows = rowsOf(product, VariableRole::kCurrent, num_seen_,
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
    for (std::size_t a = 0; a < actions_.count(); ++a)
    {
      assign(actions_, a, assignment_.of(VariableRole::kAction));
      assign(states_, 0, assignment_.of(role));
      for (std::size_t s = 0; s < states_.count(); ++s, advance(model_.state, assignment_.of(role)))
      {
        const std::uint32_t offset = offset_of(s);
        row.clear();
        product.forEach(assignment_, [&](std::size_t combination, double probability) {
          row.push_back({static_cast<std::uint32_t>(combination * stride + offset), probability});
        });
        tidy(row);
        rows.append(row);
      }
    }
    return rows.take();
  }

  void addRewards(ModelParts& parts)
  {
    parts.rewards.assign(actions_.count() * states_.count(), 0.0);
    for (const Factor& factor : model_.rewards)
    {
      if (!factor.of.empty() || factor.values.size() != model_.sizeOf(factor))
      {
        throw InvalidArgument("a reward with " + std::to_string(factor.values.size()) +
                              " entries, expected " + std::to_string(model_.sizeOf(factor)));
      }
      const Table table(model_, factor);
      const auto depends = [&factor](VariableRole role) {
        return std::any_of(factor.parents.begin(), factor.parents.end(),
                           [role](const VariableRef& ref) { return ref.role == role; });
      };
      const bool on_observation = depends(VariableRole::kObservation);
      const bool on_next = on_observation || depends(VariableRole::kCurrent);
      const Product next_states(model_, transitions_, states_);
      const Product observations(model_, observing_, observations_);
      const auto value = [&] { return factor.values[table.offset(assignment_)]; };
      for (std::size_t a = 0; a < actions_.count(); ++a)
      {
        assign(actions_, a, assignment_.of(VariableRole::kAction));
        assign(states_, 0, assignment_.of(VariableRole::kPrevious));
        for (std::size_t s = 0; s < states_.count();
             ++s, advance(model_.state, assignment_.of(VariableRole::kPrevious)))
        {
          double& sum = parts.rewards[a * states_.count() + s];
          if (!on_next)
          {
            sum += value();
            continue;
          }
          next_states.forEach(assignment_, [&](std::size_t /*next*/, double p) {
            if (!on_observation)
            {
              sum += p * value();
              return;
            }
            observations.forEach(assignment_,
                                 [&](std::size_t /*seen*/, double q) { sum += p * q * value(); });
          });
        }
      }
    }
  }

  const FactoredModel& model_;
  Combinations states_;
  Combinations actions_;
  Combinations observations_;
  std::vector<Factor> initial_;
  std::vector<Factor> transitions_;
  std::vector<Factor> observing_;
  std::vector<std::size_t> seen_;  // state variables
  std::size_t num_seen_ = 1;
  Assignment assignment_;
};

}  // namespace

const Variable& FactoredModel::variable(const VariableRef& ref) const
{
  switch (ref.role)
  {
    case VariableRole::kAction:
      return actions.at(ref.index);
    case VariableRole::kObservation:
      return observations.at(ref.index);
    default:
      return state.at(ref.index);
  }
}

std::size_t FactoredModel::sizeOf(const Factor& factor) const
{
  std::size_t size = 1;
  for (const std::vector<VariableRef>* refs : {&factor.parents, &factor.of})
  {
    for (const VariableRef& ref : *refs)
    {
      size *= variable(ref).values.size();
      if (size > kMaxFactorSize)
      {
        throw ResourceExhausted("a factor with more than " + std::to_string(kMaxFactorSize) +
                                " entries");
      }
    }
  }
  return size;
}

Model FactoredModel::flattened(double sum_tolerance) const
{
  if (state.empty() || actions.empty())
  {
    throw InvalidArgument("a factored model needs a state variable and an action variable");
  }
  return Model(Flattening(*this, sum_tolerance).parts());
}

}  // namespace kr3::pomdp
