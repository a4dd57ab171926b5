#include "text_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <kr3_common/error.hpp>

#include "diagnostics.hpp"

namespace kr3::reasoner
{

std::string readTextFile(const std::string& path)
{
  if (path.find('\0') != std::string::npos)
  {
    throw NotFound("cannot read '" + withoutNul(path) + "': found a NUL byte in its name");
  }
  std::error_code ignored;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, ignored))
  {
    throw NotFound("cannot read '" + path + "': expected a file");
  }
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream.bad())
  {
    throw NotFound("cannot read '" + path + "' to its end");
  }
  return text;
}

}  // namespace kr3::reasoner
