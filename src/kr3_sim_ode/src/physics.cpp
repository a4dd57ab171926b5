#include "physics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace kr3::sim
{

namespace
{
constexpr double kGravity = -9.81;          // m/s^2
constexpr double kFriction = 0.9;           // of all but the casters
constexpr double kSameContactPeriod = 0.5;  // s
constexpr int kMaxContacts = 8;             // per pair of geoms
constexpr int kSolverIterations = 30;

/// ODE's own set-up, once per process and thread.
void initializeOde()
{
  struct Library
  {
    Library() { dInitODE2(0); }
    ~Library() { dCloseODE(); }
  };
  static const Library library;
  dAllocateODEDataForThread(dAllocateMaskAll);
}

WorldHandle makeWorld()
{
  initializeOde();
  WorldHandle world(dWorldCreate());
  dWorldSetGravity(world.get(), 0.0, 0.0, kGravity);
  dWorldSetERP(world.get(), 0.2);
  dWorldSetCFM(world.get(), 1e-5);
  dWorldSetContactSurfaceLayer(world.get(), 0.001);
  dWorldSetQuickStepNumIterations(world.get(), kSolverIterations);
  // Objects at rest cost nothing.
  dWorldSetAutoDisableFlag(world.get(), 1);
  dWorldSetAutoDisableTime(world.get(), 0.2);
  dWorldSetAutoDisableLinearThreshold(world.get(), 0.02);
  dWorldSetAutoDisableAngularThreshold(world.get(), 0.05);
  return world;
}

SpaceHandle makeStaticSpace(const Building& building)
{
  const Rectangle all = building.extent();
  const dVector3 center = {(all.x0 + all.x1) / 2.0, (all.y0 + all.y1) / 2.0, 1.0};
  const dVector3 extents = {(all.x1 - all.x0) / 2.0 + 1.0, (all.y1 - all.y0) / 2.0 + 1.0, 2.0};
  SpaceHandle space(dQuadTreeSpaceCreate(nullptr, center, extents, 5));
  dSpaceSetCleanup(space.get(), 0);  // every geom has its own handle
  return space;
}

SpaceHandle makeSimpleSpace()
{
  SpaceHandle space(dSimpleSpaceCreate(nullptr));
  dSpaceSetCleanup(space.get(), 0);
  return space;
}

GeomHandle makeBox(dSpaceID space, const Box& box)
{
  GeomHandle geom(dCreateBox(space, box.size.x, box.size.y, box.size.z));
  dGeomSetPosition(geom.get(), box.center.x, box.center.y, box.center.z);
  dMatrix3 rotation;
  dRFromAxisAndAngle(rotation, 0.0, 0.0, 1.0, box.yaw);
  dGeomSetRotation(geom.get(), rotation);
  dGeomSetCategoryBits(geom.get(), kStaticGeom);
  return geom;
}

const std::string kWallName = "wall";
const std::string kFloorName = "floor";

const std::string& nameOf(dGeomID geom)
{
  return *static_cast<const std::string*>(dGeomGetData(geom));
}

bool isMoving(dBodyID body)
{
  return body != nullptr && dBodyIsEnabled(body) != 0;
}

bool isRobot(dGeomID geom)
{
  return (dGeomGetCategoryBits(geom) & (kRobotGeom | kCasterGeom)) != 0;
}
}  // namespace

Physics::Physics(const Building& building, std::uint64_t seed, double time_step_s)
  : time_step_s_(time_step_s)
  , random_state_(static_cast<unsigned long>(seed))
  , world_(makeWorld())
  , contacts_(dJointGroupCreate(0))
  , statics_(makeStaticSpace(building))
  , objects_(makeSimpleSpace())
  , robot_(makeSimpleSpace())
  , floor_(dCreatePlane(nullptr, 0.0, 0.0, 1.0, 0.0))
  , ray_(dCreateRay(nullptr, 1.0))
{
  dGeomSetCategoryBits(floor_.get(), kFloorGeom);
  nameGeom(floor_.get(), kFloorName);
  dGeomRaySetClosestHit(ray_.get(), 1);
  for (const Box& wall : wallsOf(building))
  {
    boxes_.push_back(makeBox(statics_.get(), wall));
    nameGeom(boxes_.back().get(), kWallName);
  }
  for (const Furniture& furniture : building.furniture)
  {
    boxes_.push_back(makeBox(statics_.get(), furniture.box()));
    names_.push_back(furniture.name);
    nameGeom(boxes_.back().get(), names_.back());
  }
}

void Physics::step()
{
  const unsigned long outer_state = dRandGetSeed();
  dRandSetSeed(random_state_);
  dSpaceCollide2(geomOf(robot_), geomOf(statics_), this, onNear);
  dSpaceCollide2(geomOf(robot_), geomOf(objects_), this, onNear);
  dSpaceCollide2(geomOf(robot_), floor_.get(), this, onNear);
  dSpaceCollide2(geomOf(objects_), geomOf(statics_), this, onNear);
  dSpaceCollide2(geomOf(objects_), floor_.get(), this, onNear);
  dSpaceCollide(objects_.get(), this, onNear);
  dWorldQuickStep(world_.get(), time_step_s_);
  sumContacts();
  dJointGroupEmpty(contacts_.get());
  random_state_ = dRandGetSeed();
  dRandSetSeed(outer_state);
  ++steps_;
}

void Physics::onNear(void* self, dGeomID a, dGeomID b)
{
  if (dGeomIsSpace(a) != 0 || dGeomIsSpace(b) != 0)
  {
    dSpaceCollide2(a, b, self, onNear);
    return;
  }
  static_cast<Physics*>(self)->collide(a, b);
}

void Physics::collide(dGeomID a, dGeomID b)
{
  dBodyID body_a = dGeomGetBody(a);
  dBodyID body_b = dGeomGetBody(b);
  const bool joined = body_a != nullptr && body_b != nullptr &&
                      dAreConnectedExcluding(body_a, body_b, dJointTypeContact) != 0;
  if (body_a == body_b || joined || (!isMoving(body_a) && !isMoving(body_b)))
  {
    return;
  }
  std::array<dContact, kMaxContacts> contacts{};
  const int count = dCollide(a, b, kMaxContacts, &contacts[0].geom, sizeof(dContact));
  const unsigned long categories = dGeomGetCategoryBits(a) | dGeomGetCategoryBits(b);
  if (count > 0 && (categories & kFloorGeom) == 0 && isRobot(a) != isRobot(b))
  {
    noteRobotContact(isRobot(a) ? b : a);
  }
  for (int i = 0; i < count; ++i)
  {
    dContact& contact = contacts.at(static_cast<std::size_t>(i));
    contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
    contact.surface.mu = (categories & kCasterGeom) != 0 ? 0.0 : kFriction;
    contact.surface.soft_erp = 0.3;
    contact.surface.soft_cfm = 1e-5;
    dJointID joint = dJointCreateContact(world_.get(), contacts_.get(), &contact);
    dJointAttach(joint, body_a, body_b);
    if ((categories & kFloorGeom) == 0 || (categories & kObjectGeom) != 0)
    {
      noteContact(a, b, contact.geom, joint);
    }
  }
}

void Physics::noteContact(dGeomID a, dGeomID b, const dContactGeom& contact, dJointID joint)
{
  PendingContact& pending = pending_contacts_.emplace_back();
  pending.name_a = &nameOf(a);
  pending.name_b = &nameOf(b);
  pending.contact = contact;
  dJointSetFeedback(joint, &pending.feedback);
}

void Physics::sumContacts()
{
  for (const PendingContact& pending : pending_contacts_)
  {
    const bool in_order = *pending.name_a <= *pending.name_b;
    const std::string& first = in_order ? *pending.name_a : *pending.name_b;
    const std::string& second = in_order ? *pending.name_b : *pending.name_a;
    ContactReport& report = contact_reports_[{first, second}];
    const dContactGeom& contact = pending.contact;
    if (report.body_a.empty() || contact.depth > report.depth_m)
    {
      const double sign = in_order ? 1.0 : -1.0;
      report.body_a = first;
      report.body_b = second;
      report.depth_m = contact.depth;
      report.position = {contact.pos[0], contact.pos[1], contact.pos[2]};
      report.normal = {sign * contact.normal[0], sign * contact.normal[1],
                       sign * contact.normal[2]};
    }
    // The same force, once on either body; one of the two may be the world.
    const auto magnitude = [](const dReal* f) { return std::hypot(f[0], f[1], f[2]); };
    report.impulse_ns +=
        time_step_s_ * std::max(magnitude(pending.feedback.f1), magnitude(pending.feedback.f2));
  }
  pending_contacts_.clear();
}

std::vector<ContactReport> Physics::takeContacts()
{
  std::vector<ContactReport> reports;
  for (auto& [bodies, report] : contact_reports_)
  {
    reports.push_back(std::move(report));
  }
  contact_reports_.clear();
  return reports;
}

void Physics::nameGeom(dGeomID geom, const std::string& name)
{
  dGeomSetData(geom, const_cast<std::string*>(&name));  // read back as constant
}

std::string Physics::penetrated(dGeomID probe, double tolerance_m, dBodyID except,
                                bool with_robot) const
{
  struct Search
  {
    double tolerance_m;
    dBodyID except;
    std::string found;
  } search{tolerance_m, except, {}};
  const auto look = [](void* data, dGeomID a, dGeomID b) {
    auto& current = *static_cast<Search*>(data);
    constexpr int kCount = 8;
    std::array<dContactGeom, kCount> contacts{};
    dGeomID other = dGeomGetData(b) == nullptr ? a : b;  // the probe has no name
    dBodyID body = dGeomGetBody(other);
    if (body != nullptr && body == current.except)
    {
      return;
    }
    const int count = dCollide(a, b, kCount, contacts.data(), sizeof(dContactGeom));
    for (int i = 0; i < count; ++i)
    {
      if (contacts.at(static_cast<std::size_t>(i)).depth > current.tolerance_m)
      {
        current.found = nameOf(other);
      }
    }
  };
  dSpaceCollide2(probe, geomOf(statics_), &search, look);
  dSpaceCollide2(probe, geomOf(objects_), &search, look);
  dSpaceCollide2(probe, floor_.get(), &search, look);
  if (with_robot)
  {
    dSpaceCollide2(probe, geomOf(robot_), &search, look);
  }
  return search.found;
}

void Physics::noteRobotContact(dGeomID other)
{
  const auto same_steps = static_cast<std::uint64_t>(kSameContactPeriod / time_step_s_);
  const auto [entry, is_new] = last_robot_contact_.emplace(other, steps_);
  if (is_new || steps_ - entry->second > same_steps)
  {
    ++robot_contacts_;
  }
  entry->second = steps_;
}

double Physics::castRay(const Vector3& origin, const Vector3& direction, double max_range_m,
                        bool with_objects) const
{
  double nearest = max_range_m;
  const auto keepNearest = [](void* data, dGeomID a, dGeomID b) {
    dContactGeom contact;
    auto& nearest_so_far = *static_cast<double*>(data);
    if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0)
    {
      nearest_so_far = std::min(nearest_so_far, static_cast<double>(contact.depth));
    }
  };
  dGeomRaySetLength(ray_.get(), max_range_m);
  dGeomRaySet(ray_.get(), origin.x, origin.y, origin.z, direction.x, direction.y, direction.z);
  dSpaceCollide2(ray_.get(), geomOf(statics_), &nearest, keepNearest);
  if (with_objects)
  {
    dSpaceCollide2(ray_.get(), geomOf(objects_), &nearest, keepNearest);
  }
  return nearest;
}

std::vector<dGeomID> Physics::solids() const
{
  std::vector<dGeomID> geoms;
  for (const GeomHandle& box : boxes_)
  {
    geoms.push_back(box.get());
  }
  for (int i = 0; i < dSpaceGetNumGeoms(objects_.get()); ++i)
  {
    geoms.push_back(dSpaceGetGeom(objects_.get(), i));
  }
  return geoms;
}

void setPose(dBodyID body, const Pose& pose)
{
  const dQuaternion q = {pose.orientation.w, pose.orientation.x, pose.orientation.y,
                         pose.orientation.z};
  dBodySetPosition(body, pose.position.x, pose.position.y, pose.position.z);
  dBodySetQuaternion(body, q);
  dBodySetLinearVel(body, 0.0, 0.0, 0.0);
  dBodySetAngularVel(body, 0.0, 0.0, 0.0);
  dBodyEnable(body);
}

Pose poseOf(dBodyID body)
{
  const dReal* const p = dBodyGetPosition(body);
  const dReal* const q = dBodyGetQuaternion(body);
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

}  // namespace kr3::sim
