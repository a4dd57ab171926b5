// Simulates a policy in a .pomdp or .pomdpx file and prints its value with a confidence interval.

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include <CLI/CLI.hpp>

#include "kr3_pomdp/finite_horizon.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/start_value.hpp"
#include "tool.hpp"

namespace
{

using namespace kr3::pomdp;

struct Options
{
  std::string model;
  std::string policy;
  std::string format = "auto";
  EvaluationLimits limits;
  std::uint64_t seed = 1;
};

Policy load(const Options& options, const Model& model)
{
  if (options.format == "auto")
  {
    return loadPolicy(options.policy, model);
  }
  return loadPolicy(options.policy, model,
                    options.format == "appl" ? PolicyFormat::kAppl : PolicyFormat::kKr3);
}

void print(const Evaluation& value)
{
  std::printf(
      "%.5f (95 %%: %.5f, %.5f), %llu trials of %.1f steps on average, %.1f %% of them finished\n",
      value.mean, value.mean - value.half_width_95, value.mean + value.half_width_95,
      static_cast<unsigned long long>(value.trials), value.mean_steps, 100.0 * value.finished);
}

void printOwn(const Model& model, const Policy& policy)
{
  std::printf("the policy's own value: %.5f\n", startValue(model, policy));
}

/// Whether the file has a policy for each step.
bool isHorizonPolicy(const std::string& path)
{
  std::ifstream in(path);
  std::string word;
  return in >> word && word == "kr3_horizon_policy";
}

/// Prints the value over the policy's horizon.
void runOverHorizon(const Options& options)
{
  const Model model = loadModel(options.model);
  std::ifstream in(options.policy);
  const HorizonPolicy policy = HorizonPolicy::read(in, options.policy);
  print(evaluate(model, policy, options.limits, options.seed));
  printOwn(model, policy.at(0));
}

void run(const Options& options)
{
  if (options.format == "auto" && isHorizonPolicy(options.policy))
  {
    runOverHorizon(options);
    return;
  }
  const Model model = loadModel(options.model);
  const Policy policy = load(options, model);
  print(evaluate(model, policy, options.limits, options.seed));
  printOwn(model, policy);
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app(
      "Simulates a policy and prints the mean discounted return. The same seed gives the same "
      "result with any number of threads.");
  app.add_option("model", options.model, "file in .pomdp or .pomdpx format")->required();
  app.add_option("policy", options.policy, "file written by kr3_solve --policy, or by APPL")
      ->required();
  app.add_option("--trials", options.limits.trials, "number of trials")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the random numbers")->capture_default_str();
  app.add_option("--threads", options.limits.num_threads, "threads that simulate")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--truncation", options.limits.truncation,
                 "a trial ends when its discount is below this")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--max-steps", options.limits.max_steps, "a trial ends after so many actions")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--format", options.format, "of the policy: auto, kr3 or appl")
      ->check(CLI::IsMember({"auto", "kr3", "appl"}))
      ->capture_default_str();
  return tool::runTool(app, argc, argv, [&] { run(options); });
}
