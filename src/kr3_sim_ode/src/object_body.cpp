#include "object_body.hpp"

#include <utility>

namespace kr3::sim
{

ObjectBody::ObjectBody(Physics& physics, std::string name, const ObjectModel& model,
                       const Pose& pose)
  : name_(std::move(name)), model_(model), body_(dBodyCreate(physics.world()))
{
  constexpr int kAxisZ = 3;
  const Vector3& size = model.size;
  dMass mass;
  if (model.shape == Shape::kCylinder)
  {
    dMassSetCylinderTotal(&mass, model.mass_kg, kAxisZ, size.x / 2.0, size.z);
    geom_.reset(dCreateCylinder(physics.objectSpace(), size.x / 2.0, size.z));
  }
  else
  {
    dMassSetBoxTotal(&mass, model.mass_kg, size.x, size.y, size.z);
    geom_.reset(dCreateBox(physics.objectSpace(), size.x, size.y, size.z));
  }
  dBodySetMass(body_.get(), &mass);
  dGeomSetBody(geom_.get(), body_.get());
  dGeomSetCategoryBits(geom_.get(), kObjectGeom);
  Physics::nameGeom(geom_.get(), name_);
  setPose(body_.get(), pose);
}

}  // namespace kr3::sim
