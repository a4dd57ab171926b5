#pragma once

#include <fstream>
#include <functional>
#include <iosfwd>
#include <string>

#include <CLI/CLI.hpp>

namespace kr3::pomdp::tool
{

/// What the footer of --help says of exit codes.
extern const char* const kExitCodes;

/// Parses the command line, runs the tool and tells errors on stderr.
/// @return the exit code: 0 done, 1 an error in a file or a value, 2 wrong usage, 3 a limit of
///         memory or size
int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

/// A file that is opened at once, so that what cannot be written is known before the work, and
/// that takes the place of an older one only when it is complete.
class OutputFile
{
public:
  /// @param path  "-" is the standard output
  /// @throws Unavailable  it cannot be opened
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  [[nodiscard]] std::ostream& stream();
  /// @throws Unavailable  not everything could be written
  void finish();

private:
  std::string path_;
  std::string written_path_;  // until it is finished; `path_` for what is no plain file
  std::ofstream file_;
  bool finished_ = false;
};

}  // namespace kr3::pomdp::tool
