#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace kr3::test_support
{

/// A new empty folder below the system's temporary one, removed with everything in it at the end.
class TemporaryFolder
{
public:
  TemporaryFolder()
  {
    if (mkdtemp(path_.data()) == nullptr)
      throw std::runtime_error("cannot make a temporary folder");
  }
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

private:
  std::string path_ = (std::filesystem::temp_directory_path() / "kr3_XXXXXX").string();
};

}  // namespace kr3::test_support
