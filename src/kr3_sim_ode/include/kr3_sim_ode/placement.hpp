#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/object_model.hpp"

namespace kr3::sim
{

/// An object of the simulated world: which model, under which name, where (its centre, world
/// frame).
struct ObjectState
{
  std::string name;
  std::string model;
  Pose pose;
};

/// Replaces the place of objects in `defaults` by "object=place" entries; an object that has no
/// default is added.
///
/// @throws InvalidArgument  an entry is not of the form object=place, or names an object twice
/// @throws NotFound         unknown object or place; the message lists those that exist
[[nodiscard]] std::vector<ObjectAssignment> overriddenAssignments(
    const std::vector<ObjectAssignment>& defaults, const std::vector<std::string>& entries,
    const Building& building, const std::vector<ObjectModel>& models);

/// Puts one more object on a free spot of the furniture of `place`: upright, its front roughly the
/// way the furniture's front faces, its centre at most 0.25 m behind the furniture's front edge and
/// at least 0.3 m from the objects of `others`.
///
/// @throws NotFound            no such place
/// @throws FailedPrecondition  nothing free was found
[[nodiscard]] Pose freeSurfacePose(const Building& building, const std::string& place,
                                   const ObjectModel& model, const std::vector<ObjectState>& others,
                                   const std::vector<ObjectModel>& models,
                                   std::mt19937_64& generator);

/// All assigned objects on surfaces of their places.
/// @throws NotFound, FailedPrecondition  as freeSurfacePose(); NotFound also for an unknown object
[[nodiscard]] std::vector<ObjectState> placedObjects(
    const Building& building, const std::vector<ObjectModel>& models,
    const std::vector<ObjectAssignment>& assignments, std::mt19937_64& generator);

/// A point of the place with at least `clearance_m` to walls and furniture, heading drawn too.
/// @throws NotFound, FailedPrecondition  as freeSurfacePose()
[[nodiscard]] Pose2 freeFloorPose(const Building& building, const std::string& place,
                                  double clearance_m, std::mt19937_64& generator);

/// What stands on the floor of a building: its walls and furniture, for many questions about one
/// building. A value; threads may share a constant one.
class Obstacles
{
public:
  explicit Obstacles(const Building& building);

  /// The distance on the floor from a point to the nearest wall or piece of furniture, at most
  /// `limit_m`, m. Cost: independent of the size of the building for limits of a few metres.
  [[nodiscard]] double clearance(double x, double y, double limit_m) const;

private:
  static constexpr double kBucket = 4.0;  // m

  std::vector<Box> boxes_;
  Rectangle extent_;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::vector<std::uint32_t>> buckets_;  // boxes that touch each square, row-major
};

}  // namespace kr3::sim
