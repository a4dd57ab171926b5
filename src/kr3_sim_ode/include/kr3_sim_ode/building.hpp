#pragma once

#include <string>
#include <vector>

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

/// A room, or any other labelled part of the floor.
struct Place
{
  std::string name;
  Rectangle rectangle;
};

/// An opening in the wall between two places.
struct Door
{
  std::string place_a;
  std::string place_b;
  double x = 0.0;  ///< centre of the opening, world
  double y = 0.0;
  double width_m = 1.0;
};

/// A closed box on the floor. Objects lie on its top. `pose.yaw` is the direction that its front
/// faces.
struct Furniture
{
  std::string name;
  std::string place;
  Vector3 size;  ///< depth (along the direction the front faces), width, height
  Pose2 pose;
  std::string texture;  ///< path of a PNG

  [[nodiscard]] Box box() const { return {{pose.x, pose.y, size.z / 2.0}, size, pose.yaw}; }
};

/// An object of the building and the place where it is by default.
struct ObjectAssignment
{
  std::string object;
  std::string place;
};

/// A building as its file describes it. Coordinates are in the world frame.
struct Building
{
  std::string name;
  double wall_height_m = 2.0;
  double wall_thickness_m = 0.1;
  std::string wall_texture;
  std::string floor_texture;
  std::vector<Place> places;
  std::vector<Door> doors;
  std::vector<Furniture> furniture;
  std::vector<ObjectAssignment> objects;
  Pose2 robot_start;

  /// @throws NotFound  no such place; the message lists those that exist
  [[nodiscard]] const Place& place(const std::string& place_name) const;

  /// The first place that contains the point; nullptr outside of all.
  [[nodiscard]] const Place* placeAt(double x, double y) const;

  /// The bounding rectangle of all places.
  [[nodiscard]] Rectangle extent() const;
};

/// Reads and checks a building file (README, "building.yaml"). Texture paths come back absolute or
/// relative to the working directory; in the file they are relative to it.
///
/// @throws Unavailable      the file cannot be opened
/// @throws InvalidArgument  "FILE:LINE: what was found, what was expected"
[[nodiscard]] Building loadBuilding(const std::string& path);

/// The walls: one around each place, shared where places touch, cut at the doors.
[[nodiscard]] std::vector<Box> wallsOf(const Building& building);

/// Places, doors, walls and furniture as JSON, for drawing.
[[nodiscard]] std::string floorPlanJson(const Building& building);

}  // namespace kr3::sim
