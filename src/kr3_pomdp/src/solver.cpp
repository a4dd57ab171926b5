#include "kr3_pomdp/solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>
#include <string>

#include <kr3_common/error.hpp>

#include "belief_graph.hpp"

namespace kr3::pomdp
{

namespace
{

double threadCpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void check(const Model& model, const SolverLimits& limits, bool has_callback)
{
  const auto valid = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!valid(limits.precision) || !valid(limits.time_s))
  {
    throw InvalidArgument("precision " + std::to_string(limits.precision) + " and time " +
                          std::to_string(limits.time_s) + " s, expected both finite and >= 0");
  }
  if (limits.precision == 0.0 && limits.time_s == 0.0 && limits.max_backups == 0 && !has_callback)
  {
    throw InvalidArgument("no precision, time, backups or callback: the run would never end");
  }
  if (model.discount() >= 1.0)
  {
    throw InvalidArgument(
        "discount 1, expected it below 1: values of an endless run have no bound");
  }
}

/// Decides when to stop, and reports.
class Supervisor
{
public:
  Supervisor(const SolverLimits& limits, const ProgressCallback& keep_going)
    : limits_(limits), keep_going_(keep_going), start_(Clock::now()), cpu_start_(threadCpuSeconds())
  {
  }

  [[nodiscard]] double elapsed() const
  {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }
  [[nodiscard]] double cpu() const { return threadCpuSeconds() - cpu_start_; }
  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] StopReason reason() const { return reason_; }
  [[nodiscard]] std::uint64_t backups() const { return backups_; }
  void countBackup() { ++backups_; }

  /// Whether work may go on.
  bool check(double lower, double upper, std::size_t num_vectors)
  {
    lower_ = std::max(lower_, lower);
    upper_ = std::max(lower_, std::min(upper_, upper));
    if (stopped_)
    {
      return false;
    }
    const double elapsed_s = elapsed();
    if (upper_ - lower_ <= limits_.precision)
    {
      stop(StopReason::kPrecision);
    }
    else if (limits_.max_backups != 0 && backups_ >= limits_.max_backups)
    {
      stop(StopReason::kBackupLimit);
    }
    else if (limits_.time_s > 0.0 && elapsed_s >= limits_.time_s)
    {
      stop(StopReason::kTimeLimit);
    }
    else if (keep_going_ && !keep_going_({lower_, upper_, backups_, num_vectors, elapsed_s}))
    {
      stop(StopReason::kCancelled);
    }
    return !stopped_;
  }

  /// Before there are bounds: only time and the callback count.
  bool checkTime()
  {
    if (!stopped_ && limits_.time_s > 0.0 && elapsed() >= limits_.time_s)
    {
      stop(StopReason::kTimeLimit);
    }
    return !stopped_;
  }

private:
  using Clock = std::chrono::steady_clock;
  void stop(StopReason reason)
  {
    stopped_ = true;
    reason_ = reason;
  }

  const SolverLimits& limits_;
  const ProgressCallback& keep_going_;
  Clock::time_point start_;
  double cpu_start_;
  std::uint64_t backups_ = 0;
  double lower_ = -std::numeric_limits<double>::infinity();
  double upper_ = std::numeric_limits<double>::infinity();
  bool stopped_ = false;
  StopReason reason_ = StopReason::kPrecision;
};

/// Walks from the initial belief, then backs up along the way in reverse.
class Search
{
public:
  Search(BeliefGraph& graph, double precision, Supervisor& supervisor)
    : graph_(&graph), precision_(precision), supervisor_(&supervisor)
  {
  }

  bool keepGoing() { return supervisor_->check(lower(), upper(), graph_->numVectors()); }

  /// Bounds of the value before anything is seen.
  double lower()
  {
    return expected([this](NodeId root) { return graph_->lower(root); });
  }
  double upper()
  {
    return expected([this](NodeId root) { return graph_->upper(root); });
  }

  void run()
  {
    const double share = 0.5;
    double credit = 0;
    while (keepGoing())
    {
      credit += share;
      if (credit >= 1.0)
      {
        credit -= 1.0;
        sampledTrial();
      }
      else
        upperTrial();
    }
  }

private:
  template <typename ValueOf>
  double expected(const ValueOf& value_of)
  {
    double sum = 0.0;
    for (std::size_t i = 0; i < graph_->roots().size(); ++i)
    {
      sum += graph_->model().starts()[i].probability * value_of(graph_->roots()[i]);
    }
    return sum;
  }

  /// The start that adds most to the gap.
  NodeId widestRoot()
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

  NodeId sampledRoot()
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
  void upperTrial()
  {
    NodeId node = widestRoot();
    const double root_gap = graph_->upper(node) - graph_->lower(node);
    double allowed = std::max(precision_ * kTrialTarget, root_gap * kTrialTarget);
    path_.clear();
    while (path_.size() < kMaxDepth && graph_->upper(node) - graph_->lower(node) > allowed)
    {
      path_.push_back(node);
      allowed /= graph_->model().discount();
      const std::size_t action = graph_->bestUpper(node).action;
      const NodeAction& entry = graph_->actions(node)[action];
      const std::vector<Edge>& edges = graph_->edges(node);
      double most = 0.0;
      NodeId next = node;
      for (std::uint32_t e = entry.first_edge; e < entry.last_edge; ++e)
      {
        const double gap = graph_->upper(edges[e].child) - graph_->lower(edges[e].child);
        const double excess = edges[e].probability * (gap - allowed);
        if (excess > most)
        {
          most = excess;
          next = edges[e].child;
        }
      }
      if (next == node)
      {
        break;
      }
      node = next;
    }
    backUpPath();
  }

  /// Samples what happens, mostly under the policy found so far, at times under the
  /// optimistic one, with some exploration: where upper bounds stay far off, this improves the
  /// lower bound where it is used.
  void sampledTrial()
  {
    NodeId node = sampledRoot();
    const double root_gap = graph_->upper(node) - graph_->lower(node);
    const bool optimistic = uniform() < kOptimistic;
    double weight = 1.0;
    path_.clear();
    while (weight > kLeastWeight &&
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
        action = graph_->bestLower(node).action;
      }
      node = sampledChild(node, action);
    }
    backUpPath();
  }

  std::size_t anyUseful(NodeId node)
  {
    std::vector<std::size_t> useful;
    const std::vector<NodeAction>& actions = graph_->actions(node);
    for (std::size_t a = 0; a < actions.size(); ++a)
    {
      if (!actions[a].useless)
      {
        useful.push_back(a);
      }
    }
    return useful[static_cast<std::size_t>(uniform() * static_cast<double>(useful.size()))];
  }

  NodeId sampledChild(NodeId node, std::size_t action)
  {
    const NodeAction& entry = graph_->actions(node)[action];
    const std::vector<Edge>& edges = graph_->edges(node);
    double u = uniform();
    std::uint32_t e = entry.first_edge;
    while (e + 1 < entry.last_edge && (u -= edges[e].probability) >= 0.0)
    {
      ++e;
    }
    return edges[e].child;
  }

  void backUpPath()
  {
    for (std::size_t i = path_.size(); i-- > 0;)
    {
      graph_->backUp(path_[i]);
      supervisor_->countBackup();
      if (i > 0 && !keepGoing())
      {
        return;
      }
    }
  }

  /// Uniform in [0, 1), the same with every standard library.
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1.0p-53; }

  static constexpr std::size_t kMaxDepth = 2000;
  static constexpr double kTrialTarget = 0.5;   // of the root's gap
  static constexpr double kOptimistic = 0.25;   // probability
  static constexpr double kExploration = 0.1;   // probability
  static constexpr double kLeastWeight = 0.05;  // discount at which a trial ends
  static constexpr double kLeastGap = 0.01;     // of the root's gap

  BeliefGraph* graph_;
  double precision_;
  Supervisor* supervisor_;
  std::vector<NodeId> path_;
  std::mt19937_64 random_{1};  // fixed, so that a run repeats
};

/// The value of doing one action for ever, in all states of the model: the best one from the start.
AlphaVector blindVector(const Model& model)
{
  AlphaVector best;
  double best_value = -std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    least =
        std::min(least, *std::min_element(model.rewards(a), model.rewards(a) + model.numStates()));
  }
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    std::vector<double> values(model.numStates(), least / (1.0 - model.discount()));
    for (int sweep = 0; sweep < 300; ++sweep)
    {
      for (std::size_t s = 0; s < values.size(); ++s)
      {
        double sum = 0.0;
        for (const SparseEntry& next : model.transitions(a, s))
        {
          sum += next.probability * values[next.index];
        }
        values[s] = std::max(values[s], model.reward(a, s) + model.discount() * sum);
      }
    }
    double value = 0.0;
    for (std::size_t s = 0; s < values.size(); ++s)
    {
      value += model.initialBelief()[s] * values[s];
    }
    if (value > best_value)
    {
      best_value = value;
      best = {a, {}, values};
    }
  }
  return best;
}

Policy policyOf(const BeliefGraph& graph)
{
  const ObservedModel& observed = graph.model();
  std::vector<AlphaVector> vectors{blindVector(observed.model())};
  for (std::size_t c = 0; c < observed.classes().size(); ++c)
  {
    const VectorSet& set = graph.vectors()[c];
    const std::vector<std::uint32_t>& states = observed.classes()[c].states;
    const bool all = states.size() == observed.model().numStates();
    for (std::uint32_t i = 0; i < set.end(); ++i)
    {
      if (set.isAlive(i))
      {
        vectors.push_back({set.action(i),
                           all ? std::vector<std::uint32_t>{} : states,
                           {set.values(i), set.values(i) + states.size()}});
      }
    }
  }
  return Policy(observed.model().numStates(), vectors);
}

}  // namespace

const char* toString(StopReason reason)
{
  switch (reason)
  {
    case StopReason::kPrecision:
      return "precision";
    case StopReason::kTimeLimit:
      return "time limit";
    case StopReason::kBackupLimit:
      return "backup limit";
    case StopReason::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

SolveResult solve(const Model& model, const SolverLimits& limits,
                  const ProgressCallback& keep_going)
{
  check(model, limits, static_cast<bool>(keep_going));
  Supervisor supervisor(limits, keep_going);
  const ObservedModel observed(model);
  const auto in_time = [&supervisor] { return supervisor.checkTime(); };
  const InformedVectors informed = informedBound(observed, in_time);
  const InformedVectors blind = blindBound(observed, in_time);
  BeliefGraph graph(observed, informed, blind);
  Search search(graph, limits.precision, supervisor);
  search.run();
  Policy policy = policyOf(graph);
  double lower = 0.0;
  for (const InitialOutcome& outcome : model.initialOutcomes())
  {
    lower += outcome.probability * policy.valueAt(outcome.belief);
  }
  return {std::move(policy),
          lower,
          std::max(lower, search.upper()),
          supervisor.backups(),
          supervisor.reason(),
          supervisor.elapsed(),
          supervisor.cpu()};
}

}  // namespace kr3::pomdp
