// The effort of one high-level action, from its POMDP: shortest paths among chances, and a tour of
// looks through the components of what is assumed.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "kr3_executive/plan_cost.hpp"

namespace kr3::executive
{
namespace
{

using refinement::kElsewhere;
using refinement::PomdpTask;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kMaxSweeps = 2000;
constexpr int kMaxPath = 100;
constexpr double kPrecise_s = 1e-3;

/// The states as the robot sees them: physical states without the hidden fluent.
class EffortOf
{
public:
  EffortOf(const PomdpTask& task, std::optional<std::size_t> hidden, double threshold, double prior)
    : task_(task), hidden_(hidden), threshold_(threshold), prior_(prior)
  {
    const auto& model = task.model();
    for (std::size_t state = 0; state < model.numStates(); ++state)
    {
      if (task.kind(state) == PomdpTask::StateKind::kPhysical)
        physical_.push_back(state);
    }
  }

  Effort find()
  {
    std::vector<bool> success(task_.model().numStates(), false);
    for (const std::size_t state : physical_)
      success[state] = task_.isSuccess(state);
    to_success_ = costsTo(success);
    Effort effort;
    if (hidden_)
      search(effort);
    if (!effort.checks)
      effort.success_s = meanAtStart();
    return effort;
  }

private:
  /// A state in which an action tells whether the hidden fluent has a value.
  struct Look
  {
    std::size_t action = 0;
    double true_positive = 0.0;
    double false_positive = 0.0;
  };

  [[nodiscard]] double cost(std::size_t action, std::size_t state) const
  {
    return -task_.model().reward(action, state);
  }

  /// Expected seconds for an action and what follows it. Where it leaves the zoom, or leads where
  /// the target cannot be reached any more, it counts as undone.
  [[nodiscard]] double costOf(std::size_t action, std::size_t state,
                              const std::vector<double>& costs) const
  {
    double stays = 0.0;
    double rest = 0.0;
    for (const auto& next : task_.model().transitions(action, state))
    {
      if (next.index == state || !std::isfinite(costs[next.index]))
        stays += next.probability;
      else
        rest += next.probability * costs[next.index];
    }
    return stays > 1.0 - 1e-9 ? kInfinite : (cost(action, state) + rest) / (1.0 - stays);
  }

  /// Expected seconds from each state to the targets, by value iteration; infinite where there is
  /// no way.
  [[nodiscard]] std::vector<double> costsTo(const std::vector<bool>& targets) const
  {
    std::vector<double> costs(task_.model().numStates(), kInfinite);
    for (const std::size_t state : physical_)
      costs[state] = targets[state] ? 0.0 : kInfinite;
    double change = kInfinite;
    for (int sweep = 0; sweep < kMaxSweeps && change > kPrecise_s; ++sweep)
    {
      change = 0.0;
      for (const std::size_t state : physical_)
      {
        if (targets[state])
          continue;
        const double best = bestAction(state, costs).second;
        if (best == costs[state])
          continue;
        change = std::isfinite(costs[state]) ? std::max(change, std::abs(best - costs[state]))
                                             : kInfinite;
        costs[state] = best;
      }
    }
    return costs;
  }

  [[nodiscard]] std::pair<std::size_t, double> bestAction(std::size_t state,
                                                          const std::vector<double>& costs) const
  {
    std::pair<std::size_t, double> best{task_.finishAction(), kInfinite};
    for (std::size_t action = 0; action < task_.finishAction(); ++action)
    {
      if (!task_.isExecutable(action, state))
        continue;
      const double candidate = costOf(action, state, costs);
      if (candidate < best.second)
        best = {action, candidate};
    }
    return best;
  }

  /// Over the start belief, given that the effects can be reached.
  [[nodiscard]] double meanAtStart() const
  {
    const auto& belief = task_.model().initialBelief();
    double mass = 0.0;
    double total = 0.0;
    for (const std::size_t state : physical_)
    {
      if (belief[state] > 0.0 && std::isfinite(to_success_[state]))
      {
        mass += belief[state];
        total += belief[state] * to_success_[state];
      }
    }
    return mass > 0.0 ? total / mass : kInfinite;
  }

  /// The state that differs in the hidden fluent alone. @return none: no such state is consistent
  [[nodiscard]] std::optional<std::size_t> with(std::size_t state, int value) const
  {
    auto values = task_.physicalState(state);
    values[*hidden_] = value;
    const auto found = index_.find(values);
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  }

  [[nodiscard]] double told(std::size_t action, std::size_t state, std::size_t observation) const
  {
    for (const auto& entry : task_.model().observations(action, state))
    {
      if (entry.index == observation)
        return entry.probability;
    }
    return 0.0;
  }

  /// The cheapest look for a value in a state where the value is `elsewhere`.
  [[nodiscard]] std::optional<Look> lookAt(std::size_t state, int value) const
  {
    const auto here = with(state, value);
    if (!here)
      return std::nullopt;
    std::optional<Look> best;
    const std::string& fluent = task_.fluents()[*hidden_].name;
    for (std::size_t action = 0; action < task_.finishAction(); ++action)
    {
      const auto& about = task_.observedFluents(action);
      if (!task_.isExecutable(action, state) ||
          std::find(about.begin(), about.end(), fluent) == about.end())
        continue;
      Look look{action, 0.0, 0.0};
      for (const std::size_t observation : task_.observationsOf(action))
      {
        const double yes = told(action, *here, observation);
        const double no = told(action, state, observation);
        if (yes - no > look.true_positive - look.false_positive)
          look = {action, yes, no};
      }
      const bool informs = look.true_positive > look.false_positive + 1e-6;
      if (informs && (!best || cost(action, state) < cost(best->action, state)))
        best = look;
    }
    return best;
  }

  void search(Effort& effort)
  {
    const auto& values = task_.fluents()[*hidden_].values;
    const auto elsewhere = std::find(values.begin(), values.end(), kElsewhere);
    if (elsewhere == values.end())
      return;
    const auto nowhere = static_cast<int>(elsewhere - values.begin());
    for (const std::size_t state : physical_)
      index_.emplace(task_.physicalState(state), state);
    std::vector<std::size_t> empty;  // states where the object is not here
    for (const std::size_t state : physical_)
    {
      if (task_.physicalState(state)[*hidden_] == nowhere)
        empty.push_back(state);
    }
    std::vector<int> components;
    const auto& belief = task_.model().initialBelief();
    for (int value = 0; value < nowhere; ++value)
    {
      const bool likely = std::any_of(physical_.begin(), physical_.end(), [&](std::size_t state) {
        return belief[state] > 0.0 && task_.physicalState(state)[*hidden_] == value;
      });
      if (likely)
        components.push_back(value);
    }
    for (const int value : components)
    {
      std::map<std::size_t, Look> looks;
      std::vector<bool> targets(task_.model().numStates(), false);
      for (const std::size_t state : empty)
      {
        if (const auto look = lookAt(state, value))
        {
          looks.emplace(state, *look);
          targets[state] = true;
        }
      }
      if (looks.empty())
        return;  // it cannot be looked for
      looks_.push_back(std::move(looks));
      to_look_.push_back(costsTo(targets));
    }
    tours(components, empty, effort);
  }

  /// Means over the states in which the tour may begin.
  void tours(const std::vector<int>& components, const std::vector<std::size_t>& empty,
             Effort& effort)
  {
    const auto& belief = task_.model().initialBelief();
    double mass = 0.0;
    for (const std::size_t state : empty)
    {
      if (!(belief[state] > 0.0))
        continue;
      Effort from;
      tour(components, state, from);
      mass += belief[state];
      effort.success_s += belief[state] * from.success_s;
      effort.failure_s += belief[state] * from.failure_s;
    }
    if (!(mass > 0.0) || components.empty())
      return;
    effort.success_s /= mass;
    effort.failure_s /= mass;
    effort.checks = true;
  }

  /// All components once, the nearest next.
  void tour(const std::vector<int>& components, std::size_t state, Effort& effort) const
  {
    const auto n = static_cast<double>(components.size());
    std::vector<bool> seen(components.size(), false);
    double time_s = 0.0;
    double found_s = 0.0;  // mean time of the look at the right component
    double then_s = 0.0;   // mean time from there to the effects
    double again_s = 0.0;  // mean time of one more look there
    Look worst;
    worst.true_positive = 1.0;
    for (std::size_t i = 0; i < components.size(); ++i)
    {
      std::size_t next = components.size();
      for (std::size_t j = 0; j < components.size(); ++j)
      {
        if (!seen[j] && (next == components.size() || to_look_[j][state] < to_look_[next][state]))
          next = j;
      }
      seen[next] = true;
      time_s += to_look_[next][state];
      if (!std::isfinite(time_s))
      {
        effort.success_s = effort.failure_s = kInfinite;
        return;
      }
      state = walked(state, next);
      const Look& look = looks_[next].at(state);
      const double look_s = cost(look.action, state);
      time_s += look_s;
      found_s += time_s / n;
      again_s += look_s / look.true_positive / n;
      then_s += to_success_[with(state, components[next]).value_or(state)] / n;
      if (look.true_positive < worst.true_positive)
        worst = look;
    }
    const double misses = 1.0 / worst.true_positive - 1.0;
    effort.success_s = found_s + misses * time_s + (looksToBelieve(worst, n) - 1.0) * again_s;
    effort.success_s += then_s;
    effort.failure_s = passesToRefute(worst) * time_s;
  }

  /// Where one is after going to look for a component, by the likeliest outcomes.
  [[nodiscard]] std::size_t walked(std::size_t state, std::size_t component) const
  {
    for (int i = 0; i < kMaxPath && looks_[component].count(state) == 0; ++i)
    {
      const std::size_t action = bestAction(state, to_look_[component]).first;
      std::size_t likeliest = state;
      double most = 0.0;
      for (const auto& next : task_.model().transitions(action, state))
      {
        if (next.index != state && next.probability > most)
        {
          most = next.probability;
          likeliest = next.index;
        }
      }
      state = likeliest;
    }
    return looks_[component].count(state) != 0 ? state : looks_[component].begin()->first;
  }

  [[nodiscard]] static double logOdds(double probability)
  {
    return std::log(probability / (1.0 - probability));
  }

  /// Positive looks until a component is believed above the threshold.
  [[nodiscard]] double looksToBelieve(const Look& look, double num_components) const
  {
    if (look.false_positive <= 0.0)
      return 1.0;
    const double needed = logOdds(threshold_) - logOdds(prior_ / num_components);
    return std::max(1.0, std::ceil(needed / std::log(look.true_positive / look.false_positive)));
  }

  /// Passes without a positive look until the assumption is refuted.
  [[nodiscard]] double passesToRefute(const Look& look) const
  {
    if (look.true_positive >= 1.0)
      return 1.0;
    const double a_pass = std::log((1.0 - look.false_positive) / (1.0 - look.true_positive));
    const double needed = logOdds(threshold_) + logOdds(prior_);
    return std::max(1.0, std::ceil(needed / a_pass));
  }

  const PomdpTask& task_;
  std::optional<std::size_t> hidden_;
  double threshold_;
  double prior_;
  std::vector<std::size_t> physical_;
  std::map<reasoner::State, std::size_t> index_;
  std::vector<double> to_success_;
  std::vector<std::map<std::size_t, Look>> looks_;  // [component], by state
  std::vector<std::vector<double>> to_look_;        // [component][state]
};

}  // namespace

Effort effortOf(const PomdpTask& task, const std::string& assumed, double threshold, double prior)
{
  std::optional<std::size_t> hidden;
  for (std::size_t i = 0; i < task.fluents().size(); ++i)
  {
    if (!assumed.empty() && task.fluents()[i].name == assumed)
      hidden = i;
  }
  return EffortOf(task, hidden, threshold, prior).find();
}

}  // namespace kr3::executive
