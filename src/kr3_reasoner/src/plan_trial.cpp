#include "plan_trial.hpp"

#include <algorithm>

namespace kr3::reasoner
{

std::optional<StateLiterals> stateAfter(const PlanSteps& steps, StateLiterals state,
                                        Dynamics& dynamics)
{
  for (const std::vector<std::string>& actions : steps)
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
    const bool possible = std::all_of(wanted.begin(), wanted.end(), [&](int action) {
      return impossible[static_cast<std::size_t>(action)] == kFalseLiteral;
    });
    if (!possible)
    {
      return std::nullopt;
    }
    state = dynamics.successor(state, occurs, sink);
    if (sink.numRules() > 0 || sink.numAtoms() > 0)
    {
      return std::nullopt;
    }
  }
  return state;
}

}  // namespace kr3::reasoner
