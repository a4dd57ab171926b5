#include "belief_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr NodeId kNoNode = std::numeric_limits<NodeId>::max();
/// Beliefs nearer than this are one node: they differ by rounding only.
constexpr double kSameBelief = 0x1p-40;
constexpr std::size_t kBlock = 1U << 15;

std::uint64_t mix(std::uint64_t hash, std::uint64_t value)
{
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
  return hash * 0xff51afd7ed558ccdULL;
}

/// Smallest improvement worth a new vector or point.
double worthwhile(double value)
{
  return 1e-9 + 1e-12 * std::abs(value);
}

}  // namespace

BeliefGraph::BeliefGraph(const ObservedModel& model, const InformedVectors& informed,
                         const InformedVectors& blind, UpperBoundSource* source)
  : model_(&model), informed_(&informed), source_(source)
{
  for (std::size_t c = 0; c < model.classes().size(); ++c)
  {
    const std::size_t size = model.classes()[c].states.size();
    vectors_.emplace_back(size);
    std::vector<double> corners(size, -kInfinity);
    fallbacks_.emplace_back();
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      vectors_.back().add(static_cast<std::uint32_t>(a), blind[c][a]);
      for (std::size_t s = 0; s < size; ++s)
      {
        corners[s] = std::max(corners[s], informed[c][a][s]);
      }
      fallbacks_.back().emplace_back(model.classes()[c].actions[a].branches.size(), kNoNode);
    }
    points_.emplace_back(std::move(corners));
  }
  for (const ObservedStart& start : model.starts())
  {
    std::vector<double> belief = start.belief;
    roots_.push_back(nodeOf(start.state_class, belief));
  }
}

std::size_t BeliefGraph::numVectors() const
{
  std::size_t sum = 0;
  for (const VectorSet& set : vectors_)
  {
    sum += set.numAlive();
  }
  return sum;
}

std::size_t BeliefGraph::sizeInBytes() const
{
  // A node of the index holds the next one, its key and its value.
  constexpr std::size_t kIndexEntry = sizeof(void*) + 2 * sizeof(std::uint64_t);
  std::size_t bytes = (source_ == nullptr ? 0 : source_->sizeInBytes()) + expansion_bytes_ +
                      storage_bytes_ + nodes_.size() * sizeof(Node) + index_.size() * kIndexEntry +
                      index_.bucket_count() * sizeof(void*);
  for (std::size_t c = 0; c < vectors_.size(); ++c)
  {
    bytes += vectors_[c].sizeInBytes() + points_[c].sizeInBytes();
  }
  return bytes;
}

NodeId BeliefGraph::nodeOf(std::uint32_t state_class, std::vector<double>& belief)
{
  std::uint64_t hash = state_class;
  for (const double p : belief)
  {
    hash = mix(hash, static_cast<std::uint64_t>(p / kSameBelief + 0.5));
  }
  const auto [first, last] = index_.equal_range(hash);
  for (auto found = first; found != last; ++found)
  {
    const Node& node = nodes_[found->second];
    if (node.state_class == state_class &&
        std::equal(belief.begin(), belief.end(), node.belief,
                   [](double p, double q) { return std::abs(p - q) <= 2.0 * kSameBelief; }))
    {
      return found->second;
    }
  }
  const auto id = static_cast<NodeId>(nodes_.size());
  const std::size_t stride = padded(belief.size());
  if (storage_.empty() || storage_.back().size() + stride > storage_.back().capacity())
  {
    storage_.emplace_back();
    storage_.back().reserve(std::max(kBlock, stride));
    storage_bytes_ += storage_.back().capacity() * sizeof(double);
  }
  std::vector<double>& block = storage_.back();
  const double* place = block.data() + block.size();
  block.insert(block.end(), belief.begin(), belief.end());
  block.resize(block.size() + stride - belief.size(), 0.0);
  Node node{};
  node.state_class = state_class;
  node.lower = -kInfinity;
  node.belief = place;
  node.upper = -kInfinity;
  for (const std::vector<double>& vector : (*informed_)[state_class])
  {
    double value = 0.0;
    for (std::size_t s = 0; s < belief.size(); ++s)
    {
      value += belief[s] * vector[s];
    }
    node.upper = std::max(node.upper, value);
  }
  nodes_.push_back(node);
  index_.emplace(hash, id);
  return id;
}

void BeliefGraph::refreshLower(Node& node)
{
  const VectorSet& set = vectors_[node.state_class];
  if (node.vectors_seen != set.end())
  {
    const VectorSet::Best best =
        set.best(node.belief, node.vectors_seen, {node.lower, node.vector});
    node.lower = best.value;
    node.vector = best.vector;
    node.vectors_seen = set.end();
  }
}

double BeliefGraph::lower(NodeId node)
{
  refreshLower(nodes_[node]);
  return nodes_[node].lower;
}

double BeliefGraph::upper(NodeId id)
{
  Node& node = nodes_[id];
  if (source_ != nullptr && node.source_version != source_->version())
  {
    node.upper = std::min(node.upper, source_->upper(node.state_class, node.belief));
    node.source_version = source_->version();
  }
  const SawtoothSet& set = points_[node.state_class];
  if (node.points_seen != set.end())
  {
    node.upper = std::min(node.upper, set.value(node.belief, node.points_seen));
    node.points_seen = set.end();
  }
  return node.upper;
}

BeliefGraph::Expansion& BeliefGraph::expansion(NodeId node)
{
  if (nodes_[node].expansion == 0)
  {
    expand(node);
  }
  return expansions_[nodes_[node].expansion - 1];
}

const std::vector<NodeAction>& BeliefGraph::actions(NodeId node)
{
  return expansion(node).actions;
}

const std::vector<Edge>& BeliefGraph::edges(NodeId node)
{
  return expansion(node).edges;
}

void BeliefGraph::expand(NodeId node)
{
  const std::uint32_t state_class = nodes_[node].state_class;
  const double* belief = nodes_[node].belief;
  const StateClass& states = model_->classes()[state_class];
  Expansion result;
  result.actions.reserve(states.actions.size());
  std::vector<double> next;
  for (const ClassAction& action : states.actions)
  {
    NodeAction entry{};
    entry.first_edge = static_cast<std::uint32_t>(result.edges.size());
    for (std::size_t s = 0; s < states.states.size(); ++s)
    {
      entry.reward += belief[s] * action.rewards[s];
    }
    for (std::size_t b = 0; b < action.branches.size(); ++b)
    {
      const Branch& branch = action.branches[b];
      next.assign(model_->classes()[branch.target_class].states.size(), 0.0);
      double total = 0.0;
      for (std::size_t s = 0; s < states.states.size(); ++s)
      {
        if (belief[s] == 0.0)
        {
          continue;
        }
        for (const SparseEntry& to : branch.joint.row(s))
        {
          next[to.index] += belief[s] * to.probability;
          total += belief[s] * to.probability;
        }
      }
      if (!(total > 0.0))
      {
        continue;
      }
      for (double& p : next)
      {
        p /= total;
      }
      result.edges.push_back(
          {total, nodeOf(branch.target_class, next), static_cast<std::uint32_t>(b)});
    }
    entry.last_edge = static_cast<std::uint32_t>(result.edges.size());
    result.actions.push_back(entry);
  }
  result.edges.shrink_to_fit();
  expansion_bytes_ += sizeof(Expansion) + result.actions.capacity() * sizeof(NodeAction) +
                      result.edges.capacity() * sizeof(Edge);
  expansions_.push_back(std::move(result));
  nodes_[node].expansion = static_cast<std::uint32_t>(expansions_.size());
}

double BeliefGraph::lowerOf(NodeId node, std::size_t action)
{
  const Expansion& expanded = expansion(node);
  const NodeAction& entry = expanded.actions[action];
  double sum = 0.0;
  for (std::uint32_t e = entry.first_edge; e < entry.last_edge; ++e)
  {
    sum += expanded.edges[e].probability * lower(expanded.edges[e].child);
  }
  return entry.reward + model_->discount() * sum;
}

double BeliefGraph::upperOf(NodeId node, std::size_t action)
{
  const Expansion& expanded = expansion(node);
  const NodeAction& entry = expanded.actions[action];
  double sum = 0.0;
  for (std::uint32_t e = entry.first_edge; e < entry.last_edge; ++e)
  {
    sum += expanded.edges[e].probability * upper(expanded.edges[e].child);
  }
  return entry.reward + model_->discount() * sum;
}

BeliefGraph::Choice BeliefGraph::bestLower(NodeId node)
{
  const Expansion& expanded = expansion(node);
  Choice best{0, -kInfinity};
  for (std::size_t a = 0; a < expanded.actions.size(); ++a)
  {
    if (expanded.actions[a].useless)
    {
      continue;
    }
    const double value = lowerOf(node, a);
    if (value > best.value)
    {
      best = {a, value};
    }
  }
  return best;
}

BeliefGraph::Choice BeliefGraph::bestUpper(NodeId node)
{
  Expansion& expanded = expansion(node);
  const double floor = lower(node);
  Choice best{0, -kInfinity};
  for (std::size_t a = 0; a < expanded.actions.size(); ++a)
  {
    if (expanded.actions[a].useless)
    {
      continue;
    }
    const double value = upperOf(node, a);
    if (value > best.value)
    {
      best = {a, value};
    }
    else
    {
      expanded.actions[a].useless = value < floor - worthwhile(floor);
    }
  }
  return best;
}

NodeId BeliefGraph::fallback(std::uint32_t state_class, std::size_t action, std::size_t branch)
{
  NodeId& node = fallbacks_[state_class][action][branch];
  if (node == kNoNode)
  {
    const Branch& to = model_->classes()[state_class].actions[action].branches[branch];
    std::vector<double> belief(model_->classes()[to.target_class].states.size(), 0.0);
    double total = 0.0;
    for (std::size_t s = 0; s < to.joint.numRows(); ++s)
    {
      for (const SparseEntry& next : to.joint.row(s))
      {
        belief[next.index] += next.probability;
        total += next.probability;
      }
    }
    for (double& p : belief)
    {
      p /= total;
    }
    node = nodeOf(to.target_class, belief);
  }
  return node;
}

std::vector<double> BeliefGraph::backedUpVector(NodeId node, std::size_t action)
{
  const std::uint32_t state_class = nodes_[node].state_class;
  const ClassAction& model_action = model_->classes()[state_class].actions[action];
  const Expansion& expanded = expansion(node);
  std::vector<double> values(model_action.rewards.size(), 0.0);
  std::uint32_t edge = expanded.actions[action].first_edge;
  for (std::size_t b = 0; b < model_action.branches.size(); ++b)
  {
    NodeId child = kNoNode;
    if (edge < expanded.actions[action].last_edge && expanded.edges[edge].branch == b)
    {
      child = expanded.edges[edge++].child;
    }
    else
    {
      child = fallback(state_class, action, b);
    }
    lower(child);
    const Branch& branch = model_action.branches[b];
    const VectorSet& set = vectors_[branch.target_class];
    const double* next_values = set.values(set.living(nodes_[child].vector));
    for (std::size_t s = 0; s < values.size(); ++s)
    {
      for (const SparseEntry& next : branch.joint.row(s))
      {
        values[s] += next.probability * next_values[next.index];
      }
    }
  }
  for (std::size_t s = 0; s < values.size(); ++s)
  {
    values[s] = model_action.rewards[s] + model_->discount() * values[s];
  }
  return values;
}

void BeliefGraph::backUp(NodeId id)
{
  const Choice best_upper = bestUpper(id);
  const double old_upper = upper(id);
  if (best_upper.value < old_upper - worthwhile(old_upper))
  {
    Node& node = nodes_[id];
    SawtoothSet& set = points_[node.state_class];
    if (node.point != 0)
    {
      set.remove(node.point - 1);
    }
    node.point = set.add(node.belief, best_upper.value) + 1;
    node.upper = best_upper.value;
  }
  const Choice best_lower = bestLower(id);
  const double old_lower = lower(id);
  if (best_lower.value > old_lower + worthwhile(old_lower))
  {
    const std::vector<double> values = backedUpVector(id, best_lower.action);
    Node& node = nodes_[id];
    vectors_[node.state_class].add(static_cast<std::uint32_t>(best_lower.action), values);
    refreshLower(node);
  }
}

}  // namespace kr3::pomdp
