#include "kr3_executive/work_rates.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <ostream>
#include <utility>

#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/solver.hpp>

#include "baseline_cache.hpp"
#include "kr3_executive/initial_belief.hpp"
#include "search_policy.hpp"

namespace kr3::executive
{
namespace
{

double cpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void check(const std::vector<double>& cpu_s)
{
  if (cpu_s.empty() || !(cpu_s.front() > 0.0) || !std::is_sorted(cpu_s.begin(), cpu_s.end()))
    throw InvalidArgument("CPU seconds, expected some that are positive and ascending");
}

/// What POMDP-1 plans for at the start of the scenario.
struct Start
{
  reasoner::Formula goal;
  DomainBelief belief;
};

Start startOf(const AbstractMissions& missions, const AbstractMissionConfig& config)
{
  const auto& scenario = missions.scenario();
  if (scenario.goal.empty())
    throw InvalidArgument("the domain's scenario has no goal");
  const auto& domain = missions.domain();
  auto task = std::make_shared<refinement::DomainTask>(
      domain, missions.models(), constantsFor(domain, scenario.goal, scenario.initial_records));
  InProcessReasoner reasoner(descriptionFor(Method::kPomdp1, domain.highLevel()), config.plan);
  reasoner.setHistory(scenario.initial_records);
  auto states =
      task->initialBelief(knowledgeOf(reasoner, *task, scenario.initial_records, {}, std::nullopt),
                          config.baseline.max_states);
  return {reasoner::parseGoal(scenario.goal, domain.highLevel()),
          DomainBelief(std::move(task), std::move(states))};
}

/// Solves for as long as the last of the seconds.
void measureAhead(const Start& start, TestPlan& tests, const WorkRateOptions& options,
                  WorkRates& rates)
{
  const double begin_s = cpuSeconds();
  const auto& task = start.belief.task();
  const FlatModel flat =
      flatModel(start.belief.task(), start.belief.states(), start.goal,
                objectiveFor(task.domain(), task.models()), options.mission.baseline.max_rows);
  rates.num_states = flat.model.numStates();
  const auto first = searchPolicy(
      flat, tests, start.belief, options.mission.driver.limits.threshold,
      {options.mission.baseline.online_candidates, options.mission.baseline.online_prospects});
  pomdp::SolverLimits limits;
  limits.precision = options.mission.baseline.budget.precision;
  const auto note = [&](const pomdp::SolverProgress& progress) {
    const double used_s = cpuSeconds() - begin_s;
    while (rates.backups.size() < options.cpu_s.size() &&
           used_s >= options.cpu_s[rates.backups.size()])
      rates.backups.push_back(progress.backups);
    return rates.backups.size() < options.cpu_s.size();
  };
  const auto result = pomdp::solve(flat.model, limits, note, first ? &*first : nullptr);
  const double used_s = cpuSeconds() - begin_s;
  while (rates.backups.size() < options.cpu_s.size())
  {
    rates.backups.push_back(static_cast<std::uint64_t>(
        static_cast<double>(result.backups) * options.cpu_s[rates.backups.size()] / used_s));
  }
}

/// Mean low-level actions of missions that are planned online.
double meanDecisions(const std::string& directory, const WorkRateOptions& options)
{
  class Silent : public MissionObserver
  {
  public:
    void onEvent(const ReportedEvent& /*event*/) override {}
    void onBelief(const ReportedBelief& /*belief*/) override {}
    void onSnapshot(const Snapshot& /*snapshot*/) override {}
  };
  AbstractMissionConfig config = options.mission;
  config.method = Method::kPomdp1;
  config.baseline.planning = FlatPlanning::kOnline;
  AbstractMissions missions(directory, config);
  double decisions = 0.0;
  for (std::uint64_t i = 0; i < options.missions; ++i)
  {
    Silent silent;
    const auto result = missions.run(missions.scenario().goal, {}, options.first_seed + i, silent);
    decisions += result.mission.ll_actions;
  }
  return std::max(1.0, decisions / static_cast<double>(options.missions));
}

void measureOnline(const Start& start, TestPlan& tests, WorkRates& rates)
{
  const Hypotheses now = hypothesesOf(start.belief.states());
  std::vector<std::uint32_t> hidden;
  for (const auto state : now.states)
    hidden.push_back(tests.parts(state).hidden);
  const std::size_t place = tests.parts(now.likeliestState()).place;
  const ProspectOf prospect = [&](std::size_t from, std::size_t hypothesis) {
    return tests.prospect({static_cast<std::uint32_t>(from), hidden[hypothesis]});
  };
  SearchOrderOptions unlimited;
  unlimited.max_prospects = std::numeric_limits<std::uint64_t>::max();
  // The first time all ways are found, which later decisions need not.
  static_cast<void>(orderOfTests(now.probability, place, prospect, unlimited));
  const double begin_s = cpuSeconds();
  std::uint64_t asked = 0;
  constexpr double kLongEnough_s = 0.5;
  do
  {
    const auto found = orderOfTests(now.probability, place, prospect, unlimited);
    rates.most_used = found ? found->prospects : 0;
    asked += std::max<std::uint64_t>(rates.most_used, 1);
  } while (cpuSeconds() - begin_s < kLongEnough_s);
  rates.prospects_per_s = static_cast<double>(asked) / (cpuSeconds() - begin_s);
}

}  // namespace

WorkRates workRates(const std::string& directory, const WorkRateOptions& options)
{
  check(options.cpu_s);
  const AbstractMissions missions(directory, options.mission);
  const Start start = startOf(missions, options.mission);
  BaselineCache cache;
  const auto tests = testPlanFor(start.belief, start.goal, cache);
  WorkRates rates;
  measureOnline(start, *tests, rates);
  rates.decisions = meanDecisions(directory, options);
  for (const double seconds : options.cpu_s)
  {
    rates.prospects.push_back(
        static_cast<std::uint64_t>(seconds * rates.prospects_per_s / rates.decisions));
  }
  try
  {
    measureAhead(start, *tests, options, rates);
  }
  catch (const ResourceExhausted&)  // no flat model of this size
  {
    rates.backups.clear();
  }
  return rates;
}

void print(std::ostream& out, const WorkRates& rates)
{
  const nlohmann::json line = {{"states", rates.num_states},
                               {"backups", rates.backups},
                               {"prospects_per_s", std::round(rates.prospects_per_s)},
                               {"decisions", rates.decisions},
                               {"prospects", rates.prospects},
                               {"most_used", rates.most_used}};
  out << line.dump() << "\n";
}

}  // namespace kr3::executive
