/// refinement_bench DOMAIN_DIR STATE ACTION HIDDEN: time of zoom, generation and solution for
/// growing numbers of components per whole, and how often the policy ends well. Medians of five
/// runs.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>

#include "command_line.hpp"
#include "kr3_refinement/pomdp_task.hpp"

namespace
{

using namespace kr3;

constexpr int kRuns = 5;
constexpr int kTrials = 2000;

double milliseconds(std::chrono::steady_clock::time_point since)
{
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since)
      .count();
}

double median(std::array<double, kRuns> values)
{
  std::sort(values.begin(), values.end());
  return values[kRuns / 2];
}

struct Ends
{
  int success = 0;
  int given_up_rightly = 0;
  int wrong = 0;
  int unfinished = 0;
  double actions = 0.0;
};

/// Executes a policy and asks how the state stood when it finished.
Ends simulate(const refinement::PomdpTask& task, const pomdp::Policy& policy, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  Ends ends;
  for (int trial = 0; trial < kTrials; ++trial)
  {
    pomdp::Belief belief = task.model().initialBelief();
    std::size_t state = pomdp::sampleState(belief, random);
    bool finished = false;
    for (int step = 0; step < 500 && !finished; ++step)
    {
      const std::size_t action = policy.actionAt(belief);
      ends.actions += 1.0 / kTrials;
      if (action == task.finishAction())
      {
        finished = true;
        ends.success += task.isSuccess(state) ? 1 : 0;
        ends.given_up_rightly += task.isHopeless(state) ? 1 : 0;
        ends.wrong += !task.isSuccess(state) && !task.isHopeless(state) ? 1 : 0;
        break;
      }
      const pomdp::SampledStep sampled = pomdp::sampleStep(task.model(), state, action, random);
      belief = pomdp::updated(task.model(), belief, action, sampled.observation).posterior;
      state = sampled.next_state;
    }
    ends.unfinished += finished ? 0 : 1;
  }
  return ends;
}

void run(const refinement::tools::Options& options)
{
  std::printf("%6s %7s %8s %9s %9s %8s %8s %8s %8s %8s %8s\n", "parts", "states", "load ms",
              "zoom ms", "gen. ms", "lower", "upper", "good %", "gave up%", "wrong %", "actions");
  for (const std::size_t parts : {4U, 9U, 16U, 25U})
  {
    refinement::tools::Options own = options;
    own.per_whole = parts;
    std::array<double, kRuns> load{};
    std::array<double, kRuns> zoom_time{};
    std::array<double, kRuns> generate{};
    std::vector<refinement::PomdpTask> tasks;
    for (std::size_t run = 0; run < kRuns; ++run)
    {
      auto start = std::chrono::steady_clock::now();
      const refinement::tools::Loaded loaded = refinement::tools::load(own);
      load[run] = milliseconds(start);
      start = std::chrono::steady_clock::now();
      const refinement::Zoom zoom = refinement::zoom(loaded.domain, loaded.state, loaded.action);
      zoom_time[run] = milliseconds(start);
      start = std::chrono::steady_clock::now();
      tasks.push_back(refinement::generatePomdp(loaded.domain, loaded.models, zoom,
                                                refinement::tools::knowledgeOf(own, zoom)));
      generate[run] = milliseconds(start);
    }
    pomdp::SolverLimits limits;
    limits.time_s = options.solve_s > 0.0 ? options.solve_s : 0.2;
    const pomdp::SolveResult result = pomdp::solve(tasks.back().model(), limits);
    const Ends ends = simulate(tasks.back(), result.policy, 1);
    const double percent = 100.0 / kTrials;
    std::printf("%6zu %7zu %8.2f %9.2f %9.2f %8.2f %8.2f %8.1f %8.1f %8.1f %8.1f\n", parts,
                tasks.back().model().numStates(), median(load), median(zoom_time), median(generate),
                result.lower, result.upper, ends.success * percent, ends.given_up_rightly * percent,
                (ends.wrong + ends.unfinished) * percent, ends.actions);
  }
}

}  // namespace

int main(int argc, char** argv)
{
  try
  {
    run(refinement::tools::parse(
        argc, argv, "Times zoom, generation and solution for growing numbers of components."));
    return EXIT_SUCCESS;
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "refinement_bench: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
