/// kr3_mission: whole missions in the abstract simulator, free ones and scripted ones. Needs no
/// ROS.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>
#include <kr3_refinement/low_level_domain.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/comparison.hpp"
#include "kr3_executive/script_runner.hpp"
#include "tool_options.hpp"

namespace
{

using namespace kr3::executive;

/// Prints what happens, one line an event.
class Printer : public MissionObserver
{
public:
  explicit Printer(bool quiet) : quiet_(quiet) {}
  [[nodiscard]] Interest interest() const override { return {!quiet_, false, false}; }
  void onEvent(const ReportedEvent& event) override
  {
    if (!quiet_)
      std::cout << std::setw(9) << toString(event.kind) << "  " << event.narration.text << "\n";
  }
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}

private:
  bool quiet_;
};

struct Options
{
  std::string domain;
  std::string goal;
  std::uint64_t seed = 1;
  std::uint64_t trials = 1;
  std::size_t threads = 1;
  std::string target_at;
  std::vector<std::string> truths;
  std::vector<std::string> scripts;
  AbstractMissionConfig mission;
  std::string method = toString(Method::kPa);
  std::string flat_planning = toString(FlatPlanning::kBest);
  bool quiet = false;
  bool caches = false;
};

void addOptions(CLI::App& app, Options& options)
{
  app.option_defaults()->always_capture_default();
  auto* domain = app.add_option("DOMAIN_DIR", options.domain,
                                "directory with domain.kr3, refinement.kr3, models.yaml, "
                                "bindings.yaml; a script's own by default");
  auto* script = app.add_option("--script", options.scripts,
                                "mission script, or a directory of them; prints PASS or FAIL");
  app.add_option("--goal", options.goal, "formula; default: that of scenario.yaml");
  app.add_option("--seed", options.seed, "of the first trial; the others count on");
  app.add_option("--trials", options.trials)->check(CLI::PositiveNumber);
  app.add_option("--threads", options.threads,
                 "of a table's trials, which come out the same for any number")
      ->check(CLI::PositiveNumber);
  app.add_option(
      "--target-at", options.target_at,
      "true value of the fluent that the goal is about; random: drawn anew for each trial");
  app.add_option("--true", options.truths,
                 "literal that is true in the world, such as \"loc(tb1) = kitchen\"");
  app.add_option("--cells-per-place", options.mission.components_per_whole,
                 "components of each magnified element where the domain has no map.yaml");
  app.add_option("--max-hl-actions", options.mission.driver.limits.max_hl_actions,
                 "after which a mission ends");
  app.add_option("--max-backups", options.mission.driver.budget.max_backups,
                 "of the solver, 0 = no limit");
  app.add_option("--solve-time", options.mission.driver.budget.time_s,
                 "s of the solver, 0 = no limit");
  app.add_option("--default-probability", options.mission.driver.default_probability);
  app.add_option("--bindings", options.mission.bindings, "file in DOMAIN_DIR");
  app.add_option("--models", options.mission.models,
                 "what the robot plans with and believes by; file in DOMAIN_DIR");
  app.add_option("--world-models", options.mission.world_models,
                 "what is so in the world, as --models; default: the robot's");
  app.add_option("--method", options.method,
                 "pa, pa_star, pomdp1, pomdp2, hierarchical; several with commas, or all: a table");
  app.add_option("--bias", options.mission.baseline.default_probability,
                 "POMDP-2: probability of what the defaults say");
  app.add_option("--flat-planning", options.flat_planning,
                 "POMDP-1 and POMDP-2: best, ahead or online");
  app.add_option("--online-prospects", options.mission.baseline.online_prospects,
                 "counted work of online planning for each action");
  app.add_option("--flat-backups", options.mission.baseline.budget.max_backups,
                 "of the solver for the whole domain");
  app.add_flag("--require-learned", options.mission.require_learned,
               "refuse numbers of models.yaml that were not learned from trials");
  app.add_flag("--quiet", options.quiet, "print the summary only");
  app.add_flag("--caches", options.caches, "print what the caches answered");
  for (const char* name : {"--goal", "--seed", "--trials", "--threads", "--target-at", "--true",
                           "--cells-per-place", "--max-hl-actions", "--max-backups", "--solve-time",
                           "--default-probability", "--bindings", "--models", "--world-models"})
    script->excludes(app.get_option(name));  // a script says all of it
  app.callback([domain, script] {
    if (domain->count() == 0 && script->count() == 0)
      throw CLI::RequiredError("DOMAIN_DIR or --script");
  });
}

std::vector<Method> methodsOf(const std::string& text)
{
  if (text == "all")
    return allMethods();
  std::vector<Method> methods;
  for (const auto& name : CLI::detail::split(text, ','))
    methods.push_back(methodNamed(name));
  return methods;
}

/// The missions of one trial after the other, dealt out to the threads.
std::vector<TrialResult> runTrials(const Options& options, AbstractMissions& missions,
                                   const std::string& goal)
{
  std::vector<TrialResult> results(options.trials);
  std::vector<std::unique_ptr<AbstractMissions>> others;
  for (std::size_t i = 1; i < options.threads; ++i)
    others.push_back(missions.another());
  std::atomic<std::uint64_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](AbstractMissions& own) {
    Printer printer(true);
    try
    {
      for (std::uint64_t trial = next++; trial < options.trials; trial = next++)
      {
        const std::uint64_t seed = options.seed + trial;
        std::vector<std::string> truths = options.truths;
        if (options.target_at == "random")
        {
          const std::vector<std::string> drawn = drawnTruths(own, goal, seed);
          truths.insert(truths.end(), drawn.begin(), drawn.end());
        }
        else if (!options.target_at.empty())
          truths.push_back(own.targetFluent(goal) + " = " + options.target_at);
        results[trial] = own.run(goal, truths, seed, printer);
      }
    }
    catch (...)
    {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = std::current_exception();
      next = options.trials;
    }
  };
  std::vector<std::thread> threads;
  for (const auto& other : others)
    threads.emplace_back(work, std::ref(*other));
  work(missions);
  for (auto& thread : threads)
    thread.join();
  if (failure)
    std::rethrow_exception(failure);
  return results;
}

void printCaches(const AbstractMissions& missions)
{
  const PolicyCacheStats policies = missions.policyStats();
  std::map<std::string, ContentCacheStats> all = missions.cacheStats();
  all["policies"] = {policies.hits + policies.disk_hits, policies.misses, policies.evictions,
                     policies.policies, policies.bytes};
  std::cout << std::left << std::setw(16) << "cache" << std::right << std::setw(10) << "asked"
            << std::setw(10) << "hit rate" << std::setw(10) << "entries" << std::setw(10) << "MB"
            << "\n";
  for (const auto& [name, stats] : all)
  {
    std::cout << std::left << std::setw(16) << name << std::right << std::setw(10)
              << stats.hits + stats.misses << std::setw(10) << std::fixed << std::setprecision(4)
              << stats.hitRate() << std::setw(10) << stats.entries << std::setw(10)
              << std::setprecision(1) << 1e-6 * static_cast<double>(stats.bytes) << "\n";
  }
}

/// The same trials by several methods, and a table.
int compare(const Options& options, const std::vector<Method>& methods)
{
  std::vector<MethodTrials> all;
  for (const Method method : methods)
  {
    AbstractMissionConfig config = options.mission;
    config.method = method;
    config.baseline.planning = flatPlanningNamed(options.flat_planning);
    AbstractMissions missions(options.domain, config);
    const std::string goal = options.goal.empty() ? missions.scenario().goal : options.goal;
    MethodTrials trials{method, {}, 0.0};
    const auto start = std::chrono::steady_clock::now();
    trials.results = runTrials(options, missions, goal);
    trials.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    all.push_back(std::move(trials));
    if (options.caches)
      printCaches(missions);
  }
  printComparison(std::cout, all);
  return EXIT_SUCCESS;
}

int run(const Options& options)
{
  const std::vector<Method> methods = methodsOf(options.method);
  if (methods.size() > 1 || options.target_at == "random")
    return compare(options, methods);
  AbstractMissionConfig config = options.mission;
  config.method = methods.front();
  config.baseline.planning = flatPlanningNamed(options.flat_planning);
  AbstractMissions missions(options.domain, config);
  const std::string goal = options.goal.empty() ? missions.scenario().goal : options.goal;
  if (goal.empty())
    throw kr3::InvalidArgument("no goal: give --goal, the domain's scenario has none");
  std::vector<std::string> truths = options.truths;
  if (!options.target_at.empty())
    truths.push_back(missions.targetFluent(goal) + " = " + options.target_at);
  Printer printer(options.quiet);
  std::uint64_t achieved = 0;
  std::uint64_t declared = 0;
  double hl_actions = 0.0;
  double ll_actions = 0.0;
  double duration_s = 0.0;
  RefutationCount refutations;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t trial = 0; trial < options.trials; ++trial)
  {
    const TrialResult result = missions.run(goal, truths, options.seed + trial, printer);
    declared += result.mission.achieved ? 1 : 0;
    achieved += result.mission.achieved && result.goal_is_true ? 1 : 0;
    hl_actions += result.mission.hl_actions;
    ll_actions += result.mission.ll_actions;
    duration_s += result.mission.duration_s;
    refutations.all += result.refutations.all;
    refutations.wrong += result.refutations.wrong;
    refutations.doubtful += result.refutations.doubtful;
    refutations.doubtful_wrong += result.refutations.doubtful_wrong;
    if (!options.quiet && !(result.mission.achieved && result.goal_is_true))
      std::cout << "trial with seed " << options.seed + trial << ": "
                << (result.mission.achieved ? "declared, but the goal is not true"
                                            : result.mission.reason)
                << "\n";
  }
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto n = static_cast<double>(options.trials);
  std::cout << std::fixed << std::setprecision(2) << "achieved " << achieved << " of "
            << options.trials << ", declared " << declared << ", high-level actions "
            << hl_actions / n << ", low-level actions " << ll_actions / n << ", simulated "
            << duration_s / n << " s, wall " << wall_s / n << " s a mission\n"
            << "refutations " << refutations.all << ", " << refutations.wrong
            << " of them wrong; not believed above the threshold " << refutations.doubtful << ", "
            << refutations.doubtful_wrong << " of them wrong\n";
  return achieved == options.trials ? EXIT_SUCCESS : EXIT_FAILURE;
}

/// The files that are meant: a directory stands for its *.yaml files, in the order of their names.
std::vector<std::string> scriptFiles(const std::vector<std::string>& given)
{
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (const auto& name : given)
  {
    if (!fs::is_directory(name))
    {
      files.push_back(name);
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(name))
    {
      if (entry.path().extension() == ".yaml")
        found.push_back(entry.path().string());
    }
    if (found.empty())
      throw kr3::InvalidArgument("no *.yaml in '" + name + "'");
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

int runScripts(const Options& options)
{
  namespace fs = std::filesystem;
  AbstractMissionConfig config = ScriptRunner::defaultConfig();
  config.require_learned = options.mission.require_learned;
  ScriptRunner runner(options.domain, config);
  Printer printer(options.quiet);
  std::size_t passed = 0;
  const std::vector<std::string> files = scriptFiles(options.scripts);
  for (const auto& file : files)
  {
    const ScriptReport report = runner.run(file, printer);
    passed += report.passed() ? 1 : 0;
    std::cout << (report.passed() ? "PASS  " : "FAIL  ") << fs::path(file).filename().string()
              << ": " << report.script.name << "\n";
    for (const auto& difference : report.differences)
      std::cout << "      " << difference << "\n";
  }
  if (files.size() > 1)
    std::cout << passed << " of " << files.size() << " scripts passed\n";
  return passed == files.size() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Runs missions of a domain in the abstract simulator."};
  Options options;
  addOptions(app, options);
  return runTool(app, "kr3_mission", argc, argv,
                 [&] { return options.scripts.empty() ? run(options) : runScripts(options); });
}
