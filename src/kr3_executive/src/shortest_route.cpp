#include "shortest_route.hpp"

#include <algorithm>
#include <queue>
#include <unordered_map>
#include <utility>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

struct Reached
{
  double cost_s = 0.0;
  StateId from = 0;
  RouteStep step;
  bool settled = false;
};

struct Open
{
  double cost_s;
  StateId state;
  bool final;  ///< its last step is done
};

bool operator>(const Open& a, const Open& b)
{
  if (a.cost_s != b.cost_s)
    return a.cost_s > b.cost_s;
  return a.state > b.state;
}

}  // namespace

std::optional<Route> shortestRoute(StateId start, const Successors& successors, const RouteEnd& end,
                                   std::size_t max_nodes)
{
  std::unordered_map<StateId, Reached> reached{{start, {}}};
  std::unordered_map<StateId, RouteStep> last;  // of the routes that may end there
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  open.push({0.0, start, false});
  std::size_t settled = 0;
  while (!open.empty())
  {
    const Open next = open.top();
    open.pop();
    if (next.final)
    {
      Route route;
      route.cost_s = next.cost_s;
      const RouteStep& final_step = last.at(next.state);
      if (final_step.cost_s > 0.0)
        route.steps.push_back(final_step);
      for (StateId state = next.state; state != start; state = reached.at(state).from)
        route.steps.push_back(reached.at(state).step);
      std::reverse(route.steps.begin(), route.steps.end());
      return route;
    }
    Reached& here = reached.at(next.state);
    if (here.settled)
      continue;
    here.settled = true;
    const double cost_s = here.cost_s;
    if (const auto final_step = end(next.state))
    {
      last[next.state] = *final_step;
      open.push({cost_s + final_step->cost_s, next.state, true});
      if (final_step->cost_s == 0.0)
        continue;
    }
    if (++settled > max_nodes)
      return std::nullopt;
    successors(next.state, [&](const RouteStep& step) {
      const double total = cost_s + step.cost_s;
      const auto [entry, is_new] = reached.try_emplace(step.next);
      if (!is_new && (entry->second.settled || entry->second.cost_s <= total))
        return;
      entry->second = {total, next.state, step, false};
      open.push({total, step.next, false});
    });
  }
  return std::nullopt;
}

}  // namespace kr3::executive
