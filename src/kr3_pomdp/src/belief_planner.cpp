#include "kr3_pomdp/belief_planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "class_bounds.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastProbability = 1e-12;  // of an outcome that is followed
constexpr double kSameBelief = 1e-9;         // largest difference of an entry

struct Node;

/// An outcome of an action, and what follows.
struct Outcome
{
  double probability;
  std::unique_ptr<Node> node;
};

struct NodeAction
{
  double reward = 0.0;
  std::vector<Outcome> outcomes;
};

struct Node
{
  ClassBelief belief;
  std::size_t policy_action;
  double policy_value;
  double lower;
  double upper;
  std::vector<NodeAction> actions;  // empty until expanded
};

void checkOptions(const Model& model, const Policy& policy, const BeliefPlannerOptions& options)
{
  const auto require = [](bool valid, const std::string& what) {
    if (!valid)
    {
      throw InvalidArgument(what);
    }
  };
  require(policy.numStates() == model.numStates() && policy.maxAction() < model.numActions(),
          "a policy over " + std::to_string(policy.numStates()) + " states with actions up to " +
              std::to_string(policy.maxAction()) + ", expected " +
              std::to_string(model.numStates()) + " states and " +
              std::to_string(model.numActions()) + " actions");
  require(model.discount() < 1.0, "discount 1, expected it below 1");
  require(options.precision >= 0.0 && std::isfinite(options.precision),
          "precision " + std::to_string(options.precision) + ", expected it >= 0");
  require(options.time_s >= 0.0 && std::isfinite(options.time_s) &&
              (options.time_s > 0.0 || options.max_expansions > 0),
          "time " + std::to_string(options.time_s) +
              " s and no number of expansions, expected a limit");
}

}  // namespace

class BeliefPlanner::Impl
{
public:
  Impl(const Model& model, const Policy& policy, const BeliefPlannerOptions& options)
    : model_(model), options_(options), bounds_(model_, &policy), belief_(model.initialBelief())
  {
    restart(model_.initialOutcomes().front().belief);
  }

  void restart(const Belief& belief)
  {
    std::unique_ptr<Node> root = nodeOf(located(belief));
    belief_ = belief;
    root_ = std::move(root);
  }

  [[nodiscard]] const Belief& belief() const { return belief_; }

  BeliefDecision plan()
  {
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t expansions = 0;
    const auto inTime = [&] {
      return (options_.max_expansions == 0 || expansions < options_.max_expansions) &&
             (options_.time_s == 0.0 ||
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() <
                  options_.time_s);
    };
    while (root_->upper - root_->lower > options_.precision && inTime())
    {
      improve();
      ++expansions;
    }
    return {bestAction(), root_->lower, root_->upper, expansions};
  }

  double advance(std::size_t action, std::size_t observation)
  {
    BeliefUpdate update = updated(model_, belief_, action, observation);
    ClassBelief next = located(update.posterior);
    std::unique_ptr<Node> kept;
    if (!root_->actions.empty())
    {
      for (Outcome& outcome : root_->actions[action].outcomes)
      {
        if (same(outcome.node->belief, next))
        {
          kept = std::move(outcome.node);
          break;
        }
      }
    }
    root_ = kept ? std::move(kept) : nodeOf(std::move(next));
    belief_ = std::move(update.posterior);
    return update.probability;
  }

private:
  static bool same(const ClassBelief& a, const ClassBelief& b)
  {
    return a.state_class == b.state_class && a.entries.size() == b.entries.size() &&
           std::equal(a.entries.begin(), a.entries.end(), b.entries.begin(),
                      [](const SparseEntry& x, const SparseEntry& y) {
      return x.index == y.index && std::abs(x.probability - y.probability) < kSameBelief;
           });
  }

  [[nodiscard]] ClassBelief located(const Belief& belief) const
  {
    if (belief.size() != model_.numStates())
    {
      throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                            std::to_string(model_.numStates()));
    }
    std::vector<SparseEntry> entries;
    for (std::uint32_t s = 0; s < belief.size(); ++s)
    {
      if (belief[s] > 0.0)
      {
        entries.push_back({s, belief[s]});
      }
    }
    std::optional<ClassBelief> local = bounds_.located(entries);
    if (!local)
    {
      throw InvalidArgument("a belief that cannot follow from the model's initial belief");
    }
    return *std::move(local);
  }

  std::unique_ptr<Node> nodeOf(ClassBelief belief)
  {
    const ClassBounds::Lower lower = bounds_.lowerAt(belief, sums_);
    const double upper = bounds_.upperAt(belief, sums_);
    return std::make_unique<Node>(Node{std::move(belief),
                                       lower.action,
                                       lower.value,
                                       lower.value,
                                       std::max(upper, lower.value),
                                       {}});
  }

  void expand(Node& node)
  {
    const StateClass& state_class = bounds_.classes()[node.belief.state_class];
    node.actions.resize(state_class.actions.size());
    for (std::size_t a = 0; a < node.actions.size(); ++a)
    {
      const ClassAction& action = state_class.actions[a];
      for (const SparseEntry& entry : node.belief.entries)
      {
        node.actions[a].reward += entry.probability * action.rewards[entry.index];
      }
      for (const Branch& branch : action.branches)
      {
        std::optional<Outcome> outcome = follow(node.belief, branch);
        if (outcome)
        {
          node.actions[a].outcomes.push_back(*std::move(outcome));
        }
      }
    }
  }

  /// What a branch makes of a belief; nothing where it cannot happen.
  std::optional<Outcome> follow(const ClassBelief& belief, const Branch& branch)
  {
    next_.assign(bounds_.classes()[branch.target_class].states.size(), 0.0);
    double probability = 0.0;
    for (const SparseEntry& entry : belief.entries)
    {
      for (const SparseEntry& next : branch.joint.row(entry.index))
      {
        next_[next.index] += entry.probability * next.probability;
        probability += entry.probability * next.probability;
      }
    }
    if (probability < kLeastProbability)
    {
      return std::nullopt;
    }
    ClassBelief after{branch.target_class, {}};
    for (std::uint32_t s = 0; s < next_.size(); ++s)
    {
      if (next_[s] > 0.0)
      {
        after.entries.push_back({s, next_[s] / probability});
      }
    }
    return Outcome{probability, nodeOf(std::move(after))};
  }

  [[nodiscard]] double backedUp(const NodeAction& action, double Node::*bound) const
  {
    double sum = 0.0;
    for (const Outcome& outcome : action.outcomes)
    {
      sum += outcome.probability * ((*outcome.node).*bound);
    }
    return action.reward + model_.discount() * sum;
  }

  /// Expands the leaf from which most of the root's gap comes, and backs its values up.
  void improve()
  {
    path_.assign(1, root_.get());
    while (!path_.back()->actions.empty())
    {
      const NodeAction* best = nullptr;
      double most = -kInfinity;
      for (const NodeAction& action : path_.back()->actions)
      {
        const double upper = backedUp(action, &Node::upper);
        if (upper > most)
        {
          most = upper;
          best = &action;
        }
      }
      Node* widest = nullptr;
      double gap = -kInfinity;
      for (const Outcome& outcome : best->outcomes)
      {
        const double share = outcome.probability * (outcome.node->upper - outcome.node->lower);
        if (share > gap)
        {
          gap = share;
          widest = outcome.node.get();
        }
      }
      path_.push_back(widest);
    }
    expand(*path_.back());
    for (auto node = path_.rbegin(); node != path_.rend(); ++node)
    {
      double lower = (*node)->policy_value;
      double upper = -kInfinity;
      for (const NodeAction& action : (*node)->actions)
      {
        lower = std::max(lower, backedUp(action, &Node::lower));
        upper = std::max(upper, backedUp(action, &Node::upper));
      }
      (*node)->lower = std::max((*node)->lower, lower);
      (*node)->upper = std::max(std::min((*node)->upper, upper), (*node)->lower);
    }
  }

  /// The action with the greatest lower bound; the policy's when none is better.
  [[nodiscard]] std::size_t bestAction() const
  {
    std::size_t best = root_->policy_action;
    double most = root_->policy_value;
    for (std::size_t a = 0; a < root_->actions.size(); ++a)
    {
      const double lower = backedUp(root_->actions[a], &Node::lower);
      if (lower > most)
      {
        most = lower;
        best = a;
      }
    }
    return best;
  }

  Model model_;
  BeliefPlannerOptions options_;
  ClassBounds bounds_;
  Belief belief_;
  std::unique_ptr<Node> root_;
  std::vector<double> sums_;  // scratch, as the next two
  std::vector<double> next_;
  std::vector<Node*> path_;
};

BeliefPlanner::BeliefPlanner(const Model& model, const Policy& policy,
                             const BeliefPlannerOptions& options)
{
  checkOptions(model, policy, options);
  impl_ = std::make_unique<Impl>(model, policy, options);
}

BeliefPlanner::~BeliefPlanner() = default;
BeliefPlanner::BeliefPlanner(BeliefPlanner&&) noexcept = default;
BeliefPlanner& BeliefPlanner::operator=(BeliefPlanner&&) noexcept = default;

void BeliefPlanner::restart(const Belief& belief)
{
  impl_->restart(belief);
}

const Belief& BeliefPlanner::belief() const
{
  return impl_->belief();
}

BeliefDecision BeliefPlanner::plan()
{
  return impl_->plan();
}

double BeliefPlanner::advance(std::size_t action, std::size_t observation)
{
  return impl_->advance(action, observation);
}

}  // namespace kr3::pomdp
