#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/model_builder.hpp>

#include "kr3_refinement/pomdp_task.hpp"
#include "prior.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{
namespace
{

const std::string kNoObservation = "none";
const std::string kOutside = "outside";

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

/// A distribution over observation names.
using Told = std::map<std::string, double>;

/// Names in model files have no blanks.
std::string withoutBlanks(std::string name)
{
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

/// What two observations together tell.
Told joined(const Told& first, const Told& second)
{
  Told result;
  for (const auto& [a, p] : first)
  {
    for (const auto& [b, q] : second)
    {
      result[a + "," + b] += p * q;
    }
  }
  return result;
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
    , semantics_(domain.description(), &zoom.constants, withElsewhere(domain, zoom, knowledge),
                 kElsewhere)
    , states_(semantics_.states(limits.max_states))
    , actions_(semantics_.actions())
  {
    for (std::size_t i = 0; i < states_.size(); ++i)
    {
      index_.emplace(states_[i], i);
    }
    boundary_ = states_.size();
    done_ = boundary_ + 1;
    weights_ = initialWeights(domain, zoom, knowledge, semantics_, states_);
  }

  PomdpTask generate()
  {
    findOutcomes();
    findSuccess();
    findObservations();
    pomdp::ModelBuilder builder(stateNames(), actionNames(), observation_names_);
    builder.setDiscount(models_.discount);
    std::vector<double> belief = weights_;
    belief.resize(done_ + 1, 0.0);
    builder.setInitialBelief(std::move(belief));
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      addAction(builder, action);
    }
    addFinish(builder);
    return task(builder.build());
  }

private:
  /// How one action turns out in one state.
  struct Outcomes
  {
    bool executable = false;
    std::vector<std::pair<std::size_t, double>> next;  // state, probability
  };

  [[nodiscard]] const ActionModel& model(const GroundAction& action) const
  {
    return models_.actions.at(action.symbol);
  }

  [[nodiscard]] std::size_t indexOf(const Values& values) const
  {
    const auto entry = index_.find(values);
    if (entry == index_.end())
    {
      throw InternalError("a successor is no state of the zoomed description");
    }
    return entry->second;
  }

  void findOutcomes()
  {
    outcomes_.assign(actions_.size(), std::vector<Outcomes>(states_.size()));
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      for (std::size_t state = 0; state < states_.size(); ++state)
      {
        outcomes_[action][state] = outcomesOf(actions_[action], state);
      }
    }
  }

  [[nodiscard]] Outcomes outcomesOf(const GroundAction& action, std::size_t state) const
  {
    const std::optional<double> distance_m = distance(action, states_[state]);
    if (!distance_m || semantics_.forbidden(states_[state], action))
    {
      return {false, {{state, 1.0}}};
    }
    const std::map<std::string, double>& probabilities = model(action).outcomes.probabilities;
    std::map<std::size_t, double> next;
    double total = 0.0;
    for (const Result& result : semantics_.results(states_[state], action))
    {
      const double probability =
          result.share * (result.label.empty() ? 1.0 : probabilities.at(result.label));
      if (probability > 0.0)
      {
        next[result.outside ? boundary_ : indexOf(result.values)] += probability;
        total += probability;
      }
    }
    if (!(total > 0.0))
    {
      return {false, {{state, 1.0}}};
    }
    Outcomes outcomes{true, {next.begin(), next.end()}};
    for (auto& [target, probability] : outcomes.next)
    {
      probability /= total;  // what outcomes that are impossible here leave over
    }
    return outcomes;
  }

  /// m that the action moves from a state; nothing when there is no way.
  [[nodiscard]] std::optional<double> distance(const GroundAction& action,
                                               const Values& state) const
  {
    const ActionModel& action_model = model(action);
    if (!action_model.cost.from)
    {
      return 0.0;
    }
    std::unordered_map<std::string, std::string> arguments;
    for (std::size_t i = 0; i < action.arguments.size(); ++i)
    {
      arguments.emplace(action_model.parameters[i],
                        semantics_.vocabulary().name(action.arguments[i]));
    }
    reasoner::Atom from = *action_model.cost.from;
    for (reasoner::Term& argument : from.arguments)
    {
      argument = {false, arguments.at(argument.name)};
    }
    const std::optional<std::size_t> fluent =
        semantics_.signature().findFluent(reasoner::toString(from));
    const std::optional<std::size_t> start =
        fluent ? domain_.map().find(semantics_.vocabulary().name(state[*fluent])) : std::nullopt;
    const std::optional<std::size_t> end = domain_.map().find(arguments.at(action_model.cost.to));
    const double distance_m = start && end ? domain_.map().distance(*start, *end) : 0.0;
    return distance_m < std::numeric_limits<double>::infinity() ? std::optional(distance_m)
                                                                : std::nullopt;
  }

  void findSuccess()
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
    findHopeless();
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
    return (coarseValue(values, isBoolean(fluents.front())) == effect.value.name) == effect.equal;
  }

  [[nodiscard]] bool isBoolean(std::size_t fluent) const
  {
    return semantics_.signature().symbols()[semantics_.fluents()[fluent].symbol].boolean;
  }

  /// States from which no sequence of actions leads to success.
  void findHopeless()
  {
    std::vector<std::vector<std::size_t>> before(done_ + 1);
    for (const std::vector<Outcomes>& of_action : outcomes_)
    {
      for (std::size_t state = 0; state < of_action.size(); ++state)
      {
        for (const auto& [next, probability] : of_action[state].next)
        {
          before[next].push_back(state);
        }
      }
    }
    hopeless_.assign(done_ + 1, true);
    hopeless_[done_] = false;
    std::vector<std::size_t> open;
    for (std::size_t state = 0; state < states_.size(); ++state)
    {
      if (success_[state])
      {
        hopeless_[state] = false;
        open.push_back(state);
      }
    }
    while (!open.empty())
    {
      const std::size_t state = open.back();
      open.pop_back();
      for (const std::size_t previous : before[state])
      {
        if (hopeless_[previous])
        {
          hopeless_[previous] = false;
          open.push_back(previous);
        }
      }
    }
  }

  void findObservations()
  {
    std::set<std::string> seen{kNoObservation};
    observation_names_ = {kNoObservation};
    told_.resize(actions_.size());
    for (std::size_t action = 0; action < actions_.size(); ++action)
    {
      laws_.push_back(semantics_.observations(actions_[action]));
      std::vector<bool> arrived(states_.size(), false);
      for (std::size_t state = 0; state < states_.size(); ++state)
      {
        for (const auto& [next, probability] : outcomes_[action][state].next)
        {
          if (next < states_.size() && outcomes_[action][state].executable)
          {
            arrived[next] = true;
          }
        }
      }
      for (std::size_t state = 0; state <= boundary_; ++state)
      {
        told_[action].push_back(toldBy(action, state, state < boundary_ && arrived[state]));
        for (const auto& [name, probability] : told_[action].back())
        {
          if (seen.insert(name).second)
          {
            observation_names_.push_back(name);
          }
        }
      }
    }
  }

  /// @param really  the action was carried out to come here; otherwise it was impossible and
  /// nothing was sensed
  [[nodiscard]] Told toldBy(std::size_t action, std::size_t state, bool really) const
  {
    std::optional<Told> result;
    for (const GroundObservation& law : laws_[action])
    {
      const std::string& fluent =
          semantics_.signature().symbols()[semantics_.fluents()[law.fluent].symbol].name;
      const ObservationModel& observation_model = model(actions_[action]).observations.at(fluent);
      const bool informative = really || semantics_.affects(actions_[action], law.fluent);
      const Told told = toldBy(law, observation_model, state, informative);
      result = result ? joined(*result, told) : told;
    }
    return result ? *result : Told{{kNoObservation, 1.0}};
  }

  [[nodiscard]] Told toldBy(const GroundObservation& law, const ObservationModel& observation_model,
                            std::size_t state, bool informative) const
  {
    const PhysicalFluent& fluent = semantics_.fluents()[law.fluent];
    const int value = state == boundary_ ? Vocabulary::kNone : states_[state][law.fluent];
    const auto yesNo = [](double yes) {
      Told told;
      if (yes > 0.0)
      {
        told["true"] = yes;
      }
      if (yes < 1.0)
      {
        told["false"] = 1.0 - yes;
      }
      return told;
    };
    if (law.value != Vocabulary::kNone)
    {
      const bool is_so = informative && value == law.value;
      return yesNo(is_so ? observation_model.true_positive : observation_model.false_positive);
    }
    if (isBoolean(law.fluent))
    {
      const bool is_so = value == semantics_.signature().trueValue();
      const bool told = informative && value != Vocabulary::kNone;
      return yesNo(
          told ? (is_so ? observation_model.true_positive : observation_model.false_positive)
               : 0.5);
    }
    if (value == Vocabulary::kNone)
    {
      return {{kOutside, 1.0}};
    }
    Told told;
    const auto count = static_cast<double>(fluent.values.size());
    const double right = count < 2.0 ? 1.0 : observation_model.true_positive;
    for (const int candidate : fluent.values)
    {
      const double wrong = (1.0 - right) / (count - 1.0);
      const double probability = informative ? (candidate == value ? right : wrong) : 1.0 / count;
      if (probability > 0.0)
      {
        told[semantics_.vocabulary().name(candidate)] = probability;
      }
    }
    return told;
  }

  void addAction(pomdp::ModelBuilder& builder, std::size_t action)
  {
    const CostModel& cost = model(actions_[action]).cost;
    for (std::size_t state = 0; state < states_.size(); ++state)
    {
      const Outcomes& outcomes = outcomes_[action][state];
      for (const auto& [next, probability] : outcomes.next)
      {
        builder.addTransition(action, state, next, probability);
      }
      const double seconds =
          outcomes.executable
              ? cost.base_s +
                    cost.per_metre_s * distance(actions_[action], states_[state]).value_or(0.0)
              : cost.impossible_s;
      builder.setReward(action, state, -seconds);
    }
    for (std::size_t state = 0; state <= boundary_; ++state)
    {
      for (const auto& [name, probability] : told_[action][state])
      {
        builder.addObservation(action, state, builder.observation(name), probability);
      }
    }
    builder.setTransition(action, boundary_, boundary_, 1.0);
    builder.setReward(action, boundary_, -cost.impossible_s);
    builder.setTransition(action, done_, done_, 1.0);
    builder.setObservation(action, done_, builder.observation(kNoObservation), 1.0);
  }

  void addFinish(pomdp::ModelBuilder& builder)
  {
    const std::size_t finish = actions_.size();
    const std::size_t none = builder.observation(kNoObservation);
    for (std::size_t state = 0; state <= done_; ++state)
    {
      builder.setTransition(finish, state, done_, 1.0);
      builder.setObservation(finish, state, none, 1.0);
      const RewardModel& rewards = models_.rewards;
      const double reward = success_[state]
                                ? rewards.success
                                : (hopeless_[state] ? rewards.given_up : rewards.wrong_finish);
      builder.setReward(finish, state, state == done_ ? 0.0 : reward);
    }
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

  [[nodiscard]] PomdpTask task(pomdp::Model model) const
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
      const bool is_finish = action == actions_.size();
      std::set<std::size_t> observations;
      for (std::size_t state = 0; state <= boundary_; ++state)
      {
        for (const pomdp::SparseEntry& entry : task.model_.observations(action, state))
        {
          observations.insert(entry.index);
        }
      }
      task.observations_of_.emplace_back(observations.begin(), observations.end());
      task.action_texts_.push_back(is_finish ? "finish" : actions_[action].name);
      task.action_symbols_.push_back(is_finish ? "finish" : actions_[action].symbol);
      task.action_arguments_.emplace_back();
      for (const int argument : is_finish ? std::vector<int>{} : actions_[action].arguments)
      {
        task.action_arguments_.back().push_back(semantics_.vocabulary().name(argument));
      }
    }
    task.success_ = success_;
    task.hopeless_ = hopeless_;
    task.coarse_fluents_ = refinement::coarseFluents(domain_, semantics_);
    return task;
  }

  const LowLevelDomain& domain_;
  const Models& models_;
  const Zoom& zoom_;
  Semantics semantics_;
  std::vector<Values> states_;
  std::vector<GroundAction> actions_;
  std::unordered_map<Values, std::size_t, ValuesHash> index_;
  std::size_t boundary_ = 0;
  std::size_t done_ = 0;
  std::vector<double> weights_;
  std::vector<std::vector<Outcomes>> outcomes_;  // [action][state]
  std::vector<std::vector<GroundObservation>> laws_;
  std::vector<std::vector<Told>> told_;  // [action][state], the boundary's last
  std::vector<std::string> observation_names_;
  std::vector<bool> success_;
  std::vector<bool> hopeless_;
};

PomdpTask generatePomdp(const LowLevelDomain& domain, const Models& models, const Zoom& zoom,
                        const InitialKnowledge& knowledge, const GeneratorLimits& limits)
{
  return TaskGenerator(domain, models, zoom, knowledge, limits).generate();
}

}  // namespace kr3::refinement
