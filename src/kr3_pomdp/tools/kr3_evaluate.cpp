// Simulates a policy in a .pomdp or .pomdpx file and prints its value with a confidence interval.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>

#include <CLI/CLI.hpp>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/simulation.hpp"

int main(int argc, char** argv)
{
  std::string model_path;
  std::string policy_path;
  kr3::pomdp::EvaluationLimits limits;
  std::uint64_t seed = 1;
  CLI::App app("Simulates a policy and prints the mean discounted return.");
  app.add_option("model", model_path, "file in .pomdp or .pomdpx format")->required();
  app.add_option("policy", policy_path, "file written by kr3_solve --policy")->required();
  app.add_option("--trials", limits.trials, "number of trials")->capture_default_str();
  app.add_option("--seed", seed, "seed of the random numbers")->capture_default_str();
  app.add_option("--truncation", limits.truncation, "a trial ends when its discount is below this")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try
  {
    using namespace kr3::pomdp;
    const Model model = loadModel(model_path);
    std::ifstream in(policy_path);
    if (!in)
    {
      throw kr3::Unavailable("cannot open '" + policy_path + "'");
    }
    const Policy policy = Policy::read(in, policy_path);
    const Evaluation value = evaluate(model, policy, limits, seed);
    std::printf("%.5f (95 %%: %.5f, %.5f), %llu trials of %.1f steps on average\n", value.mean,
                value.mean - value.half_width_95, value.mean + value.half_width_95,
                static_cast<unsigned long long>(value.trials), value.mean_steps);
    double lower = 0.0;
    for (const InitialOutcome& outcome : model.initialOutcomes())
    {
      lower += outcome.probability * policy.valueAt(outcome.belief);
    }
    std::printf("the policy's own lower bound: %.5f\n", lower);
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
