#include "texts.hpp"

#include <algorithm>
#include <cstddef>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

/// The length of the UTF-8 character that begins at `at`, 0 if none does (RFC 3629, section 4).
std::size_t characterLength(const std::string& text, std::size_t at)
{
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned first = byte(at);
  if (first < 0x80)
  {
    return 1;
  }
  const std::size_t length = first >= 0xC2 && first <= 0xDF   ? 2
                             : first >= 0xE0 && first <= 0xEF ? 3
                             : first >= 0xF0 && first <= 0xF4 ? 4
                                                              : 0;
  for (std::size_t i = 1; i < length; ++i)
  {
    if ((byte(at + i) & 0xC0U) != 0x80U)
    {
      return 0;
    }
  }
  const unsigned second = byte(at + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || beyond ? 0 : length;
}

}  // namespace

const std::string& checkedText(const std::string& text, const std::string& what)
{
  constexpr std::size_t kMaxSize = 4096;
  if (text.size() > kMaxSize)
  {
    throw InvalidArgument("found a " + what + " of " + std::to_string(text.size()) +
                          " bytes, expected at most " + std::to_string(kMaxSize));
  }
  if (text.find('\0') != std::string::npos)
  {
    throw InvalidArgument("found a NUL byte in a " + what +
                          ", expected a text: " + printable(text));
  }
  return text;
}

std::string printable(const std::string& text, std::size_t max_size)
{
  constexpr const char* kDigits = "0123456789abcdef";
  std::string result;
  for (std::size_t i = 0; i < text.size();)
  {
    if (result.size() >= max_size)
    {
      return result + " ...";
    }
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = characterLength(text, i);
    if (length == 0 || (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F)
    {
      result += std::string("\\x") + kDigits[byte / 16] + kDigits[byte % 16];
      ++i;
      continue;
    }
    result.append(text, i, length);
    i += length;
  }
  return result;
}

std::string jsonOf(const ReasonerOptions& options)
{
  return std::string("{\"diagnose_exogenous\": ") +
         (options.diagnose_exogenous ? "true" : "false") +
         ", \"exception_weight\": " + std::to_string(options.exception_weight) +
         ", \"exogenous_weight\": " + std::to_string(options.exogenous_weight) +
         ", \"max_combinations\": " + std::to_string(options.max_combinations) +
         ", \"window\": " + std::to_string(options.window) + "}";
}

}  // namespace kr3::reasoner
