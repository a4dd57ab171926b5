#pragma once

#include <string>
#include <vector>

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

enum class Shape
{
  kBox,
  kCylinder,  ///< upright, axis z
};

/// What an object looks and weighs like. Its frame is in its centre, z up, its front (cover) faces
/// +x.
struct ObjectModel
{
  std::string name;
  std::string class_name;
  Shape shape = Shape::kBox;
  Vector3 size;  ///< full size; of a cylinder: diameter, diameter, height
  double mass_kg = 1.0;
  std::string texture;  ///< path of a PNG

  /// Radius of the circle around its footprint.
  [[nodiscard]] double footprintRadius() const;
};

/// Reads and checks an objects file (README, "objects.yaml").
///
/// @throws Unavailable      the file cannot be opened
/// @throws InvalidArgument  "FILE:LINE: what was found, what was expected"
[[nodiscard]] std::vector<ObjectModel> loadObjectModels(const std::string& path);

/// @throws NotFound  no such model; the message lists those that exist
[[nodiscard]] const ObjectModel& findModel(const std::vector<ObjectModel>& models,
                                           const std::string& name);

}  // namespace kr3::sim
