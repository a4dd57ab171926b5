// What libFuzzer runs: each reader must refuse any bytes with a message or take them, and what it
// took must be written as text that is read again as the same.

#include <cstddef>
#include <cstdint>
#include <string>

#include "read_anything.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  kr3::pomdp::readAnything(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
