#include "file_text.hpp"

#include <algorithm>
#include <fstream>
#include <istream>
#include <iterator>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

std::string readAll(std::istream& in, const std::string& name)
{
  std::string text;
  try
  {
    text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  catch (const std::ios_base::failure&)  // of a directory, say
  {
    in.setstate(std::ios_base::badbit);
  }
  if (in.bad())
  {
    throw Unavailable("cannot read '" + name + "'");
  }
  return text;
}

std::string readFile(const std::string& path)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  return readAll(in, path);
}

bool looksLikeXml(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string::npos && text[first] == '<';
}

std::string placeIn(const std::string& text, std::size_t offset, const std::string& name)
{
  offset = std::min(offset, text.size());
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(offset);
  const auto line = 1 + std::count(text.begin(), end, '\n');
  const std::size_t before = offset == 0 ? std::string::npos : text.rfind('\n', offset - 1);
  const std::size_t column = before == std::string::npos ? offset + 1 : offset - before;
  return name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

}  // namespace kr3::pomdp
