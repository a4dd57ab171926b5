#include "kr3_refinement/factored_task.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "dependence.hpp"
#include "factor_table.hpp"
#include "known_variables.hpp"
#include "observation_channels.hpp"

namespace kr3::refinement
{
namespace
{

using pomdp::Factor;
using pomdp::VariableRef;
using pomdp::VariableRole;
using Context = Dependence::Context;
using Outcome = Dependence::Outcome;

constexpr std::size_t kTask = 0;     // the state variable that says whether the task goes on
constexpr std::size_t kRunning = 0;  // its value while it does
/// The value of a fluent in the boundary and after the end.
constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

std::string withoutBlanks(std::string name)
{
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

class FactoredBuilder
{
public:
  explicit FactoredBuilder(const PomdpTask& task)
    : task_(task), flat_(task.model()), finish_(task.finishAction())
  {
  }

  FactoredTask build()
  {
    addVariables();
    addInitial();
    addTaskTransition();
    for (std::size_t variable = 1; variable < model_.state.size(); ++variable)
    {
      addTransition(variable);
    }
    addObservations();
    addRewards();
    return {std::move(model_), std::move(values_)};
  }

private:
  /// Columns of a context as variables.
  using Columns = std::vector<VariableRef>;

  [[nodiscard]] std::size_t numPhysical() const { return task_.boundaryState(); }
  [[nodiscard]] std::size_t doneValue() const { return model_.state[kTask].values.size() - 1; }
  [[nodiscard]] bool hasBoundary() const { return doneValue() == 2; }
  [[nodiscard]] std::uint32_t valueOf(std::size_t state, std::size_t variable) const
  {
    return static_cast<std::uint32_t>(values_[state][variable]);
  }
  [[nodiscard]] std::size_t sizeOf(const VariableRef& ref) const
  {
    return model_.variable(ref).values.size();
  }

  void addVariables()
  {
    bool leaves = false;
    for (std::size_t action = 0; action < flat_.numActions(); ++action)
    {
      for (std::size_t state = 0; state < numPhysical(); ++state)
      {
        for (const pomdp::SparseEntry& next : flat_.transitions(action, state))
        {
          leaves = leaves || next.index == task_.boundaryState();
        }
      }
    }
    pomdp::StateVariable going_on;
    going_on.name = "task";
    going_on.values = leaves ? std::vector<std::string>{"running", "boundary", "done"}
                             : std::vector<std::string>{"running", "done"};
    model_.state.push_back(std::move(going_on));
    for (const reasoner::GroundFluent& fluent : task_.fluents())
    {
      pomdp::StateVariable variable;
      variable.name = withoutBlanks(fluent.name);
      variable.values = fluent.values;
      model_.state.push_back(std::move(variable));
    }
    model_.discount = flat_.discount();
    pomdp::Variable action{"action", {}};
    for (std::size_t i = 0; i < flat_.numActions(); ++i)
    {
      action.values.push_back(flat_.actionName(i));
    }
    model_.actions.push_back(std::move(action));
    addValues();
  }

  void addValues()
  {
    std::vector<std::vector<std::uint32_t>> labels;
    for (std::size_t state = 0; state < flat_.numStates(); ++state)
    {
      const bool physical = state < numPhysical();
      const bool boundary = state == task_.boundaryState();
      values_.emplace_back(model_.state.size(), 0);
      values_.back()[kTask] = physical ? kRunning : (boundary && hasBoundary() ? 1 : doneValue());
      labels.emplace_back(model_.state.size(), kNothing);
      labels.back()[kTask] = static_cast<std::uint32_t>(values_.back()[kTask]);
      for (std::size_t variable = 1; physical && variable < model_.state.size(); ++variable)
      {
        const auto value = task_.physicalState(state)[variable - 1];
        values_.back()[variable] = static_cast<std::size_t>(value);
        labels.back()[variable] = static_cast<std::uint32_t>(value);
      }
    }
    const std::vector<bool> known = knownVariables(flat_, labels);
    for (std::size_t variable = 0; variable < known.size(); ++variable)
    {
      model_.state[variable].observed = known[variable];
    }
  }

  /// Columns that may be left out: those of many values first, those in `last` at the end.
  [[nodiscard]] std::vector<std::size_t> dropOrder(const Columns& columns,
                                                   const std::vector<std::size_t>& last) const
  {
    std::vector<std::size_t> order(columns.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto rank = [&](std::size_t column) {
      return std::find(last.begin(), last.end(), column) - last.begin();
    };
    order.erase(std::remove_if(
                    order.begin(), order.end(),
                    [&](std::size_t column) {
      return rank(column) < static_cast<std::ptrdiff_t>(last.size());
                    }),
                order.end());
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return sizeOf(columns[a]) > sizeOf(columns[b]);
    });
    order.insert(order.end(), last.begin(), last.end());
    return order;
  }

  /// A factor over the columns kept.
  /// @param otherwise  gives the outcome of a row that is not in `cases`, by its parents' values
  template <typename Otherwise>
  [[nodiscard]] Factor factor(const Dependence& cases, const Columns& columns,
                              const std::vector<std::size_t>& kept,
                              const std::vector<VariableRef>& of, const Otherwise& otherwise) const
  {
    Columns parents;
    for (const std::size_t column : kept)
    {
      parents.push_back(columns[column]);
    }
    FactorTable table(model_, parents, of);
    table.fill([&](const Context& context) { return otherwise(parents, context); });
    cases.forEach(
        kept, [&](const Context& context, const Outcome& outcome) { table.set(context, outcome); });
    return std::move(table).take();
  }

  void addInitial()
  {
    const std::size_t count = model_.state[kTask].values.size();
    model_.initial.push_back({{}, {{VariableRole::kPrevious, kTask}}, certain(kRunning, count)});
    for (std::size_t variable = 1; variable < model_.state.size(); ++variable)
    {
      const std::size_t size = model_.state[variable].values.size();
      Columns columns;
      for (std::size_t earlier = 1; earlier < variable; ++earlier)
      {
        columns.push_back({VariableRole::kPrevious, earlier});
      }
      std::map<Context, Outcome> masses;
      for (std::size_t state = 0; state < numPhysical(); ++state)
      {
        addMass(state, variable, flat_.initialBelief()[state], masses);
      }
      Dependence cases(columns.size());
      for (auto& [context, mass] : masses)
      {
        cases.add(context, normalised(mass));
      }
      model_.initial.push_back(
          factor(cases, columns, cases.columns(dropOrder(columns, {})),
                 {{VariableRole::kPrevious, variable}},
                 [size](const Columns& /*parents*/, const Context& /*context*/) {
        return certain(0, size);
          }));
    }
  }

  /// Adds a state's mass to that of its variable's value, given the values of earlier variables.
  void addMass(std::size_t state, std::size_t variable, double mass,
               std::map<Context, Outcome>& masses) const
  {
    if (mass <= 0.0)
    {
      return;
    }
    Context context;
    for (std::size_t earlier = 1; earlier < variable; ++earlier)
    {
      context.push_back(valueOf(state, earlier));
    }
    Outcome& outcome =
        masses.try_emplace(context, model_.state[variable].values.size(), 0.0).first->second;
    outcome[valueOf(state, variable)] += mass;
  }

  static Outcome normalised(Outcome outcome)
  {
    const double total = std::accumulate(outcome.begin(), outcome.end(), 0.0);
    for (double& entry : outcome)
    {
      entry /= total;
    }
    return outcome;
  }

  /// Action, the task variable of a role, the fluents of this role.
  [[nodiscard]] Columns columnsOf(VariableRole role) const
  {
    Columns columns{{VariableRole::kAction, 0}};
    for (std::size_t variable = 0; variable < model_.state.size(); ++variable)
    {
      columns.push_back({role, variable});
    }
    return columns;
  }
  [[nodiscard]] Context contextOf(std::size_t action, std::size_t state) const
  {
    Context context{static_cast<std::uint32_t>(action)};
    for (std::size_t variable = 0; variable < model_.state.size(); ++variable)
    {
      context.push_back(valueOf(state, variable));
    }
    return context;
  }
  /// Fluents among columnsOf(), those of many values first.
  [[nodiscard]] std::vector<std::size_t> fluentColumns(const Columns& columns) const
  {
    std::vector<std::size_t> order = dropOrder(columns, {0, 1 + kTask});
    order.resize(order.size() - 2);
    return order;
  }

  void addTaskTransition()
  {
    const Columns columns = columnsOf(VariableRole::kPrevious);
    const std::size_t count = doneValue() + 1;
    Dependence cases(columns.size());
    for (std::size_t action = 0; action < finish_; ++action)
    {
      for (std::size_t state = 0; state < numPhysical(); ++state)
      {
        Outcome outcome(count, 0.0);
        for (const pomdp::SparseEntry& next : flat_.transitions(action, state))
        {
          outcome[values_[next.index][kTask]] += next.probability;
        }
        cases.add(contextOf(action, state), outcome);
      }
    }
    model_.transitions.push_back(factor(cases, columns, cases.columns(fluentColumns(columns)),
                                        {{VariableRole::kCurrent, kTask}},
                                        [&](const Columns& /*parents*/, const Context& context) {
      return certain(context[0] == finish_ ? doneValue() : context[1], count);
    }));
  }

  /// A fluent's value after an action while the task goes on: in other cases it means nothing.
  void addTransition(std::size_t variable)
  {
    const std::size_t size = model_.state[variable].values.size();
    Columns columns{{VariableRole::kAction, 0}};
    for (std::size_t before = 1; before < model_.state.size(); ++before)
    {
      columns.push_back({VariableRole::kPrevious, before});
    }
    for (std::size_t earlier = 1; earlier < variable; ++earlier)
    {
      columns.push_back({VariableRole::kCurrent, earlier});
    }
    Dependence cases(columns.size());
    for (std::size_t action = 0; action < finish_; ++action)
    {
      for (std::size_t state = 0; state < numPhysical(); ++state)
      {
        std::map<Context, Outcome> masses;
        for (const pomdp::SparseEntry& next : flat_.transitions(action, state))
        {
          addMass(next.index, variable, next.index < numPhysical() ? next.probability : 0.0,
                  masses);
        }
        Context context = contextOf(action, state);
        context.erase(context.begin() + 1);  // the task goes on
        for (auto& [earlier, mass] : masses)
        {
          Context full = context;
          full.insert(full.end(), earlier.begin(), earlier.end());
          cases.add(full, normalised(mass));
        }
      }
    }
    const VariableRef own{VariableRole::kPrevious, variable};
    model_.transitions.push_back(factor(
        cases, columns, cases.columns(dropOrder(columns, {variable, 0})),
        {{VariableRole::kCurrent, variable}}, [&](const Columns& parents, const Context& context) {
          const auto at = std::find(parents.begin(), parents.end(), own) - parents.begin();
          const auto stays = static_cast<std::size_t>(at);
          return certain(stays < parents.size() ? context[stays] : 0, size);
        }));
  }

  void addObservations()
  {
    const Columns columns = columnsOf(VariableRole::kCurrent);
    for (const ObservationChannel& channel : observationChannels(task_))
    {
      Dependence cases(columns.size());
      for (std::size_t action = 0; action < finish_; ++action)
      {
        for (std::size_t state = 0; state < numPhysical(); ++state)
        {
          cases.add(contextOf(action, state), channel.told(action, state));
        }
      }
      const std::vector<std::size_t> kept = cases.columns(fluentColumns(columns));
      const bool says_nothing_new = std::all_of(
          kept.begin() + 1, kept.end(),
          [&](std::size_t column) { return model_.state[columns[column].index].observed; });
      if (says_nothing_new)
      {
        continue;
      }
      const VariableRef own{VariableRole::kObservation, model_.observations.size()};
      model_.observations.push_back(channel.variable());
      model_.observing.push_back(factor(cases, columns, kept, {own},
                                        [&](const Columns& /*parents*/, const Context& context) {
        return context[0] == finish_ || context[1] == kRunning
                   ? certain(0, channel.variable().values.size())
                   : channel.told(context[0], stateOf(context[1]));
      }));
    }
    if (model_.observations.empty())
    {
      model_.observations.push_back({"observation", {kNoObservation}});
      model_.observing.push_back({{}, {{VariableRole::kObservation, 0}}, {1.0}});
    }
  }

  /// The task's state for a value of the task variable other than running.
  [[nodiscard]] std::size_t stateOf(std::uint32_t value) const
  {
    return value == doneValue() ? task_.doneState() : task_.boundaryState();
  }

  void addRewards()
  {
    const Columns columns = columnsOf(VariableRole::kPrevious);
    Dependence cases(columns.size());
    for (std::size_t action = 0; action < flat_.numActions(); ++action)
    {
      for (std::size_t state = 0; state < numPhysical(); ++state)
      {
        cases.add(contextOf(action, state), {flat_.reward(action, state)});
      }
    }
    model_.rewards.push_back(factor(cases, columns, cases.columns(fluentColumns(columns)), {},
                                    [&](const Columns& /*parents*/, const Context& context) {
      return Outcome{context[1] == kRunning ? 0.0 : flat_.reward(context[0], stateOf(context[1]))};
    }));
  }

  const PomdpTask& task_;
  const pomdp::Model& flat_;
  std::size_t finish_;
  pomdp::FactoredModel model_;
  std::vector<std::vector<std::size_t>> values_;
};

}  // namespace

FactoredTask factored(const PomdpTask& task)
{
  return FactoredBuilder(task).build();
}

}  // namespace kr3::refinement
