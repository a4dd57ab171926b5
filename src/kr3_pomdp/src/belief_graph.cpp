#include "belief_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Beliefs nearer than this are one node: they differ by rounding only.
constexpr double kSameBelief = 0x1p-40;

std::uint64_t mix(std::uint64_t hash, std::uint64_t value)
{
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
  hash *= 0xff51afd7ed558ccdULL;
  return hash ^ (hash >> 32U);
}

std::uint64_t hashOf(std::uint32_t state_class, const PackedBelief& belief)
{
  std::uint64_t hash = state_class;
  for (std::size_t i = 0; i < belief.num_blocks * kLanes; ++i)
  {
    hash = mix(hash, static_cast<std::uint64_t>(belief.values[i] / kSameBelief + 0.5));
  }
  return hash;
}

bool same(const PackedBelief& a, const PackedBelief& b)
{
  return a.num_blocks == b.num_blocks && std::equal(a.blocks, a.blocks + a.num_blocks, b.blocks) &&
         std::equal(a.values, a.values + a.num_blocks * kLanes, b.values,
                    [](double p, double q) { return std::abs(p - q) <= 2.0 * kSameBelief; });
}

/// Smallest improvement worth a new vector or point.
double worthwhile(double value)
{
  return 1e-9 + 1e-12 * std::abs(value);
}

}  // namespace

BeliefGraph::BeliefGraph(const ObservedModel& model, InformedVectors informed,
                         const InformedVectors& blind, UpperBoundSource* source)
  : model_(&model), informed_(std::move(informed)), source_(source)
{
  for (std::size_t c = 0; c < model.classes().size(); ++c)
  {
    const std::size_t size = model.classes()[c].states.size();
    vectors_.emplace_back(size);
    std::vector<double> corners(size, -kInfinity);
    fallbacks_.emplace_back();
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      for (std::size_t s = 0; s < size; ++s)
      {
        corners[s] = std::max(corners[s], informed_[c][a][s]);
      }
      informed_[c][a].resize(padded(size), 0.0);
      fallbacks_.back().emplace_back(model.classes()[c].actions[a].branches.size(), kNone);
      fixed_bytes_ +=
          padded(size) * sizeof(double) + fallbacks_.back().back().size() * sizeof(NodeId);
    }
    points_.emplace_back(std::move(corners));
    set_bytes_ += vectors_.back().sizeInBytes() + points_.back().sizeInBytes();
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      addVector(static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(a), blind[c][a]);
    }
  }
  for (const ObservedStart& start : model.starts())
  {
    roots_.push_back(nodeOf(start.state_class, start.belief));
  }
}

std::size_t BeliefGraph::sizeInBytes() const
{
  return sizeof(*this) + (source_ == nullptr ? 0 : source_->sizeInBytes()) + fixed_bytes_ +
         set_bytes_ + nodes_.size() * sizeof(Node) +
         action_tables_.capacity() * sizeof(NodeAction*) +
         beliefs_.capacity() * sizeof(PackedBelief) + actions_.sizeInBytes() +
         edges_.sizeInBytes() + belief_values_.sizeInBytes() + belief_blocks_.sizeInBytes() +
         index_.sizeInBytes();
}

NodeId BeliefGraph::nodeOf(std::uint32_t state_class, const std::vector<double>& belief)
{
  next_.reset(belief.size());
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      next_.add(s, belief[s]);
    }
  }
  next_.finish(1.0);
  return find(state_class, next_, nullptr);
}

NodeId BeliefGraph::find(std::uint32_t state_class, const UnpackedBelief& belief,
                         const Origin* origin)
{
  const std::uint64_t hash = hashOf(state_class, belief.packed());
  const NodeId known = index_.find(hash, [&](NodeId id) {
    const Node& node = nodes_[id];
    if (node.hash != hash || node.state_class != state_class)
    {
      return false;
    }
    return same(belief.packed(), packed(id));
  });
  if (known != BeliefIndex::kNotFound)
  {
    return known;
  }
  const auto id = static_cast<NodeId>(nodes_.size());
  Node node{};
  node.state_class = state_class;
  node.lower = -kInfinity;
  node.hash = hash;
  node.upper = -kInfinity;
  for (const std::vector<double>& vector : informed_[state_class])
  {
    node.upper = std::max(node.upper, dot(belief.packed(), vector.data()));
  }
  if (origin != nullptr)
  {
    node.parent = origin->parent;
    node.parent_action = origin->action;
    node.parent_branch = origin->branch;
  }
  nodes_.push_back(node);
  index_.insert(hash, id, [this](NodeId other) { return nodes_[other].hash; });
  if (origin == nullptr)
  {
    store(id, belief);
  }
  return id;
}

double BeliefGraph::follow(const PackedBelief& belief, const Branch& branch,
                           UnpackedBelief& next) const
{
  next.reset(model_->classes()[branch.target_class].states.size());
  double total = 0.0;
  for (std::size_t i = 0; i < belief.num_blocks * kLanes; ++i)
  {
    const double probability = belief.values[i];
    if (probability == 0.0)
    {
      continue;
    }
    for (const SparseEntry& to : branch.joint.row(belief.blocks[i / kLanes] * kLanes + i % kLanes))
    {
      next.add(to.index, probability * to.probability);
      total += probability * to.probability;
    }
  }
  if (total > 0.0)
  {
    next.finish(total);
  }
  return total;
}

/// The belief of a node, stored or found anew in `other_`.
PackedBelief BeliefGraph::packed(NodeId id)
{
  const Node& node = nodes_[id];
  if (node.belief != kNone)
  {
    return beliefs_[node.belief];
  }
  const Branch& branch = model_->classes()[nodes_[node.parent].state_class]
                             .actions[node.parent_action]
                             .branches[node.parent_branch];
  follow(beliefs_[nodes_[node.parent].belief], branch, other_);
  return other_.packed();
}

const UnpackedBelief& BeliefGraph::unpacked(NodeId id)
{
  if (unpacked_node_ == id)
  {
    return unpacked_;
  }
  unpacked_node_ = id;
  const Node& node = nodes_[id];
  if (node.belief == kNone)
  {
    const Branch& branch = model_->classes()[nodes_[node.parent].state_class]
                               .actions[node.parent_action]
                               .branches[node.parent_branch];
    follow(beliefs_[nodes_[node.parent].belief], branch, unpacked_);
    return unpacked_;
  }
  unpacked_.assign(model_->classes()[node.state_class].states.size(), beliefs_[node.belief]);
  return unpacked_;
}

void BeliefGraph::store(NodeId id, const UnpackedBelief& belief)
{
  const PackedBelief from = belief.packed();
  double* values = belief_values_.allocate(from.num_blocks * kLanes);
  std::copy_n(from.values, from.num_blocks * kLanes, values);
  std::uint32_t* blocks = belief_blocks_.allocate(from.num_blocks);
  std::copy_n(from.blocks, from.num_blocks, blocks);
  nodes_[id].belief = static_cast<std::uint32_t>(beliefs_.size());
  beliefs_.push_back({values, blocks, from.num_blocks});
}

std::vector<double> BeliefGraph::belief(NodeId id)
{
  const UnpackedBelief& belief = unpacked(id);
  return {belief.values(), belief.values() + belief.numStates()};
}

void BeliefGraph::refreshLower(NodeId id)
{
  Node& node = nodes_[id];
  const VectorSet& set = vectors_[node.state_class];
  if (node.vectors_seen != set.end())
  {
    const PackedBelief belief =
        node.belief == kNone ? unpacked(id).packed() : beliefs_[node.belief];
    work_ += std::min<std::uint64_t>(set.numAlive(), set.end() - node.vectors_seen) * 2 *
             (1 + belief.num_blocks);
    const VectorSet::Best best = set.best(belief, node.vectors_seen, {node.lower, node.vector});
    node.lower = best.value;
    node.vector = best.vector;
    node.vectors_seen = set.end();
  }
}

double BeliefGraph::lower(NodeId node)
{
  refreshLower(node);
  return nodes_[node].lower;
}

double BeliefGraph::upper(NodeId id)
{
  ++work_;
  Node& node = nodes_[id];
  if (source_ != nullptr && node.source_version != source_->version())
  {
    node.upper = std::min(node.upper, source_->upper(node.state_class, unpacked(id).values()));
    node.source_version = source_->version();
  }
  const SawtoothSet& set = points_[node.state_class];
  if (node.points_seen != set.end())
  {
    work_ += std::min<std::uint64_t>(set.numPoints(), set.end() - node.points_seen);
    node.upper = set.value(unpacked(id), node.points_seen, node.upper);
    node.points_seen = set.end();
  }
  return node.upper;
}

void BeliefGraph::setUpper(NodeId id, double value)
{
  const UnpackedBelief& belief = unpacked(id);
  if (nodes_[id].belief == kNone)
  {
    store(id, belief);
  }
  Node& node = nodes_[id];
  SawtoothSet& set = points_[node.state_class];
  set_bytes_ -= set.sizeInBytes();
  if (node.point != kNone)
  {
    set.remove(node.point);
  }
  node.point = set.add(belief, beliefs_[node.belief], value);
  node.upper = value;
  if (recording_)
  {
    new_points_.push_back(id);
  }
  set_bytes_ += set.sizeInBytes();
}

void BeliefGraph::tighten(NodeId node, double value)
{
  const double known = upper(node);
  if (value < known - worthwhile(known))
  {
    setUpper(node, value);
  }
}

void BeliefGraph::addVector(std::uint32_t state_class, std::uint32_t action,
                            const std::vector<double>& values)
{
  VectorSet& set = vectors_[state_class];
  set_bytes_ -= set.sizeInBytes();
  num_vectors_ -= set.numAlive();
  num_entries_ -= set.numAlive() * values.size();
  const std::uint32_t end = set.end();
  work_ += 2 * set.numAlive();
  set.add(action, values);
  if (recording_ && set.end() != end)
  {
    new_vectors_.push_back({state_class, end});
  }
  num_vectors_ += set.numAlive();
  num_entries_ += set.numAlive() * values.size();
  set_bytes_ += set.sizeInBytes();
}

NodeAction* BeliefGraph::table(NodeId id)
{
  if (nodes_[id].actions == kNone)
  {
    if (nodes_[id].belief == kNone)
    {
      store(id, unpacked(id));
    }
    Node& node = nodes_[id];
    const PackedBelief& belief = beliefs_[node.belief];
    const StateClass& states = model_->classes()[node.state_class];
    NodeAction* entries = actions_.allocate(model_->numActions());
    for (std::size_t a = 0; a < model_->numActions(); ++a)
    {
      entries[a].upper = dot(belief, informed_[node.state_class][a].data());
      for (std::size_t i = 0; i < belief.num_blocks * kLanes; ++i)
      {
        if (belief.values[i] > 0.0)
        {
          entries[a].reward +=
              belief.values[i] *
              states.actions[a].rewards[belief.blocks[i / kLanes] * kLanes + i % kLanes];
        }
      }
    }
    node.actions = static_cast<std::uint32_t>(action_tables_.size());
    action_tables_.push_back(entries);
  }
  return action_tables_[nodes_[id].actions];
}

Slice<const NodeAction> BeliefGraph::actions(NodeId node)
{
  return {table(node), model_->numActions()};
}

Slice<const Edge> BeliefGraph::edges(NodeId node, std::size_t action)
{
  const NodeAction& entry = table(node)[action];
  if (entry.edges == nullptr)
  {
    expand(node, action);
  }
  return {entry.edges, entry.size};
}

void BeliefGraph::expand(NodeId id, std::size_t action)
{
  NodeAction& entry = table(id)[action];
  const std::vector<Branch>& branches =
      model_->classes()[nodes_[id].state_class].actions[action].branches;
  std::vector<Edge> edges;
  for (std::size_t b = 0; b < branches.size(); ++b)
  {
    const double total = follow(beliefs_[nodes_[id].belief], branches[b], next_);
    if (total > 0.0)
    {
      work_ += kLanes * (1 + next_.packed().num_blocks);
      const Origin origin{id, static_cast<std::uint32_t>(action), static_cast<std::uint32_t>(b)};
      edges.push_back({total, find(branches[b].target_class, next_, &origin), origin.branch});
    }
  }
  Edge* stored = edges_.allocate(edges.size());
  std::copy(edges.begin(), edges.end(), stored);
  entry.edges = stored;
  entry.size = static_cast<std::uint32_t>(edges.size());
}

double BeliefGraph::lowerOf(NodeId node, std::size_t action)
{
  double sum = 0.0;
  for (const Edge& edge : edges(node, action))
  {
    sum += edge.probability * lower(edge.child);
  }
  return table(node)[action].reward + model_->discount() * sum;
}

double BeliefGraph::upperOf(NodeId node, std::size_t action)
{
  double sum = 0.0;
  for (const Edge& edge : edges(node, action))
  {
    sum += edge.probability * upper(edge.child);
  }
  NodeAction& entry = table(node)[action];
  entry.upper = std::min(entry.upper, entry.reward + model_->discount() * sum);
  return entry.upper;
}

BeliefGraph::Choice BeliefGraph::bestLower(NodeId id, Width width)
{
  const NodeAction* entries = table(id);
  refreshLower(id);
  const VectorSet& set = vectors_[nodes_[id].state_class];
  const std::size_t known = set.action(set.living(nodes_[id].vector));
  Choice best{known, lowerOf(id, known)};
  for (std::size_t a = 0; a < model_->numActions(); ++a)
  {
    const bool left_out = width == Width::kExpanded && entries[a].edges == nullptr;
    if (a == known || left_out || entries[a].useless || entries[a].upper <= best.value)
    {
      continue;
    }
    const double value = lowerOf(id, a);
    if (value > best.value)
    {
      best = {a, value};
    }
  }
  return best;
}

BeliefGraph::Choice BeliefGraph::bestUpper(NodeId node)
{
  NodeAction* entries = table(node);
  const double floor = lower(node);
  // What is out of date only is too high: the greatest that is up to date is the greatest.
  std::vector<bool>& fresh = fresh_;
  fresh.assign(model_->numActions(), false);
  while (true)
  {
    Choice best{0, -kInfinity};
    for (std::size_t a = 0; a < fresh.size(); ++a)
    {
      if (!entries[a].useless && entries[a].upper > best.value)
      {
        best = {a, entries[a].upper};
      }
    }
    if (fresh[best.action])
    {
      for (std::size_t a = 0; a < fresh.size(); ++a)
      {
        entries[a].useless = entries[a].useless ||
                             (a != best.action && entries[a].upper < floor - worthwhile(floor));
      }
      return best;
    }
    upperOf(node, best.action);
    fresh[best.action] = true;
  }
}

NodeId BeliefGraph::fallback(std::uint32_t state_class, std::size_t action, std::size_t branch)
{
  NodeId& node = fallbacks_[state_class][action][branch];
  if (node == kNone)
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
  const Slice<const Edge> outcomes = edges(node, action);
  std::vector<double> values(model_action.rewards.size(), 0.0);
  const Edge* edge = outcomes.begin();
  for (std::size_t b = 0; b < model_action.branches.size(); ++b)
  {
    const bool possible = edge != outcomes.end() && edge->branch == b;
    const NodeId child = possible ? (edge++)->child : fallback(state_class, action, b);
    refreshLower(child);
    const Branch& branch = model_action.branches[b];
    work_ += branch.joint.numEntries();
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

void BeliefGraph::backUp(NodeId id, Width width)
{
  const Choice best_upper = bestUpper(id);
  tighten(id, best_upper.value);
  const Choice best_lower = bestLower(id, width);
  const double known = lower(id);
  if (best_lower.value > known + worthwhile(known))
  {
    addVector(nodes_[id].state_class, static_cast<std::uint32_t>(best_lower.action),
              backedUpVector(id, best_lower.action));
    refreshLower(id);
  }
}

Findings BeliefGraph::takeFindings()
{
  Findings findings;
  for (const NewVector& added : new_vectors_)
  {
    const VectorSet& set = vectors_[added.state_class];
    if (set.isAlive(added.number))
    {
      const double* values = set.values(added.number);
      findings.vectors.push_back(
          {added.state_class,
           set.action(added.number),
           {values, values + model_->classes()[added.state_class].states.size()}});
    }
  }
  std::sort(new_points_.begin(), new_points_.end());
  new_points_.erase(std::unique(new_points_.begin(), new_points_.end()), new_points_.end());
  for (const NodeId node : new_points_)
  {
    findings.points.push_back({nodes_[node].state_class, belief(node), nodes_[node].upper});
  }
  new_vectors_.clear();
  new_points_.clear();
  return findings;
}

void BeliefGraph::take(const Findings& findings)
{
  const bool recording = std::exchange(recording_, false);
  for (const Findings::Vector& vector : findings.vectors)
  {
    addVector(vector.state_class, vector.action, vector.values);
  }
  for (const Findings::Point& point : findings.points)
  {
    const NodeId node = nodeOf(point.state_class, point.belief);
    const double known = nodes_[node].upper;  // may be out of date: the point is worth it there
    if (point.upper < known - worthwhile(known))
    {
      setUpper(node, point.upper);
    }
  }
  recording_ = recording;
}

}  // namespace kr3::pomdp
