#include <algorithm>
#include <cstddef>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdpx_format.hpp"
#include "pomdpx_writer.hpp"

namespace kr3::pomdp
{

namespace
{

class FactoredWriter
{
public:
  FactoredWriter(std::ostream& out, const FactoredModel& model)
    : xml_(out, model.discount), model_(model)
  {
    for (const StateVariable& variable : model.state)
    {
      previous_.push_back(newName(variable.name));
      state_values_.push_back(pomdpxNames(variable.values));
    }
    named(model.actions, actions_, action_values_);
    named(model.observations, observations_, observation_values_);
    for (const StateVariable& variable : model.state)
    {
      std::string name = variable.name;
      if (name.size() > 2 && name.compare(name.size() - 2, 2, "_0") == 0)
      {
        name.resize(name.size() - 2);
      }
      name += "_1";
      while (taken_.count(name) != 0)
      {
        name += "_";
      }
      current_.push_back(newName(name));
    }
    for (std::size_t i = 0; i < model.rewards.size(); ++i)
    {
      std::string name = "reward_" + std::to_string(i);
      while (taken_.count(name) != 0)
      {
        name += "_";
      }
      rewards_.push_back(newName(name));
    }
  }

  void write()
  {
    variables();
    section("InitialStateBelief", model_.initial);
    section("StateTransitionFunction", model_.transitions);
    if (!model_.observations.empty())
    {
      section("ObsFunction", model_.observing);
    }
    xml_.open("RewardFunction");
    for (std::size_t i = 0; i < model_.rewards.size(); ++i)
    {
      factor(model_.rewards[i], rewards_[i]);
    }
    xml_.close("RewardFunction");
    xml_.end();
  }

private:
  /// @throws InvalidArgument  a second variable of this name, or one that the format cannot hold
  std::string newName(const std::string& name)
  {
    if (!taken_.insert(name).second)
    {
      throw InvalidArgument("two variables are called '" + name + "'");
    }
    return pomdpxNames({name}).front();
  }

  void named(const std::vector<Variable>& variables, std::vector<std::string>& names,
             std::vector<std::vector<std::string>>& values)
  {
    for (const Variable& variable : variables)
    {
      names.push_back(newName(variable.name));
      values.push_back(pomdpxNames(variable.values));
    }
  }

  void variables()
  {
    xml_.open("Variable");
    for (std::size_t v = 0; v < model_.state.size(); ++v)
    {
      xml_.stateVariable(previous_[v], current_[v], model_.state[v].observed, state_values_[v]);
    }
    for (std::size_t v = 0; v < actions_.size(); ++v)
    {
      xml_.variable("ActionVar", actions_[v], action_values_[v]);
    }
    for (std::size_t v = 0; v < observations_.size(); ++v)
    {
      xml_.variable("ObsVar", observations_[v], observation_values_[v]);
    }
    for (const std::string& reward : rewards_)
    {
      xml_.rewardVariable(reward);
    }
    xml_.close("Variable");
  }

  void section(const char* name, const std::vector<Factor>& factors)
  {
    xml_.open(name);
    for (const Factor& each : factors)
    {
      factor(each, "");
    }
    xml_.close(name);
  }

  [[nodiscard]] const std::string& nameOf(const VariableRef& ref) const
  {
    switch (ref.role)
    {
      case VariableRole::kPrevious:
        return previous_.at(ref.index);
      case VariableRole::kCurrent:
        return current_.at(ref.index);
      case VariableRole::kAction:
        return actions_.at(ref.index);
      default:
        return observations_.at(ref.index);
    }
  }

  [[nodiscard]] const std::vector<std::string>& valuesOf(const VariableRef& ref) const
  {
    switch (ref.role)
    {
      case VariableRole::kAction:
        return action_values_.at(ref.index);
      case VariableRole::kObservation:
        return observation_values_.at(ref.index);
      default:
        return state_values_.at(ref.index);
    }
  }

  [[nodiscard]] std::vector<std::string> namesOf(const std::vector<VariableRef>& refs) const
  {
    std::vector<std::string> names;
    for (const VariableRef& ref : refs)
    {
      names.push_back(nameOf(ref));
    }
    return names;
  }

  /// @param reward  the name of the reward; empty for probabilities
  void factor(const Factor& factor, const std::string& reward)
  {
    if (factor.values.size() != model_.sizeOf(factor) || factor.of.empty() == reward.empty())
    {
      throw InvalidArgument("a factor with " + std::to_string(factor.values.size()) +
                            " entries of " + std::to_string(factor.of.size()) +
                            " variables, expected " + std::to_string(model_.sizeOf(factor)) +
                            " entries, and no variable for a reward only");
    }
    xml_.openTable(!reward.empty(),
                   reward.empty() ? namesOf(factor.of) : std::vector<std::string>{reward},
                   namesOf(factor.parents));
    std::vector<VariableRef> scope = factor.parents;
    scope.insert(scope.end(), factor.of.begin(), factor.of.end());
    if (scope.empty())
    {
      xml_.entry("", factor.values);
    }
    else
    {
      rows(factor, scope);
    }
    xml_.closeTable();
  }

  /// The entries by all variables but the last: each that is not 0, or all at once where most are
  /// not.
  void rows(const Factor& factor, const std::vector<VariableRef>& scope)
  {
    const std::vector<std::string>& columns = valuesOf(scope.back());
    std::vector<std::size_t> at(scope.size(), 0);
    for (std::size_t start = 0; start < factor.values.size(); start += columns.size())
    {
      const auto first = factor.values.begin() + static_cast<std::ptrdiff_t>(start);
      const std::vector<double> row(first, first + static_cast<std::ptrdiff_t>(columns.size()));
      std::string instance;
      for (std::size_t i = 0; i + 1 < scope.size(); ++i)
      {
        instance += valuesOf(scope[i])[at[i]] + " ";
      }
      const auto zeros = static_cast<std::size_t>(std::count(row.begin(), row.end(), 0.0));
      if (2 * zeros < row.size() && row.size() > 1)
      {
        xml_.entry(instance + "-", row);
      }
      else
      {
        for (std::size_t i = 0; i < row.size(); ++i)
        {
          if (row[i] != 0.0)
          {
            xml_.entry(instance + columns[i], {row[i]});
          }
        }
      }
      for (std::size_t i = scope.size() - 1; i-- > 0;)
      {
        at[i] = at[i] + 1 < valuesOf(scope[i]).size() ? at[i] + 1 : 0;
        if (at[i] != 0)
        {
          break;
        }
      }
    }
  }

  PomdpxElements xml_;
  const FactoredModel& model_;
  std::set<std::string> taken_;
  std::vector<std::string> previous_;
  std::vector<std::string> current_;
  std::vector<std::string> actions_;
  std::vector<std::string> observations_;
  std::vector<std::string> rewards_;
  std::vector<std::vector<std::string>> state_values_;
  std::vector<std::vector<std::string>> action_values_;
  std::vector<std::vector<std::string>> observation_values_;
};

}  // namespace

void writePomdpx(std::ostream& out, const FactoredModel& model)
{
  FactoredWriter(out, model).write();
}

}  // namespace kr3::pomdp
