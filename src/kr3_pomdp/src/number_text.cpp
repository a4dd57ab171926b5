#include "number_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace kr3::pomdp
{

std::string exactText(double value)
{
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof(text), value);
  return {text, end.ptr};
}

std::optional<double> finiteNumber(std::string_view text)
{
  if (text.size() > 1 && text.front() == '+' && text[1] != '-')
  {
    text.remove_prefix(1);
  }
  double value = 0.0;
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ptr != text.data() + text.size() || text.empty())
  {
    return std::nullopt;
  }
  if (end.ec == std::errc::result_out_of_range)  // too small is 0, too large is no number
  {
    value = std::strtod(std::string(text).c_str(), nullptr);
  }
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<std::size_t> indexNumber(std::string_view text)
{
  std::size_t value = 0;
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end.ec == std::errc() && end.ptr == text.data() + text.size();
  return whole && !text.empty() ? std::optional(value) : std::nullopt;
}

}  // namespace kr3::pomdp
