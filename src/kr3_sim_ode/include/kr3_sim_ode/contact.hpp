#pragma once

#include <string>

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

/// Two bodies that touched during some period. Names are "robot", "floor", "wall", or that of a
/// piece of furniture or an object; `body_a` comes before `body_b` in the alphabet.
struct ContactReport
{
  std::string body_a;
  std::string body_b;
  Vector3 position;         ///< of the deepest contact point, world
  Vector3 normal;           ///< there, unit vector, from b towards a
  double depth_m = 0.0;     ///< greatest penetration
  double impulse_ns = 0.0;  ///< N s: magnitudes at all contact points, over the period
};

/// The velocity of a body's centre, world frame.
struct BodyTwist
{
  std::string name;
  Vector3 linear_m_s;
  Vector3 angular_rad_s;
};

}  // namespace kr3::sim
