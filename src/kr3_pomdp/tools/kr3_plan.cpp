// Simulates planning online in a .pomdp or .pomdpx file and prints the mean discounted return.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/belief_planner.hpp"
#include "kr3_pomdp/online_planner.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "tool.hpp"

namespace
{

using namespace kr3::pomdp;

struct Options
{
  std::string model;
  std::string policy;
  std::string method = "beliefs";
  SolverLimits offline;
  OnlineOptions online;
  std::uint64_t trials = 100;
  std::uint64_t seed = 1;
  double truncation = 1e-2;
};

double cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// Chooses actions by one of the methods.
class Player
{
public:
  Player(const Model& model, const SampledModel& sampled, const Policy* policy,
         const Options& options)
    : policy_(policy)
  {
    if (options.method == "samples")
    {
      sampling_.emplace(sampled, options.online);
    }
    else if (options.method == "beliefs")
    {
      BeliefPlannerOptions limits;
      limits.time_s = options.online.time_s;
      limits.max_expansions = options.online.max_expansions;
      searching_.emplace(model, *policy, limits);
    }
  }

  void start(const Belief& belief)
  {
    if (searching_)
    {
      searching_->restart(belief);
    }
  }

  std::size_t actionAt(const Belief& belief, std::uint64_t seed)
  {
    if (sampling_)
    {
      const OnlineDecision decision = sampling_->plan(sampler(belief), seed);
      expansions += decision.expansions;
      return decision.action;
    }
    if (searching_)
    {
      const BeliefDecision decision = searching_->plan();
      expansions += decision.expansions;
      return decision.action;
    }
    return policy_->actionAt(belief);
  }

  void advance(std::size_t action, std::size_t observation)
  {
    if (searching_)
    {
      searching_->advance(action, observation);
    }
  }

  std::uint64_t expansions = 0;

private:
  const Policy* policy_;
  std::optional<OnlinePlanner> sampling_;
  std::optional<BeliefPlanner> searching_;
};

struct Counts
{
  std::uint64_t moves = 0;
  double cpu_s = 0.0;
};

/// The discounted return of one trial; a seed gives the same world with every method.
double played(const Model& model, const SampledModel& world, Player& player, std::uint64_t seed,
              double truncation, Counts& counts)
{
  std::mt19937_64 random(seed);
  const std::vector<InitialOutcome> starts = model.initialOutcomes();
  std::size_t start = 0;
  for (double u = uniform(random) - starts[0].probability; u >= 0.0 && start + 1 < starts.size();)
  {
    u -= starts[++start].probability;
  }
  Belief belief = starts[start].belief;
  std::uint64_t state = sampleState(belief, random);
  player.start(belief);
  double sum = 0.0;
  for (double weight = 1.0; weight > truncation; weight *= model.discount())
  {
    const double before = cpuSeconds();
    const std::size_t action = player.actionAt(belief, random());
    counts.cpu_s += cpuSeconds() - before;
    ++counts.moves;
    const GenerativeStep step = world.step(state, action, uniform(random));
    sum += weight * step.reward;
    if (step.terminal)
    {
      break;
    }
    player.advance(action, step.observation);
    belief = updated(model, belief, action, step.observation).posterior;
    state = step.state;
  }
  return sum;
}

std::optional<Policy> offlinePolicy(const Model& model, const Options& options)
{
  if (!options.policy.empty())
  {
    return loadPolicy(options.policy, model);
  }
  if (options.offline.time_s == 0.0 && options.offline.max_backups == 0)
  {
    if (options.method != "samples")
    {
      throw kr3::InvalidArgument(
          "only --method samples plans without --policy, --offline-time or "
          "--offline-backups");
    }
    return std::nullopt;
  }
  SolveResult result = solve(model, options.offline);
  std::printf("offline: [%.4f, %.4f], %llu backups, %.2f s CPU\n", result.lower, result.upper,
              static_cast<unsigned long long>(result.backups), result.cpu_s);
  return std::move(result.policy);
}

void run(const Options& options)
{
  const Model model = loadModel(options.model);
  const std::optional<Policy> policy = offlinePolicy(model, options);
  const Policy* known = policy ? &*policy : nullptr;
  const double before = cpuSeconds();
  const SampledModel world(model, options.method == "samples" ? known : nullptr);
  Player player(model, world, known, options);
  std::printf("set-up: %.2f s CPU\n", cpuSeconds() - before);
  double mean = 0.0;
  double squares = 0.0;  // sum of squared deviations (Welford)
  Counts counts;
  for (std::uint64_t trial = 1; trial <= options.trials; ++trial)
  {
    const double value =
        played(model, world, player, options.seed * 1000003 + trial, options.truncation, counts);
    const auto n = static_cast<double>(trial);
    const double deviation = value - mean;
    mean += deviation / n;
    squares += deviation * (value - mean);
    if ((trial & (trial - 1)) == 0 || trial == options.trials)
    {
      const double half = trial > 1 ? 1.96 * std::sqrt(squares / (n - 1.0) / n) : 0.0;
      const auto moves = static_cast<double>(counts.moves);
      std::printf("%6llu trials: %.3f +- %.3f (95 %%); a move: %.4f s CPU, %.1f expansions\n",
                  static_cast<unsigned long long>(trial), mean, half, counts.cpu_s / moves,
                  static_cast<double>(player.expansions) / moves);
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  options.offline.precision = 1e-6;
  options.online.time_s = 0.0;
  CLI::App app("Simulates planning online and prints the mean discounted return.");
  app.add_option("model", options.model, "file in .pomdp or .pomdpx format")->required();
  app.add_option("--method", options.method,
                 "beliefs: search of exact beliefs; samples: DESPOT; policy: only the offline one")
      ->check(CLI::IsMember({"beliefs", "samples", "policy"}))
      ->capture_default_str();
  app.add_option("--policy", options.policy,
                 "offline policy, written by kr3_solve --policy, or by APPL");
  app.add_option("--offline-time", options.offline.time_s, "seconds of solving first");
  app.add_option("--offline-backups", options.offline.max_backups, "backups of solving first");
  app.add_option("--trials", options.trials, "number of trials")->capture_default_str();
  app.add_option("--seed", options.seed, "of all random numbers")->capture_default_str();
  app.add_option("--budget", options.online.max_expansions,
                 "expansions a move: counted work, which repeats exactly");
  app.add_option("--time", options.online.time_s, "wall seconds a move; 0 = no limit")
      ->capture_default_str();
  app.add_option("--scenarios", options.online.num_scenarios, "of --method samples")
      ->capture_default_str();
  app.add_option("--depth", options.online.max_depth, "of --method samples")->capture_default_str();
  app.add_option("--regularisation", options.online.regularisation, "of --method samples")
      ->capture_default_str();
  app.add_option("--truncation", options.truncation, "a trial ends when its discount is below this")
      ->capture_default_str();
  return tool::runTool(app, argc, argv, [&] { run(options); });
}
