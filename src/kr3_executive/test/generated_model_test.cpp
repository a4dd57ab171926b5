// A generated POMDP against the low-level description itself. The description is carried out by
// AbstractWorld, which interprets the laws and knows no zoom and no POMDP; both must show the same
// observations and states, as far as chance lets one tell.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/low_level_task.hpp"

namespace kr3::executive
{
namespace
{

using refinement::InitialKnowledge;
using refinement::LowLevelDomain;
using refinement::Models;
using refinement::PomdpTask;
using Counts = std::map<std::string, double>;

constexpr double kSignificance = 0.001;  // of a whole comparison, shared by its tests
constexpr double kLeastExpected = 8.0;   // rarer results are counted together

/// One start of the world, with its probability.
struct Start
{
  double probability = 1.0;
  FluentValues coarse;
  FluentValues fine;
};

/// A high-level action in a state, with what is known, told in two ways: to the generator as
/// knowledge, to the world as starts.
struct Case
{
  std::string name;
  const LowLevelDomain* domain = nullptr;
  const Models* models = nullptr;
  std::vector<std::string> state;
  std::string action;
  InitialKnowledge knowledge;
  std::vector<Start> starts;

  [[nodiscard]] PomdpTask task(const Models& numbers) const
  {
    std::vector<reasoner::Literal> literals;
    for (const std::string& literal : state)
      literals.push_back(reasoner::parseGroundLiteral(literal, domain->highLevel()));
    const auto zoom = refinement::zoom(*domain, literals,
                                       reasoner::parseGroundAction(action, domain->highLevel()));
    return refinement::generatePomdp(*domain, numbers, zoom, knowledge);
  }
};

/// What one step shows: the observation and the coarse state after it.
std::string shown(const std::string& observation, const std::string& state)
{
  return observation + " | " + state;
}

const std::string kLeft = "boundary";

/// The coarse state of a task's state, "loc(rob1)=office, ...".
std::string coarseState(const PomdpTask& task, const LowLevelDomain& domain, std::size_t state)
{
  if (task.kind(state) != PomdpTask::StateKind::kPhysical)
    return kLeft;
  std::map<std::string, std::string> values;
  for (std::size_t f = 0; f < task.fluents().size(); ++f)
  {
    const auto& fluent = task.fluents()[f];
    std::string& whole = values[coarseFluent(domain, fluent.name)];
    if (whole != "true")
      whole = domain.coarse(fluent.values[static_cast<std::size_t>(task.physicalState(state)[f])]);
  }
  std::string text;
  for (const auto& [fluent, value] : values)
    text += (text.empty() ? "" : ", ") + fluent + "=" + value;
  return text;
}

/// The world, seen as the task names things.
class WorldView
{
public:
  WorldView(const Case& c, const PomdpTask& task, std::uint64_t seed)
    : case_(c), task_(task), world_(*c.domain, *c.models, seed), random_(seed + 1)
  {
  }

  void reset()
  {
    double left = std::uniform_real_distribution<double>(0.0, 1.0)(random_);
    const Start* chosen = &case_.starts.back();
    for (const Start& start : case_.starts)
    {
      left -= start.probability;
      if (left < 0.0)
      {
        chosen = &start;
        break;
      }
    }
    world_.reset(chosen->coarse, chosen->fine);
    before_ = fine();
  }

  /// @return what is observed, by the model's name for it
  std::string execute(std::size_t action)
  {
    before_ = fine();
    const LowLevelAction executed{task_.actionText(action), task_.actionSymbol(action),
                                  task_.actionArguments(action)};
    const LowLevelResult result = world_.execute(executed, Disturbance{});
    std::string name;
    for (std::size_t i = 0; i < result.observation.size(); ++i)
    {
      const std::string& told = result.observation[i];
      const bool known =
          told == "true" || told == "false" || task_.zoom().constants.count(told) > 0;
      name += (i == 0 ? "" : ",") + (known ? told : refinement::kOutside);
    }
    return name.empty() ? refinement::kNoObservation : name;
  }

  /// The coarse state, or `boundary` when the last action took something out of the zoom.
  [[nodiscard]] std::string state() const
  {
    const FluentValues now = fine();
    std::map<std::string, std::string> values;
    for (const auto& [fluent, value] : now)
    {
      if (value == refinement::kElsewhere && before_.at(fluent) != value)
        return kLeft;
      std::string& whole = values[coarseFluent(*case_.domain, fluent)];
      if (whole != "true")
        whole = case_.domain->coarse(value);
    }
    std::string text;
    for (const auto& [fluent, value] : values)
      text += (text.empty() ? "" : ", ") + fluent + "=" + value;
    return text;
  }

private:
  /// The task's fluents; what is outside the zoom is elsewhere.
  [[nodiscard]] FluentValues fine() const
  {
    FluentValues result;
    for (const auto& fluent : task_.fluents())
    {
      const auto held = world_.fine().find(fluent.name);
      const std::string value = held == world_.fine().end() ? "false" : held->second;
      const bool inside =
          std::find(fluent.values.begin(), fluent.values.end(), value) != fluent.values.end();
      result[fluent.name] = inside ? value : refinement::kElsewhere;
    }
    return result;
  }

  const Case& case_;
  const PomdpTask& task_;
  AbstractWorld world_;
  std::mt19937_64 random_;
  FluentValues before_;
};

/// p-values of several tests together.
struct Comparison
{
  double least = 1.0;
  std::size_t tests = 0;
  std::string where;

  void add(double p, const std::string& what)
  {
    ++tests;
    if (p < least)
    {
      least = p;
      where = what;
    }
  }
  /// Bonferroni: any of the tests rejects at its share of the significance.
  [[nodiscard]] bool rejected() const { return least < kSignificance / static_cast<double>(tests); }
};

double chiSquaredTail(double statistic, std::size_t cells)
{
  if (cells < 2)
    return 1.0;
  const boost::math::chi_squared distribution(static_cast<double>(cells - 1));
  return boost::math::cdf(boost::math::complement(distribution, statistic));
}

/// Pearson's test of counts against probabilities. A result that has no probability rejects.
double fitP(const Counts& observed, const Counts& probabilities, double trials)
{
  double statistic = 0.0;
  double rest_expected = 0.0;
  double rest_observed = trials;
  std::size_t cells = 0;
  for (const auto& [result, count] : observed)
  {
    if (count > 0.0 && probabilities.count(result) == 0)
      return 0.0;
  }
  for (const auto& [result, probability] : probabilities)
  {
    const double expected = probability * trials;
    if (expected < kLeastExpected)
    {
      rest_expected += expected;
      continue;
    }
    const auto found = observed.find(result);
    const double count = found == observed.end() ? 0.0 : found->second;
    statistic += (count - expected) * (count - expected) / expected;
    rest_observed -= count;
    ++cells;
  }
  if (rest_expected >= kLeastExpected)
  {
    statistic += (rest_observed - rest_expected) * (rest_observed - rest_expected) / rest_expected;
    ++cells;
  }
  return chiSquaredTail(statistic, cells);
}

/// Pearson's test of homogeneity of two samples of the same size.
double sameP(const Counts& a, const Counts& b)
{
  Counts total = a;
  for (const auto& [result, count] : b)
    total[result] += count;
  double statistic = 0.0;
  std::size_t cells = 0;
  double rest_a = 0.0;
  double rest_b = 0.0;
  const auto add = [&](double in_a, double in_b) {
    const double expected = (in_a + in_b) / 2.0;
    statistic +=
        ((in_a - expected) * (in_a - expected) + (in_b - expected) * (in_b - expected)) / expected;
    ++cells;
  };
  for (const auto& [result, count] : total)
  {
    const auto in_a = a.find(result);
    const auto in_b = b.find(result);
    const double count_a = in_a == a.end() ? 0.0 : in_a->second;
    const double count_b = in_b == b.end() ? 0.0 : in_b->second;
    if (count < 2.0 * kLeastExpected)
    {
      rest_a += count_a;
      rest_b += count_b;
    }
    else
      add(count_a, count_b);
  }
  if (rest_a + rest_b >= 2.0 * kLeastExpected)
    add(rest_a, rest_b);
  return chiSquaredTail(statistic, cells);
}

/// Distribution of (observation, coarse state) at each step of a sequence, exactly: T and O of the
/// model, without conditioning. Mass that has left the zoom stays `boundary`.
std::vector<Counts> predicted(const PomdpTask& task, const LowLevelDomain& domain,
                              const std::vector<std::size_t>& actions)
{
  const pomdp::Model& model = task.model();
  std::vector<double> mass(model.numStates(), 0.0);
  for (std::size_t s = 0; s < mass.size(); ++s)
    mass[s] = model.initialBelief()[s];
  std::vector<Counts> steps;
  double gone = 0.0;
  for (const std::size_t action : actions)
  {
    std::vector<double> next(mass.size(), 0.0);
    for (std::size_t s = 0; s < mass.size(); ++s)
    {
      for (const auto& entry : model.transitions(action, s))
        next[entry.index] += mass[s] * entry.probability;
    }
    Counts& step = steps.emplace_back();
    if (gone > 0.0)
      step[kLeft] = gone;
    for (std::size_t s = 0; s < mass.size(); ++s)
    {
      for (const auto& entry : model.observations(action, s))
      {
        if (next[s] > 0.0)
          step[shown(model.observationName(entry.index), coarseState(task, domain, s))] +=
              next[s] * entry.probability;
      }
    }
    gone += next[task.boundaryState()];
    next[task.boundaryState()] = 0.0;
    mass = std::move(next);
  }
  return steps;
}

/// The same, counted in the world.
std::vector<Counts> counted(const Case& c, const PomdpTask& task,
                            const std::vector<std::size_t>& actions, int trials, std::uint64_t seed)
{
  std::vector<Counts> steps(actions.size());
  WorldView world(c, task, seed);
  for (int trial = 0; trial < trials; ++trial)
  {
    world.reset();
    bool left = false;
    for (std::size_t step = 0; step < actions.size(); ++step)
    {
      if (left)
      {
        steps[step][kLeft] += 1.0;
        continue;
      }
      const std::string observation = world.execute(actions[step]);
      const std::string state = world.state();
      left = state == kLeft;
      steps[step][shown(observation, state)] += 1.0;
    }
  }
  return steps;
}

/// A random sequence: each action is one that can be carried out with some probability, except now
/// and then.
std::vector<std::size_t> randomActions(const PomdpTask& task, std::size_t length,
                                       std::mt19937_64& random)
{
  const pomdp::Model& model = task.model();
  std::size_t state = pomdp::sampleState(model.initialBelief(), random);
  std::vector<std::size_t> actions;
  while (actions.size() < length)
  {
    const std::size_t action =
        std::uniform_int_distribution<std::size_t>(0, task.finishAction() - 1)(random);
    const bool any = std::uniform_int_distribution<int>(0, 9)(random) == 0;
    if (any || task.isExecutable(action, state) || state == task.boundaryState())
    {
      actions.push_back(action);
      state = pomdp::sampleStep(model, state, action, random).next_state;
    }
  }
  return actions;
}

/// What the world shows under some sequences of actions.
struct Sample
{
  std::vector<std::vector<std::size_t>> sequences;
  std::vector<std::vector<Counts>> counts;  // [sequence][step]
  int trials = 0;
};

Sample sampled(const Case& c, int sequences, int trials, std::uint64_t seed)
{
  const PomdpTask task = c.task(*c.models);
  std::mt19937_64 random(seed);
  Sample sample;
  sample.trials = trials;
  for (int sequence = 0; sequence < sequences; ++sequence)
  {
    sample.sequences.push_back(randomActions(task, 4, random));
    sample.counts.push_back(counted(c, task, sample.sequences.back(), trials, random()));
  }
  return sample;
}

/// Open-loop sequences: the world's counts against a model's probabilities.
Comparison compareSequences(const Case& c, const Models& numbers, const Sample& sample)
{
  const PomdpTask task = c.task(numbers);
  Comparison comparison;
  for (std::size_t i = 0; i < sample.sequences.size(); ++i)
  {
    const std::vector<std::size_t>& actions = sample.sequences[i];
    const std::vector<Counts> model = predicted(task, *c.domain, actions);
    for (std::size_t step = 0; step < actions.size(); ++step)
    {
      comparison.add(fitP(sample.counts[i][step], model[step], sample.trials),
                     task.actionText(actions[step]) + " at step " + std::to_string(step));
    }
  }
  return comparison;
}

/// What a policy meets, step by step, and the end of it.
struct Run
{
  std::vector<std::string> steps;
  std::string story;  // all observations
};

/// Lets a policy act on its belief. @param act  executes an action: the observation, then the state
Run policyRun(const PomdpTask& task, const pomdp::Policy& policy, std::size_t length,
              const std::function<std::pair<std::string, std::string>(std::size_t)>& act)
{
  const pomdp::Model& model = task.model();
  pomdp::Belief belief = model.initialBelief();
  Run run;
  while (run.steps.size() < length)
  {
    const std::size_t action = policy.actionAt(belief);
    if (action == task.finishAction())
      break;
    const auto [observation, state] = act(action);
    run.steps.push_back(task.actionText(action) + ": " + shown(observation, state));
    run.story += observation + ";";
    if (state == kLeft)
      break;
    const auto index = model.findObservation(observation);
    if (!index)
    {
      run.steps.back() = "an observation that the model does not have: " + observation;
      break;
    }
    try
    {
      belief = pomdp::updated(model, belief, action, *index).posterior;
    }
    catch (const FailedPrecondition&)
    {
      run.steps.back() = "an observation that the belief excludes: " + observation;
      break;
    }
  }
  run.steps.resize(length, "ended");
  return run;
}

/// A policy acting in the model and in the world: two samples.
Comparison comparePolicy(const Case& c, const Models& numbers, int trials, std::uint64_t seed)
{
  constexpr std::size_t kLength = 8;
  const PomdpTask task = c.task(numbers);
  const pomdp::Model& model = task.model();
  pomdp::SolverLimits limits;
  limits.time_s = 0.0;
  limits.max_backups = 300;
  const pomdp::Policy policy = pomdp::solve(model, limits).policy;
  std::vector<Counts> in_model(kLength + 1);
  std::vector<Counts> in_world(kLength + 1);
  const auto add = [&](const Run& run, std::vector<Counts>& counts) {
    for (std::size_t step = 0; step < kLength; ++step)
      counts[step][run.steps[step]] += 1.0;
    counts[kLength][run.story] += 1.0;
  };
  std::mt19937_64 random(seed);
  WorldView world(c, task, random());
  for (int trial = 0; trial < trials; ++trial)
  {
    std::size_t state = pomdp::sampleState(model.initialBelief(), random);
    add(policyRun(
            task, policy, kLength,
            [&](std::size_t action) {
      const pomdp::SampledStep step = pomdp::sampleStep(model, state, action, random);
      state = step.next_state;
      return std::make_pair(model.observationName(step.observation),
                            coarseState(task, *c.domain, state));
            }),
        in_model);
    world.reset();
    add(policyRun(
            task, policy, kLength,
            [&](std::size_t action) {
      std::string observation = world.execute(action);
      return std::make_pair(std::move(observation), world.state());
            }),
        in_world);
  }
  Comparison comparison;
  for (std::size_t step = 0; step <= kLength; ++step)
    comparison.add(sameP(in_model[step], in_world[step]), "step " + std::to_string(step));
  return comparison;
}

std::string textOf(const std::string& path)
{
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Loaded
{
  LowLevelDomain domain;
  Models models;
};

Loaded composed(const std::string& high, const std::string& fine, const std::string& models,
                const refinement::ComponentMap& map)
{
  const auto description = reasoner::parseDescription(high, "domain.kr3");
  LowLevelDomain domain(description, reasoner::parseRefinement(fine, "refinement.kr3", description),
                        map);
  Models numbers = refinement::parseModels(models, "models.yaml", domain.description());
  return {std::move(domain), std::move(numbers)};
}

/// A domain of the repository with only some of its constants, so that the world is quick.
Loaded shipped(const std::string& name, const std::set<std::string>& keep,
               const refinement::ComponentMap& map)
{
  const std::string directory = std::string(KR3_DOMAINS_DIR) + "/" + name;
  const auto whole = reasoner::readDescription(directory + "/domain.kr3");
  return composed(reasoner::toString(reasoner::restricted(whole, keep)),
                  textOf(directory + "/refinement.kr3"), textOf(directory + "/models.yaml"), map);
}

/// Three rooms of three cells in one row: a slip can end in the next room, outside a zoom.
refinement::ComponentMap corridorMap()
{
  refinement::ComponentMapData data;
  for (const std::string room : {"office", "main_library", "kitchen"})
  {
    for (int cell = 0; cell < 3; ++cell)
      data.components.push_back({room + "_c" + std::to_string(cell), room});
  }
  const std::size_t size = data.components.size();
  for (std::size_t i = 0; i < size; ++i)
  {
    std::vector<std::size_t>& beside = data.neighbors.emplace_back();
    if (i > 0)
      beside.push_back(i - 1);
    if (i + 1 < size)
      beside.push_back(i + 1);
    for (std::size_t j = 0; j < size; ++j)
      data.distances_m.push_back(std::abs(static_cast<double>(i) - static_cast<double>(j)));
  }
  return refinement::ComponentMap(std::move(data));
}

const Loaded& office()
{
  static const Loaded loaded =
      shipped("office", {"rob1", "tb1", "office", "main_library", "kitchen"}, corridorMap());
  return loaded;
}

Case grasping()
{
  const FluentValues robot{{"loc(rob1)", "main_library_c1"}};
  const auto with = [](const std::string& place) {
    return FluentValues{{"loc(rob1)", "main_library"}, {"loc(tb1)", place}};
  };
  return {"grasp",
          &office().domain,
          &office().models,
          {"loc(rob1) = main_library", "loc(tb1) = main_library"},
          "grasp(rob1, tb1)",
          {{{"loc(rob1)", {{"main_library_c1", 1.0}}}}, {{"loc(tb1)", {{"main_library", 0.7}}}}},
          {{0.7, with("main_library"), robot},
           {0.2, with("kitchen"), robot},
           {0.1, with("office"), robot}}};
}

Case carrying()
{
  const FluentValues at{
      {"loc(rob1)", "office"}, {"loc(tb1)", "office"}, {"in_hand(rob1, tb1)", "true"}};
  return {"carry",
          &office().domain,
          &office().models,
          {"loc(rob1) = office", "loc(tb1) = office", "in_hand(rob1, tb1)"},
          "move(rob1, main_library)",
          {{{"loc(rob1)", {{"office_c1", 1.0}}}}, {}},
          {{1.0, at, {{"loc(rob1)", "office_c1"}, {"loc(tb1)", "office_c1"}}}}};
}

const Loaded& workbench()
{
  static const Loaded loaded =
      shipped("workbench", {"psu", "amplifier", "tuner", "display", "tech1", "hum"},
              refinement::readComponentMap(std::string(KR3_DOMAINS_DIR) + "/workbench/map.yaml"));
  return loaded;
}

Case repairing()
{
  const FluentValues covers{{"opened(mains_switch)", "true"},
                            {"opened(transformer)", "false"},
                            {"opened(rectifier)", "true"}};
  InitialKnowledge knowledge{{}, {{"cause(hum)", {{"psu", 0.6}}}}};
  for (const auto& [fluent, value] : covers)
    knowledge.fine[fluent] = {{value, 1.0}};
  return {"repair",
          &workbench().domain,
          &workbench().models,
          {"opened(psu)", "cause(hum) = psu"},
          "replace(tech1, psu, hum)",
          std::move(knowledge),
          {{0.6, {{"cause(hum)", "psu"}}, covers},
           {0.3, {{"cause(hum)", "amplifier"}}, covers},
           {0.1, {{"cause(hum)", "display"}}, covers}}};
}

/// Sensors for values that err, a constraint between fluents, laws under conditions.
const Loaded& racks()
{
  static const Loaded loaded = composed(R"(
sorts
  rack = {near, far}.
  thing = {box, crate}.
fluents
  inertial on(thing) : rack.
  inertial tagged(thing).
  inertial sealed(thing).
actions
  push(thing, rack).
  tag(thing).
axioms
  push(X, K) causes on(X) = K.
  tag(X) causes tagged(X) if -sealed(X).
  tag(X) causes sealed(X) if tagged(X).
  -tagged(X) if sealed(X).
  impossible tag(X) if on(X) = K, sealed(X).
  impossible push(X, K) if sealed(X).
)",
                                        R"(
magnify rack into shelf by of_rack.
statics
  beside(shelf, shelf).
actions
  gauge(thing).
axioms
  push(X, S) causes on(X) = S [placed] or on(X) = {Z : beside(Z, S)} [slid].
  impossible gauge(X) if sealed(X).
observations
  gauge(X) observes on(X).
  gauge(X) observes tagged(X).
  tag(X) observes tagged(X).
)",
                                        R"(
actions:
  push(X, S):
    outcomes: {probabilities: {placed: 0.7, slid: 0.3}, source: hand-written}
    cost: {base_s: 1.0, impossible_s: 2.0}
  tag(X):
    observations: {tagged: {true_positive: 0.9, false_positive: 0.2, source: hand-written}}
    cost: {base_s: 1.0, impossible_s: 2.0}
  gauge(X):
    observations:
      on: {true_positive: 0.8, source: hand-written}
      tagged: {true_positive: 0.85, false_positive: 0.1, source: hand-written}
    cost: {base_s: 1.0, impossible_s: 2.0}
)",
                                        refinement::gridMap({"near", "far"}, 3, 1.0));
  return loaded;
}

Case tagging()
{
  return {"tag",
          &racks().domain,
          &racks().models,
          {"on(box) = near", "on(crate) = far"},
          "tag(box)",
          {{}, {{"on(box)", {{"near", 0.75}}}}},
          {{0.75, {{"on(box)", "near"}, {"on(crate)", "far"}}, {}},
           {0.25, {{"on(box)", "far"}, {"on(crate)", "far"}}, {}}}};
}

/// With the false-positive or outcome probabilities changed by a little.
Models perturbed(Models models, const std::string& action, const std::string& outcome,
                 const std::string& other, double probability)
{
  auto& probabilities = models.actions.at(action).outcomes.probabilities;
  probabilities.at(outcome) = probability;
  probabilities.at(other) = 1.0 - probability;
  return models;
}

Models withFalsePositive(Models models, const std::string& action, const std::string& fluent,
                         double probability)
{
  models.actions.at(action).observations.at(fluent).false_positive = probability;
  return models;
}

// Counted work: the world's samples are taken once and held against several models.
constexpr int kSequences = 3;
constexpr int kPolicyTrials = 600;

struct SampledCase
{
  Case c;
  Sample sample;
};

const std::vector<SampledCase>& cases()
{
  static const std::vector<SampledCase> all = [] {
    std::vector<SampledCase> result;
    result.push_back({grasping(), sampled(grasping(), kSequences, 4500, 11)});
    result.push_back({carrying(), sampled(carrying(), kSequences, 1000, 11)});
    result.push_back({repairing(), sampled(repairing(), kSequences, 1500, 11)});
    result.push_back({tagging(), sampled(tagging(), kSequences, 2500, 11)});
    return result;
  }();
  return all;
}

const SampledCase& caseOf(const std::string& name)
{
  return *std::find_if(cases().begin(), cases().end(),
                       [&](const SampledCase& sampled) { return sampled.c.name == name; });
}

std::string summaryOf(const Comparison& comparison)
{
  char p[32];
  std::snprintf(p, sizeof(p), "%.3g", comparison.least);
  return std::string("p = ") + p + ", the least of " + std::to_string(comparison.tests) + ", at " +
         comparison.where;
}

TEST(GeneratedModel, ShowsWhatTheDescriptionShowsUnderRandomActions)
{
  for (const auto& [c, sample] : cases())
  {
    const Comparison comparison = compareSequences(c, *c.models, sample);
    EXPECT_FALSE(comparison.rejected()) << c.name << ": " << summaryOf(comparison);
  }
}

TEST(GeneratedModel, ShowsWhatTheDescriptionShowsToAPolicy)
{
  for (const auto& [c, sample] : cases())
  {
    const Comparison comparison = comparePolicy(c, *c.models, kPolicyTrials, 12);
    EXPECT_FALSE(comparison.rejected()) << c.name << ": " << summaryOf(comparison);
  }
}

// The same tests of the same samples must notice a model that is a little wrong.
TEST(GeneratedModel, IsRejectedWhenItsNumbersAreALittleWrong)
{
  const auto expectRejected =
      [](const std::string& name, const Models& models, const std::string& what) {
    const SampledCase& sampled = caseOf(name);
    const Comparison comparison = compareSequences(sampled.c, models, sampled.sample);
    EXPECT_TRUE(comparison.rejected()) << what << ": " << summaryOf(comparison);
  };
  const Models& own = office().models;
  expectRejected("grasp", perturbed(own, "move", "slipped", "reached", 0.10), "slip 0.05 as 0.10");
  expectRejected("carry", perturbed(own, "move", "slipped", "reached", 0.10), "slip 0.05 as 0.10");
  expectRejected("grasp", withFalsePositive(own, "search", "loc", 0.08),
                 "false positives 0.05 as 0.08");
  expectRejected("repair", perturbed(workbench().models, "unscrew", "stuck", "loose", 0.27),
                 "stuck screws 0.20 as 0.27");
  expectRejected("tag", perturbed(racks().models, "push", "slid", "placed", 0.40),
                 "sliding 0.30 as 0.40");
}

TEST(GeneratedModel, IsRejectedByAPolicysRunsWhenItsNumbersAreWrong)
{
  EXPECT_TRUE(comparePolicy(grasping(), withFalsePositive(office().models, "search", "loc", 0.15),
                            kPolicyTrials, 12)
                  .rejected());
}

// A model whose start is a little wrong: the share of `elsewhere`.
TEST(GeneratedModel, IsRejectedWhenItsStartIsALittleWrong)
{
  SampledCase grasp = caseOf("grasp");
  grasp.c.knowledge.coarse["loc(tb1)"] = {{"main_library", 0.78}};
  EXPECT_TRUE(compareSequences(grasp.c, *grasp.c.models, grasp.sample).rejected());
}

// What leaves the zoom ends in the boundary, as often as it does in the world.
TEST(GeneratedModel, LeavesTheZoomAsOftenAsTheWorldDoes)
{
  const Case c = grasping();
  const PomdpTask task = c.task(*c.models);
  const std::size_t edge = task.model().findAction("move(rob1,main_library_c2)").value();
  const std::vector<Counts> model = predicted(task, *c.domain, {edge});
  EXPECT_NEAR(model[0].at("outside | boundary"), 0.025, 1e-9);  // half of the slips at the edge
  const std::vector<Counts> world = counted(c, task, {edge}, 4000, 13);
  EXPECT_GT(fitP(world[0], model[0], 4000), kSignificance);
  EXPECT_GT(world[0].at("outside | boundary"), 0.0);
}

// The tests themselves: known quantiles, and a result that cannot be.
TEST(ChiSquared, HasItsKnownTails)
{
  EXPECT_NEAR(chiSquaredTail(3.841459, 2), 0.05, 1e-6);
  EXPECT_NEAR(chiSquaredTail(18.307038, 11), 0.05, 1e-6);
  EXPECT_EQ(fitP({{"never", 1.0}, {"always", 99.0}}, {{"always", 1.0}}, 100.0), 0.0);
  EXPECT_NEAR(fitP({{"a", 60.0}, {"b", 40.0}}, {{"a", 0.5}, {"b", 0.5}}, 100.0), 0.0455, 1e-4);
  EXPECT_NEAR(sameP({{"a", 60.0}, {"b", 40.0}}, {{"a", 60.0}, {"b", 40.0}}), 1.0, 1e-12);
}

}  // namespace
}  // namespace kr3::executive
