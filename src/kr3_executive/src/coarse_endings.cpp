// What the upper level holds the rest of a mission for worth where a lower task ends.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "coarse_policy.hpp"

namespace kr3::executive
{
namespace
{

using refinement::StateId;

/// Probabilities between which the value is taken for linear.
constexpr double kGrid[] = {0.0, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 0.99, 1.0};
/// Lines are rounded to this part of what a mission can win or lose, so that few different tasks
/// are solved.
constexpr double kRounding = 0.0025;

double roundedTo(double value, double unit)
{
  return std::round(value / unit) * unit;
}

/// In a cost: nothing is known of where the robot is, but its state of the high level.
std::string anywhere(const std::string& /*fluent*/)
{
  return {};
}

}  // namespace

std::vector<EndingLine> CoarsePolicy::actionValues(CoarsePlan& plan, const pomdp::Belief& belief,
                                                   std::optional<std::size_t> without) const
{
  std::vector<EndingLine> result{{std::nullopt, actionValue(belief, choices_.size()), 0.0}};
  double best = result.front().if_possible;
  double range_s = 0.0;
  StateId likeliest = states_.front();
  double highest = 0.0;
  for (std::size_t state = 0; state < states_.size(); ++state)
  {
    if (belief[state] > highest)
    {
      highest = belief[state];
      likeliest = states_[state];
    }
  }
  for (std::size_t a = 0; a < choices_.size(); ++a)
  {
    const std::size_t action = choices_[a].action;
    if (without == action || !plan.supposedFor(likeliest, action))
      continue;
    const EndingLine line{action, actionValue(belief, a), 0.0};
    const auto [least_s, greatest_s] = plan.costRange(likeliest, action);
    range_s = std::max(range_s, greatest_s - least_s);
    best = std::max(best, line.if_possible);
    if (result.back().next == line.next)
      result.back().if_possible = std::max(result.back().if_possible, line.if_possible);
    else
      result.push_back(line);
  }
  result.erase(
      std::remove_if(result.begin(), result.end(),
                     [&](const EndingLine& line) { return line.if_possible < best - range_s; }),
      result.end());
  return result;
}

pomdp::Model CoarsePolicy::paid(const refinement::PomdpTask& task, CoarsePlan& plan,
                                const CoarseStart& start, std::size_t action) const
{
  const EndingsOf endings_of = [&](const CoarseStart& of, bool unchanged) {
    return endings(plan, of, unchanged ? std::optional(action) : std::nullopt);
  };
  const double outside = value(start.at(start.probability())).value_or(objective_.wrong_finish);
  return withEndings(task, plan, start, endings_of,
                     roundedTo(outside, kRounding * objective_.stake()));
}

std::vector<EndingLine> CoarsePolicy::endings(CoarsePlan& plan, const CoarseStart& start,
                                              std::optional<std::size_t> without) const
{
  const double unit = kRounding * objective_.stake();
  std::vector<pomdp::Belief> beliefs;
  std::set<std::optional<std::size_t>> next;
  for (const double probability : kGrid)
  {
    auto belief = dense(start.at(probability));
    if (!belief)
      return {{std::nullopt, objective_.wrong_finish, objective_.wrong_finish}};
    beliefs.push_back(std::move(*belief));
    for (const EndingLine& line : actionValues(plan, beliefs.back(), without))
      next.insert(line.next);
  }
  std::vector<EndingLine> lines;
  const auto add = [&](EndingLine line) {
    line.if_possible = roundedTo(line.if_possible, unit);
    line.if_impossible = roundedTo(line.if_impossible, unit);
    if (std::none_of(lines.begin(), lines.end(), [&](const EndingLine& o) {
          return o.next == line.next && o.if_possible == line.if_possible &&
                 o.if_impossible == line.if_impossible;
        }))
      lines.push_back(line);
  };
  for (const auto& action_next : next)
  {
    std::vector<double> values;
    for (const auto& belief : beliefs)
      values.push_back(valueIfNext(belief, action_next));
    for (std::size_t i = 1; i < values.size(); ++i)
    {
      const double slope = (values[i] - values[i - 1]) / (kGrid[i] - kGrid[i - 1]);
      const double at_zero = values[i] - slope * kGrid[i];
      add({action_next, at_zero + slope, at_zero});
    }
  }
  if (!without && start.possible.size() + start.impossible.size() == 1)
    add(routeValue(plan, start.supposed));
  return lines;
}

EndingLine CoarsePolicy::routeValue(CoarsePlan& plan, StateId state) const
{
  const auto& route = plan.goalFrom(state);
  if (!route)
    return {std::nullopt, objective_.given_up, objective_.given_up};
  EndingLine line;
  double factor = 1.0;
  StateId at = state;
  for (const RouteStep& step : route->steps)
  {
    if (!line.next)
      line.next = step.action;
    const OptionModel& option = plan.option(at, step.action);
    line.if_possible -= factor * (option.on_hidden ? option.success.seconds
                                                   : plan.costFrom(at, step.action, anywhere));
    factor *= std::pow(objective_.discount, option.success.steps);
    at = step.next;
  }
  line.if_possible += factor * objective_.success;
  line.if_impossible = line.if_possible;
  return line;
}

double CoarsePolicy::valueIfNext(const pomdp::Belief& belief,
                                 std::optional<std::size_t> action) const
{
  if (!action)
    return actionValue(belief, choices_.size());
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < choices_.size(); ++a)
  {
    if (choices_[a].action == *action)
      best = std::max(best, actionValue(belief, a));
  }
  return best;
}

}  // namespace kr3::executive
