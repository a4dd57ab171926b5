/// kr3_zoom: what matters to a high-level action, and the POMDP that it becomes. Needs no ROS.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/pomdp_format.hpp>
#include <kr3_pomdp/pomdpx_format.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>

#include "command_line.hpp"
#include "kr3_refinement/factored_task.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/sensitivity.hpp"
#include "kr3_refinement/task_report.hpp"
#include "kr3_refinement/zoom.hpp"

namespace
{

using namespace kr3;

struct ZoomOptions : refinement::tools::Options
{
  bool flat = false;
  std::string goal;
  std::string pomdp;
  std::string pomdpx;
  bool numbered = false;
  std::size_t max_states = refinement::GeneratorLimits{}.max_states;
  std::size_t max_names = 5;
  std::string sensitivity;
};

class CpuStopwatch
{
public:
  [[nodiscard]] double lap_ms()
  {
    const std::clock_t now = std::clock();
    const double elapsed = 1e3 * static_cast<double>(now - last_) / CLOCKS_PER_SEC;
    last_ = now;
    return elapsed;
  }

private:
  std::clock_t last_ = std::clock();
};

std::string fixed(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", value);
  return text;
}

refinement::Zoom zoomOf(const ZoomOptions& options, const refinement::tools::Loaded& loaded)
{
  if (!options.flat)
  {
    return refinement::zoom(loaded.domain, loaded.state, loaded.action);
  }
  return refinement::wholeDomain(
      loaded.domain, loaded.state,
      options.goal.empty()
          ? refinement::zoom(loaded.domain, loaded.state, loaded.action).effects
          : refinement::tools::literalsOf(options.goal, loaded.domain.highLevel()));
}

void printZoom(const refinement::LowLevelDomain& domain, const refinement::Zoom& zoom)
{
  std::cout << "Relevant to " << zoom.action << ":\n";
  for (const refinement::RelevantConstant& relevant : zoom.relevant)
  {
    std::cout << "  " << relevant.name << ": " << relevant.reason << "\n";
  }
  std::cout << "\nEffects to bring about:\n";
  for (const reasoner::Literal& effect : zoom.effects)
  {
    std::cout << "  " << reasoner::toString(effect) << "\n";
  }
  std::cout << "\nZoomed low-level description:\n\n"
            << reasoner::toString(refinement::zoomedDescription(domain, zoom)) << "\n";
}

/// Where the numbers of the zoom's actions come from; actions with the same ones together.
void printSources(const refinement::PomdpTask& task, const refinement::Models& models)
{
  struct Same
  {
    std::string actions;
    std::size_t count = 0;
    std::vector<std::string> lines;
  };
  std::vector<Same> all;
  for (std::size_t action = 0; action < task.finishAction(); ++action)
  {
    std::vector<std::string> lines =
        refinement::sources(models, task.actionSymbol(action), task.actionArguments(action));
    const auto known = std::find_if(all.begin(), all.end(), [&](const Same& same) {
      return same.lines == lines && same.actions.rfind(task.actionSymbol(action) + "(", 0) == 0;
    });
    if (known == all.end())
    {
      all.push_back({task.actionText(action), 1, std::move(lines)});
    }
    else
    {
      ++known->count;
    }
  }
  std::cout << "Numbers:\n";
  for (const Same& same : all)
  {
    std::cout << "  " << same.actions
              << (same.count > 1 ? " and " + std::to_string(same.count - 1) + " more" : "") << "\n";
    for (const std::string& line : same.lines)
    {
      std::cout << "    " << line << "\n";
    }
  }
  std::cout << "\n";
}

/// "move (4), search (4), grasp, finish"
std::string actionCounts(const refinement::PomdpTask& task)
{
  std::vector<std::string> order;
  std::map<std::string, std::size_t> counts;
  for (std::size_t action = 0; action < task.model().numActions(); ++action)
  {
    if (++counts[task.actionSymbol(action)] == 1)
    {
      order.push_back(task.actionSymbol(action));
    }
  }
  std::string text;
  for (const std::string& symbol : order)
  {
    text += (text.empty() ? "" : ", ") + symbol;
    text += counts[symbol] > 1 ? " (" + std::to_string(counts[symbol]) + ")" : "";
  }
  return text;
}

void printModel(const refinement::PomdpTask& task, const refinement::FactoredTask& factors,
                std::size_t max_names)
{
  const pomdp::Model& model = task.model();
  std::cout << "POMDP: " << model.numStates() << " states (" << task.boundaryState()
            << " physical, boundary, done), " << model.numActions() << " actions, "
            << model.numObservations() << " observations, discount " << model.discount() << "\n"
            << "  actions: " << actionCounts(task) << "\n"
            << "  variables:\n";
  for (const pomdp::StateVariable& variable : factors.model.state)
  {
    std::cout << "    " << variable.name << ", " << variable.values.size() << " values, "
              << (variable.observed ? "always known" : "hidden") << "\n";
  }
  std::cout << "  start: " << task.summary(model.initialBelief()) << "\n\nChecks:\n"
            << refinement::validate(task).text(max_names);
}

template <typename Write>
void writeFile(const std::string& path, const Write& write)
{
  if (path.empty())
  {
    return;
  }
  std::ofstream out(path);
  write(out);
  out.close();
  if (!out)
  {
    throw Unavailable("cannot write '" + path + "'");
  }
  std::cout << "Wrote " << path << "\n";
}

void solve(const refinement::PomdpTask& task, double seconds)
{
  pomdp::SolverLimits limits;
  limits.time_s = seconds;
  const pomdp::SolveResult result = pomdp::solve(task.model(), limits);
  const pomdp::Evaluation evaluation = pomdp::evaluate(task.model(), result.policy, {}, 1);
  std::cout << "Solved: bounds " << fixed(result.lower) << ", " << fixed(result.upper) << " after "
            << fixed(result.elapsed_s) << " s (" << pomdp::toString(result.reason)
            << "); simulated " << fixed(evaluation.mean) << " +- "
            << fixed(evaluation.half_width_95) << "\n"
            << "First action: "
            << task.actionText(result.policy.actionAt(task.model().initialBelief())) << "\n";
}

void run(const ZoomOptions& options)
{
  CpuStopwatch stopwatch;
  const refinement::tools::Loaded loaded = refinement::tools::load(options);
  const double load_ms = stopwatch.lap_ms();
  const refinement::Zoom zoom = zoomOf(options, loaded);
  const double zoom_ms = stopwatch.lap_ms();
  printZoom(loaded.domain, zoom);
  (void)stopwatch.lap_ms();
  const refinement::PomdpTask task = refinement::generatePomdp(
      loaded.domain, loaded.models, zoom, refinement::tools::knowledgeOf(options, zoom),
      {options.max_states});
  const double generate_ms = stopwatch.lap_ms();
  const refinement::FactoredTask factors = refinement::factored(task);
  const double factor_ms = stopwatch.lap_ms();

  printModel(task, factors, options.max_names);
  std::cout << "\n";
  printSources(task, loaded.models);
  std::cout << "CPU: load " << fixed(load_ms) << " ms, zoom " << fixed(zoom_ms) << " ms, generate "
            << fixed(generate_ms) << " ms, factor " << fixed(factor_ms) << " ms\n";
  writeFile(options.pomdp, [&](std::ostream& out) {
    if (options.numbered)
    {
      pomdp::writePomdpNumbered(out, task.model());
    }
    else
    {
      pomdp::writePomdp(out, task.model());
    }
  });
  writeFile(options.pomdpx, [&](std::ostream& out) { pomdp::writePomdpx(out, factors.model); });
  if (options.solve_s > 0.0)
  {
    solve(task, options.solve_s);
  }
  if (!options.sensitivity.empty())
  {
    refinement::SensitivityOptions how;
    how.limits.time_s = options.solve_s;
    std::cout << "\n" << refinement::sensitivity(task, options.sensitivity, how).text(task);
  }
}

void addOptions(CLI::App& app, ZoomOptions& options)
{
  refinement::tools::addDomainOptions(app, options);
  refinement::tools::addTaskOptions(app, options);
  app.add_flag("--flat", options.flat,
               "zoom nothing away: the whole domain, for the effects of --action or for --goal");
  app.add_option("--goal", options.goal, "with --flat: high-level literals joined by commas");
  app.add_option("--pomdp", options.pomdp,
                 "write the flat POMDP to this file (Cassandra's format)");
  app.add_flag("--numbered", options.numbered,
               "in it, numbers for names, which comments say: other tools read no 'f(a)=b'");
  app.add_option("--pomdpx", options.pomdpx,
                 "write the POMDP in factors to this file, with what is always known as observed");
  app.add_option("--solve", options.solve_s, "solve it for so many seconds and simulate the policy")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--sensitivity", options.sensitivity,
                 "a hidden low-level fluent: solve again with its hypothesis more and less likely, "
                 "and with each of its values certain, for --solve seconds each");
  app.add_option("--max-states", options.max_states, "most physical states");
  app.add_option("--names", options.max_names, "most names of unreachable states and the like");
  app.footer(
      "Example:\n  kr3_zoom DOMAIN_DIR --state \"f(a)=b, f(c)=b\" --action \"act(a, c)\" "
      "--hidden \"f(c)=0.8\" --solve 0.1");
}

/// @throws InvalidArgument  options that do not fit together
void check(const ZoomOptions& options)
{
  if (!options.goal.empty() && !options.flat)
  {
    throw InvalidArgument("--goal is for --flat; without it the goal is the effects of --action");
  }
  if (options.action.empty() && options.goal.empty())
  {
    throw InvalidArgument(options.flat ? "--flat needs --action or --goal" : "--action is missing");
  }
  if (!options.action.empty() && !options.goal.empty())
  {
    throw InvalidArgument("--action and --goal exclude each other");
  }
  if (!(options.solve_s >= 0.0))
  {
    throw InvalidArgument("--solve " + std::to_string(options.solve_s) + ": expected seconds");
  }
  if (!options.sensitivity.empty() && !(options.solve_s > 0.0))
  {
    throw InvalidArgument("--sensitivity needs --solve SECONDS, for each belief");
  }
  if (options.numbered && options.pomdp.empty())
  {
    throw InvalidArgument("--numbered is for --pomdp FILE");
  }
}

}  // namespace

int main(int argc, char** argv)
{
  ZoomOptions options;
  CLI::App app{"Shows what matters to a high-level action, and the POMDP that it becomes."};
  app.option_defaults()->always_capture_default();
  addOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  try
  {
    check(options);
    run(options);
    return EXIT_SUCCESS;
  }
  catch (const std::exception& error)
  {
    std::cout.flush();
    std::cerr << "kr3_zoom: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
