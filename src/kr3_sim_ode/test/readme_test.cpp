// The example of README.md.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_sim_ode/scenario.hpp>

TEST(Readme, ExampleRuns)
{
  const std::string domain = std::string(KR3_DOMAINS_DIR) + "/office";
  kr3::sim::Scenario scenario;
  scenario.building = kr3::sim::loadBuilding(domain + "/building.yaml");
  scenario.models = kr3::sim::loadObjectModels(domain + "/objects.yaml");
  scenario.placements = {"tb1=aux_library"};
  scenario.world.seed = 7;
  const auto world = kr3::sim::makeWorld(scenario);
  const kr3::sim::ObjectState book = world->objects().at(0);
  EXPECT_EQ(scenario.building.placeAt(book.pose.position.x, book.pose.position.y)->name,
            "aux_library");
  world->setCommand(0.3, 0.0);
  for (int i = 0; i < 500; ++i)
  {
    world->step();
  }
  const std::vector<double> ranges = world->scan();
  EXPECT_EQ(ranges.size(), 360U);
}
