// Writes the world of a building and its objects as a binary OctoMap.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "kr3_sim_ode/octomap.hpp"
#include "kr3_sim_ode/scenario.hpp"

int main(int argc, char** argv)
{
  using namespace kr3::sim;
  std::string building;
  std::string objects;
  std::string out;
  Scenario scenario;
  OctomapOptions options;
  CLI::App app{
      "Write the world as a binary OctoMap (.bt): what is solid is occupied, the rest of the "
      "places is free, "
      "what is outside is unknown. The robot is left out."};
  app.add_option("building", building, "building file (YAML)")->required();
  app.add_option("objects", objects, "objects file (YAML)")->required();
  app.add_option("out", out, "file to write (.bt)")->required();
  app.add_option("--resolution", options.resolution_m, "m")->capture_default_str();
  app.add_option("--z-min", options.z_min_m, "m, of the lowest layer")->capture_default_str();
  app.add_option("--z-max", options.z_max_m, "m, of the highest layer")->capture_default_str();
  app.add_option("-s,--seed", scenario.world.seed, "seed of where objects are")
      ->capture_default_str();
  app.add_option("--placement", scenario.placements, "object=place, in place of the building's");
  CLI11_PARSE(app, argc, argv);
  try
  {
    scenario.building = loadBuilding(building);
    scenario.models = loadObjectModels(objects);
    saveOctomap(makeWorld(scenario)->octomap(options), out);
  }
  catch (const std::exception& e)
  {
    std::cerr << "world_octomap: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
