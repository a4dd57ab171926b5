#include "dataset.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

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
  std::vector<ObjectState> objects;
  for (const ObjectModel& model : models)
  {
    std::vector<std::string> left = places;
    while (true)
    {
      const auto choice =
          left.begin() + static_cast<std::ptrdiff_t>(uniformIndex(generator, left.size()));
      try
      {
        const Pose pose = freeSurfacePose(building, *choice, model, objects, models, generator);
        objects.push_back({model.name, model.name, pose});
        break;
      }
      catch (const FailedPrecondition&)  // full, or too small for this one
      {
        left.erase(choice);
      }
      if (left.empty())
      {
        throw FailedPrecondition("no free surface for '" + model.name + "' in the whole building");
      }
    }
  }
  return objects;
}

/// Where the robot may stand to look at a target; nothing when no such spot was found.
std::optional<Pose2> viewpoint(const Building& building, const Obstacles& obstacles,
                               const Vector3& target, const RobotModel& robot,
                               const ViewRange& range, std::mt19937_64& generator)
{
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
    if (building.placeAt(x, y) == target_place &&
        obstacles.clearance(x, y, kRobotClearance) >= kRobotClearance)
    {
      return Pose2{x, y, wrapped(yaw)};
    }
  }
  return std::nullopt;
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
  const Obstacles obstacles(building);
  std::vector<ObjectState> left = view.objects;
  while (!left.empty())
  {
    const auto choice =
        left.begin() + static_cast<std::ptrdiff_t>(uniformIndex(generator, left.size()));
    const std::optional<Pose2> pose =
        viewpoint(building, obstacles, choice->pose.position, robot, range, generator);
    if (pose)
    {
      view.T_world_base = *pose;
      return view;
    }
    left.erase(choice);
  }
  throw FailedPrecondition("no viewpoint on the floor for any object");
}

}  // namespace kr3::sim
