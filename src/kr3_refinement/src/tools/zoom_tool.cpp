/// kr3_zoom: what matters to a high-level action, and the POMDP that it becomes. Needs no ROS.

#include <chrono>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/pomdp_format.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>

#include "command_line.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/zoom.hpp"

namespace
{

using namespace kr3;

class Stopwatch
{
public:
  [[nodiscard]] double lap_ms()
  {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> elapsed = now - last_;
    last_ = now;
    return elapsed.count();
  }

private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void printZoom(const refinement::LowLevelDomain& domain, const refinement::Zoom& zoom)
{
  std::cout << "Relevant to " << zoom.action << ":\n";
  for (const refinement::RelevantConstant& relevant : zoom.relevant)
  {
    std::cout << "  " << relevant.name << ": " << relevant.reason << "\n";
  }
  std::cout << "Effects:\n";
  for (const reasoner::Literal& effect : zoom.effects)
  {
    std::cout << "  " << reasoner::toString(effect) << "\n";
  }
  std::cout << "\nZoomed description:\n"
            << reasoner::toString(refinement::zoomedDescription(domain, zoom)) << "\n";
}

void solve(const refinement::PomdpTask& task, double seconds)
{
  pomdp::SolverLimits limits;
  limits.time_s = seconds;
  const pomdp::SolveResult result = pomdp::solve(task.model(), limits);
  const pomdp::Evaluation evaluation = pomdp::evaluate(task.model(), result.policy, {}, 1);
  std::cout << "Solved: bounds " << result.lower << ", " << result.upper << " after "
            << result.elapsed_s << " s (" << pomdp::toString(result.reason) << "); simulated "
            << evaluation.mean << " +- " << evaluation.half_width_95 << "\n";
}

void run(const refinement::tools::Options& options)
{
  Stopwatch stopwatch;
  const refinement::tools::Loaded loaded = refinement::tools::load(options);
  const double load_ms = stopwatch.lap_ms();
  const refinement::Zoom zoom = refinement::zoom(loaded.domain, loaded.state, loaded.action);
  const double zoom_ms = stopwatch.lap_ms();
  const refinement::PomdpTask task = refinement::generatePomdp(
      loaded.domain, loaded.models, zoom, refinement::tools::knowledgeOf(options, zoom));
  const double generate_ms = stopwatch.lap_ms();

  printZoom(loaded.domain, zoom);
  const pomdp::Model& model = task.model();
  std::cout << "POMDP: " << model.numStates() << " states, " << model.numActions() << " actions, "
            << model.numObservations() << " observations\n"
            << "Start: " << task.summary(model.initialBelief()) << "\n"
            << "Time: load " << load_ms << " ms, zoom " << zoom_ms << " ms, generate "
            << generate_ms << " ms\n";
  if (!options.pomdp.empty())
  {
    std::ofstream out(options.pomdp);
    pomdp::writePomdp(out, model);
    out.close();
    if (!out)
    {
      throw Unavailable("cannot write '" + options.pomdp + "'");
    }
  }
  if (options.solve_s > 0.0)
  {
    solve(task, options.solve_s);
  }
}

}  // namespace

int main(int argc, char** argv)
{
  try
  {
    run(refinement::tools::parse(
        argc, argv, "Shows what matters to a high-level action, and the POMDP that it becomes."));
    return EXIT_SUCCESS;
  }
  catch (const std::exception& error)
  {
    std::cerr << "kr3_zoom: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
