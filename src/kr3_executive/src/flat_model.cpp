#include "flat_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/model_builder.hpp>

namespace kr3::executive
{
namespace
{

using refinement::DomainTask;
using refinement::StateId;

const std::string kFinish = "finish";
const std::string kNoObservation = "none";
const std::string kDone = "done";

std::string withoutBlanks(std::string name)
{
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

class Enumeration
{
public:
  Enumeration(DomainTask& task, const refinement::SparseBelief& start,
              const reasoner::Formula& goal, std::size_t max_rows)
    : task_(task)
  {
    for (const auto& entry : start)
      add(entry.first);
    for (std::size_t next = 0; next < states.size(); ++next)
    {
      if (states.size() * (task.numActions() + 1) > max_rows)
      {
        throw ResourceExhausted("the flat model has more than " + std::to_string(max_rows) +
                                " rows of T (actions times states)");
      }
      for (std::size_t action = 0; action < task.numActions(); ++action)
      {
        for (const auto& outcome : task.transition(states[next], action).next)
          add(outcome.state);
      }
    }
    for (const StateId state : states)
      success.push_back(task.holds(goal, state));
    findHopeless();
  }

  std::vector<StateId> states;
  std::unordered_map<StateId, std::size_t> number;
  std::vector<bool> success;
  std::vector<bool> hopeless;

private:
  void add(StateId state)
  {
    if (number.emplace(state, states.size()).second)
      states.push_back(state);
  }

  /// States from which no actions lead to success.
  void findHopeless()
  {
    std::vector<std::vector<std::size_t>> before(states.size());
    for (std::size_t state = 0; state < states.size(); ++state)
    {
      for (std::size_t action = 0; action < task_.numActions(); ++action)
      {
        for (const auto& outcome : task_.transition(states[state], action).next)
          before[number.at(outcome.state)].push_back(state);
      }
    }
    hopeless.assign(states.size(), true);
    std::vector<std::size_t> open;
    for (std::size_t state = 0; state < states.size(); ++state)
    {
      if (success[state])
      {
        hopeless[state] = false;
        open.push_back(state);
      }
    }
    while (!open.empty())
    {
      const std::size_t state = open.back();
      open.pop_back();
      for (const std::size_t previous : before[state])
      {
        if (hopeless[previous])
        {
          hopeless[previous] = false;
          open.push_back(previous);
        }
      }
    }
  }

  DomainTask& task_;
};

/// What each action tells in each state that it can lead to: sensed where it really led there.
using ToldTable = std::vector<std::vector<std::vector<std::pair<std::string, double>>>>;

ToldTable toldTable(DomainTask& task, const Enumeration& all)
{
  ToldTable told(task.numActions());
  for (std::size_t action = 0; action < task.numActions(); ++action)
  {
    std::vector<bool> arrived(all.states.size(), false);
    for (const StateId state : all.states)
    {
      const auto& transition = task.transition(state, action);
      for (const auto& outcome : transition.next)
      {
        if (transition.executable)
          arrived[all.number.at(outcome.state)] = true;
      }
    }
    for (std::size_t state = 0; state < all.states.size(); ++state)
      told[action].push_back(task.told(action, all.states[state], arrived[state]));
  }
  return told;
}

}  // namespace

Objective objectiveFor(const refinement::LowLevelDomain& domain, const refinement::Models& models)
{
  std::set<std::string> wholes;
  for (const auto& component : domain.map().components())
    wholes.insert(component.part_of);
  const double scale = std::max(1.0, static_cast<double>(wholes.size()) / 2.0);
  return {models.rewards.success * scale, models.rewards.given_up * scale,
          models.rewards.wrong_finish * scale, std::pow(models.discount, 1.0 / scale)};
}

double endWorth(const Objective& objective, double achieved)
{
  return achieved * objective.success + (1.0 - achieved) * objective.wrong_finish;
}

pomdp::Belief FlatModel::belief(const refinement::SparseBelief& sparse) const
{
  std::vector<double> dense(model.numStates(), 0.0);
  for (const auto& [state, probability] : sparse)
  {
    const auto found = number.find(state);
    if (found == number.end())
      throw FailedPrecondition("the belief is in a state that the flat model cannot reach");
    dense[found->second] = probability;
  }
  return pomdp::Belief(std::move(dense));
}

FlatModel flatModel(DomainTask& task, const refinement::SparseBelief& start,
                    const reasoner::Formula& goal, const Objective& objective, std::size_t max_rows)
{
  Enumeration all(task, start, goal, max_rows);
  const ToldTable told = toldTable(task, all);
  std::vector<std::string> state_names;
  for (const StateId state : all.states)
  {
    std::string name;
    for (std::size_t i = 0; i < task.space().fluents().size(); ++i)
      name += (i == 0 ? "" : ",") + withoutBlanks(task.space().fluents()[i].name) + "=" +
              task.space().value(state, i);
    state_names.push_back(std::move(name));
  }
  state_names.push_back(kDone);
  std::vector<std::string> action_names;
  for (const auto& action : task.space().actions())
    action_names.push_back(withoutBlanks(action.text));
  action_names.push_back(kFinish);
  std::vector<std::string> observation_names{kNoObservation};
  std::set<std::string> seen{kNoObservation};
  for (const auto& of_action : told)
  {
    for (const auto& of_state : of_action)
    {
      for (const auto& entry : of_state)
      {
        if (seen.insert(entry.first).second)
          observation_names.push_back(entry.first);
      }
    }
  }

  pomdp::ModelBuilder builder(std::move(state_names), std::move(action_names),
                              std::move(observation_names));
  builder.setDiscount(objective.discount);
  const std::size_t done = all.states.size();
  const std::size_t finish = task.numActions();
  const std::size_t none = builder.observation(kNoObservation);
  std::vector<double> belief(done + 1, 0.0);
  for (const auto& [state, probability] : start)
    belief[all.number.at(state)] = probability;
  builder.setInitialBelief(std::move(belief));
  for (std::size_t action = 0; action < task.numActions(); ++action)
  {
    for (std::size_t state = 0; state < done; ++state)
    {
      const auto& transition = task.transition(all.states[state], action);
      for (const auto& outcome : transition.next)
        builder.addTransition(action, state, all.number.at(outcome.state), outcome.probability);
      builder.setReward(action, state, -transition.cost_s);
      for (const auto& [name, probability] : told[action][state])
        builder.addObservation(action, state, builder.observation(name), probability);
    }
    builder.setTransition(action, done, done, 1.0);
    builder.setObservation(action, done, none, 1.0);
  }
  for (std::size_t state = 0; state <= done; ++state)
  {
    builder.setTransition(finish, state, done, 1.0);
    builder.setObservation(finish, state, none, 1.0);
    if (state < done)
    {
      builder.setReward(finish, state,
                        all.success[state]
                            ? objective.success
                            : (all.hopeless[state] ? objective.given_up : objective.wrong_finish));
    }
  }
  return {builder.build(), std::move(all.states), std::move(all.number)};
}

}  // namespace kr3::executive
