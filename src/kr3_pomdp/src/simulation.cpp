#include "kr3_pomdp/simulation.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <string>
#include <thread>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/policy_format.hpp"
#include "policy_walk.hpp"

namespace kr3::pomdp
{

namespace
{

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

std::size_t sampleRow(const SparseRow& row, std::mt19937_64& random)
{
  double u = uniform(random);
  const SparseEntry* last = row.begin();
  for (const SparseEntry& entry : row)
  {
    last = &entry;
    u -= entry.probability;
    if (u < 0.0)
    {
      break;
    }
  }
  return last->index;
}

std::size_t sampleStart(const std::vector<InitialOutcome>& starts, std::mt19937_64& random)
{
  std::size_t i = 0;
  for (double u = starts.size() > 1 ? uniform(random) : 0.0; i + 1 < starts.size(); ++i)
  {
    u -= starts[i].probability;
    if (u < 0.0)
    {
      break;
    }
  }
  return i;
}

constexpr std::uint64_t kTrialsPerBlock = 64;
constexpr std::size_t kMaxWalkBytes = std::size_t{256} << 20;

/// Mean and squared deviations of returns (Welford), and what else is counted.
struct Returns
{
  double trials = 0.0;
  double mean = 0.0;
  double squares = 0.0;
  double steps = 0.0;
  double finished = 0.0;

  void add(const Returns& other)
  {
    const double sum = trials + other.trials;
    const double difference = other.mean - mean;
    mean += difference * (other.trials / sum);
    squares += other.squares + difference * difference * (trials * other.trials / sum);
    trials = sum;
    steps += other.steps;
    finished += other.finished;
  }
};

/// Trials of a policy. Safe to use from several threads, each with a walk of its own.
class Simulation
{
public:
  Simulation(const Model& model, const EvaluationLimits& limits, std::uint64_t seed)
    : model_(model)
    , limits_(limits)
    , seed_(seed)
    , finished_(finishedStates(model))
    , starts_(model.initialOutcomes())
  {
  }

  [[nodiscard]] Returns block(std::uint64_t number, PolicyWalk& walk) const
  {
    std::seed_seq seeds{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32),
                        static_cast<std::uint32_t>(number),
                        static_cast<std::uint32_t>(number >> 32)};
    std::mt19937_64 random(seeds);
    const std::uint64_t first = number * kTrialsPerBlock;
    const std::uint64_t count = std::min(kTrialsPerBlock, limits_.trials - first);
    Returns returns;
    for (std::uint64_t trial = 0; trial < count; ++trial)
    {
      returns.add(this->trial(walk, random));
    }
    return returns;
  }

private:
  [[nodiscard]] Returns trial(PolicyWalk& walk, std::mt19937_64& random) const
  {
    const std::size_t start = sampleStart(starts_, random);
    std::size_t state = sampleState(starts_[start].belief, random);
    PolicyWalk::Place* place = walk.start(starts_[start].belief);
    Returns result;
    result.trials = 1.0;
    double weight = 1.0;
    std::uint64_t step = 0;
    while (step < limits_.max_steps && weight > limits_.truncation && !finished_[state])
    {
      const std::size_t action = place->action;
      result.mean += weight * model_.reward(action, state);
      state = sampleRow(model_.transitions(action, state), random);
      place = walk.after(place, sampleRow(model_.observations(action, state), random));
      weight *= model_.discount();
      ++step;
    }
    result.steps = static_cast<double>(step);
    result.finished = finished_[state] ? 1.0 : 0.0;
    return result;
  }

  const Model& model_;
  EvaluationLimits limits_;
  std::uint64_t seed_;
  std::vector<bool> finished_;
  std::vector<InitialOutcome> starts_;
};

}  // namespace

SampledStep sampleStep(const Model& model, std::size_t state, std::size_t action,
                       std::mt19937_64& random)
{
  if (state >= model.numStates() || action >= model.numActions())
  {
    throw InvalidArgument("state " + std::to_string(state) + " of " +
                          std::to_string(model.numStates()) + ", action " + std::to_string(action) +
                          " of " + std::to_string(model.numActions()));
  }
  const std::size_t next = sampleRow(model.transitions(action, state), random);
  return {next, sampleRow(model.observations(action, next), random)};
}

std::size_t sampleState(const Belief& belief, std::mt19937_64& random)
{
  double u = uniform(random);
  std::size_t last = 0;
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      last = s;
      u -= belief[s];
      if (u < 0.0)
      {
        break;
      }
    }
  }
  return last;
}

std::vector<bool> finishedStates(const Model& model)
{
  std::vector<bool> finished(model.numStates(), true);
  for (bool changed = true; changed;)
  {
    changed = false;
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      for (std::size_t s = 0; s < model.numStates(); ++s)
      {
        if (!finished[s])
        {
          continue;
        }
        const SparseRow row = model.transitions(a, s);
        finished[s] = model.reward(a, s) == 0.0 &&
                      std::all_of(row.begin(), row.end(),
                                  [&](const SparseEntry& next) { return finished[next.index]; });
        changed |= !finished[s];
      }
    }
  }
  return finished;
}

Evaluation evaluate(const Model& model, const Policy& policy, const EvaluationLimits& limits,
                    std::uint64_t seed)
{
  checkFits(policy, model);
  if (limits.trials == 0 || limits.num_threads < 1 || !(limits.truncation >= 0.0))
  {
    throw InvalidArgument(std::to_string(limits.trials) + " trials with " +
                          std::to_string(limits.num_threads) + " threads and truncation at " +
                          std::to_string(limits.truncation) +
                          ", expected at least 1 trial, 1 thread and a truncation from 0");
  }
  const std::uint64_t num_blocks = (limits.trials + kTrialsPerBlock - 1) / kTrialsPerBlock;
  std::vector<Returns> blocks(num_blocks);
  const Simulation simulation(model, limits, seed);
  const auto num_workers =
      std::min<std::uint64_t>(static_cast<std::uint64_t>(limits.num_threads), num_blocks);
  std::atomic<std::uint64_t> next{0};
  std::vector<std::exception_ptr> errors(num_workers);
  const auto work = [&](std::size_t worker) {
    try
    {
      PolicyWalk walk(model, policy, kMaxWalkBytes / num_workers);
      for (std::uint64_t block = next++; block < num_blocks; block = next++)
      {
        blocks[block] = simulation.block(block, walk);
      }
    }
    catch (...)
    {
      errors[worker] = std::current_exception();
      next = num_blocks;
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t worker = 1; worker < num_workers; ++worker)
  {
    threads.emplace_back(work, worker);
  }
  work(0);
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  for (const std::exception_ptr& error : errors)
  {
    if (error)
    {
      std::rethrow_exception(error);
    }
  }
  Returns all;
  for (const Returns& block : blocks)
  {
    all.add(block);
  }
  const double n = all.trials;
  const double error = n > 1.0 ? std::sqrt(all.squares / (n - 1.0) / n) : 0.0;
  return {all.mean, error, 1.96 * error, limits.trials, all.steps / n, all.finished / n};
}

}  // namespace kr3::pomdp
