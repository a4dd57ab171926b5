// Prints a building's floor plan as JSON.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "kr3_sim_ode/building.hpp"

int main(int argc, char** argv)
{
  CLI::App app{
      "Print places, doors, walls and furniture of a building file as JSON (metres, world frame)."};
  std::string path;
  app.add_option("building", path, "building file (YAML)")->required();
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::cout << kr3::sim::floorPlanJson(kr3::sim::loadBuilding(path)) << '\n';
  }
  catch (const std::exception& e)
  {
    std::cerr << "floor_plan: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
