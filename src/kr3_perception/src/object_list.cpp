#include "kr3_perception/object_list.hpp"

#include <algorithm>
#include <set>

#include <yaml-cpp/yaml.h>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

ObjectDescription fromYaml(const YAML::Node& node)
{
  ObjectDescription object;
  object.name = node["name"].as<std::string>();
  object.class_name = node["class"].as<std::string>();
  const std::string shape = node["shape"].as<std::string>();
  const std::vector<double> size = node["size"].as<std::vector<double>>();
  if (shape == "box" && size.size() == 3)  // depth, width, height
    object.width_m = std::max(size[0], size[1]);
  else if (shape == "cylinder" && size.size() == 2)  // diameter, height
    object.width_m = size[0];
  else
    throw InvalidArgument("object '" + object.name + "' is a " + shape + " with " +
                          std::to_string(size.size()) +
                          " sizes, expected a box with 3 or a cylinder with 2");
  object.height_m = size.back();
  if (!(object.width_m > 0.0 && object.height_m > 0.0))
    throw InvalidArgument("object '" + object.name + "' has no positive size");
  return object;
}

}  // namespace

std::vector<ObjectDescription> loadObjectList(const std::string& path)
{
  YAML::Node root;
  try
  {
    root = YAML::LoadFile(path);
  }
  catch (const YAML::BadFile&)
  {
    throw Unavailable("cannot read objects file '" + path + "'");
  }
  catch (const YAML::Exception& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
  if (!root.IsMap() || !root["objects"] || !root["objects"].IsSequence())
    throw InvalidArgument(path + ": expected a list named 'objects'");
  std::vector<ObjectDescription> objects;
  for (const YAML::Node& node : root["objects"])
  {
    try
    {
      objects.push_back(fromYaml(node));
    }
    catch (const YAML::Exception& e)
    {
      throw InvalidArgument(path + ": object " + std::to_string(objects.size()) +
                            " needs name, class, shape and size: " + e.what());
    }
    catch (const InvalidArgument& e)
    {
      throw InvalidArgument(path + ": " + e.what());
    }
  }
  return objects;
}

std::vector<ObjectDescription> objectsOf(const std::vector<LabelledFolder>& folders)
{
  std::set<std::string> names;
  for (const LabelledFolder& folder : folders)
    for (std::size_t i = 0; i < folder.size(); ++i)
      for (const Label& label : folder.labels(i))
        names.insert(label.name);
  std::vector<ObjectDescription> objects;
  for (const std::string& name : names)
    objects.push_back({name, name, 0.0, 0.0, 1});
  return objects;
}

}  // namespace kr3::perception
