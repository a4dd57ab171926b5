#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "problems.hpp"

namespace kr3::refinement
{

/// A YAML file that is read to its end: every problem is noted with its line, none stops it.
class YamlFile
{
public:
  /// @param name  of the file, for messages
  /// @throws InvalidArgument  the text is no YAML
  YamlFile(const std::string& text, std::string name);

  [[nodiscard]] const YAML::Node& root() const { return root_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// The line of a node, from 1; of one that is not there, 1.
  [[nodiscard]] static int line(const YAML::Node& node);

  void report(const YAML::Node& node, const std::string& message);
  [[nodiscard]] Problems& problems() { return problems_; }

  /// Checks that a node is a map with known keys, each of them once.
  /// @param what  what the node describes, for messages
  /// @return false when it is no map
  bool checkMap(const YAML::Node& node, const std::string& what,
                const std::vector<std::string>& keys);

  /// The entry of a map; an undefined node when it is not there or `map` is no map.
  [[nodiscard]] static YAML::Node entry(const YAML::Node& map, const std::string& key);

  /// What is written in a scalar; "no text" and the like otherwise, for messages.
  [[nodiscard]] static std::string shown(const YAML::Node& node);

  /// A finite number of a map between `least` and `most`; `fallback` where it is missing or wrong.
  double number(const YAML::Node& map, const std::string& key, double fallback, double least,
                double most);

  /// A finite number; nothing, and a report, when it is not one.
  std::optional<double> finite(const YAML::Node& node, const std::string& what);

  /// A whole number from 0 on; nothing, and a report, when it is not one.
  std::optional<std::uint64_t> count(const YAML::Node& node, const std::string& what);

private:
  std::string name_;
  YAML::Node root_;
  Problems problems_;
};

/// The text of a file. @throws Unavailable  it cannot be read
[[nodiscard]] std::string fileText(const std::string& path);

}  // namespace kr3::refinement
