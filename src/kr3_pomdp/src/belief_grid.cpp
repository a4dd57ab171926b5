#include "belief_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kSweeps = 10;          // a round
constexpr std::size_t kAllActionsEvery = 5;  // sweeps
constexpr double kSettled = 1e-3;            // of the gap at the start, used change of a sweep
constexpr double kPublished = 0.02;          // of the gap at the start, a change worth a new point

}  // namespace

BeliefGrid::BeliefGrid(BeliefGraph& graph, std::function<bool()> keep_going)
  : graph_(&graph), keep_going_(std::move(keep_going))
{
}

/// Whether the step may last longer; asks only when there was some work since the last time.
bool BeliefGrid::goOn()
{
  const std::uint64_t done = work() + kOperationsPerWork * graph_->work();
  if (!stopped_ && done - asked_at_ >= kWorkPerQuestion)
  {
    asked_at_ = done;
    stopped_ = !keep_going_();
  }
  return !stopped_;
}

void BeliefGrid::addCorners()
{
  const std::vector<StateClass>& classes = graph_->model().classes();
  for (std::uint32_t c = 0; c < classes.size(); ++c)
  {
    grids_.emplace_back(classes[c].states.size(), graph_->informed()[c]);
    first_corner_.push_back(static_cast<std::uint32_t>(points_.size()));
    more_points_.emplace_back();
    for (std::uint32_t s = 0; s < grids_.back().numStates(); ++s)
    {
      points_.emplace_back();
      points_.back().state_class = c;
      points_.back().number = s;
    }
  }
}

void BeliefGrid::countBytes()
{
  constexpr std::size_t kIndexEntry = 4 * sizeof(std::uint64_t);
  bytes_ = extra_bytes_ + points_.capacity() * sizeof(Point) + entries_.capacity() * sizeof(Entry) +
           entry_of_.size() * kIndexEntry;
  for (const GridPoints& grid : grids_)
  {
    bytes_ += grid.sizeInBytes();
  }
}

std::uint32_t BeliefGrid::entryOf(NodeId node)
{
  const auto [found, inserted] =
      entry_of_.emplace(node, static_cast<std::uint32_t>(entries_.size()));
  if (inserted)
  {
    entries_.emplace_back();
    entries_.back().node = node;
    entries_.back().state_class = graph_->stateClass(node);
  }
  return found->second;
}

std::uint32_t BeliefGrid::pointOf(std::uint32_t state_class, std::uint32_t number) const
{
  const std::size_t corners = grids_[state_class].numStates();
  return number < corners ? first_corner_[state_class] + number
                          : more_points_[state_class][number - corners];
}

/// The least bound that is known, and the best action under the grid's.
GridPoints::Best BeliefGrid::best(const Entry& entry)
{
  const double known = graph_->knownUpper(entry.node);
  const GridPoints& grid = grids_[entry.state_class];
  GridPoints::Best best{0, known};
  if (entry.point != kNone)
  {
    best = grid.best(points_[entry.point].number);
    work_ += grid.numActions();
  }
  else if (!entry.shares.empty())
  {
    best = grid.best(entry.shares);
    work_ += entry.shares.size() * grid.numActions();
  }
  best.value = std::min(best.value, known);
  return best;
}

double BeliefGrid::gap(const Entry& entry)
{
  return best(entry).value - graph_->lower(entry.node);
}

double BeliefGrid::rootGap()
{
  double sum = 0.0;
  for (std::size_t i = 0; i < roots_.size(); ++i)
  {
    sum += graph_->model().starts()[i].probability * gap(entries_[points_[roots_[i]].entry]);
  }
  return sum;
}

void BeliefGrid::makeUp(Entry& entry)
{
  const GridPoints& grid = grids_[entry.state_class];
  std::vector<Share> shares = entry.shares;
  std::vector<float> duals;
  decomposer_.decompose(grid, graph_->belief(entry.node), tolerance_, shares, duals,
                        [this] { return goOn(); });
  entry.points_seen = grid.size();
  if (entry.shares.empty() || grid.best(shares).value < grid.best(entry.shares).value)
  {
    extra_bytes_ -=
        entry.shares.capacity() * sizeof(Share) + entry.duals.capacity() * sizeof(float);
    shares.shrink_to_fit();
    entry.shares = std::move(shares);
    entry.duals = std::move(duals);
    extra_bytes_ +=
        entry.shares.capacity() * sizeof(Share) + entry.duals.capacity() * sizeof(float);
  }
}

/// Makes an outcome a point; its bounds are those of what it is made up of.
std::uint32_t BeliefGrid::addPoint(std::uint32_t index)
{
  Entry& entry = entries_[index];
  if (entry.shares.empty())
  {
    makeUp(entry);
  }
  GridPoints& grid = grids_[entry.state_class];
  std::vector<double> values(grid.numActions(), 0.0);
  for (std::size_t a = 0; a < values.size(); ++a)
  {
    for (const Share& share : entry.shares)
    {
      values[a] += share.weight * grid.values(share.point)[a];
    }
    values[a] =
        std::min({values[a], graph_->actions(entry.node)[a].upper, graph_->knownUpper(entry.node)});
  }
  const auto point = static_cast<std::uint32_t>(points_.size());
  points_.emplace_back();
  points_.back().state_class = entry.state_class;
  points_.back().number = grid.add(graph_->belief(entry.node), values);
  more_points_[entry.state_class].push_back(point);
  open(points_.back(), index);
  return point;
}

/// Lets a point have outcomes.
void BeliefGrid::open(Point& point, std::uint32_t index)
{
  Entry& entry = entries_[index];
  point.entry = index;
  point.outcomes.resize(graph_->model().numActions());
  for (std::size_t a = 0; a < point.outcomes.size(); ++a)
  {
    point.rewards.push_back(graph_->actions(entry.node)[a].reward);
  }
  entry.point = static_cast<std::uint32_t>(&point - points_.data());
  extra_bytes_ -= entry.shares.capacity() * sizeof(Share) + entry.duals.capacity() * sizeof(float);
  entry.shares = {};
  entry.duals = {};
  extra_bytes_ += point.rewards.size() * (sizeof(double) + sizeof(point.outcomes[0]));
  opened_.push_back(entry.point);
}

double BeliefGrid::backedUp(const Point& point, std::size_t action)
{
  double sum = point.rewards[action];
  for (const Outcome& outcome : point.outcomes[action])
  {
    sum += outcome.probability * best(entries_[outcome.entry]).value;
  }
  return sum;
}

/// Value iteration at a point: of the action that looks best, or of all that may be best.
/// @return by how much the point's bound fell
double BeliefGrid::sweep(Point& point, bool all_actions)
{
  GridPoints& grid = grids_[point.state_class];
  const GridPoints::Best before = grid.best(point.number);
  const double floor = all_actions ? graph_->lower(entries_[point.entry].node) : before.value;
  for (std::size_t a = 0; a < grid.numActions() && goOn(); ++a)
  {
    if (grid.values(point.number)[a] < floor)
    {
      continue;
    }
    if (point.outcomes[a].empty())
    {
      const NodeId node = entries_[point.entry].node;
      for (const Edge& edge : graph_->edges(node, a))
      {
        point.outcomes[a].push_back(
            {graph_->model().discount() * edge.probability, entryOf(edge.child)});
      }
      extra_bytes_ += point.outcomes[a].capacity() * sizeof(Outcome);
    }
    grid.tighten(point.number, a, backedUp(point, a));
  }
  return before.value - grid.best(point.number).value;
}

/// A backup with outcomes made up anew, until the action that looks best is one for which that was
/// done.
void BeliefGrid::backUp(Point& point)
{
  const GridPoints& grid = grids_[point.state_class];
  std::vector<bool> done(grid.numActions(), false);
  sweep(point, true);
  for (std::size_t a = grid.best(point.number).action; !done[a] && goOn();
       a = grid.best(point.number).action)
  {
    done[a] = true;
    for (std::size_t i = 0; i < point.outcomes[a].size() && goOn(); ++i)
    {
      Entry& entry = entries_[point.outcomes[a][i].entry];
      if (entry.point == kNone)
      {
        makeUp(entry);
      }
    }
    sweep(point, false);
  }
  ++backups_;
}

void BeliefGrid::start()
{
  addCorners();
  double widest = 0.0;
  for (const NodeId root : graph_->roots())
  {
    widest = std::max(widest, graph_->upper(root) - graph_->lower(root));
  }
  tolerance_ = kTolerance * widest;
  for (const NodeId root : graph_->roots())
  {
    const std::uint32_t entry = entryOf(root);
    makeUp(entries_[entry]);
    roots_.push_back(entries_[entry].point == kNone ? addPoint(entry) : entries_[entry].point);
  }
  for (const std::uint32_t root : roots_)
  {
    backUp(points_[root]);
  }
}

/// A part of a sweep over all points; the last first, since those are nearer to corners.
void BeliefGrid::sweepSome()
{
  const bool all_actions = num_sweeps_ % kAllActionsEvery == 0;
  const std::uint64_t end = work() + kWorkPerStep;
  for (; next_ < opened_.size() && work() < end && goOn(); ++next_)
  {
    Point& point = points_[opened_[opened_.size() - 1 - next_]];
    if (num_sweeps_ == 0 || point.use > kLeastUse)
    {
      const double fall = sweep(point, all_actions);
      changed_ = changed_ || fall > 0.0;
      sweep_change_ += point.use * fall;
    }
  }
  if (next_ < opened_.size())
  {
    return;
  }
  ++num_sweeps_;
  if (num_sweeps_ == kSweeps || (!all_actions && sweep_change_ < settled_))
  {
    enter(Phase::kPublish);
  }
  next_ = 0;
  sweep_change_ = 0.0;
}

/// Hands the bounds to the graph, where they serve its trials.
void BeliefGrid::publish()
{
  const double worthwhile = kPublished * rootGap();
  for (const std::uint32_t i : opened_)
  {
    const NodeId node = entries_[points_[i].entry].node;
    const double value = grids_[points_[i].state_class].best(points_[i].number).value;
    if (points_[i].use > kLeastUse && value < graph_->knownUpper(node) - worthwhile)
    {
      graph_->tighten(node, value);
    }
  }
  for (const std::uint32_t root : roots_)
  {
    graph_->tighten(entries_[points_[root].entry].node,
                    grids_[points_[root].state_class].best(points_[root].number).value);
  }
}

void BeliefGrid::enter(Phase phase)
{
  phase_ = phase;
  next_ = 0;
}

void BeliefGrid::step()
{
  stopped_ = false;
  switch (phase_)
  {
    case Phase::kUse:
      plan();
      enter(Phase::kCorners);
      break;
    case Phase::kCorners:
      openCorner();
      break;
    case Phase::kOutcomes:
      addOutcome();
      break;
    case Phase::kPromise:
      ranked_again_ = outcomesByPromise();
      changed_ = changed_ || !ranked_again_.empty();
      enter(Phase::kAgain);
      break;
    case Phase::kAgain:
      if (next_ < ranked_again_.size())
      {
        makeUp(entries_[ranked_again_[next_++].index]);
        break;
      }
      settled_ = kSettled * rootGap();
      num_sweeps_ = 0;
      sweep_change_ = 0.0;
      enter(Phase::kSweeps);
      break;
    case Phase::kSweeps:
      sweepSome();
      break;
    case Phase::kPublish:
      publish();
      exhausted_ = !changed_;
      enter(Phase::kUse);
      break;
  }
  countBytes();
}

}  // namespace kr3::pomdp
