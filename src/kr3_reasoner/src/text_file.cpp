#include "text_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

std::string readTextFile(const std::string& path)
{
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
