// What libFuzzer runs: any bytes must be refused with a message or be understood, and what was
// understood must print as text that is understood again as the same.

#include <cstddef>
#include <cstdint>
#include <string>

#include "parse_anything.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  kr3::reasoner::parseAnything(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
