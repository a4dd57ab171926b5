/// refinement_bench DOMAIN_DIR --state S --action A [--hidden F=P]...: CPU time from a high-level
/// action to a policy that is nearly as good as the best one known. Prints one JSON object;
/// `./kr3 bench coupling` runs it for many tasks.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>

#include "command_line.hpp"
#include "kr3_refinement/pomdp_task.hpp"

namespace
{

using namespace kr3;
using nlohmann::json;

struct BenchOptions
{
  refinement::tools::Options task;
  int runs = 5;
  std::uint64_t trials = 4000;
  double best_cpu_s = 10.0;  // of the long run that says what is the best known
  double part = 0.98;        // of the best known value
  double near_zero = 10.0;   // below this, `regret` counts instead
  double regret = 0.5;
};

double cpuMilliseconds()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// The bounds of a run as they changed.
struct Trace
{
  struct Point
  {
    std::uint64_t backups;
    double lower;
    double upper;
  };
  std::vector<Point> points;

  void add(const pomdp::SolverProgress& progress)
  {
    if (points.empty() || points.back().lower < progress.lower)
    {
      points.push_back({progress.backups, progress.lower, progress.upper});
    }
  }

  /// Backups after which the lower bound is at least `value`; nothing when it never is.
  [[nodiscard]] std::optional<std::uint64_t> reached(double value) const
  {
    for (const Point& point : points)
    {
      if (point.lower >= value)
      {
        return std::max<std::uint64_t>(point.backups, 1);
      }
    }
    return std::nullopt;
  }
};

/// From the high-level action to a policy by so many backups.
struct Run
{
  double zoom_ms;
  double generate_ms;
  double solve_ms;
  pomdp::SolveResult result;

  [[nodiscard]] double total_ms() const { return zoom_ms + generate_ms + solve_ms; }
};

Run policyAfter(const refinement::tools::Loaded& loaded, const refinement::tools::Options& options,
                std::uint64_t backups)
{
  const double start_ms = cpuMilliseconds();
  const refinement::Zoom zoom = refinement::zoom(loaded.domain, loaded.state, loaded.action);
  const double zoomed_ms = cpuMilliseconds();
  const refinement::PomdpTask task = refinement::generatePomdp(
      loaded.domain, loaded.models, zoom, refinement::tools::knowledgeOf(options, zoom));
  const double generated_ms = cpuMilliseconds();
  pomdp::SolverLimits limits;
  limits.max_backups = backups;
  pomdp::SolveResult result = pomdp::solve(task.model(), limits);
  return {zoomed_ms - start_ms, generated_ms - zoomed_ms, cpuMilliseconds() - generated_ms,
          std::move(result)};
}

json valueOf(const pomdp::Model& model, const pomdp::Policy& policy, std::uint64_t trials)
{
  pomdp::EvaluationLimits limits;
  limits.trials = trials;
  const pomdp::Evaluation value = pomdp::evaluate(model, policy, limits, 1);
  return {{"mean", value.mean}, {"half_width_95", value.half_width_95}};
}

/// One step of execution: the policy's action and the belief update, mean over trials, ms.
json stepCost(const pomdp::Model& model, const pomdp::Policy& policy)
{
  constexpr int kSteps = 2000;
  std::mt19937_64 random(1);
  double lookup_ms = 0.0;
  double update_ms = 0.0;
  pomdp::Belief belief = model.initialBelief();
  std::size_t state = pomdp::sampleState(belief, random);
  for (int step = 0; step < kSteps; ++step)
  {
    const double start_ms = cpuMilliseconds();
    const std::size_t action = policy.actionAt(belief);
    const double looked_ms = cpuMilliseconds();
    const pomdp::SampledStep sampled = pomdp::sampleStep(model, state, action, random);
    const double sampled_ms = cpuMilliseconds();
    belief = pomdp::updated(model, belief, action, sampled.observation).posterior;
    update_ms += (cpuMilliseconds() - sampled_ms) / kSteps;
    lookup_ms += (looked_ms - start_ms) / kSteps;
    state = sampled.next_state;
    if (step % 12 == 11)
    {
      belief = model.initialBelief();
      state = pomdp::sampleState(belief, random);
    }
  }
  return {{"lookup_us", 1e3 * lookup_ms}, {"update_us", 1e3 * update_ms}};
}

json measure(const BenchOptions& options)
{
  const double start_ms = cpuMilliseconds();
  const refinement::tools::Loaded loaded = refinement::tools::load(options.task);
  const double load_ms = cpuMilliseconds() - start_ms;
  const refinement::Zoom zoom = refinement::zoom(loaded.domain, loaded.state, loaded.action);
  const refinement::PomdpTask task = refinement::generatePomdp(
      loaded.domain, loaded.models, zoom, refinement::tools::knowledgeOf(options.task, zoom));
  const pomdp::Model& model = task.model();

  Trace trace;
  const double solve_start_ms = cpuMilliseconds();
  const pomdp::SolveResult best =
      pomdp::solve(model, {}, [&](const pomdp::SolverProgress& progress) {
        trace.add(progress);
        return cpuMilliseconds() - solve_start_ms < 1e3 * options.best_cpu_s;
      });
  trace.add({best.lower, best.upper, best.backups, 0, 0.0, 0});
  const json simulated = valueOf(model, best.policy, options.trials);
  // A simulated mean counts as known only beyond its interval: one that noise has lifted is none.
  const double mean = simulated["mean"];
  const double known = std::max(best.lower, mean - simulated["half_width_95"].get<double>());
  const double allowed =
      std::abs(known) < options.near_zero ? options.regret : (1.0 - options.part) * std::abs(known);

  json answer = {{"states", model.numStates()},
                 {"actions", model.numActions()},
                 {"observations", model.numObservations()},
                 {"load_ms", load_ms},
                 {"best", {{"lower", best.lower}, {"upper", best.upper}, {"simulated", simulated}}},
                 {"best_known", known},
                 {"target", known - allowed}};
  const std::optional<std::uint64_t> backups = trace.reached(known - allowed);
  json zoom_ms = json::array();
  json generate_ms = json::array();
  json total_ms = json::array();
  std::optional<Run> last;
  for (int run = 0; run < options.runs; ++run)
  {
    last = policyAfter(loaded, options.task, backups.value_or(best.backups));
    zoom_ms.push_back(last->zoom_ms);
    generate_ms.push_back(last->generate_ms);
    total_ms.push_back(last->total_ms());
  }
  answer["zoom_ms"] = zoom_ms;
  answer["generate_ms"] = generate_ms;
  answer["ready_ms"] = backups && last->result.lower >= known - allowed ? total_ms : json::array();
  answer["ready"] = {{"backups", backups.value_or(best.backups)},
                     {"lower", last->result.lower},
                     {"upper", last->result.upper},
                     {"vectors", last->result.policy.numAlphaVectors()},
                     {"simulated", valueOf(model, last->result.policy, options.trials)}};
  answer["step"] = stepCost(model, last->result.policy);
  return answer;
}

}  // namespace

int main(int argc, char** argv)
{
  BenchOptions options;
  CLI::App app{"CPU time from a high-level action to a policy worth nearly the best known value."};
  app.option_defaults()->always_capture_default();
  refinement::tools::addDomainOptions(app, options.task);
  refinement::tools::addTaskOptions(app, options.task);
  app.get_option("--state")->required();
  app.get_option("--action")->required();
  app.add_option("--runs", options.runs)->check(CLI::PositiveNumber);
  app.add_option("--trials", options.trials, "simulated for each value")
      ->check(CLI::PositiveNumber);
  app.add_option("--best-time", options.best_cpu_s, "CPU s of the run for the best known value");
  app.add_option("--part", options.part, "of the best known value, to be reached");
  app.add_option("--near-zero", options.near_zero, "values below this need --regret instead");
  app.add_option("--regret", options.regret, "that is allowed near 0");
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::cout << measure(options).dump() << "\n";
    return EXIT_SUCCESS;
  }
  catch (const std::exception& error)
  {
    std::cerr << "refinement_bench: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
