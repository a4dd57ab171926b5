#include <algorithm>

#include "belief_grid.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kLeastGrowth = 5;    // points a round
constexpr double kGrowth = 0.05;           // of the points, a round
constexpr double kOwnPointWorth = 0.5;     // how much less a belief gains near another point
constexpr double kSamePoint = 1.0 - 1e-9;  // weight of a point that is the belief itself
constexpr int kMaxSteps = 500;             // that flow is followed
constexpr double kLeastFlow = 0.01;        // of the start's, that is followed further

}  // namespace

void BeliefGrid::addFlow(std::uint32_t index, double probability)
{
  const Entry& entry = entries_[index];
  const auto add = [this](std::uint32_t point, double amount) {
    if (flow_[point] == 0.0)
    {
      flow_to_.push_back(point);
    }
    flow_[point] += amount;
  };
  if (entry.point != kNone)
  {
    add(entry.point, probability);
    return;
  }
  for (const Share& share : entry.shares)
  {
    add(pointOf(entry.state_class, share.point), probability * share.weight);
  }
}

/// How often, discounted, points and outcomes are met from the start.
void BeliefGrid::spreadUse()
{
  struct Flow
  {
    std::uint32_t to;
    double part;
  };
  std::vector<std::vector<Flow>> flows(points_.size());
  flow_.assign(points_.size(), 0.0);
  std::vector<std::size_t> actions(points_.size(), 0);
  std::size_t num_flows = 0;
  for (std::size_t i = 0; i < opened_.size() && goOn(); ++i)
  {
    const Point& point = points_[opened_[i]];
    actions[opened_[i]] = grids_[point.state_class].best(point.number).action;
    for (const Outcome& outcome : point.outcomes[actions[opened_[i]]])
    {
      addFlow(outcome.entry, outcome.probability);
    }
    for (const std::uint32_t to : flow_to_)
    {
      flows[opened_[i]].push_back({to, flow_[to]});
      flow_[to] = 0.0;
    }
    num_flows += flow_to_.size();
    work_ += flow_to_.size();
    flow_to_.clear();
  }
  for (Point& point : points_)
  {
    point.use = 0.0;
  }
  for (Entry& entry : entries_)
  {
    entry.use = 0.0;
  }
  std::vector<double> now(points_.size(), 0.0);
  std::vector<double> next;
  for (std::size_t i = 0; i < roots_.size(); ++i)
  {
    now[roots_[i]] += graph_->model().starts()[i].probability;
  }
  double rest = 1.0;
  for (int step = 0; step < kMaxSteps && rest > kLeastFlow && goOn(); ++step)
  {
    next.assign(points_.size(), 0.0);
    rest = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i)
    {
      points_[i].use += now[i];
      for (const Flow& flow : flows[i])
      {
        next[flow.to] += now[i] * flow.part;
        rest += now[i] * flow.part;
      }
    }
    now.swap(next);
    work_ += num_flows + points_.size();
  }
  for (const std::uint32_t i : opened_)
  {
    for (const Outcome& outcome : points_[i].outcomes[actions[i]])
    {
      entries_[outcome.entry].use += points_[i].use * outcome.probability;
    }
  }
}

/// Outcomes that could become points, those first that promise most. Near a point little is gained.
std::vector<BeliefGrid::Ranked> BeliefGrid::outcomesByUse()
{
  std::vector<Ranked> ranked;
  for (std::uint32_t i = 0; i < entries_.size() && goOn(); ++i)
  {
    const Entry& entry = entries_[i];
    if (entry.point != kNone || entry.use < kLeastUse)
    {
      continue;
    }
    double greatest = 0.0;
    for (const Share& share : entry.shares)
    {
      greatest = std::max(greatest, share.weight);
    }
    if (greatest > kSamePoint)
    {
      continue;
    }
    ranked.push_back({entry.use * gap(entry) * (1.0 - kOwnPointWorth * greatest), i});
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const Ranked& a, const Ranked& b) { return a.rank > b.rank; });
  return ranked;
}

std::vector<BeliefGrid::Ranked> BeliefGrid::cornersByUse()
{
  std::vector<Ranked> ranked;
  for (std::uint32_t i = 0; i < points_.size(); ++i)
  {
    if (points_[i].entry == kNone && points_[i].use > kLeastUse)
    {
      ranked.push_back({points_[i].use, i});
    }
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const Ranked& a, const Ranked& b) { return a.rank > b.rank; });
  return ranked;
}

/// Outcomes that should be made up anew, by what the new points promise.
std::vector<BeliefGrid::Ranked> BeliefGrid::outcomesByPromise()
{
  std::vector<Ranked> ranked;
  for (std::uint32_t i = 0; i < entries_.size() && goOn(); ++i)
  {
    const Entry& entry = entries_[i];
    if (entry.point != kNone || entry.use < kLeastUse)
    {
      continue;
    }
    const GridPoints& grid = grids_[entry.state_class];
    double promise = gap(entry);
    if (!entry.shares.empty())
    {
      promise = -grid.leastCost(entry.duals, entry.points_seen);
      work_ += (grid.size() - entry.points_seen) * grid.stride() / 2;
    }
    if (promise > tolerance_)
    {
      ranked.push_back({entry.use * promise, i});
    }
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const Ranked& a, const Ranked& b) { return a.rank > b.rank; });
  return ranked;
}

/// Begins a round.
void BeliefGrid::plan()
{
  if (roots_.empty())
  {
    start();
  }
  tolerance_ = kTolerance * std::max(0.0, rootGap());
  spreadUse();
  most_new_ =
      kLeastGrowth + static_cast<std::size_t>(kGrowth * static_cast<double>(opened_.size()));
  ranked_corners_ = cornersByUse();
  ranked_outcomes_ = outcomesByUse();
  changed_ = false;
}

/// The next corner gets outcomes.
void BeliefGrid::openCorner()
{
  if (next_ == std::min(most_new_, ranked_corners_.size()))
  {
    enter(Phase::kOutcomes);
    return;
  }
  Point& corner = points_[ranked_corners_[next_++].index];
  std::vector<double> belief(grids_[corner.state_class].numStates(), 0.0);
  belief[corner.number] = 1.0;
  open(corner, entryOf(graph_->nodeOf(corner.state_class, belief)));
  backUp(corner);
  changed_ = true;
}

/// The next outcome becomes a point.
void BeliefGrid::addOutcome()
{
  const std::size_t most = 2 * most_new_ - std::min(most_new_, ranked_corners_.size());
  if (next_ == std::min(most, ranked_outcomes_.size()) || ranked_outcomes_[next_].rank <= 0.0)
  {
    enter(Phase::kPromise);
    return;
  }
  const std::uint32_t outcome = ranked_outcomes_[next_++].index;
  if (entries_[outcome].point == kNone)
  {
    backUp(points_[addPoint(outcome)]);
    changed_ = true;
  }
}

}  // namespace kr3::pomdp
