/// kr3_values: what each method earns on a small floor, beside the bounds of the best value. Needs
/// no ROS.

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "kr3_executive/method_values.hpp"

namespace
{

using namespace kr3::executive;

struct Arguments
{
  std::string domain;
  std::vector<std::string> methods{"all"};
  std::string truth = "uniform";
  double bias = 0.85;
  std::string flat_planning = toString(FlatPlanning::kBest);
  std::size_t show = 0;
  ValueOptions options;
};

int run(const Arguments& arguments)
{
  std::vector<Method> methods;
  for (const auto& name : arguments.methods)
  {
    if (name == "all")
      methods.insert(methods.end(), allMethods().begin(), allMethods().end());
    else
      methods.push_back(methodNamed(name));
  }
  ValueOptions options = arguments.options;
  options.mission.driver.budget.time_s = 0.0;  // counted work, so that it repeats
  options.mission.baseline.default_probability = arguments.bias;
  options.mission.baseline.planning = flatPlanningNamed(arguments.flat_planning);
  if (arguments.truth == "defaults")
    options.default_probability = arguments.bias;
  const ValueTable table = methodValues(arguments.domain, methods, options);
  print(std::cout, table);
  printDifferences(std::cout, table, arguments.show);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app{"Prints what methods earn on a domain, beside bounds of the best value."};
  app.option_defaults()->always_capture_default();
  app.add_option("DOMAIN_DIR", arguments.domain, "directory with a scenario.yaml")->required();
  app.add_option("--method", arguments.methods, "as of kr3_mission; several with commas, or all")
      ->delimiter(',');
  app.add_option("--truth", arguments.truth,
                 "what the true states are drawn from: uniform, as POMDP-1 believes, or defaults, "
                 "as POMDP-2 does")
      ->check(CLI::IsMember({"uniform", "defaults"}));
  app.add_option("--bias", arguments.bias, "POMDP-2: probability of what the defaults say");
  app.add_option("--trials", arguments.options.trials)->check(CLI::PositiveNumber);
  app.add_option("--seed", arguments.options.first_seed, "of the first trial");
  app.add_option("--reference-backups", arguments.options.reference.max_backups,
                 "of the solver that gives the bounds");
  app.add_option("--reference-precision", arguments.options.reference.precision);
  app.add_option("--max-backups", arguments.options.mission.driver.budget.max_backups,
                 "of the solver for a high-level action");
  app.add_option("--flat-backups", arguments.options.mission.baseline.budget.max_backups,
                 "of POMDP-1 and POMDP-2");
  app.add_option("--flat-planning", arguments.flat_planning, "best, ahead or online");
  app.add_option("--online-prospects", arguments.options.mission.baseline.online_prospects,
                 "counted work of online planning for each action");
  app.add_option("--show", arguments.show,
                 "so many trials in which methods acted otherwise than the reference");
  try
  {
    app.parse(argc, argv);
  }
  catch (const CLI::ParseError& error)
  {
    return app.exit(error) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  try
  {
    return run(arguments);
  }
  catch (const std::exception& error)
  {
    std::cerr << "kr3_values: " << error.what() << "\n";
    return 2;
  }
}
