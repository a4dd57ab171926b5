#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

inline std::string readText(const std::string& path)
{
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// What a call throws, or "nothing".
template <typename Call>
std::string errorOf(Call&& call)
{
  try
  {
    call();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return "nothing";
}

}  // namespace kr3::reasoner
