#include "kr3_sim_ode/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kMinSpacing = 0.3;           // m, between centres
constexpr double kMaxBehindFrontEdge = 0.25;  // m: the gripper's reach less the robot's own radius
constexpr double kEdgeMargin = 0.02;          // m
constexpr double kFrontJitter = 0.35;         // rad
constexpr int kAttempts = 400;

bool isClear(double x, double y, double radius, const std::vector<ObjectState>& others,
             const std::vector<ObjectModel>& models)
{
  return std::all_of(others.begin(), others.end(), [&](const ObjectState& other) {
    const double distance = std::hypot(other.pose.position.x - x, other.pose.position.y - y);
    const double other_radius = findModel(models, other.model).footprintRadius();
    return distance >= std::max(kMinSpacing, radius + other_radius + kEdgeMargin);
  });
}
}  // namespace

std::vector<ObjectAssignment> overriddenAssignments(const std::vector<ObjectAssignment>& defaults,
                                                    const std::vector<std::string>& entries,
                                                    const Building& building,
                                                    const std::vector<ObjectModel>& models)
{
  std::vector<ObjectAssignment> result = defaults;
  std::set<std::string> seen;
  for (const std::string& entry : entries)
  {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == entry.size())
    {
      throw InvalidArgument("placement '" + entry + "' is not of the form object=place");
    }
    const std::string object = findModel(models, entry.substr(0, equals)).name;
    const std::string place = building.place(entry.substr(equals + 1)).name;
    if (!seen.insert(object).second)
    {
      throw InvalidArgument("object '" + object + "' is placed twice");
    }
    const auto found = std::find_if(result.begin(), result.end(),
                                    [&](const ObjectAssignment& a) { return a.object == object; });
    if (found == result.end())
    {
      result.push_back({object, place});
    }
    else
    {
      found->place = place;
    }
  }
  return result;
}

Pose freeSurfacePose(const Building& building, const std::string& place, const ObjectModel& model,
                     const std::vector<ObjectState>& others, const std::vector<ObjectModel>& models,
                     std::mt19937_64& generator)
{
  (void)building.place(place);
  const double radius = model.footprintRadius();
  // Surfaces on which the object fits, as often as they are wide.
  std::vector<const Furniture*> surfaces;
  double total_width = 0.0;
  for (const Furniture& furniture : building.furniture)
  {
    if (furniture.place == place && furniture.size.y >= 2.0 * (radius + kEdgeMargin) &&
        furniture.size.x >= 2.0 * (radius + kEdgeMargin) &&
        radius + kEdgeMargin <= kMaxBehindFrontEdge)
    {
      surfaces.push_back(&furniture);
      total_width += furniture.size.y;
    }
  }
  if (surfaces.empty())
  {
    throw FailedPrecondition("'" + model.name + "', " + std::to_string(2.0 * radius) +
                             " m across, is too large for the furniture of '" + place + "'");
  }
  for (int attempt = 0; attempt < kAttempts; ++attempt)
  {
    double along = uniform(generator, 0.0, total_width);
    std::size_t index = 0;
    while (index + 1 < surfaces.size() && along >= surfaces[index]->size.y)
    {
      along -= surfaces[index++]->size.y;
    }
    const Furniture& surface = *surfaces[index];
    const double deepest = std::min(kMaxBehindFrontEdge, surface.size.x - radius - kEdgeMargin);
    const double local_x =
        surface.size.x / 2.0 - uniform(generator, radius + kEdgeMargin, deepest + 1e-6);
    const double free_y = surface.size.y / 2.0 - radius - kEdgeMargin;
    const double local_y = uniform(generator, -free_y, free_y + 1e-6);
    const double jitter = uniform(generator, -kFrontJitter, kFrontJitter);
    const Pose T_world_surface = poseOf(surface.pose, surface.size.z);
    const Pose T_surface_object = poseOf({local_x, local_y, jitter}, model.size.z / 2.0 + 0.001);
    const Pose T_world_object = T_world_surface * T_surface_object;
    if (isClear(T_world_object.position.x, T_world_object.position.y, radius, others, models))
    {
      return T_world_object;
    }
  }
  throw FailedPrecondition("no free surface for '" + model.name + "' in '" + place + "'");
}

std::vector<ObjectState> placedObjects(const Building& building,
                                       const std::vector<ObjectModel>& models,
                                       const std::vector<ObjectAssignment>& assignments,
                                       std::mt19937_64& generator)
{
  std::vector<ObjectState> objects;
  for (const ObjectAssignment& assignment : assignments)
  {
    const ObjectModel& model = findModel(models, assignment.object);
    const Pose pose =
        freeSurfacePose(building, assignment.place, model, objects, models, generator);
    objects.push_back({assignment.object, model.name, pose});
  }
  return objects;
}

Pose2 freeFloorPose(const Building& building, const std::string& place, double clearance_m,
                    std::mt19937_64& generator)
{
  const Rectangle& r = building.place(place).rectangle;
  const Obstacles obstacles(building);
  for (int attempt = 0; attempt < kAttempts; ++attempt)
  {
    const double x = uniform(generator, r.x0, r.x1);
    const double y = uniform(generator, r.y0, r.y1);
    if (obstacles.clearance(x, y, clearance_m) >= clearance_m)
    {
      return {x, y, uniform(generator, -3.14159265358979, 3.14159265358979)};
    }
  }
  throw FailedPrecondition("no free floor in '" + place + "'");
}

}  // namespace kr3::sim
