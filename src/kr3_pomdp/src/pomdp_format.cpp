#include "kr3_pomdp/pomdp_format.hpp"

#include "file_text.hpp"
#include "pomdp_parser.hpp"

namespace kr3::pomdp
{

Model readPomdp(std::istream& in, const std::string& name, const ReadOptions& options)
{
  return PomdpParser(readAll(in, name), name, options).parse();
}

Model loadPomdp(const std::string& path)
{
  return PomdpParser(readFile(path), path).parse();
}

}  // namespace kr3::pomdp
