#include "yaml_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{

YamlFile::YamlFile(const std::string& text, std::string name) : name_(std::move(name))
{
  try
  {
    root_ = YAML::Load(text);
  }
  catch (const YAML::Exception& error)
  {
    throw InvalidArgument(name_ + ":" + std::to_string(std::max(error.mark.line, 0) + 1) +
                          ": found no YAML: " + error.msg);
  }
}

int YamlFile::line(const YAML::Node& node)
{
  const bool placed = node.IsDefined() && !node.Mark().is_null();
  return placed ? std::max(node.Mark().line, 0) + 1 : 1;
}

void YamlFile::report(const YAML::Node& node, const std::string& message)
{
  problems_.add({name_, line(node), 0}, message);
}

bool YamlFile::checkMap(const YAML::Node& node, const std::string& what,
                        const std::vector<std::string>& keys)
{
  if (!node.IsDefined() || !node.IsMap())
  {
    report(node, what + ": found " + shown(node) + ", expected a map" +
                     (keys.empty() ? std::string(" (nothing belongs in it)")
                                   : " with keys " + listed(keys)));
    return false;
  }
  std::set<std::string> seen;
  for (const auto& item : node)
  {
    if (!item.first.IsScalar())
    {
      report(item.first, what + ": found a key that is no text, expected " + listed(keys));
      continue;
    }
    const std::string& key = item.first.Scalar();
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
    {
      const std::string meant = suggestion(key, keys);
      report(item.first,
             what + ": unknown key '" + key + "', expected one of " + listed(keys) + meant);
    }
    if (!seen.insert(key).second)
    {
      report(item.first, what + ": key '" + key + "' a second time; leave one of them");
    }
  }
  return true;
}

YAML::Node YamlFile::entry(const YAML::Node& map, const std::string& key)
{
  return map.IsDefined() && map.IsMap() ? map[key] : YAML::Node(YAML::NodeType::Undefined);
}

std::string YamlFile::shown(const YAML::Node& node)
{
  if (!node.IsDefined() || node.IsNull())
  {
    return "nothing";
  }
  return node.IsScalar() ? "'" + node.Scalar() + "'" : (node.IsMap() ? "a map" : "a list");
}

double YamlFile::number(const YAML::Node& map, const std::string& key, double fallback,
                        double least, double most)
{
  const YAML::Node node = entry(map, key);
  if (!node.IsDefined())
  {
    return fallback;
  }
  double value = fallback;
  const bool is_number =
      node.IsScalar() && YAML::convert<double>::decode(node, value) && std::isfinite(value);
  if (!is_number || value < least || value > most)
  {
    std::ostringstream message;
    message << key << ": found " << shown(node) << ", expected a number from " << least << " to "
            << most;
    report(node, message.str());
    return fallback;
  }
  return value;
}

std::optional<double> YamlFile::finite(const YAML::Node& node, const std::string& what)
{
  double value = 0.0;
  if (node.IsDefined() && node.IsScalar() && YAML::convert<double>::decode(node, value) &&
      std::isfinite(value))
  {
    return value;
  }
  report(node, what + ": found " + shown(node) + ", expected a number");
  return std::nullopt;
}

std::optional<std::uint64_t> YamlFile::count(const YAML::Node& node, const std::string& what)
{
  std::uint64_t value = 0;
  if (node.IsDefined() && node.IsScalar() && node.Scalar().find('-') == std::string::npos &&
      YAML::convert<std::uint64_t>::decode(node, value))
  {
    return value;
  }
  report(node, what + ": found " + shown(node) + ", a count must be a whole number from 0 on");
  return std::nullopt;
}

std::string fileText(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open() || file.bad())
  {
    throw Unavailable("cannot read '" + path + "'");
  }
  return text.str();
}

}  // namespace kr3::refinement
