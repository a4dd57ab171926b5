#include "kr3_pomdp/pomdp_format.hpp"

#include <fstream>
#include <istream>
#include <iterator>
#include <utility>

#include <kr3_common/error.hpp>

#include "pomdp_parser.hpp"

namespace kr3::pomdp
{

Model readPomdp(std::istream& in, const std::string& name, const ReadOptions& options)
{
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return PomdpParser(std::move(text), name, options).parse();
}

Model loadPomdp(const std::string& path)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  return readPomdp(in, path);
}

}  // namespace kr3::pomdp
