// Solves a .pomdp or .pomdpx file and prints the bounds as they come nearer.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/solver.hpp"
#include "solve_trace.hpp"

namespace
{

struct Options
{
  std::string model;
  std::string policy;
  std::string trace;
  double cpu_time_s = 0.0;
  kr3::pomdp::SolverLimits limits;
  bool quiet = false;
};

void printBounds(double elapsed_s, double lower, double upper, std::uint64_t backups,
                 std::size_t num_vectors)
{
  std::printf("%8.3f s  [%.5f, %.5f]  gap %.5f  %llu backups  %zu vectors\n", elapsed_s, lower,
              upper, upper - lower, static_cast<unsigned long long>(backups), num_vectors);
  std::fflush(stdout);
}

void run(const Options& options)
{
  using namespace kr3::pomdp;
  const Model model = loadModel(options.model);
  std::printf("%zu states, %zu actions, %zu observations, discount %g\n", model.numStates(),
              model.numActions(), model.numObservations(), model.discount());
  SolveTrace trace(options.trace, model, processCpuSeconds());
  bool out_of_cpu_time = false;
  double next_print_s = 0.05;
  const SolveResult result = solve(model, options.limits, [&](const SolverProgress& progress) {
    const bool bounded = std::isfinite(progress.lower);
    if (bounded && !options.quiet && progress.elapsed_s >= next_print_s)
    {
      printBounds(progress.elapsed_s, progress.lower, progress.upper, progress.backups,
                  progress.num_alpha_vectors);
      next_print_s = std::max(2.0 * next_print_s, progress.elapsed_s);
    }
    const double cpu_s = trace.cpuSeconds();
    if (bounded)
    {
      trace.add(progress, cpu_s);
    }
    out_of_cpu_time = options.cpu_time_s > 0.0 && cpu_s >= options.cpu_time_s;
    return !out_of_cpu_time;
  });
  const char* reason = out_of_cpu_time ? "CPU time limit" : toString(result.reason);
  trace.finish(result, reason);
  printBounds(result.elapsed_s, result.lower, result.upper, result.backups,
              result.policy.numAlphaVectors());
  std::printf("stopped: %s; %.3f s CPU\n", reason, result.cpu_s);
  if (!options.policy.empty())
  {
    std::ofstream out(options.policy);
    result.policy.write(out);
    out.close();
    if (!out)
    {
      throw kr3::Unavailable("cannot write '" + options.policy + "'");
    }
  }
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  options.limits.time_s = 60.0;
  CLI::App app("Solves a POMDP and prints the bounds of the value at its initial belief.");
  app.add_option("model", options.model, "file in .pomdp or .pomdpx format")->required();
  app.add_option("--precision", options.limits.precision, "stop when the gap is below this")
      ->capture_default_str();
  app.add_option("--time", options.limits.time_s, "stop after so many seconds; 0 = no limit")
      ->capture_default_str();
  app.add_option("--cpu-time", options.cpu_time_s,
                 "stop after so many seconds of CPU time after loading; 0 = no limit")
      ->capture_default_str();
  app.add_option("--backups", options.limits.max_backups,
                 "stop after so many backups; 0 = no limit")
      ->capture_default_str();
  app.add_option("--policy", options.policy, "file to write the policy to");
  app.add_option("--trace", options.trace, "file to write the bounds over time to, as JSON lines");
  app.add_flag("--quiet", options.quiet, "only the result");
  CLI11_PARSE(app, argc, argv);
  try
  {
    run(options);
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
