#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace kr3::pomdp
{

/// Writes the elements of a POMDPX file, one a line.
class PomdpxElements
{
public:
  /// Writes the head.
  PomdpxElements(std::ostream& out, double discount);

  void open(const char* section);
  void close(const char* section);

  void stateVariable(const std::string& previous, const std::string& current, bool observed,
                     const std::vector<std::string>& values);
  /// @param kind  ActionVar or ObsVar
  void variable(const char* kind, const std::string& name, const std::vector<std::string>& values);
  void rewardVariable(const std::string& name);

  /// A table; entries follow.
  void openTable(bool reward, const std::vector<std::string>& of,
                 const std::vector<std::string>& parents);
  void entry(const std::string& instance, const std::vector<double>& numbers);
  void closeTable();

  void end();

private:
  void values(const std::vector<std::string>& values);

  std::ostream& out_;
  bool reward_ = false;  // of the open table
};

/// Names of values as they stand in instances.
/// @throws InvalidArgument  a name that the format cannot hold
[[nodiscard]] std::vector<std::string> pomdpxNames(const std::vector<std::string>& names);

}  // namespace kr3::pomdp
