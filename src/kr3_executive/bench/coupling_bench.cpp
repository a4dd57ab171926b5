/// coupling_bench cache|missions DOMAIN_DIR ...: what a cached policy costs, and whole missions.
/// Prints one JSON object; `./kr3 bench coupling` runs it.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <kr3_common/error.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/abstract_mission.hpp"

namespace
{

using namespace kr3;
using namespace kr3::executive;
using nlohmann::json;

const std::atomic<bool> kGoOn{false};

double threadCpuMilliseconds()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Options
{
  std::string domain;
  std::size_t cells = 4;
  double pitch_m = 1.0;
  int runs = 5;
  std::vector<std::string> tasks;
  SolveBudget budget{0.5, 0.0, 2000};
  std::string goal;
  int trials = 200;
  int threads = 1;
  double obedience = 0.8;
  std::string method = toString(Method::kPa);
};

AbstractMissionConfig missionConfig(const Options& options)
{
  AbstractMissionConfig config;
  config.method = methodNamed(options.method);
  config.driver.budget = options.budget;
  config.components_per_whole = options.cells;
  config.pitch_m = options.pitch_m;
  return config;
}

std::vector<std::string> split(const std::string& text, char separator)
{
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);)
    parts.push_back(part);
  return parts;
}

/// @param text  "STATE LITERAL; ... | ACTION | FLUENT=VALUE known | FLUENT=P of its value"
refinement::PomdpTask taskOf(const refinement::LowLevelDomain& domain,
                             const refinement::Models& models, const std::string& text)
{
  const std::vector<std::string> parts = split(text, '|');
  if (parts.size() != 4)
    throw InvalidArgument("task '" + text + "', expected STATE|ACTION|KNOWN|HIDDEN");
  std::vector<reasoner::Literal> state;
  for (const std::string& literal : split(parts[0], ';'))
    state.push_back(reasoner::parseGroundLiteral(literal, domain.highLevel()));
  const refinement::Zoom zoom =
      refinement::zoom(domain, state, reasoner::parseGroundAction(parts[1], domain.highLevel()));
  refinement::InitialKnowledge knowledge;
  const auto sides = [](const std::string& equation) {
    const std::size_t equal = equation.rfind('=');
    return std::pair<std::string, std::string>{equation.substr(0, equal),
                                               equation.substr(equal + 1)};
  };
  const auto known = sides(parts[2]);
  knowledge.fine[known.first] = {{known.second, 1.0}};
  const auto hidden = sides(parts[3]);
  for (const reasoner::Literal& literal : zoom.start)
  {
    if (reasoner::toString(literal.atom) == hidden.first)
      knowledge.coarse[hidden.first] = {{literal.value.name, std::stod(hidden.second)}};
  }
  return refinement::generatePomdp(domain, models, zoom, knowledge);
}

/// CPU microseconds of some work, in `runs` runs of `repetitions`.
json microseconds(int runs, int repetitions, const std::function<void()>& work)
{
  json result = json::array();
  for (int run = 0; run < runs; ++run)
  {
    const double start_ms = threadCpuMilliseconds();
    for (int i = 0; i < repetitions; ++i)
      work();
    result.push_back(1e3 * (threadCpuMilliseconds() - start_ms) / repetitions);
  }
  return result;
}

/// The first task is solved; the others, the same under other names, have to hit.
json measureCache(const Options& options)
{
  const AbstractMissions missions(options.domain, missionConfig(options));
  const refinement::Models models =
      refinement::readModels((std::filesystem::path(options.domain) / "models.yaml").string(),
                             missions.domain().description());
  std::vector<refinement::PomdpTask> tasks;
  for (const std::string& text : options.tasks)
    tasks.push_back(taskOf(missions.domain(), models, text));
  if (tasks.size() < 2)
    throw InvalidArgument("expected two tasks or more");

  const pomdp::Model& model = tasks.front().model();
  json cost;
  cost["solved"] = microseconds(options.runs, 1, [&] {
    static_cast<void>(InProcessPolicyServer().solve(model, options.budget, kGoOn));
  });
  InProcessPolicyServer server;
  const SolvedPolicy solved = server.solve(model, options.budget, kGoOn);
  cost["hit, same names"] = microseconds(
      options.runs, 200, [&] { static_cast<void>(server.solve(model, options.budget, kGoOn)); });
  const pomdp::Model& renamed = tasks.back().model();
  if (!server.solve(renamed, options.budget, kGoOn).cached)
    throw InternalError("'" + options.tasks.back() + "' did not hit");
  cost["hit, other names"] = microseconds(
      options.runs, 200, [&] { static_cast<void>(server.solve(renamed, options.budget, kGoOn)); });
  cost["action at a belief"] = microseconds(options.runs, 2000, [&] {
    static_cast<void>(server.actionAt(solved.id, model.initialBelief()));
  });

  PolicyCacheOptions on_disk;
  on_disk.directory = (std::filesystem::temp_directory_path() /
                       ("kr3_coupling_bench_" + std::to_string(::getpid())))
                          .string();
  static_cast<void>(InProcessPolicyServer(std::make_shared<PolicyCache>(on_disk))
                        .solve(model, options.budget, kGoOn));
  cost["hit, read from disk"] = microseconds(options.runs, 5, [&] {
    static_cast<void>(InProcessPolicyServer(std::make_shared<PolicyCache>(on_disk))
                          .solve(model, options.budget, kGoOn));
  });
  std::filesystem::remove_all(on_disk.directory);
  return {{"states", model.numStates()}, {"backups", solved.backups}, {"cost_us", cost}};
}

class Silent : public MissionObserver
{
public:
  [[nodiscard]] Interest interest() const override { return {false, false, false}; }
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
};

/// Where the target is in a trial: as the defaults say with probability `obedience`, else anywhere.
std::vector<std::string> truthsOf(const AbstractMissions& missions, const std::string& fluent,
                                  double obedience, std::uint64_t trial)
{
  std::mt19937_64 random(trial);
  if (fluent.empty() || std::uniform_real_distribution<double>(0.0, 1.0)(random) < obedience)
    return {};
  const reasoner::Description& description = missions.domain().highLevel();
  const reasoner::FluentDeclaration* declared =
      description.findFluent(fluent.substr(0, fluent.find('(')));
  const auto& values = description.findSort(*declared->value_sort)->elements;
  const std::size_t any = std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random);
  return {fluent + " = " + values[any]};
}

struct Trials
{
  double cpu_ms = 0.0;
  double wall_s = 0.0;
  int achieved = 0;
  double ll_actions = 0.0;
};

/// The trials, dealt out to the threads; each has missions of its own and they share the policies.
Trials runTrials(const Options& options, std::vector<std::unique_ptr<AbstractMissions>>& missions)
{
  Trials all;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto start = std::chrono::steady_clock::now();
  const auto work = [&](std::size_t index) {
    try
    {
      AbstractMissions& own = *missions[index];
      const std::string goal = options.goal.empty() ? own.scenario().goal : options.goal;
      std::string fluent;
      try
      {
        fluent = own.targetFluent(goal);
      }
      catch (const InvalidArgument&)  // about truths only
      {
      }
      Silent silent;
      Trials sum;
      const double start_ms = threadCpuMilliseconds();
      for (std::size_t trial = index; trial < static_cast<std::size_t>(options.trials);
           trial += missions.size())
      {
        const TrialResult result =
            own.run(goal, truthsOf(own, fluent, options.obedience, trial), trial, silent);
        sum.achieved += result.mission.achieved && result.goal_is_true ? 1 : 0;
        sum.ll_actions += result.mission.ll_actions;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      all.cpu_ms += threadCpuMilliseconds() - start_ms;
      all.achieved += sum.achieved;
      all.ll_actions += sum.ll_actions;
    }
    catch (...)
    {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < missions.size(); ++i)
    threads.emplace_back(work, i);
  for (std::thread& thread : threads)
    thread.join();
  if (failure)
    std::rethrow_exception(failure);
  all.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return all;
}

json statsOf(const PolicyCacheStats& stats)
{
  return {{"hits", stats.hits},
          {"disk_hits", stats.disk_hits},
          {"misses", stats.misses},
          {"hit_rate", stats.hitRate()},
          {"policies", stats.policies},
          {"bytes", stats.bytes},
          {"solve_cpu_s", stats.solve_cpu_s}};
}

/// The same trials twice: from empty caches, and with what this left. The hit rates are those of
/// the first time.
json measureMissions(const Options& options)
{
  AbstractMissionConfig config = missionConfig(options);
  config.policies = std::make_shared<PolicyCache>();
  std::vector<std::unique_ptr<AbstractMissions>> missions;
  missions.push_back(std::make_unique<AbstractMissions>(options.domain, config));
  for (int i = 1; i < options.threads; ++i)
    missions.push_back(missions.front()->another());
  const Trials cold = runTrials(options, missions);
  const json stats = statsOf(config.policies->stats());
  json caches;
  for (const auto& [name, cache] : missions.front()->cacheStats())
  {
    caches[name] = {{"asked", cache.hits + cache.misses},
                    {"hit_rate", cache.hitRate()},
                    {"entries", cache.entries},
                    {"bytes", cache.bytes}};
  }
  const Trials warm = runTrials(options, missions);
  const double n = options.trials;
  return {
      {"trials", options.trials},
      {"threads", options.threads},
      {"achieved", warm.achieved},
      {"same_when_repeated", warm.achieved == cold.achieved && warm.ll_actions == cold.ll_actions},
      {"ll_actions", warm.ll_actions / n},
      {"cold_ms", cold.cpu_ms / n},
      {"warm_ms", warm.cpu_ms / n},
      {"trials_per_s", 1e3 * options.threads * n / warm.cpu_ms},
      {"cold_trials_per_s", 1e3 * options.threads * n / cold.cpu_ms},
      {"trials_per_wall_s", n / warm.wall_s},
      {"caches", caches},
      {"stats", stats}};
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app{"What a cached policy costs, and whole missions in process."};
  app.option_defaults()->always_capture_default();
  app.require_subcommand(1);
  CLI::App* cache = app.add_subcommand("cache", "one policy");
  CLI::App* missions = app.add_subcommand("missions", "trials in the abstract simulator");
  for (CLI::App* command : {cache, missions})
  {
    command->add_option("DOMAIN_DIR", options.domain)->required();
    command->add_option("--cells", options.cells, "of each place, in a grid");
    command->add_option("--pitch", options.pitch_m, "m between neighbours in the grid");
    command->add_option("--max-backups", options.budget.max_backups);
    command->add_option("--precision", options.budget.precision);
  }
  cache->add_option("--runs", options.runs)->check(CLI::PositiveNumber);
  cache->add_option("--task", options.tasks, "STATE; ...|ACTION|FLUENT=VALUE|FLUENT=P")->required();
  missions->add_option("--method", options.method, "pa, pa_star, ...");
  missions->add_option("--goal", options.goal, "default: the scenario's");
  missions->add_option("--trials", options.trials)->check(CLI::PositiveNumber);
  missions->add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  missions->add_option("--obedience", options.obedience,
                       "probability that the target is where the defaults say");
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::cout << (cache->parsed() ? measureCache(options) : measureMissions(options)).dump()
              << "\n";
    return EXIT_SUCCESS;
  }
  catch (const std::exception& error)
  {
    std::cerr << "coupling_bench: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
