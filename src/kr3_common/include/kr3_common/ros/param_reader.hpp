#pragma once

#include <set>
#include <string>
#include <vector>

#include <ros/node_handle.h>

namespace kr3
{

/// Reads a node's private parameters and reports everything wrong with them at once: missing,
/// mistyped, out of range, and unknown (misspelt, or left on the master by an earlier run).
///
/// Not thread-safe; one instance while a node starts.
class ParamReader
{
public:
  /// @param private_nh  handle on the node's private namespace ("~")
  explicit ParamReader(const ros::NodeHandle& private_nh);

  /// The value of an optional parameter; `fallback` when it is not set or has the wrong type (which
  /// is reported).
  template <typename T>
  [[nodiscard]] T get(const std::string& name, const T& fallback);

  /// The value of a parameter that has no default; a default-constructed T when it is missing
  /// (which is reported).
  template <typename T>
  [[nodiscard]] T require(const std::string& name);

  /// Reports `name` with `expectation` ("must be in (0, 1)") unless `ok`.
  void check(bool ok, const std::string& name, const std::string& expectation);

  /// @throws InvalidArgument  listing every problem found, unknown parameters included
  void finish() const;

private:
  ros::NodeHandle nh_;
  std::set<std::string> known_;
  std::vector<std::string> problems_;
};

}  // namespace kr3
