#include "yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/nearest_name.hpp>

namespace kr3::executive
{

std::string readTextFile(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf()))
    throw Unavailable("cannot read '" + path + "'");
  return text.str();
}

std::string suggestion(const std::string& name, const std::vector<std::string>& known)
{
  const std::size_t limit = std::max<std::size_t>(2, name.size() / 3);
  const std::string* nearest =
      name.empty() ? nullptr : nearestName(name, known, std::min(limit, name.size() - 1));
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

YamlReader::YamlReader(const std::string& text, std::string file) : file_(std::move(file))
{
  try
  {
    root_ = YAML::Load(text);
  }
  catch (const YAML::Exception& e)
  {
    throw InvalidArgument(file_ + ":" + std::to_string(e.mark.line + 1) + ": " + e.msg);
  }
  if (!root_.IsMap())
    throw InvalidArgument(file_ + ":1: no map, expected keys and values");
}

void YamlReader::problem(const YAML::Node& node, const std::string& message)
{
  // A node that is not there has no place of its own.
  const int line = node.IsDefined() && !node.Mark().is_null() ? node.Mark().line + 1 : 1;
  problems_.push_back(file_ + ":" + std::to_string(line) + ": " + message);
}

void YamlReader::checkKeys(const YAML::Node& map, const std::set<std::string>& known)
{
  if (!map.IsMap())
  {
    problem(map, "expected a map");
    return;
  }
  std::set<std::string> seen;
  for (const auto& entry : map)
  {
    if (!entry.first.IsScalar())
    {
      problem(entry.first, "found a key that is no text");
      continue;
    }
    const std::string& key = entry.first.Scalar();
    if (known.count(key) == 0)
      problem(entry.first,
              "unknown key '" + key + "'" + suggestion(key, {known.begin(), known.end()}));
    if (!seen.insert(key).second)
      problem(entry.first, "key '" + key + "' a second time; leave one of them");
  }
}

std::string YamlReader::text(const YAML::Node& map, const std::string& key)
{
  if (!map.IsMap() || !map[key])
  {
    problem(map, "no '" + key + "'");
    return {};
  }
  return optionalText(map, key);
}

std::string YamlReader::optionalText(const YAML::Node& map, const std::string& key)
{
  if (!map.IsMap() || !map[key])
    return {};
  if (map[key].IsScalar())
    return map[key].as<std::string>();
  problem(map[key], "'" + key + "' is no text");
  return {};
}

double YamlReader::number(const YAML::Node& map, const std::string& key, double fallback)
{
  if (!map.IsMap() || !map[key])
    return fallback;
  double value = fallback;
  if (!map[key].IsScalar() || !YAML::convert<double>::decode(map[key], value) ||
      !std::isfinite(value))
  {
    problem(map[key], "'" + key + "' is no number");
    return fallback;
  }
  return value;
}

bool YamlReader::truth(const YAML::Node& map, const std::string& key, bool fallback)
{
  if (!map.IsMap() || !map[key])
    return fallback;
  bool value = fallback;
  if (!map[key].IsScalar() || !YAML::convert<bool>::decode(map[key], value))
    problem(map[key], "'" + key + "' is neither true nor false");
  return value;
}

std::vector<std::string> YamlReader::texts(const YAML::Node& list)
{
  std::vector<std::string> items;
  if (!list.IsDefined())
    return items;
  if (!list.IsSequence())
  {
    problem(list, "expected a list");
    return items;
  }
  for (const auto& item : list)
  {
    if (item.IsScalar())
      items.push_back(item.as<std::string>());
    else
      problem(item, "expected a text");
  }
  return items;
}

void YamlReader::finish() const
{
  if (problems_.empty())
    return;
  std::string message;
  for (const auto& problem : problems_)
    message += (message.empty() ? "" : "\n") + problem;
  throw InvalidArgument(message);
}

}  // namespace kr3::executive
