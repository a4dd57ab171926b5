/// kr3_budgets: what counted budgets of POMDP-1 are worth in CPU seconds on this machine. Needs no
/// ROS.

#include <cstdlib>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "kr3_executive/work_rates.hpp"
#include "tool_options.hpp"

int main(int argc, char** argv)
{
  using namespace kr3::executive;
  std::string domain;
  WorkRateOptions options;
  CLI::App app{"Prints the counted work of POMDP-1 that CPU seconds are worth, as a line of JSON."};
  app.option_defaults()->always_capture_default();
  app.add_option("DOMAIN_DIR", domain, "directory with a scenario.yaml")->required();
  app.add_option("--seconds", options.cpu_s, "of CPU, ascending, with commas")->delimiter(',');
  app.add_option("--missions", options.missions, "for the mean number of actions")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.first_seed, "of the first mission");
  return runTool(app, "kr3_budgets", argc, argv, [&] {
    print(std::cout, workRates(domain, options));
    return EXIT_SUCCESS;
  });
}
