#pragma once

#include <set>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace kr3::executive
{

/// The text of a file. @throws Unavailable  it cannot be read
[[nodiscard]] std::string readTextFile(const std::string& path);

/// "; did you mean 'x'?" with the known name nearest to one that is not, or nothing.
[[nodiscard]] std::string suggestion(const std::string& name,
                                     const std::vector<std::string>& known);

/// A YAML document that is read to the end and reports all its problems at once.
class YamlReader
{
public:
  /// @throws InvalidArgument  not YAML, or no map at the top
  YamlReader(const std::string& text, std::string file);

  [[nodiscard]] const YAML::Node& root() const { return root_; }

  /// Notes "file:line: message" for the place of a node.
  void problem(const YAML::Node& node, const std::string& message);
  void checkKeys(const YAML::Node& map, const std::set<std::string>& known);

  /// Scalars of a map; a missing or mistyped one is a problem.
  [[nodiscard]] std::string text(const YAML::Node& map, const std::string& key);
  [[nodiscard]] std::string optionalText(const YAML::Node& map, const std::string& key);
  [[nodiscard]] double number(const YAML::Node& map, const std::string& key, double fallback);
  [[nodiscard]] bool truth(const YAML::Node& map, const std::string& key, bool fallback);
  /// A list of scalars; empty when the node is missing.
  [[nodiscard]] std::vector<std::string> texts(const YAML::Node& list);

  /// @throws InvalidArgument  with all problems, one a line
  void finish() const;

private:
  std::string file_;
  YAML::Node root_;
  std::vector<std::string> problems_;
};

}  // namespace kr3::executive
