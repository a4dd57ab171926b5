#include "kr3_sim_ode/scenario.hpp"

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kRobotClearance = 0.35;  // m, from where the robot starts to walls and furniture
}

std::unique_ptr<World> makeWorld(const Scenario& scenario)
{
  const Building& building = scenario.building;
  std::mt19937_64 generator = makeGenerator(scenario.world.seed, Stream::kPlacement);
  const std::vector<ObjectAssignment> assignments =
      overriddenAssignments(building.objects, scenario.placements, building, scenario.models);
  const std::vector<ObjectState> objects =
      placedObjects(building, scenario.models, assignments, generator);
  const Pose2 start =
      scenario.robot_start.empty()
          ? scenario.robot_pose.value_or(building.robot_start)
          : freeFloorPose(building, scenario.robot_start, kRobotClearance, generator);
  return std::make_unique<World>(building, scenario.models, objects, start, scenario.world);
}

}  // namespace kr3::sim
