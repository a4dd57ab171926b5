// Solves a .pomdp or .pomdpx file and prints the bounds as they come nearer.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/exact_solver.hpp"
#include "kr3_pomdp/finite_horizon.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/solver.hpp"
#include "solve_trace.hpp"
#include "tool.hpp"

namespace
{

using namespace kr3::pomdp;

constexpr double kMebibyte = 1024.0 * 1024.0;

volatile std::sig_atomic_t interrupted = 0;

struct Options
{
  std::string model;
  std::string policy;
  std::string format = "kr3";
  std::string trace;
  double cpu_time_s = 0.0;
  double memory_mib = 0.0;
  SolverLimits limits;
  std::size_t horizon = 0;
  bool exact = false;
  bool quiet = false;
};

/// The bounds over time, in columns.
class Report
{
public:
  explicit Report(std::FILE* out) : out_(out) {}

  void model(const Model& model, double load_cpu_s)
  {
    std::fprintf(out_, "%zu states, %zu actions, %zu observations, discount %g; loaded in %.3f s\n",
                 model.numStates(), model.numActions(), model.numObservations(), model.discount(),
                 load_cpu_s);
    std::fprintf(out_, "%9s %9s %14s %14s %12s %10s %8s %8s\n", "time s", "CPU s", "lower", "upper",
                 "gap", "backups", "vectors", "MiB");
    std::fflush(out_);
  }

  void bounds(const SolverProgress& progress, double cpu_s)
  {
    std::fprintf(out_, "%9.3f %9.3f %14.6f %14.6f %12.6f %10llu %8zu %8.1f\n", progress.elapsed_s,
                 cpu_s, progress.lower, progress.upper, progress.upper - progress.lower,
                 static_cast<unsigned long long>(progress.backups), progress.num_alpha_vectors,
                 static_cast<double>(progress.memory_bytes) / kMebibyte);
    std::fflush(out_);
  }

  void stopped(const std::string& reason) { std::fprintf(out_, "stopped: %s\n", reason.c_str()); }

private:
  std::FILE* out_;
};

/// Small models, by incremental pruning.
void runExactly(const Options& options, const Model& model, std::FILE* out,
                std::optional<tool::OutputFile>& output)
{
  ExactLimits limits;
  limits.horizon = options.horizon;
  limits.precision = options.limits.precision;
  limits.time_s = options.limits.time_s;
  const ExactSolution solution = solveExactly(model, limits);
  const double value = startValue(model, solution);
  std::fprintf(out, "optimum in [%.6f, %.6f], %zu vectors after %zu iterations, %.3f s CPU\n",
               value, value + solution.error, solution.stages.back().numAlphaVectors(),
               solution.iterations, processCpuSeconds());
  if (output)
  {
    if (options.horizon > 0)
    {
      HorizonPolicy(solution).write(output->stream());
    }
    else
    {
      solution.stages.back().write(output->stream());
    }
    output->finish();
  }
}

void run(const Options& options)
{
  if ((options.exact || options.horizon > 0) && options.format != "kr3")
  {
    throw kr3::InvalidArgument("--format " + options.format +
                               ", expected kr3 with --exact or --horizon");
  }
  // What cannot be written is known before the work.
  std::optional<tool::OutputFile> output;
  if (!options.policy.empty())
  {
    output.emplace(options.policy);
  }
  const Model loaded = loadModel(options.model);
  if (options.exact)
  {
    runExactly(options, loaded, options.policy == "-" ? stderr : stdout, output);
    return;
  }
  const Model model = options.horizon > 0 ? overHorizon(loaded, options.horizon) : loaded;
  SolverLimits limits = options.limits;
  limits.max_memory_bytes = static_cast<std::size_t>(options.memory_mib * kMebibyte);
  Report report(options.policy == "-" ? stderr : stdout);
  report.model(model, processCpuSeconds());
  SolveTrace trace(options.trace, model, processCpuSeconds());
  std::signal(SIGINT, [](int) {
    interrupted = 1;
    std::signal(SIGINT, SIG_DFL);  // the second one ends the program
  });
  bool out_of_cpu_time = false;
  double next_print_s = 0.05;
  const SolveResult result = solve(model, limits, [&](const SolverProgress& progress) {
    const double cpu_s = trace.cpuSeconds();
    const bool bounded = std::isfinite(progress.lower);
    if (bounded && !options.quiet && progress.elapsed_s >= next_print_s)
    {
      report.bounds(progress, cpu_s);
      next_print_s = std::max(1.5 * next_print_s, progress.elapsed_s);
    }
    if (bounded)
    {
      trace.add(progress, cpu_s);
    }
    out_of_cpu_time = options.cpu_time_s > 0.0 && cpu_s >= options.cpu_time_s;
    return !out_of_cpu_time && interrupted == 0;
  });
  const std::string reason = out_of_cpu_time ? "CPU time limit" : toString(result.reason);
  trace.finish(result, reason);
  report.bounds({result.lower, result.upper, result.backups, result.policy.numAlphaVectors(),
                 result.elapsed_s, result.memory_bytes},
                trace.cpuSeconds());
  report.stopped(reason);
  if (output)
  {
    if (options.horizon > 0)
    {
      HorizonPolicy(result.policy, options.horizon).write(output->stream());
    }
    else if (options.format == "appl")
    {
      writeApplPolicy(output->stream(), result.policy, model, options.model);
    }
    else
    {
      result.policy.write(output->stream());
    }
    output->finish();
  }
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  options.limits.time_s = 60.0;
  CLI::App app(
      "Solves a POMDP and prints the bounds of the value at its initial belief. Ctrl-C stops and "
      "keeps what was found.");
  app.add_option("model", options.model, "file in .pomdp or .pomdpx format")->required();
  app.add_option("--precision", options.limits.precision, "stop when the gap is below this")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--time", options.limits.time_s, "stop after so many seconds; 0 = no limit")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--cpu-time", options.cpu_time_s,
                 "stop after so many seconds of CPU time after loading; 0 = no limit")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--memory", options.memory_mib,
                 "stop when the search holds so many MiB; 0 = no limit")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  app.add_option("--backups", options.limits.max_backups,
                 "stop after so many backups; 0 = no limit")
      ->capture_default_str();
  app.add_option("--threads", options.limits.num_threads, "threads that search")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--horizon", options.horizon,
                 "steps after which all is over; 0 = none. The policy is one for each step")
      ->capture_default_str();
  app.add_flag(
      "--exact", options.exact,
      "small models: exactly, by incremental pruning; --precision, --time and --horizon hold");
  app.add_option("--policy", options.policy,
                 "file to write the policy to; - = the standard output, and the bounds to stderr");
  app.add_option("--format", options.format, "of the policy: kr3 or appl")
      ->check(CLI::IsMember({"kr3", "appl"}))
      ->capture_default_str();
  app.add_option("--trace", options.trace, "file to write the bounds over time to, as JSON lines");
  app.add_flag("--quiet", options.quiet, "only the result");
  return tool::runTool(app, argc, argv, [&] { run(options); });
}
