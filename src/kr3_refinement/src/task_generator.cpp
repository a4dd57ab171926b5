#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "action_model_reader.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "prior.hpp"
#include "semantics.hpp"
#include "sensor_table.hpp"
#include "transition_table.hpp"

namespace kr3::refinement
{
namespace
{

/// Names in model files have no blanks.
std::string withoutBlanks(std::string name)
{
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

/// What a reader of models.yaml has checked; models made in memory are checked here.
/// @throws InvalidArgument  an action without a model, or probabilities that do not sum to 1
void checkModels(const Models& models, const std::vector<GroundAction>& actions,
                 const Vocabulary& vocabulary, const reasoner::Description& description)
{
  for (const GroundAction& action : actions)
  {
    const auto model = models.actions.find(action.symbol);
    if (model == models.actions.end())
    {
      throw InvalidArgument("the models have no numbers for the action '" + action.symbol + "'");
    }
    const OutcomeModel& outcomes = model->second.outcomesOf(argumentNames(vocabulary, action));
    if (!outcomes.probabilities.empty() && !sumsToOne(outcomes, description, action.symbol))
    {
      double total = 0.0;
      for (const auto& [label, probability] : outcomes.probabilities)
      {
        total += probability;
      }
      throw InvalidArgument("the probabilities of the outcomes of '" + action.symbol + "' sum to " +
                            std::to_string(total) + ", expected 1");
    }
  }
}

}  // namespace

/// Builds the POMDP of a zoom.
class TaskGenerator
{
public:
  TaskGenerator(const LowLevelDomain& domain, const Models& models, const Zoom& zoom,
                const InitialKnowledge& knowledge, const GeneratorLimits& limits)
    : domain_(domain)
    , models_(models)
    , zoom_(zoom)
    , priors_(priorsOf(domain, models, zoom.constants, knowledge))
    , semantics_(domain.description(), &zoom.constants,
                 withElsewhere(domain, zoom, knowledge, priors_), kElsewhere)
    , states_(semantics_.states(limits.max_states))
    , actions_(semantics_.actions())
    , boundary_(states_.size())
    , done_(boundary_ + 1)
    , weights_(initialWeights(domain, zoom, knowledge, priors_, semantics_, states_))
  {
    checkModels(models, actions_, semantics_.vocabulary(), domain_.description());
  }

  PomdpTask generate()
  {
    const TransitionTable table(domain_, models_, semantics_, states_, actions_);
    findSuccess(table);
    pomdp::ModelParts parts;
    parts.states = stateNames();
    parts.actions = actionNames();
    parts.discount = models_.discount;
    parts.initial_belief = weights_;
    parts.initial_belief.resize(done_ + 1, 0.0);
    addTransitions(table, parts);
    addObservations(table, parts);
    addRewards(table, parts);
    return task(pomdp::Model(std::move(parts)), table);
  }

private:
  void findSuccess(const TransitionTable& table)
  {
    const CoarseFluents coarse_fluents = coarseFluents(domain_, semantics_);
    success_.assign(done_ + 1, false);
    for (std::size_t state = 0; state < states_.size(); ++state)
    {
      success_[state] = std::all_of(zoom_.effects.begin(), zoom_.effects.end(),
                                    [&](const reasoner::Literal& effect) {
        const auto fluents = coarse_fluents.find(reasoner::toString(effect.atom));
        return fluents != coarse_fluents.end() &&
               coarselyHolds(effect, fluents->second, states_[state]);
      });
    }
    hopeless_ = table.canReach({success_.begin(), success_.begin() + boundary_ + 1});
    hopeless_.flip();
    hopeless_.push_back(false);  // done
  }

  [[nodiscard]] bool coarselyHolds(const reasoner::Literal& effect,
                                   const std::vector<std::size_t>& fluents,
                                   const Values& state) const
  {
    std::vector<std::string> values;
    for (const std::size_t fluent : fluents)
    {
      values.push_back(domain_.coarse(semantics_.vocabulary().name(state[fluent])));
    }
    const bool boolean =
        semantics_.signature().symbols()[semantics_.fluents()[fluents.front()].symbol].boolean;
    return (coarseValue(values, boolean) == effect.value.name) == effect.equal;
  }

  void addTransitions(const TransitionTable& table, pomdp::ModelParts& parts) const
  {
    pomdp::SharedRowsBuilder rows;
    rows.reserve((actions_.size() + 1) * (done_ + 1));
    const auto to = [](std::size_t state) {
      return std::vector<pomdp::SparseEntry>{{static_cast<std::uint32_t>(state), 1.0}};
    };
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      for (std::size_t state = 0; state < states_.size(); ++state)
      {
        rows.append(table.outcomes(action, state).next);
      }
      rows.append(to(boundary_));
      rows.append(to(done_));
    }
    const std::vector<pomdp::SparseEntry> finished = to(done_);
    for (std::size_t state = 0; state <= done_; ++state)
    {
      rows.append(finished);
    }
    parts.transitions = rows.take();
  }

  void addObservations(const TransitionTable& table, pomdp::ModelParts& parts)
  {
    ObservationNames names;
    pomdp::SharedRowsBuilder rows;
    rows.reserve((actions_.size() + 1) * (done_ + 1));
    const std::vector<pomdp::SparseEntry> nothing{{names.number(kNoObservation), 1.0}};
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      SensorTable sensors(semantics_, models_, actions_[action], names);
      const std::vector<bool> arrived = table.arrivals(action);
      for (std::size_t state = 0; state < states_.size(); ++state)
      {
        rows.append(sensors.row(&states_[state], arrived[state]));
      }
      rows.append(sensors.row(nullptr, false));
      rows.append(nothing);
      laws_.push_back(sensors.laws());
    }
    for (std::size_t state = 0; state <= done_; ++state)
    {
      rows.append(nothing);
    }
    parts.observations = names.names();
    parts.observation_rows = rows.take();
  }

  void addRewards(const TransitionTable& table, pomdp::ModelParts& parts) const
  {
    parts.rewards.reserve((actions_.size() + 1) * (done_ + 1));
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      for (std::size_t state = 0; state < states_.size(); ++state)
      {
        parts.rewards.push_back(-table.outcomes(action, state).seconds);
      }
      const std::vector<std::string> arguments =
          argumentNames(semantics_.vocabulary(), actions_[action]);
      parts.rewards.push_back(
          -models_.actions.at(actions_[action].symbol).costOf(arguments).impossible_s);
      parts.rewards.push_back(0.0);
    }
    const RewardModel& rewards = models_.rewards;
    for (std::size_t state = 0; state <= boundary_; ++state)
    {
      parts.rewards.push_back(success_[state]
                                  ? rewards.success
                                  : (hopeless_[state] ? rewards.given_up : rewards.wrong_finish));
    }
    parts.rewards.push_back(0.0);
  }

  [[nodiscard]] std::vector<std::string> stateNames() const
  {
    std::vector<std::string> names;
    for (const Values& state : states_)
    {
      std::string name;
      for (std::size_t i = 0; i < semantics_.signature().numInertial(); ++i)
      {
        name += (i == 0 ? "" : ",") + withoutBlanks(semantics_.fluents()[i].name) + "=" +
                semantics_.vocabulary().name(state[i]);
      }
      names.push_back(name.empty() ? "only_state" : name);
    }
    names.emplace_back("boundary");
    names.emplace_back("done");
    return names;
  }

  [[nodiscard]] std::vector<std::string> actionNames() const
  {
    std::vector<std::string> names;
    std::transform(actions_.begin(), actions_.end(), std::back_inserter(names),
                   [](const GroundAction& action) { return withoutBlanks(action.name); });
    names.emplace_back("finish");
    return names;
  }

  [[nodiscard]] reasoner::GroundFluent groundFluent(std::size_t index) const
  {
    const PhysicalFluent& fluent = semantics_.fluents()[index];
    reasoner::GroundFluent result;
    result.name = fluent.name;
    result.symbol = semantics_.signature().symbols()[fluent.symbol].name;
    const auto name = [this](int constant) { return semantics_.vocabulary().name(constant); };
    std::transform(fluent.arguments.begin(), fluent.arguments.end(),
                   std::back_inserter(result.arguments), name);
    std::transform(fluent.values.begin(), fluent.values.end(), std::back_inserter(result.values),
                   name);
    result.kind = reasoner::FluentKind::kInertial;
    return result;
  }

  [[nodiscard]] PomdpTask task(pomdp::Model model, const TransitionTable& table) const
  {
    PomdpTask task(std::move(model), zoom_);
    for (std::size_t i = 0; i < semantics_.signature().numInertial(); ++i)
    {
      task.fluents_.push_back(groundFluent(i));
      for (const int value : semantics_.fluents()[i].values)
      {
        const std::string& name = semantics_.vocabulary().name(value);
        task.coarse_of_.emplace(name, domain_.coarse(name));
      }
    }
    for (const Values& state : states_)
    {
      reasoner::State indices;
      for (std::size_t i = 0; i < semantics_.signature().numInertial(); ++i)
      {
        const std::vector<int>& values = semantics_.fluents()[i].values;
        indices.push_back(
            static_cast<int>(std::find(values.begin(), values.end(), state[i]) - values.begin()));
      }
      task.states_.push_back(std::move(indices));
    }
    for (std::size_t action = 0; action <= actions_.size(); ++action)
    {
      addMeaning(action, table, task);
    }
    task.success_ = success_;
    task.hopeless_ = hopeless_;
    task.coarse_fluents_ = refinement::coarseFluents(domain_, semantics_);
    return task;
  }

  /// What an action's index stands for.
  void addMeaning(std::size_t action, const TransitionTable& table, PomdpTask& task) const
  {
    const bool is_finish = action == actions_.size();
    std::vector<bool> given(task.model_.numObservations(), false);
    for (std::size_t state = 0; state <= boundary_; ++state)
    {
      for (const pomdp::SparseEntry& entry : task.model_.observations(action, state))
      {
        given[entry.index] = true;
      }
    }
    std::vector<std::size_t>& observations = task.observations_of_.emplace_back();
    for (std::size_t observation = 0; observation < given.size(); ++observation)
    {
      if (given[observation])
      {
        observations.push_back(observation);
      }
    }
    task.action_texts_.push_back(is_finish ? "finish" : actions_[action].name);
    task.action_symbols_.push_back(is_finish ? "finish" : actions_[action].symbol);
    std::vector<std::string>& arguments = task.action_arguments_.emplace_back();
    std::vector<std::string>& observed = task.observed_fluents_.emplace_back();
    std::vector<bool>& feedback = task.feedback_.emplace_back();
    std::vector<bool>& executable = task.executable_.emplace_back(states_.size(), is_finish);
    if (is_finish)
    {
      return;
    }
    arguments = argumentNames(semantics_.vocabulary(), actions_[action]);
    for (const GroundObservation& law : laws_[action])
    {
      observed.push_back(semantics_.fluents()[law.fluent].name);
      feedback.push_back(semantics_.affects(actions_[action], law.fluent));
    }
    for (std::size_t state = 0; state < states_.size(); ++state)
    {
      executable[state] = table.outcomes(action, state).executable;
    }
  }

  const LowLevelDomain& domain_;
  const Models& models_;
  const Zoom& zoom_;
  std::map<std::string, Distribution> priors_;
  Semantics semantics_;
  std::vector<Values> states_;
  std::vector<GroundAction> actions_;
  std::size_t boundary_;
  std::size_t done_;
  std::vector<double> weights_;
  std::vector<std::vector<GroundObservation>> laws_;  // of each action
  std::vector<bool> success_;
  std::vector<bool> hopeless_;
};

PomdpTask generatePomdp(const LowLevelDomain& domain, const Models& models, const Zoom& zoom,
                        const InitialKnowledge& knowledge, const GeneratorLimits& limits)
{
  return TaskGenerator(domain, models, zoom, knowledge, limits).generate();
}

}  // namespace kr3::refinement
