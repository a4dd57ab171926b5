#include "dataset.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kRobotClearance = 0.30;  // m, to walls and furniture
constexpr int kAttempts = 2000;
constexpr double kCrowdGap = 0.01;    // m, between footprints
constexpr double kCrowdEdge = 0.01;   // m, to the furniture's edge
constexpr double kCrowdDepth = 0.45;  // m behind the front edge, at most
constexpr double kCrowdWidth = 0.9;   // m along the front, at most

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
                               const SceneOptions& scene, std::mt19937_64& generator)
{
  const Place* const target_place = building.placeAt(target.x, target.y);
  for (int attempt = 0; attempt < kAttempts; ++attempt)
  {
    const double distance = uniform(generator, scene.min_distance_m, scene.max_distance_m);
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
/// `count` objects, drawn without replacement, close together on one piece of furniture. Those that
/// find no room are left out.
std::vector<ObjectState> crowdedObjects(const Building& building,
                                        const std::vector<ObjectModel>& models, int count,
                                        std::mt19937_64& generator)
{
  if (building.furniture.empty())
  {
    throw FailedPrecondition("the building has no furniture to put objects on");
  }
  const Furniture& surface = building.furniture[uniformIndex(generator, building.furniture.size())];
  const double width = std::min(surface.size.y, kCrowdWidth);
  const double middle = uniform(generator, -0.5, 0.5) * (surface.size.y - width);
  std::vector<std::size_t> rest(models.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  std::vector<ObjectState> objects;
  for (int i = 0; i < count && !rest.empty(); ++i)
  {
    const std::size_t pick = uniformIndex(generator, rest.size());
    const ObjectModel& model = models[rest[pick]];
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(pick));
    const double radius = model.footprintRadius();
    const double depth = std::min(surface.size.x, kCrowdDepth) - 2.0 * (radius + kCrowdEdge);
    const double free_y = width / 2.0 - radius - kCrowdEdge;
    for (int attempt = 0; attempt < kAttempts && depth > 0.0 && free_y > 0.0; ++attempt)
    {
      const double x = surface.size.x / 2.0 - radius - kCrowdEdge - uniform(generator, 0.0, depth);
      const double y = middle + uniform(generator, -free_y, free_y);
      const Pose pose = poseOf(surface.pose, surface.size.z) *
                        poseOf({x, y, uniform(generator, -0.35, 0.35)}, model.size.z / 2.0 + 0.001);
      const bool clear = std::all_of(objects.begin(), objects.end(), [&](const ObjectState& other) {
        return std::hypot(other.pose.position.x - pose.position.x,
                          other.pose.position.y - pose.position.y) >=
               radius + findModel(models, other.model).footprintRadius() + kCrowdGap;
      });
      if (clear)
      {
        objects.push_back({model.name, model.name, pose});
        break;
      }
    }
  }
  if (objects.empty())
  {
    throw FailedPrecondition("no object fits on '" + surface.name + "'");
  }
  return objects;
}

void turn(std::vector<ObjectState>& objects, double max_turn_rad, std::mt19937_64& generator)
{
  for (ObjectState& object : objects)
  {
    const Pose pose = object.pose;
    object.pose = pose * poseOf({0.0, 0.0, uniform(generator, -max_turn_rad, max_turn_rad)}, 0.0);
  }
}

}  // namespace

LabelledView drawView(const Building& building, const std::vector<ObjectModel>& models,
                      const RobotModel& robot, const SceneOptions& scene, bool background,
                      std::mt19937_64& generator)
{
  LabelledView view;
  view.objects = scene.crowd > 0 ? crowdedObjects(building, models, scene.crowd, generator)
                                 : scatteredObjects(building, models, generator);
  if (scene.max_turn_rad > 0.0)
  {
    turn(view.objects, scene.max_turn_rad, generator);
  }
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
        viewpoint(building, obstacles, choice->pose.position, robot, scene, generator);
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
