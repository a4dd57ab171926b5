#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/contact.hpp"
#include "ode_handles.hpp"

namespace kr3::sim
{

/// What a geom is, as its ODE category bits.
enum GeomCategory : unsigned long
{
  kFloorGeom = 1,
  kStaticGeom = 2,
  kObjectGeom = 4,
  kRobotGeom = 8,
  kCasterGeom = 16,  ///< of the robot, without friction
};

/// The ODE world of a building: floor, walls, furniture, collision handling, rays.
///
/// Not thread-safe. Steps are repeatable: ODE's global random state is this world's own during a
/// step.
class Physics
{
public:
  Physics(const Building& building, std::uint64_t seed, double time_step_s);

  void step();

  [[nodiscard]] dWorldID world() const { return world_.get(); }
  [[nodiscard]] dSpaceID objectSpace() const { return objects_.get(); }
  [[nodiscard]] dSpaceID robotSpace() const { return robot_.get(); }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] double timeStep() const { return time_step_s_; }

  /// How often the robot came to touch a wall, a piece of furniture or an object. What touches
  /// again within half a second is the same contact.
  [[nodiscard]] std::uint32_t robotContacts() const { return robot_contacts_; }

  /// The distance from `origin` along the unit vector `direction` to the first wall, furniture or
  /// (on request) object; `max_range_m` when there is none.
  [[nodiscard]] double castRay(const Vector3& origin, const Vector3& direction, double max_range_m,
                               bool with_objects) const;

  /// What touched since the last call, by the names of the bodies; the robot's wheels on the floor
  /// and what rests without moving are left out.
  [[nodiscard]] std::vector<ContactReport> takeContacts();

  /// Says in contacts whose geom it is. @param name  outlives the geom
  static void nameGeom(dGeomID geom, const std::string& name);

  /// The name of something solid, or of the floor, into which `probe` reaches deeper than
  /// `tolerance_m`; geoms of `except` are left out. Empty: nothing.
  [[nodiscard]] std::string penetrated(dGeomID probe, double tolerance_m, dBodyID except,
                                       bool with_robot) const;

  /// The geoms of walls, furniture and objects.
  [[nodiscard]] std::vector<dGeomID> solids() const;

private:
  static void onNear(void* self, dGeomID a, dGeomID b);
  void collide(dGeomID a, dGeomID b);
  void noteRobotContact(dGeomID other);
  void noteContact(dGeomID a, dGeomID b, const dContactGeom& contact, dJointID joint);
  void sumContacts();

  /// A contact joint of the step that is being computed.
  struct PendingContact
  {
    const std::string* name_a;
    const std::string* name_b;
    dContactGeom contact;
    dJointFeedback feedback;
  };

  double time_step_s_;
  unsigned long random_state_;
  std::uint64_t steps_ = 0;
  std::uint32_t robot_contacts_ = 0;
  std::map<dGeomID, std::uint64_t> last_robot_contact_;  // step
  WorldHandle world_;
  JointGroupHandle contacts_;
  SpaceHandle statics_;
  SpaceHandle objects_;
  SpaceHandle robot_;
  GeomHandle floor_;
  GeomHandle ray_;
  std::deque<std::string> names_;  // of furniture; addresses stay
  std::deque<PendingContact> pending_contacts_;
  std::map<std::pair<std::string, std::string>, ContactReport> contact_reports_;
  std::vector<GeomHandle> boxes_;
};

void setPose(dBodyID body, const Pose& pose);
[[nodiscard]] Pose poseOf(dBodyID body);

}  // namespace kr3::sim
