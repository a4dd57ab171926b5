#include "yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
bool isUtf8(const std::string& text)
{
  try
  {
    (void)nlohmann::json(text).dump();
    return true;
  }
  catch (const nlohmann::json::type_error&)
  {
    return false;
  }
}

YAML::Node parsed(const std::string& path)
{
  try
  {
    return YAML::LoadFile(path);
  }
  catch (const YAML::BadFile&)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  catch (const YAML::Exception& e)
  {
    throw InvalidArgument(path + ":" + std::to_string(std::max(e.mark.line, 0) + 1) + ": " + e.msg);
  }
}
}  // namespace

YamlReader::YamlReader(const std::string& path) : path_(path), root_(parsed(path)) {}

void YamlReader::fail(const YAML::Node& node, const std::string& message) const
{
  throw InvalidArgument(path_ + ":" + std::to_string(std::max(node.Mark().line, 0) + 1) + ": " +
                        message);
}

void YamlReader::checkMap(const YAML::Node& node, const std::string& what,
                          const std::set<std::string>& keys) const
{
  const std::string expected = joined({keys.begin(), keys.end()});
  if (!node.IsMap())
  {
    fail(node, what + " must be a map with the keys " + expected);
  }
  std::set<std::string> seen;
  for (const auto& entry : node)
  {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)";
    if (keys.count(key) == 0)
    {
      fail(entry.first, "unknown key '" + key + "' in " + what + ", expected one of: " + expected);
    }
    if (!seen.insert(key).second)
    {
      fail(entry.first, "key '" + key + "' twice in " + what);
    }
  }
}

YAML::Node YamlReader::child(const YAML::Node& map, const std::string& key) const
{
  const YAML::Node node = map[key];
  if (!node)
  {
    fail(map, "key '" + key + "' is missing");
  }
  return node;
}

YAML::Node YamlReader::list(const YAML::Node& map, const std::string& key) const
{
  const YAML::Node node = child(map, key);
  if (!node.IsSequence())
  {
    fail(node, "'" + key + "' must be a list");
  }
  return node;
}

std::string YamlReader::text(const YAML::Node& map, const std::string& key) const
{
  const YAML::Node node = child(map, key);
  if (!node.IsScalar() || node.Scalar().empty())
  {
    fail(node, "'" + key + "' must be a text");
  }
  if (!isUtf8(node.Scalar()))
  {
    fail(node, "'" + key + "' must be a text in UTF-8");
  }
  return node.Scalar();
}

double YamlReader::positive(const YAML::Node& map, const std::string& key) const
{
  const YAML::Node node = child(map, key);
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value) ||
      value <= 0.0)
  {
    fail(node, "'" + key + "' must be a number above 0");
  }
  return value;
}

std::vector<double> YamlReader::numbers(const YAML::Node& map, const std::string& key,
                                        std::size_t count) const
{
  const YAML::Node node = child(map, key);
  const std::string expected =
      "'" + key + "' must be a list of " + std::to_string(count) + " numbers";
  if (!node.IsSequence() || node.size() != count)
  {
    fail(node, expected);
  }
  std::vector<double> values;
  for (const YAML::Node& item : node)
  {
    double value = 0.0;
    if (!item.IsScalar() || !YAML::convert<double>::decode(item, value) || !std::isfinite(value))
    {
      fail(item, expected);
    }
    values.push_back(value);
  }
  return values;
}

std::string YamlReader::file(const YAML::Node& map, const std::string& key) const
{
  const YAML::Node node = child(map, key);
  const std::filesystem::path path =
      std::filesystem::path(path_).parent_path() / std::filesystem::path(text(map, key));
  if (!std::filesystem::is_regular_file(path))
  {
    fail(node, "'" + key + "': there is no file '" + path.string() + "'");
  }
  return path.string();
}

std::string joined(const std::vector<std::string>& names)
{
  std::string all;
  for (const std::string& name : names)
  {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

}  // namespace kr3::sim
