#include "kr3_executive/method_values.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iomanip>
#include <memory>
#include <ostream>
#include <random>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

#include "baseline_cache.hpp"
#include "flat_controller.hpp"
#include "kr3_executive/initial_belief.hpp"

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr double kNearPart = 0.05;     // of the best known value
constexpr double kNearAbsolute = 1.0;  // where values are near 0
const char* const kReference = "reference";

/// Adds up what low-level actions cost, and notes them.
class Earnings : public MissionObserver
{
public:
  explicit Earnings(double discount) : discount_(discount) {}
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
  void onInput(const Input& input) override
  {
    const auto* skill = std::get_if<SkillEnded>(&input);
    if (skill == nullptr || skill->code != ErrorCode::kOk)
      return;
    add(-skill->result.duration_s);
    course += skill->action.text;
    for (const auto& value : skill->result.observation)
      course += " " + value;
    course += "; ";
  }
  void add(double reward)
  {
    undiscounted += reward;
    discounted += factor_ * reward;
    factor_ *= discount_;
  }

  double discounted = 0.0;
  double undiscounted = 0.0;
  std::string course;

private:
  double discount_;
  double factor_ = 1.0;
};

/// The flat model from the scenario's start.
class Reference
{
public:
  Reference(const AbstractMissions& missions, const std::string& goal, const ValueOptions& options)
    : missions_(missions)
    , objective_(objectiveFor(missions.domain(), missions.models()))
    , task_(std::make_shared<refinement::DomainTask>(
          missions.domain(), missions.models(),
          constantsFor(missions.domain(), goal, missions.scenario().initial_records)))
    , start_(startBelief(options))
    , formula_(reasoner::parseGoal(goal, missions.domain().highLevel()))
    , flat_(flatModel(*task_, start_, formula_, objective_, options.max_rows))
  {
  }

  [[nodiscard]] const FlatModel& flat() const { return flat_; }

  [[nodiscard]] SolvedPolicy solve(const ValueOptions& options, PolicyServer& policies)
  {
    BaselineCache cache;
    BaselineOptions baseline = options.mission.baseline;
    baseline.budget = options.reference;
    const DomainBelief start(task_, start_);
    const auto tests = testPlanFor(start, formula_, cache);
    const std::atomic<bool> never{false};
    return solvedFlat(flat_, *tests, start, options.mission.driver.limits.threshold, baseline,
                      policies, never);
  }
  [[nodiscard]] const Objective& objective() const { return objective_; }

  /// A state drawn from the start, as low-level literals.
  [[nodiscard]] std::vector<std::string> drawTruths(std::uint64_t seed) const
  {
    std::mt19937_64 random(drawnApart(seed));
    double left = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    StateId drawn = start_.rbegin()->first;
    for (const auto& [state, probability] : start_)
    {
      left -= probability;
      if (left < 0.0)
      {
        drawn = state;
        break;
      }
    }
    std::vector<std::string> truths;
    const auto& fluents = task_->space().fluents();
    for (std::size_t i = 0; i < fluents.size(); ++i)
    {
      const std::string& value = task_->space().value(drawn, i);
      const bool boolean = value == "true" || value == "false";
      truths.push_back(boolean ? (value == "true" ? "" : "-") + fluents[i].name
                               : fluents[i].name + " = " + value);
    }
    return truths;
  }

  /// Of ending where the world is.
  [[nodiscard]] double finishReward(const TrialResult& trial)
  {
    std::vector<std::string> values;
    for (const auto& fluent : task_->space().fluents())
    {
      const auto held = trial.fine.find(fluent.name);
      values.push_back(held == trial.fine.end() ? "false" : held->second);
    }
    const auto state = task_->space().find(values);
    const auto number = state ? flat_.number.find(*state) : flat_.number.end();
    if (number == flat_.number.end())
      throw InternalError("the world is in a state that the flat model cannot reach");
    const double reward = flat_.model.reward(flat_.finishAction(), number->second);
    const bool unsaid = !trial.mission.achieved && trial.goal_is_true;
    return unsaid ? objective_.wrong_finish : reward;
  }

private:
  [[nodiscard]] refinement::SparseBelief startBelief(const ValueOptions& options)
  {
    const auto& history = missions_.scenario().initial_records;
    const auto& domain = missions_.domain();
    InProcessReasoner reasoner(
        descriptionFor(options.default_probability ? Method::kPomdp2 : Method::kPomdp1,
                       domain.highLevel()),
        options.mission.plan);
    reasoner.setHistory(history);
    return task_->initialBelief(
        knowledgeOf(reasoner, *task_, history, {}, options.default_probability),
        options.mission.baseline.max_states);
  }

  const AbstractMissions& missions_;
  Objective objective_;
  std::shared_ptr<refinement::DomainTask> task_;
  refinement::SparseBelief start_;
  reasoner::Formula formula_;
  FlatModel flat_;
};

MethodValue valueOf(const std::string& directory, const std::string& name,
                    const AbstractMissionConfig& config, Reference& reference,
                    const ValueOptions& options)
{
  AbstractMissions missions(directory, config);
  MethodValue value{name, {}, {}, 0, 0, {}};
  for (std::uint64_t trial = 0; trial < options.trials; ++trial)
  {
    const std::uint64_t seed = options.first_seed + trial;
    Earnings earnings(reference.objective().discount);
    const TrialResult result =
        missions.run(missions.scenario().goal, reference.drawTruths(seed), seed, earnings);
    earnings.add(reference.finishReward(result));
    value.discounted.push_back(earnings.discounted);
    value.undiscounted.push_back(earnings.undiscounted);
    value.wrong += result.mission.achieved && !result.goal_is_true ? 1 : 0;
    value.silent += result.mission.achieved ? 0 : 1;
    value.courses.push_back(earnings.course + (!result.mission.achieved ? "given up"
                                               : result.goal_is_true    ? "declared"
                                                                        : "declared falsely"));
  }
  return value;
}

std::string shown(double value)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << value;
  return text.str();
}

std::string shown(const Estimate& estimate)
{
  return shown(estimate.value) + " +- " + shown(estimate.high - estimate.value);
}

}  // namespace

ValueTable methodValues(const std::string& directory, const std::vector<Method>& methods,
                        const ValueOptions& options)
{
  AbstractMissionConfig config = options.mission;
  if (!config.policies)
    config.policies = std::make_shared<PolicyCache>();
  config.baseline.default_probability =
      options.default_probability.value_or(config.baseline.default_probability);
  const AbstractMissions missions(directory, config);
  if (missions.scenario().goal.empty())
    throw InvalidArgument("the domain's scenario has no goal");
  Reference reference(missions, missions.scenario().goal, options);
  InProcessPolicyServer solver(config.policies);
  const SolvedPolicy solved = reference.solve(options, solver);

  ValueTable table;
  table.num_states = reference.flat().model.numStates();
  table.num_actions = reference.flat().model.numActions();
  table.discount = reference.objective().discount;
  table.lower = solved.lower;
  table.upper = solved.upper;
  table.backups = solved.backups;
  table.cpu_s = solved.cpu_s;
  AbstractMissionConfig ahead = config;
  ahead.method = options.default_probability ? Method::kPomdp2 : Method::kPomdp1;
  ahead.baseline.planning = FlatPlanning::kAhead;
  ahead.baseline.budget = options.reference;
  ahead.baseline.max_rows = options.max_rows;
  table.methods.push_back(valueOf(directory, kReference, ahead, reference, options));
  for (const Method method : methods)
  {
    config.method = method;
    table.methods.push_back(valueOf(directory, toString(method), config, reference, options));
  }
  return table;
}

Estimate pairedDifference(const std::vector<double>& a, const std::vector<double>& b)
{
  if (a.size() != b.size())
  {
    throw InvalidArgument(std::to_string(a.size()) + " and " + std::to_string(b.size()) +
                          " trials, expected as many of each");
  }
  std::vector<double> difference;
  std::transform(a.begin(), a.end(), b.begin(), std::back_inserter(difference), std::minus<>());
  return meanOf(difference);
}

const MethodValue& bestOf(const ValueTable& table)
{
  if (table.methods.empty())
    throw InvalidArgument("a table without methods");
  return *std::max_element(table.methods.begin(), table.methods.end(),
                           [](const MethodValue& a, const MethodValue& b) {
    return meanOf(a.discounted).value < meanOf(b.discounted).value;
  });
}

bool isNearBest(const ValueTable& table, const MethodValue& method)
{
  const double best = meanOf(bestOf(table).discounted).value;
  return best - meanOf(method.discounted).value <=
         std::max(kNearAbsolute, kNearPart * std::abs(best));
}

void print(std::ostream& out, const ValueTable& table)
{
  const MethodValue& best = bestOf(table);
  const double best_value = meanOf(best.discounted).value;
  out << "flat model: " << table.num_states << " states, " << table.num_actions
      << " actions, discount " << std::setprecision(6) << table.discount << "; optimum in ["
      << shown(table.lower) << ", " << shown(table.upper) << "] after " << table.backups
      << " backups, " << shown(table.cpu_s) << " s of CPU\n"
      << best.discounted.size() << " trials each, the same worlds and seeds; 95 % intervals; best "
      << "known: " << best.name << "\n"
      << std::left << std::setw(14) << "method" << std::setw(18) << "value" << std::setw(18)
      << "regret" << std::setw(9) << "%" << std::setw(13) << "within 5 %" << std::setw(18)
      << "undiscounted" << std::setw(8) << "false"
      << "not declared\n";
  for (const MethodValue& method : table.methods)
  {
    const Estimate regret = pairedDifference(best.discounted, method.discounted);
    out << std::left << std::setw(14) << method.name << std::setw(18)
        << shown(meanOf(method.discounted)) << std::setw(18) << shown(regret) << std::setw(9)
        << shown(100.0 * regret.value / std::abs(best_value)) << std::setw(13)
        << (isNearBest(table, method) ? "yes" : "no") << std::setw(18)
        << shown(meanOf(method.undiscounted)) << std::setw(8) << method.wrong << method.silent
        << "\n";
  }
}

void printDifferences(std::ostream& out, const ValueTable& table, std::size_t trials)
{
  const auto& first = table.methods.front().courses;
  for (std::size_t trial = 0; trial < first.size() && trials > 0; ++trial)
  {
    const bool differ = std::any_of(
        table.methods.begin(), table.methods.end(),
        [&](const MethodValue& method) { return method.courses[trial] != first[trial]; });
    if (!differ)
      continue;
    --trials;
    out << "trial " << trial << "\n";
    for (const MethodValue& method : table.methods)
      out << "  " << std::left << std::setw(14) << method.name << std::setw(9)
          << shown(method.discounted[trial]) << method.courses[trial] << "\n";
  }
}

}  // namespace kr3::executive
