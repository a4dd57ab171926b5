#include "kr3_refinement/task_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "known_variables.hpp"

namespace kr3::refinement
{
namespace
{

constexpr double kTolerance = 1e-9;

std::string number(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

/// Looks through a task's POMDP.
class Validation
{
public:
  explicit Validation(const PomdpTask& task)
    : task_(task), model_(task.model()), reachable_(reachableStates(task.model()))
  {
  }

  TaskReport report()
  {
    checkRows();
    checkStates();
    checkActions();
    checkObservations();
    return std::move(report_);
  }

private:
  void checkRows()
  {
    for (std::size_t action = 0; action < model_.numActions(); ++action)
    {
      for (std::size_t state = 0; state < model_.numStates(); ++state)
      {
        checkRow("T", action, state, model_.transitions(action, state));
        checkRow("O", action, state, model_.observations(action, state));
      }
    }
    std::vector<pomdp::SparseEntry> start;
    for (std::size_t state = 0; state < model_.numStates(); ++state)
    {
      start.push_back({static_cast<std::uint32_t>(state), model_.initialBelief()[state]});
    }
    const std::string problem = rowProblem({start.data(), start.data() + start.size()});
    if (!problem.empty())
    {
      report_.bad_rows.push_back("the initial belief: " + problem);
    }
  }

  void checkRow(const char* what, std::size_t action, std::size_t state,
                const pomdp::SparseRow& row)
  {
    const std::string problem = rowProblem(row);
    if (!problem.empty())
    {
      report_.bad_rows.push_back(std::string(what) + " of " + task_.actionText(action) + " in " +
                                 model_.stateName(state) + ": " + problem);
    }
  }

  void checkStates()
  {
    report_.num_states = task_.boundaryState();
    report_.unachievable = true;
    for (std::size_t state = 0; state < task_.boundaryState(); ++state)
    {
      if (!reachable_[state])
      {
        report_.unreachable_states.push_back(model_.stateName(state));
        continue;
      }
      ++report_.num_reachable;
      report_.unachievable = report_.unachievable && !task_.isSuccess(state);
    }
  }

  void checkActions()
  {
    for (std::size_t action = 0; action < task_.finishAction(); ++action)
    {
      bool possible = false;
      for (std::size_t state = 0; state < task_.boundaryState() && !possible; ++state)
      {
        possible = reachable_[state] && task_.isExecutable(action, state);
      }
      if (!possible)
      {
        report_.impossible_actions.push_back(task_.actionText(action));
      }
    }
  }

  void checkObservations()
  {
    std::vector<bool> given(model_.numObservations(), false);
    for (std::size_t action = 0; action < model_.numActions(); ++action)
    {
      std::vector<bool> arrived(model_.numStates(), false);  // by carrying the action out
      for (std::size_t state = 0; state < model_.numStates(); ++state)
      {
        if (!reachable_[state])
        {
          continue;
        }
        for (const pomdp::SparseEntry& next : model_.transitions(action, state))
        {
          arrived[next.index] = arrived[next.index] || task_.isExecutable(action, state);
          for (const pomdp::SparseEntry& seen : model_.observations(action, next.index))
          {
            given[seen.index] = true;
          }
        }
      }
      checkMisleading(action, arrived);
    }
    for (std::size_t observation = 0; observation < given.size(); ++observation)
    {
      if (!given[observation])
      {
        report_.impossible_observations.push_back(model_.observationName(observation));
      }
    }
  }

  void checkMisleading(std::size_t action, const std::vector<bool>& arrived)
  {
    const std::vector<bool>& feedback = task_.isFeedback(action);
    if (std::find(feedback.begin(), feedback.end(), false) == feedback.end())
    {
      return;  // it tells of its own effects only
    }
    for (std::size_t state = 0; state < task_.boundaryState(); ++state)
    {
      if (reachable_[state] && arrived[state] && !task_.isExecutable(action, state))
      {
        report_.misleading_observations.push_back(task_.actionText(action) + " in " +
                                                  model_.stateName(state));
      }
    }
  }

  const PomdpTask& task_;
  const pomdp::Model& model_;
  std::vector<bool> reachable_;
  TaskReport report_;
};

void addLine(const char* what, const std::vector<std::string>& names, std::size_t max_names,
             std::string& text)
{
  if (names.empty())
  {
    return;
  }
  text += std::string("  ") + what + ": " + std::to_string(names.size()) + "\n";
  for (std::size_t i = 0; i < std::min(max_names, names.size()); ++i)
  {
    text += "    " + names[i] + "\n";
  }
  if (names.size() > max_names)
  {
    text += "    and " + std::to_string(names.size() - max_names) + " more\n";
  }
}

}  // namespace

std::string rowProblem(const pomdp::SparseRow& row)
{
  double total = 0.0;
  for (const pomdp::SparseEntry& entry : row)
  {
    if (!(entry.probability >= 0.0 && entry.probability <= 1.0 + kTolerance))
    {
      return number(entry.probability) + " among them";
    }
    total += entry.probability;
  }
  return std::abs(total - 1.0) <= kTolerance ? std::string() : number(total) + " in all";
}

std::string TaskReport::text(std::size_t max_names) const
{
  std::string text = "  " + std::to_string(num_reachable) + " of " + std::to_string(num_states) +
                     " physical states can come about from the start\n";
  if (unachievable)
  {
    text += "  no state that can come about has the effects: the policy can only give up\n";
  }
  addLine("rows that are no distributions", bad_rows, max_names, text);
  addLine("states that never come about", unreachable_states, max_names, text);
  addLine("actions that are never possible", impossible_actions, max_names, text);
  addLine("observations that are never made", impossible_observations, max_names, text);
  addLine("impossible attempts that tell as much as possible ones", misleading_observations,
          max_names, text);
  return text;
}

TaskReport validate(const PomdpTask& task)
{
  return Validation(task).report();
}

}  // namespace kr3::refinement
