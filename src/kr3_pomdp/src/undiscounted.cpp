#include "undiscounted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "end_components.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr int kMaxStepSweeps = 100000;
constexpr int kMaxValueSweeps = 1000;
constexpr double kEnough = 0.1;      // how far off 1 a step may count when steps are bounded
constexpr double kTolerance = 1e-7;  // of the rewards
constexpr double kNoValue = -1e300;  // of states that cannot be reached

/// Bounds the numbers of steps and sums of rewards until the end.
class Endings
{
public:
  Endings(const ObservedModel& observed, const std::function<bool()>& keep_going)
    : model_(&observed.model()), keep_going_(&keep_going)
  {
    std::vector<std::uint32_t> states;
    for (const StateClass& state_class : observed.classes())
    {
      states.insert(states.end(), state_class.states.begin(), state_class.states.end());
    }
    std::sort(states.begin(), states.end());
    states.erase(std::unique(states.begin(), states.end()), states.end());
    ends_ = endComponents(*model_, std::move(states));
    for (const std::uint32_t s : ends_.states)
    {
      for (std::size_t a = 0; a < model_->numActions(); ++a)
      {
        least_ = std::min(least_, model_->reward(a, s));
        greatest_ = std::max(greatest_, model_->reward(a, s));
        if (keeps(a, s) && model_->reward(a, s) >= 0.0)
        {
          char reward[32];
          std::snprintf(reward, sizeof(reward), "%g", model_->reward(a, s) + 0.0);  // 0, not -0
          throw InvalidArgument(
              "discount 1, and from state '" + model_->stateName(s) +
              "' the robot can go on for ever and do '" + model_->actionName(a) +
              "' again and again with reward " + reward +
              ": expected that each run ends or costs something at each step; give a horizon");
        }
      }
    }
  }

  /// No policy earns more.
  [[nodiscard]] std::vector<double> upper() const
  {
    // Steps that are no part of an end component are bounded in number, whatever the policy; the
    // others earn nothing.
    std::vector<double> steps(model_->numStates(), 0.0);
    const auto more = [&](std::uint32_t s) {
      double most = steps[ends_.component[s]];
      for (std::size_t a = 0; a < model_->numActions(); ++a)
      {
        if (!keeps(a, s))
        {
          double sum = 1.0;
          for (const SparseEntry& next : model_->transitions(a, s))
          {
            sum += next.probability * steps[ends_.component[next.index]];
          }
          most = std::max(most, sum);
        }
      }
      return most;
    };
    boundSteps(steps, ends_.component, more);
    std::vector<double> result(model_->numStates(), 0.0);
    for (const std::uint32_t s : ends_.states)
    {
      result[s] = greatest_ * steps[ends_.component[s]];
    }
    return result;
  }

  /// Whether a plan's runs end from all states.
  /// @param action  done for ever; nothing: any action
  [[nodiscard]] bool ends(std::optional<std::size_t> action) const
  {
    return neverEnding(action) == model_->numStates();
  }

  /// A state from which no run ends, or numStates().
  [[nodiscard]] std::size_t neverEnding(std::optional<std::size_t> action) const
  {
    std::vector<bool> ends(ends_.finished);
    for (bool changed = true; changed;)
    {
      changed = false;
      for (auto s = ends_.states.rbegin(); s != ends_.states.rend(); ++s)
      {
        if (!ends[*s] && someFollows(action, *s, ends))
        {
          ends[*s] = true;
          changed = true;
        }
      }
    }
    for (const std::uint32_t s : ends_.states)
    {
      if (!ends[s])
      {
        return s;
      }
    }
    return model_->numStates();
  }

  /// What a plan earns at least; its runs end.
  /// @param action  done for ever; nothing: each with the same probability at each step
  [[nodiscard]] std::vector<double> lower(std::optional<std::size_t> action) const
  {
    std::vector<std::uint32_t> own(model_->numStates());
    for (std::uint32_t s = 0; s < own.size(); ++s)
    {
      own[s] = s;
    }
    std::vector<double> steps(model_->numStates(), 0.0);
    boundSteps(steps, own, [&](std::uint32_t s) {
      return std::max(steps[s], backedUp(action, s, steps, [](std::size_t) { return 1.0; }));
    });
    std::vector<double> values(model_->numStates(), kNoValue);
    for (const std::uint32_t s : ends_.states)
    {
      values[s] = least_ * steps[s];
    }
    const double enough = kTolerance * std::max(greatest_, -least_);
    double change = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxValueSweeps && change > enough && (*keep_going_)(); ++i)
    {
      change = 0.0;
      for (auto s = ends_.states.rbegin(); s != ends_.states.rend(); ++s)
      {
        const double value =
            backedUp(action, *s, values, [&](std::size_t a) { return model_->reward(a, *s); });
        change = std::max(change, value - values[*s]);
        values[*s] = std::max(values[*s], value);
      }
    }
    return values;
  }

private:
  [[nodiscard]] bool keeps(std::size_t a, std::size_t s) const
  {
    return ends_.keeps[a * model_->numStates() + s];
  }

  /// Raises `steps` until one more sweep would add less than kEnough anywhere, then by so much that
  /// a step is counted as one at least: with t >= 1 - e + sum T t everywhere, t / (1 - e) is a
  /// bound.
  template <typename More>
  void boundSteps(std::vector<double>& steps, const std::vector<std::uint32_t>& places,
                  const More& more) const
  {
    for (int i = 0; i < kMaxStepSweeps; ++i)
    {
      double missing = 0.0;
      for (const std::uint32_t s : ends_.states)
      {
        if (!ends_.finished[s])
        {
          missing = std::max(missing, more(s) - steps[places[s]]);
        }
      }
      if (missing <= kEnough)
      {
        for (double& step : steps)
        {
          step /= 1.0 - kEnough;
        }
        return;
      }
      for (auto s = ends_.states.rbegin(); s != ends_.states.rend(); ++s)
      {
        if (!ends_.finished[*s])
        {
          steps[places[*s]] = more(*s);
        }
      }
    }
    throw ResourceExhausted("discount 1, and runs take more than " +
                            std::to_string(kMaxStepSweeps) +
                            " steps to end: expected a horizon or a discount below 1");
  }

  [[nodiscard]] bool someFollows(std::optional<std::size_t> action, std::size_t s,
                                 const std::vector<bool>& wanted) const
  {
    for (std::size_t a = action.value_or(0); a < (action ? *action + 1 : model_->numActions()); ++a)
    {
      const SparseRow row = model_->transitions(a, s);
      if (std::any_of(row.begin(), row.end(),
                      [&](const SparseEntry& next) { return wanted[next.index]; }))
      {
        return true;
      }
    }
    return false;
  }

  /// 0 in finished states.
  template <typename Reward>
  [[nodiscard]] double backedUp(std::optional<std::size_t> action, std::size_t s,
                                const std::vector<double>& values, const Reward& reward) const
  {
    if (ends_.finished[s])
    {
      return 0.0;
    }
    double sum = 0.0;
    for (std::size_t a = action.value_or(0); a < (action ? *action + 1 : model_->numActions()); ++a)
    {
      sum += reward(a);
      for (const SparseEntry& next : model_->transitions(a, s))
      {
        sum += next.probability * values[next.index];
      }
    }
    return action ? sum : sum / static_cast<double>(model_->numActions());
  }

  const Model* model_;
  const std::function<bool()>* keep_going_;
  EndComponents ends_;
  double least_ = 0.0;     // reward, <= 0
  double greatest_ = 0.0;  // reward, >= 0
};

}  // namespace

UndiscountedBounds undiscountedBounds(const ObservedModel& observed,
                                      const std::function<bool()>& keep_going)
{
  const Model& model = observed.model();
  const Endings endings(observed, keep_going);
  UndiscountedBounds result{endings.upper(), {}, std::nullopt};
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    if (endings.ends(a))
    {
      std::vector<double> values = endings.lower(a);
      double value = 0.0;
      for (std::size_t s = 0; s < values.size(); ++s)
      {
        value += model.initialBelief()[s] * values[s];
      }
      if (value > best)
      {
        best = value;
        result.lower = std::move(values);
        result.base_action = a;
      }
    }
  }
  if (!result.base_action)
  {
    const std::size_t endless = endings.neverEnding(std::nullopt);
    if (endless < model.numStates())
    {
      throw InvalidArgument("discount 1, and from state '" + model.stateName(endless) +
                            "' no run ends: expected that each can end; give a horizon");
    }
    result.lower = endings.lower(std::nullopt);
  }
  return result;
}

std::vector<double> thenBasePlan(const Model& model, const UndiscountedBounds& bounds,
                                 std::size_t action)
{
  std::vector<double> values(model.numStates());
  for (std::size_t s = 0; s < values.size(); ++s)
  {
    values[s] = model.reward(action, s);
    for (const SparseEntry& next : model.transitions(action, s))
    {
      values[s] += next.probability * bounds.lower[next.index];
    }
  }
  return values;
}

}  // namespace kr3::pomdp
