#pragma once

#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "object_body.hpp"
#include "robot_body.hpp"

namespace kr3::sim
{

/// Takes objects from surfaces in front of the robot and puts them there. What it holds is fixed to
/// the base.
class Gripper
{
public:
  using Bodies = std::vector<std::unique_ptr<ObjectBody>>;

  /// Keeps references to `physics` and `robot`.
  Gripper(const Building& building, Physics& physics, RobotBody& robot, const RobotModel& model,
          double failure_rate, std::uint64_t seed);

  /// World::closeGripper().
  bool close(const Bodies& bodies);

  /// World::openGripper().
  bool open(const Bodies& bodies);

  /// Loses what is held: it falls on the surface on which open() would put it.
  /// @return false when there is none; it stays held
  bool drop(const Bodies& bodies);

  /// Lets go of `body` where it is, if it is held.
  void release(const ObjectBody& body);

  /// Takes what is held along after the robot was moved by hand.
  void follow();

  [[nodiscard]] const ObjectBody* held() const { return held_; }

private:
  struct Spot
  {
    double x;
    double y;
    double surface_z;
  };

  [[nodiscard]] ObjectBody* nearestInReach(const Bodies& bodies) const;
  [[nodiscard]] std::optional<Spot> bestSpot(const Bodies& bodies) const;
  [[nodiscard]] std::optional<double> surfaceAt(double x, double y, double radius) const;
  [[nodiscard]] bool isVisible(const Vector3& point) const;
  [[nodiscard]] Pose carryPose() const;

  std::vector<Box> furniture_;
  std::vector<Box> walls_;
  Physics& physics_;
  RobotBody& robot_;
  RobotModel model_;
  double failure_rate_;
  std::mt19937_64 generator_;
  ObjectBody* held_ = nullptr;
  JointHandle joint_;
};

}  // namespace kr3::sim
