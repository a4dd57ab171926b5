/// kr3_training: the training phase in the abstract simulator, a trial a line (JSON). Needs no ROS.

#include <cstdlib>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/abstract_training.hpp"
#include "tool_options.hpp"

namespace
{

using namespace kr3::executive;
using nlohmann::json;

struct Options
{
  std::string domain;
  std::uint64_t trials = 200;
  std::uint64_t seed = 1;
  AbstractMissionConfig mission;
};

json lineOf(const TrainingAttempt& attempt)
{
  json observed = json::array();
  for (const auto& one : attempt.observed)
  {
    observed.push_back({{"fluent", one.fluent},
                        {"truth", one.truth},
                        {"said", one.said},
                        {"tells_value", one.tells_value}});
  }
  return {{"action", attempt.action.symbol},
          {"arguments", attempt.action.arguments},
          {"possible", true},
          {"outcome", attempt.outcome},
          {"observed", std::move(observed)},
          {"duration_s", attempt.duration_s},
          {"metres", attempt.metres ? json(*attempt.metres) : json()}};
}

int run(const Options& options)
{
  const AbstractMissions missions(options.domain, options.mission);
  AbstractTraining training(missions.domain(), missions.worldModels(), options.seed);
  std::cout
      << json{{"about",
               {{"world", "abstract"}, {"models", options.mission.models}, {"seed", options.seed}}}}
      << '\n';
  for (std::uint64_t trial = 0; trial < options.trials; ++trial)
  {
    for (const auto& attempt : training.round())
      std::cout << lineOf(attempt) << '\n';
  }
  std::cout << std::flush;
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Tries every low-level action in the abstract simulator: a trial a line (JSON)."};
  Options options;
  app.option_defaults()->always_capture_default();
  app.add_option("DOMAIN_DIR", options.domain, "directory of the domain")->required();
  app.add_option("--trials", options.trials, "of each action, and each truth of what it asks")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed);
  app.add_option("--models", options.mission.models, "of the world; file in DOMAIN_DIR");
  app.add_option("--cells-per-place", options.mission.components_per_whole,
                 "components of each magnified element where the domain has no map.yaml");
  return runTool(app, "kr3_training", argc, argv, [&] { return run(options); });
}
