#include "dataset.hpp"

#include <algorithm>
#include <cmath>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kRobotClearance = 0.30;  // m, to walls and furniture
constexpr int kAttempts = 2000;

std::vector<std::string> furnishedPlaces(const Building& building)
{
  std::vector<std::string> names;
  for (const Furniture& furniture : building.furniture)
  {
    if (std::find(names.begin(), names.end(), furniture.place) == names.end())
    {
      names.push_back(furniture.place);
    }
  }
  return names;
}

std::vector<ObjectState> scatteredObjects(const Building& building,
                                          const std::vector<ObjectModel>& models,
                                          std::mt19937_64& generator)
{
  const std::vector<std::string> places = furnishedPlaces(building);
  if (places.empty())
  {
    throw FailedPrecondition("the building has no furniture to put objects on");
  }
  std::vector<ObjectAssignment> assignments;
  for (const ObjectModel& model : models)
  {
    assignments.push_back({model.name, places[uniformIndex(generator, places.size())]});
  }
  return placedObjects(building, models, assignments, generator);
}
}  // namespace

LabelledView drawView(const Building& building, const std::vector<ObjectModel>& models,
                      const RobotModel& robot, const ViewRange& range, bool background,
                      std::mt19937_64& generator)
{
  LabelledView view;
  view.objects = scatteredObjects(building, models, generator);
  if (background)
  {
    const std::string place = building.places[uniformIndex(generator, building.places.size())].name;
    view.T_world_base = freeFloorPose(building, place, kRobotClearance, generator);
    return view;
  }
  const Vector3 target = view.objects[uniformIndex(generator, view.objects.size())].pose.position;
  const Place* const target_place = building.placeAt(target.x, target.y);
  for (int attempt = 0; attempt < kAttempts; ++attempt)
  {
    const double distance = uniform(generator, range.min_distance_m, range.max_distance_m);
    const double bearing = uniform(generator, -M_PI, M_PI);
    const double camera_x = target.x - distance * std::cos(bearing);
    const double camera_y = target.y - distance * std::sin(bearing);
    const double yaw = bearing + uniform(generator, -0.4, 0.4);
    const double x = camera_x - robot.camera_x_m * std::cos(yaw);
    const double y = camera_y - robot.camera_x_m * std::sin(yaw);
    if (building.placeAt(x, y) == target_place && floorClearance(building, x, y) >= kRobotClearance)
    {
      view.T_world_base = {x, y, wrapped(yaw)};
      return view;
    }
  }
  throw FailedPrecondition("no viewpoint on the floor of '" + target_place->name + "'");
}

}  // namespace kr3::sim
