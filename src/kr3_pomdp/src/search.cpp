#include "search.hpp"

#include <algorithm>

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxDepth = 2000;
constexpr double kTrialTarget = 0.5;   // of the root's gap
constexpr double kSourceShare = 0.25;  // pieces of work on the graph's source for each backup
constexpr double kOptimistic = 0.25;   // probability
constexpr double kExploration = 0.1;   // probability
constexpr double kThorough = 0.25;     // probability that a sampled trial tries all actions
constexpr double kLeastWeight = 0.05;  // discount at which a trial ends
constexpr double kLeastGap = 0.01;     // of the root's gap

}  // namespace

Search::Search(BeliefGraph& graph, BeliefGrid* grid, double precision, const SearchStyle& style,
               const Supervisor& supervisor)
  : graph_(&graph)
  , grid_(grid)
  , precision_(precision)
  , style_(style)
  , supervisor_(&supervisor)
  , random_(style.seed)
{
}

template <typename ValueOf>
double Search::expected(const ValueOf& value_of)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < graph_->roots().size(); ++i)
  {
    sum += graph_->model().starts()[i].probability * value_of(graph_->roots()[i]);
  }
  return sum;
}

double Search::lower()
{
  return expected([this](NodeId root) { return graph_->lower(root); });
}

double Search::upper()
{
  return expected([this](NodeId root) { return graph_->upper(root); });
}

bool Search::isSourceDue() const
{
  const UpperBoundSource* source = graph_->source();
  return source != nullptr && !source->finished() &&
         static_cast<double>(source_work_) < kSourceShare * static_cast<double>(backups_);
}

void Search::step()
{
  if (path_.empty() && isSourceDue())
  {
    graph_->source()->advance();
    ++source_work_;
    return;
  }
  if (grid_ != nullptr && path_.empty() && (grid_->isInRound() || split_.gridIsDue()))
  {
    gridStep();
    return;
  }
  const double gap = upper() - lower();
  const std::uint64_t work = graph_->work();
  trialStep();
  split_.addTrial(graph_->work() - work, gap - (upper() - lower()));
}

void Search::trialStep()
{
  if (path_.empty())
  {
    sampled_due_ += style_.sampled_share;
    if (sampled_due_ >= 1.0)
    {
      sampled_due_ -= 1.0;
      sampledTrial();
    }
    else
    {
      upperTrial();
    }
  }
  if (!path_.empty())
  {
    graph_->backUp(path_.back(), width_);
    path_.pop_back();
    ++backups_;
  }
}

void Search::gridStep()
{
  if (!grid_->isInRound())
  {
    gap_before_ = upper() - lower();
    round_work_ = 0;
  }
  const std::uint64_t work = graph_->work();
  const std::uint64_t grid_work = grid_->work();
  const std::uint64_t backups = grid_->backups();
  grid_->step();
  graph_->countWork((grid_->work() - grid_work) / BeliefGrid::kOperationsPerWork);
  backups_ += grid_->backups() - backups;
  round_work_ += graph_->work() - work;
  if (!grid_->isInRound())
  {
    split_.addRound(round_work_, gap_before_ - (upper() - lower()), !grid_->isExhausted());
  }
}

/// The start that adds most to the gap.
NodeId Search::widestRoot()
{
  NodeId widest = graph_->roots().front();
  double most = -1.0;
  for (std::size_t i = 0; i < graph_->roots().size(); ++i)
  {
    const NodeId root = graph_->roots()[i];
    const double excess =
        graph_->model().starts()[i].probability * (graph_->upper(root) - graph_->lower(root));
    if (excess > most)
    {
      most = excess;
      widest = root;
    }
  }
  return widest;
}

NodeId Search::sampledRoot()
{
  const std::vector<NodeId>& roots = graph_->roots();
  std::size_t i = 0;
  for (double u = roots.size() > 1 ? uniform() : 0.0; i + 1 < roots.size(); ++i)
  {
    u -= graph_->model().starts()[i].probability;
    if (u < 0.0)
    {
      break;
    }
  }
  return roots[i];
}

/// Follows the upper bound to where the gap that the root still has comes from.
/// Source: Smith and Simmons (2004); the trial's target shrinks with the gap at the root.
void Search::upperTrial()
{
  const bool draw = uniform() < style_.drawn_share;
  NodeId node = widestRoot();
  const double root_gap = graph_->upper(node) - graph_->lower(node);
  double allowed = std::max(precision_ * kTrialTarget, root_gap * kTrialTarget);
  width_ = BeliefGraph::Width::kExpanded;
  while (path_.size() < kMaxDepth && !supervisor_->isTimeUp() &&
         graph_->upper(node) - graph_->lower(node) > allowed)
  {
    path_.push_back(node);
    allowed /= graph_->model().discount();
    const std::size_t action = graph_->bestUpper(node).action;
    const NodeId next = widestChild(node, action, allowed, draw);
    if (next == node)
    {
      break;
    }
    node = next;
  }
}

/// The outcome that adds most to the gap beyond what is allowed, or one drawn by what it adds; the
/// node itself if none does.
NodeId Search::widestChild(NodeId node, std::size_t action, double allowed, bool draw)
{
  double most = 0.0;
  double total = 0.0;
  NodeId widest = node;
  for (const Edge& edge : graph_->edges(node, action))
  {
    const double gap = graph_->upper(edge.child) - graph_->lower(edge.child);
    const double excess = edge.probability * (gap - allowed);
    if (excess <= 0.0)
    {
      continue;
    }
    total += excess;
    if (draw ? uniform() * total < excess : excess > most)
    {
      most = excess;
      widest = edge.child;
    }
  }
  return widest;
}

/// Samples what happens, mostly under the policy found so far, at times under the
/// optimistic one, with some exploration: where upper bounds stay far off, this improves the
/// lower bound where it is used.
void Search::sampledTrial()
{
  NodeId node = sampledRoot();
  const double root_gap = graph_->upper(node) - graph_->lower(node);
  const bool optimistic = uniform() < kOptimistic;
  width_ = uniform() < kThorough ? BeliefGraph::Width::kAll : BeliefGraph::Width::kExpanded;
  double weight = 1.0;
  while (path_.size() < kMaxDepth && !supervisor_->isTimeUp() && weight > kLeastWeight &&
         weight * (graph_->upper(node) - graph_->lower(node)) > kLeastGap * root_gap)
  {
    path_.push_back(node);
    weight *= graph_->model().discount();
    std::size_t action = graph_->bestUpper(node).action;
    if (uniform() < kExploration)
    {
      action = anyUseful(node);
    }
    else if (!optimistic)
    {
      action = graph_->bestLower(node, width_).action;
    }
    node = sampledChild(node, action);
  }
}

std::size_t Search::anyUseful(NodeId node)
{
  std::vector<std::size_t> useful;
  const Slice<const NodeAction> actions = graph_->actions(node);
  for (std::size_t a = 0; a < actions.size(); ++a)
  {
    if (!actions[a].useless)
    {
      useful.push_back(a);
    }
  }
  return useful[static_cast<std::size_t>(uniform() * static_cast<double>(useful.size()))];
}

NodeId Search::sampledChild(NodeId node, std::size_t action)
{
  const Slice<const Edge> edges = graph_->edges(node, action);
  double u = uniform();
  std::size_t e = 0;
  while (e + 1 < edges.size() && (u -= edges[e].probability) >= 0.0)
  {
    ++e;
  }
  return edges[e].child;
}

/// Uniform in [0, 1), the same with every standard library.
double Search::uniform()
{
  return static_cast<double>(random_() >> 11) * 0x1.0p-53;
}

}  // namespace kr3::pomdp
