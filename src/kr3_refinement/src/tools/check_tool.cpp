/// kr3_check: whether the low level can carry out what the high level plans. Needs no ROS.

#include <cstdlib>
#include <exception>
#include <iostream>

#include <CLI/CLI.hpp>

#include "command_line.hpp"
#include "kr3_refinement/coupling_check.hpp"

int main(int argc, char** argv)
{
  kr3::refinement::tools::Options options;
  kr3::refinement::CouplingCheckOptions check;
  bool all = false;
  bool numbers = false;
  kr3::refinement::ModelsOptions models;
  CLI::App app{
      "Checks that for every transition of the high level and every low-level state that fits its "
      "start, low-level actions can lead to its end."};
  app.option_defaults()->always_capture_default();
  kr3::refinement::tools::addDomainOptions(app, options);
  app.add_option("--action", check.action, "only this action, ground or by name");
  app.add_flag("--all", all, "try all constants, not one of each kind");
  app.add_flag("--direct", check.direct, "coarse states on the way must be the start or the end");
  app.add_option("--counterexamples", check.max_counterexamples, "most to print");
  app.add_option("--max-states", check.max_states, "of one description");
  app.add_flag("--numbers", numbers, "check models.yaml too, and list what was not learned");
  app.add_flag("--require-learned", models.require_learned,
               "refuse models.yaml when a probability was not learned");
  CLI11_PARSE(app, argc, argv);
  check.up_to_symmetry = !all;
  try
  {
    const bool with_models = numbers || models.require_learned;
    kr3::refinement::Models read;
    const kr3::refinement::LowLevelDomain domain =
        kr3::refinement::tools::loadDomain(options, with_models ? &read : nullptr, models);
    for (const std::string& line : kr3::refinement::handWritten(read))
    {
      std::cout << "not learned: " << line << "\n";
    }
    const kr3::refinement::CouplingReport report = kr3::refinement::checkCoupling(domain, check);
    std::cout << kr3::refinement::toString(report);
    return report.passed() ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  catch (const std::exception& error)
  {
    std::cerr << "kr3_check: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
