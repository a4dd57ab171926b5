#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/contact.hpp"
#include "kr3_sim_ode/object_model.hpp"
#include "kr3_sim_ode/octomap.hpp"
#include "kr3_sim_ode/odometry.hpp"
#include "kr3_sim_ode/placement.hpp"
#include "kr3_sim_ode/robot.hpp"

namespace kr3::sim
{

/// A laser that scans the full circle, beam 0 backwards, counter-clockwise.
struct LaserModel
{
  int num_beams = 360;
  double min_range_m = 0.05;
  double max_range_m = 12.0;
  double noise_stddev_m = 0.01;
  double dropout_rate = 0.002;  ///< share of beams that return nothing
};

struct WorldConfig
{
  std::uint64_t seed = 1;
  double time_step_s = 0.002;
  RobotModel robot;
  LaserModel laser;
  OdometryNoise odometry;
  double grasp_failure_rate = 0.05;
  double drop_rate_per_m = 0.0;  ///< of what is carried, for each metre driven
};

/// A building with objects and a robot, simulated by rigid bodies in fixed steps.
///
/// The same arguments and the same calls give bit-identical results on one machine and build. Not
/// thread-safe.
class World
{
public:
  /// Comes to rest before it returns: objects lie, the robot stands.
  /// @throws NotFound         an object of an unknown model
  /// @throws InvalidArgument  two objects of one name
  World(const Building& building, const std::vector<ObjectModel>& models,
        const std::vector<ObjectState>& objects, const Pose2& robot_start,
        const WorldConfig& config);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Advances by config.time_step_s.
  void step();
  [[nodiscard]] std::uint64_t steps() const;

  /// The velocity that the robot tries to reach, limited to what it can do.
  /// @throws InvalidArgument  a value is not finite
  void setCommand(double speed_m_s, double turn_rate_rad_s);

  [[nodiscard]] Pose robotPose() const;  ///< T_world_base
  [[nodiscard]] Velocity robotVelocity() const;
  [[nodiscard]] Pose2 odometryPose() const;  ///< T_odom_base as the wheels tell it
  [[nodiscard]] Velocity odometryVelocity() const;

  /// How often the robot bumped into something (Physics::robotContacts()).
  [[nodiscard]] std::uint32_t robotContacts() const;

  /// What touched since the last call, in the order of the names: walls, furniture, objects, the
  /// robot's body. The robot's wheels on the floor and what rests without moving are left out.
  [[nodiscard]] std::vector<ContactReport> takeContacts();

  /// Of the robot ("robot"), then of every object.
  [[nodiscard]] std::vector<BodyTwist> twists() const;

  /// One scan from where the robot is now, shape [num_beams], metres; infinity where nothing
  /// returned. Beam i points to -pi + i * 2 pi / num_beams in frame laser.
  [[nodiscard]] std::vector<double> scan();

  [[nodiscard]] std::vector<ObjectState> objects() const;
  [[nodiscard]] std::optional<std::string> held() const;

  /// The world as a binary OctoMap, the bytes of a `.bt` file: voxels that a wall, a piece of
  /// furniture or an object reaches into are occupied, the others of the places are free, what is
  /// outside is unknown. The robot and what it holds are left out.
  /// @throws InvalidArgument  a value is not finite, the band is empty, or the resolution too fine
  /// Cost: about 0.3 s for 300 square metres at 0.1 m and 2 m of height.
  [[nodiscard]] std::vector<std::uint8_t> octomap(const OctomapOptions& options) const;

  /// Grasps the object nearest to the grasp point among those in reach that nothing solid hides,
  /// and lifts it.
  /// @return whether the gripper holds something now: false when nothing was in reach or the grasp
  /// failed
  /// @throws FailedPrecondition  it holds something already
  bool closeGripper();

  /// Lowers what is held onto the highest free surface in front, the nearest to the grasp point,
  /// and lets it go.
  /// @return false when nothing was held
  /// @throws FailedPrecondition  no free surface within reach; the object stays held
  bool openGripper();

  /// Lets go of what is held: it falls on the free surface in front, as by accident. What is held
  /// is dropped on the way, too, at `drop_rate_per_m`, as soon as there is free room for it.
  /// @return the object; nothing when none was held
  /// @throws FailedPrecondition  no free room in front; the object stays held
  std::optional<std::string> dropHeld();

  /// @throws InvalidArgument  the name is taken, the pose is not a pose, or the object would be
  ///                          inside of something
  /// @throws NotFound         no such model
  void spawn(const std::string& name, const std::string& model, const Pose& pose);

  /// @throws NotFound  no such object
  void remove(const std::string& name);

  /// Puts an object down at a pose with zero velocity; the gripper lets go of it first.
  /// @throws NotFound         no such object
  /// @throws InvalidArgument  the pose is not a pose, or the object would be inside of something
  void setObjectPose(const std::string& name, const Pose& pose);

  /// Puts the robot, with what it holds, elsewhere. The odometry does not notice.
  /// @throws InvalidArgument  a value is not finite, or the robot would be inside of something or
  ///                          outside of the building
  void setRobotPose(const Pose2& pose);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::sim
