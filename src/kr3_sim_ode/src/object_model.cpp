#include "kr3_sim_ode/object_model.hpp"

#include <algorithm>
#include <cmath>

#include <kr3_common/error.hpp>

#include "yaml_reader.hpp"

namespace kr3::sim
{

namespace
{
// What ODE can compute with; it ends the process when it meets an inertia of zero.
constexpr double kSmallest = 0.001;  // m
constexpr double kLargest = 20.0;
constexpr double kLightest = 0.001;  // kg
constexpr double kHeaviest = 10000.0;
}  // namespace

double ObjectModel::footprintRadius() const
{
  return shape == Shape::kCylinder ? size.x / 2.0 : std::hypot(size.x, size.y) / 2.0;
}

std::vector<ObjectModel> loadObjectModels(const std::string& path)
{
  const YamlReader yaml(path);
  yaml.checkMap(yaml.root(), "an objects file", {"objects"});
  std::vector<ObjectModel> models;
  for (const YAML::Node& node : yaml.list(yaml.root(), "objects"))
  {
    yaml.checkMap(node, "an object", {"name", "class", "shape", "size", "mass", "texture"});
    ObjectModel model;
    model.name = yaml.text(node, "name");
    if (std::any_of(models.begin(), models.end(),
                    [&](const ObjectModel& other) { return other.name == model.name; }))
    {
      yaml.fail(node["name"], "object '" + model.name + "' twice");
    }
    model.class_name = yaml.text(node, "class");
    const std::string shape = yaml.text(node, "shape");
    if (shape != "box" && shape != "cylinder")
    {
      yaml.fail(node["shape"], "unknown shape '" + shape + "', expected box or cylinder");
    }
    model.shape = shape == "box" ? Shape::kBox : Shape::kCylinder;
    const auto size = yaml.numbers(node, "size", model.shape == Shape::kBox ? 3 : 2);
    if (*std::min_element(size.begin(), size.end()) < kSmallest ||
        *std::max_element(size.begin(), size.end()) > kLargest)
    {
      yaml.fail(node["size"], "'size' must be numbers from 0.001 to 20 m");
    }
    model.size = model.shape == Shape::kBox ? Vector3{size[0], size[1], size[2]}
                                            : Vector3{size[0], size[0], size[1]};
    model.mass_kg = yaml.positive(node, "mass");
    if (model.mass_kg < kLightest || model.mass_kg > kHeaviest)
    {
      yaml.fail(node["mass"], "'mass' must be a number from 0.001 to 10000 kg");
    }
    model.texture = yaml.file(node, "texture");
    models.push_back(model);
  }
  return models;
}

const ObjectModel& findModel(const std::vector<ObjectModel>& models, const std::string& name)
{
  std::vector<std::string> names;
  for (const ObjectModel& model : models)
  {
    if (model.name == name)
    {
      return model;
    }
    names.push_back(model.name);
  }
  throw NotFound("unknown object '" + name + "', expected one of: " + joined(names));
}

}  // namespace kr3::sim
