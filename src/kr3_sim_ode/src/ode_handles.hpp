#pragma once

#include <memory>

#include <ode/ode.h>

namespace kr3::sim
{

struct OdeDeleter
{
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
  void operator()(dxSpace* space) const { dSpaceDestroy(space); }
  void operator()(dxBody* body) const { dBodyDestroy(body); }
  void operator()(dxGeom* geom) const { dGeomDestroy(geom); }
  void operator()(dxJoint* joint) const { dJointDestroy(joint); }
  void operator()(dxJointGroup* group) const { dJointGroupDestroy(group); }
};

using WorldHandle = std::unique_ptr<dxWorld, OdeDeleter>;
using SpaceHandle = std::unique_ptr<dxSpace, OdeDeleter>;
using BodyHandle = std::unique_ptr<dxBody, OdeDeleter>;
using GeomHandle = std::unique_ptr<dxGeom, OdeDeleter>;
using JointHandle = std::unique_ptr<dxJoint, OdeDeleter>;
using JointGroupHandle = std::unique_ptr<dxJointGroup, OdeDeleter>;

/// A space as a geom: in C++ ODE hides that the one is the other.
inline dGeomID geomOf(const SpaceHandle& space)
{
  return reinterpret_cast<dGeomID>(space.get());
}

}  // namespace kr3::sim
