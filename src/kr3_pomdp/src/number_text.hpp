#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kr3::pomdp
{

/// The shortest text that reads back as exactly this number, whatever the locale.
[[nodiscard]] std::string exactText(double value);

/// The number that is the whole of a text; none for anything else, infinite numbers too.
[[nodiscard]] std::optional<double> finiteNumber(std::string_view text);

/// The index that is the whole of a text, decimal digits only; none for anything else.
[[nodiscard]] std::optional<std::size_t> indexNumber(std::string_view text);

}  // namespace kr3::pomdp
