// Solves a model with parts of the solver left out, one by one; prints the bounds as JSON lines.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "kr3_pomdp/pomdpx_format.hpp"
#include "solve_trace.hpp"
#include "solver_parts.hpp"

namespace
{

using namespace kr3::pomdp;

struct Variant
{
  const char* without;
  SolverParts parts;
};

std::vector<Variant> variants()
{
  std::vector<Variant> result(7);
  result[0].without = "nothing";
  result[1].without = "noise-free bound";
  result[1].parts.noise_free_bound = false;
  result[2].without = "sampled trials";
  result[2].parts.sampled_trials = false;
  result[3].without = "trials of the upper bound";
  result[3].parts.upper_trials = false;
  result[4].without = "informed vectors";
  result[4].parts.informed_vectors = false;
  result[5].without = "classes";
  result[5].parts.classes = false;
  result[6].without = "belief grid";
  result[6].parts.belief_grid = false;
  return result;
}

void print(const Variant& variant, double time_s, const SolverProgress& progress)
{
  std::printf(
      "{\"without\": \"%s\", \"time_s\": %g, \"lower\": %.17g, \"upper\": %.17g, \"backups\": "
      "%llu, "
      "\"vectors\": %zu}\n",
      variant.without, time_s, progress.lower, progress.upper,
      static_cast<unsigned long long>(progress.backups), progress.num_alpha_vectors);
  std::fflush(stdout);
}

/// A line for each time; those after the model is solved are left out.
void run(const Model& model, const Variant& variant, const std::vector<double>& times)
{
  const double start_s = processCpuSeconds();
  std::size_t next = 0;
  SolverLimits limits;
  limits.precision = 0.0;
  (void)solveWith(model, limits, variant.parts, [&](const SolverProgress& progress) {
    const double cpu_s = processCpuSeconds() - start_s;
    const bool bounded = std::isfinite(progress.lower);
    while (bounded && next < times.size() && cpu_s >= times[next])
    {
      print(variant, times[next++], progress);
    }
    return next < times.size() && progress.upper > progress.lower;
  });
}

}  // namespace

int main(int argc, char** argv)
{
  std::string path;
  std::vector<double> times{1.0, 10.0};
  CLI::App app("Solves a model with parts of the solver left out and prints the bounds.");
  app.add_option("model", path, "file in .pomdp or .pomdpx format")->required();
  app.add_option("--times", times, "CPU seconds after loading")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::sort(times.begin(), times.end());
    const Model model = loadModel(path);
    for (const Variant& variant : variants())
    {
      run(model, variant, times);
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
