#pragma once

#include <string>

#include "kr3_sim_ode/object_model.hpp"
#include "physics.hpp"

namespace kr3::sim
{

/// A movable object as an ODE body.
class ObjectBody
{
public:
  ObjectBody(Physics& physics, std::string name, const ObjectModel& model, const Pose& pose);
  ObjectBody(const ObjectBody&) = delete;  // its geom refers to its name
  ObjectBody& operator=(const ObjectBody&) = delete;

  /// With zero velocity.
  void moveTo(const Pose& pose) { setPose(body_.get(), pose); }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const ObjectModel& model() const { return model_; }
  [[nodiscard]] dBodyID body() const { return body_.get(); }
  [[nodiscard]] dGeomID geom() const { return geom_.get(); }
  [[nodiscard]] Pose pose() const { return poseOf(body_.get()); }

private:
  std::string name_;
  ObjectModel model_;
  BodyHandle body_;
  GeomHandle geom_;
};

}  // namespace kr3::sim
