#include "kr3_pomdp/online_planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <string>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A scenario that has come to a node.
struct Particle
{
  std::uint32_t scenario;
  std::uint64_t state;
};

/// An action at a node: what it earns there, and the nodes that follow.
struct TreeAction
{
  double reward = 0.0;  // over the scenarios, weighted, less the regularisation
  std::vector<std::uint32_t> children;
};

/// A history of actions and observations, with the scenarios that agree with it. Values are
/// weighted: a node of few scenarios, late, counts for little.
struct TreeNode
{
  std::uint32_t parent;
  std::uint32_t depth;
  std::vector<Particle> particles;
  std::size_t default_action = 0;
  double default_value = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  std::vector<TreeAction> actions;  // empty until expanded
};

/// The random numbers of the scenarios, step by step; made when they are first asked for.
class Streams
{
public:
  Streams(std::size_t num_scenarios, std::uint64_t seed) : steps_(num_scenarios)
  {
    for (std::size_t i = 0; i < num_scenarios; ++i)
    {
      std::seed_seq sequence{static_cast<std::uint32_t>(seed),
                             static_cast<std::uint32_t>(seed >> 32U),
                             static_cast<std::uint32_t>(i)};
      engines_.emplace_back(sequence);
    }
  }

  double at(std::uint32_t scenario, std::size_t depth)
  {
    std::vector<double>& steps = steps_[scenario];
    while (steps.size() <= depth)
    {
      steps.push_back(static_cast<double>(engines_[scenario]() >> 11U) * 0x1.0p-53);
    }
    return steps[depth];
  }

private:
  std::vector<std::mt19937_64> engines_;
  std::vector<std::vector<double>> steps_;
};

class Tree
{
public:
  Tree(const GenerativeModel& model, const OnlineOptions& options,
       const std::function<std::uint64_t(double)>& sample, std::uint64_t seed)
    : model_(model), options_(options), streams_(options.num_scenarios, seed)
  {
    TreeNode root{0, 0, {}, 0, 0.0, 0.0, 0.0, {}};
    for (std::uint32_t i = 0; i < options.num_scenarios; ++i)
    {
      root.particles.push_back({i, sample(streams_.at(i, 0))});
    }
    nodes_.push_back(std::move(root));
    evaluate(nodes_.front());
  }

  OnlineDecision decide()
  {
    const auto start = std::chrono::steady_clock::now();
    const auto inTime = [&] {
      return (options_.max_expansions == 0 || expansions_ < options_.max_expansions) &&
             (options_.time_s == 0.0 ||
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() <
                  options_.time_s);
    };
    while (nodes_.front().upper - nodes_.front().lower > kLeastGap && inTime())
    {
      if (!trial(inTime))
      {
        break;
      }
    }
    return {bestAction(), nodes_.front().lower, nodes_.front().upper, expansions_, nodes_.size()};
  }

private:
  [[nodiscard]] double weight(const TreeNode& node) const
  {
    return std::pow(model_.discount(), node.depth) / static_cast<double>(options_.num_scenarios);
  }

  /// First bounds of a node: the default policy, and what could be earned in known states.
  void evaluate(TreeNode& node)
  {
    const double w = weight(node);
    states_.clear();
    for (const Particle& particle : node.particles)
    {
      states_.push_back(particle.state);
    }
    node.upper = w * model_.upperBoundOf(states_);
    const std::optional<KnownPlan> known = model_.knownPlan(states_);
    node.default_action = known ? known->action : model_.defaultAction(states_);
    node.default_value = w * (known ? known->value : rollout(node));
    node.lower = node.default_value;
    node.upper = std::max(node.upper, node.lower);
  }

  /// What the default policy earns from a node on, summed over its scenarios. It goes on with one
  /// action for all as long as they agree in what they observe; then each group by itself.
  double rollout(const TreeNode& node)
  {
    struct Group
    {
      std::vector<Particle> particles;
      std::size_t depth;
      double discount;
    };
    double sum = 0.0;
    std::vector<Group> open{{node.particles, node.depth, 1.0}};
    std::vector<std::uint64_t> states;
    while (!open.empty())
    {
      const Group group = std::move(open.back());
      open.pop_back();
      if (group.depth >= options_.max_depth || group.particles.empty())
      {
        continue;
      }
      states.clear();
      for (const Particle& particle : group.particles)
      {
        states.push_back(particle.state);
      }
      const std::size_t action = model_.defaultAction(states);
      std::unordered_map<std::uint64_t, std::size_t> by_observation;
      for (const Particle& particle : group.particles)
      {
        const GenerativeStep step =
            model_.step(particle.state, action, streams_.at(particle.scenario, group.depth + 1));
        sum += group.discount * step.reward;
        if (step.terminal)
        {
          continue;
        }
        const auto [found, inserted] = by_observation.emplace(step.observation, open.size());
        if (inserted)
        {
          open.push_back({{}, group.depth + 1, group.discount * model_.discount()});
        }
        open[found->second].particles.push_back({particle.scenario, step.state});
      }
    }
    return sum;
  }

  void expand(std::uint32_t index)
  {
    ++expansions_;
    std::vector<TreeAction> actions(model_.numActions());
    for (std::size_t a = 0; a < actions.size(); ++a)
    {
      std::unordered_map<std::uint64_t, std::uint32_t> by_observation;
      const std::size_t depth = nodes_[index].depth;
      const double w = weight(nodes_[index]);
      actions[a].reward = -options_.regularisation;
      for (std::size_t i = 0; i < nodes_[index].particles.size(); ++i)
      {
        const Particle particle = nodes_[index].particles[i];
        const GenerativeStep step =
            model_.step(particle.state, a, streams_.at(particle.scenario, depth + 1));
        actions[a].reward += w * step.reward;
        if (step.terminal)
        {
          continue;
        }
        const auto next = static_cast<std::uint32_t>(nodes_.size());
        const auto [found, inserted] = by_observation.emplace(step.observation, next);
        if (inserted)
        {
          nodes_.push_back(
              {index, static_cast<std::uint32_t>(depth + 1), {}, 0, 0.0, 0.0, 0.0, {}});
          actions[a].children.push_back(next);
        }
        nodes_[found->second].particles.push_back({particle.scenario, step.state});
      }
      for (const std::uint32_t child : actions[a].children)
      {
        evaluate(nodes_[child]);
      }
    }
    nodes_[index].actions = std::move(actions);
  }

  [[nodiscard]] double sum(const TreeAction& action, double TreeNode::*bound) const
  {
    double sum = action.reward;
    for (const std::uint32_t child : action.children)
    {
      sum += nodes_[child].*bound;
    }
    return sum;
  }

  void backUp(TreeNode& node)
  {
    double lower = node.default_value;
    double upper = node.default_value;
    for (const TreeAction& action : node.actions)
    {
      lower = std::max(lower, sum(action, &TreeNode::lower));
      upper = std::max(upper, sum(action, &TreeNode::upper));
    }
    node.lower = std::max(node.lower, lower);
    node.upper = std::min(node.upper, std::max(upper, node.lower));
  }

  /// One walk to where the root's gap comes from, and back. @return whether anything was done
  template <typename InTime>
  bool trial(const InTime& in_time)
  {
    const double root_gap = nodes_.front().upper - nodes_.front().lower;
    const auto excess = [&](const TreeNode& node) {
      return node.upper - node.lower -
             options_.target * root_gap * static_cast<double>(node.particles.size()) /
                 static_cast<double>(options_.num_scenarios);
    };
    std::uint32_t index = 0;
    const std::uint64_t before = expansions_;
    while (nodes_[index].depth < options_.max_depth && in_time())
    {
      if (nodes_[index].actions.empty())
      {
        expand(index);
      }
      const TreeAction* best = nullptr;
      double most = -kInfinity;
      for (const TreeAction& action : nodes_[index].actions)
      {
        const double upper = sum(action, &TreeNode::upper);
        if (upper > most)
        {
          most = upper;
          best = &action;
        }
      }
      std::uint32_t next = index;
      double widest = 0.0;
      for (const std::uint32_t child : best->children)
      {
        const double value = excess(nodes_[child]);
        if (value > widest)
        {
          widest = value;
          next = child;
        }
      }
      if (next == index)
      {
        break;
      }
      index = next;
    }
    for (;; index = nodes_[index].parent)
    {
      if (!nodes_[index].actions.empty())
      {
        backUp(nodes_[index]);
      }
      if (index == 0)
      {
        break;
      }
    }
    const double gap = nodes_.front().upper - nodes_.front().lower;
    return expansions_ > before || gap < root_gap;
  }

  /// The action with the greatest lower bound; the default policy's when none is better.
  [[nodiscard]] std::size_t bestAction() const
  {
    const TreeNode& root = nodes_.front();
    std::size_t best = root.default_action;
    double most = root.default_value;
    for (std::size_t a = 0; a < root.actions.size(); ++a)
    {
      const double lower = sum(root.actions[a], &TreeNode::lower);
      if (lower > most)
      {
        most = lower;
        best = a;
      }
    }
    return best;
  }

  static constexpr double kLeastGap = 1e-6;

  const GenerativeModel& model_;
  const OnlineOptions& options_;
  Streams streams_;
  std::deque<TreeNode> nodes_;
  std::uint64_t expansions_ = 0;
  std::vector<std::uint64_t> states_;  // scratch
};

void require(bool valid, const std::string& what)
{
  if (!valid)
  {
    throw InvalidArgument(what);
  }
}

}  // namespace

double GenerativeModel::upperBoundOf(const std::vector<std::uint64_t>& states) const
{
  double sum = 0.0;
  for (const std::uint64_t state : states)
  {
    sum += upperBound(state);
  }
  return sum;
}

std::optional<KnownPlan> GenerativeModel::knownPlan(
    const std::vector<std::uint64_t>& /*states*/) const
{
  return std::nullopt;
}

std::optional<double> GenerativeModel::observationProbability(std::size_t /*action*/,
                                                              std::uint64_t /*next_state*/,
                                                              std::uint64_t /*observation*/) const
{
  return std::nullopt;
}

std::optional<std::uint64_t> GenerativeModel::perturbed(std::uint64_t /*state*/,
                                                        double /*random*/) const
{
  return std::nullopt;
}

OnlinePlanner::OnlinePlanner(const GenerativeModel& model, const OnlineOptions& options)
  : model_(model), options_(options)
{
  require(options.num_scenarios >= 1, "no scenarios, expected at least 1");
  require(options.max_depth >= 1, "a depth of 0, expected at least 1");
  require(options.regularisation >= 0.0 && std::isfinite(options.regularisation),
          "regularisation " + std::to_string(options.regularisation) + ", expected it >= 0");
  require(options.target > 0.0 && options.target < 1.0,
          "target " + std::to_string(options.target) + ", expected it in (0, 1)");
  require(options.time_s >= 0.0 && std::isfinite(options.time_s) &&
              (options.time_s > 0.0 || options.max_expansions > 0),
          "time " + std::to_string(options.time_s) +
              " s and no number of expansions, expected a limit");
  require(model.discount() > 0.0 && model.discount() < 1.0,
          "discount " + std::to_string(model.discount()) + ", expected it in (0, 1)");
}

OnlineDecision OnlinePlanner::plan(const std::function<std::uint64_t(double)>& sample,
                                   std::uint64_t seed) const
{
  return Tree(model_, options_, sample, seed).decide();
}

std::function<std::uint64_t(double)> sampler(const Belief& belief)
{
  std::vector<std::pair<double, std::uint64_t>> cumulative;
  double sum = 0.0;
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      sum += belief[s];
      cumulative.emplace_back(sum, s);
    }
  }
  return [cumulative = std::move(cumulative)](double random) {
    const auto found = std::upper_bound(
        cumulative.begin(), cumulative.end(), random,
        [](double u, const std::pair<double, std::uint64_t>& entry) { return u < entry.first; });
    return found == cumulative.end() ? cumulative.back().second : found->second;
  };
}

}  // namespace kr3::pomdp
