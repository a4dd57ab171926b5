#include "plan_trial.hpp"

#include <algorithm>

namespace kr3::reasoner
{

namespace
{

/// What comes of the actions of one step.
struct Trial
{
  bool is_impossible = false;          ///< for certain
  std::optional<StateLiterals> state;  ///< nothing when that is open
};

Trial afterStep(const std::vector<std::string>& actions, const StateLiterals& state,
                Dynamics& dynamics)
{
  RuleSink sink;  // what is written there is open
  std::vector<int> wanted;
  std::vector<SolverLiteral> occurs(dynamics.actions().size(), kFalseLiteral);
  for (const std::string& action : actions)
  {
    wanted.push_back(dynamics.actionNumber(action));
    occurs[static_cast<std::size_t>(wanted.back())] = kTrueLiteral;
  }
  const std::vector<SolverLiteral> impossible = dynamics.impossible(state, wanted, sink);
  const auto is = [&](SolverLiteral truth) {
    return [&impossible, truth](int action) {
      return impossible[static_cast<std::size_t>(action)] == truth;
    };
  };
  if (!std::all_of(wanted.begin(), wanted.end(), is(kFalseLiteral)))
  {
    return {std::any_of(wanted.begin(), wanted.end(), is(kTrueLiteral)), std::nullopt};
  }
  StateLiterals after = dynamics.successor(state, occurs, sink);
  if (sink.numRules() > 0 || sink.numAtoms() > 0)
  {
    return {};
  }
  return {false, std::move(after)};
}

}  // namespace

std::optional<StateLiterals> stateAfter(const PlanSteps& steps, StateLiterals state,
                                        Dynamics& dynamics)
{
  for (const std::vector<std::string>& actions : steps)
  {
    Trial trial = afterStep(actions, state, dynamics);
    if (!trial.state)
    {
      return std::nullopt;
    }
    state = std::move(*trial.state);
  }
  return state;
}

bool surelyFails(const PlanSteps& steps, StateLiterals state, Dynamics& dynamics,
                 const std::function<SolverLiteral(const StateLiterals&)>& goal)
{
  for (const std::vector<std::string>& actions : steps)
  {
    Trial trial = afterStep(actions, state, dynamics);
    if (!trial.state)
    {
      return trial.is_impossible;
    }
    state = std::move(*trial.state);
  }
  return goal(state) == kFalseLiteral;
}

}  // namespace kr3::reasoner
