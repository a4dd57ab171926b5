#pragma once

#include <set>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace kr3::sim
{

/// A YAML file whose errors name the file and the line.
class YamlReader
{
public:
  /// @throws Unavailable      the file cannot be read
  /// @throws InvalidArgument  it is not YAML
  explicit YamlReader(const std::string& path);

  [[nodiscard]] const YAML::Node& root() const { return root_; }

  /// @throws InvalidArgument  "FILE:LINE: message", always
  [[noreturn]] void fail(const YAML::Node& node, const std::string& message) const;

  /// @throws InvalidArgument  `node` is no map, or has a key that is not in `keys`
  void checkMap(const YAML::Node& node, const std::string& what,
                const std::set<std::string>& keys) const;

  /// The value of a key that must be there. @throws InvalidArgument  it is missing or of another
  /// type
  [[nodiscard]] YAML::Node child(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] YAML::Node list(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] std::string text(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] double positive(const YAML::Node& map, const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const YAML::Node& map, const std::string& key,
                                            std::size_t count) const;

  /// A file name, relative to this file. @throws InvalidArgument  there is no such file
  [[nodiscard]] std::string file(const YAML::Node& map, const std::string& key) const;

private:
  std::string path_;
  YAML::Node root_;
};

/// "a, b, c", for messages.
[[nodiscard]] std::string joined(const std::vector<std::string>& names);

}  // namespace kr3::sim
