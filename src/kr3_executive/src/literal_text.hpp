#pragma once

#include <string>
#include <vector>

namespace kr3::executive
{

/// A ground literal or action taken apart: `loc(tb1) = office`, `-in_hand(rob1, tb1)`.
struct LiteralText
{
  std::string symbol;
  std::vector<std::string> arguments;
  std::string value;  ///< "true" or "false" for a boolean one
  bool equal = true;

  /// "loc(tb1)"
  [[nodiscard]] std::string fluent() const;
  [[nodiscard]] bool isBoolean() const { return value == "true" || value == "false"; }
};

/// @param text  well-formed, as the language prints it
[[nodiscard]] LiteralText takeApart(const std::string& text);

/// Whether a term is a variable of the language: it begins with a capital letter.
[[nodiscard]] bool isVariable(const std::string& term);

/// "a, b and c"; "nothing" for none.
[[nodiscard]] std::string listed(const std::vector<std::string>& items);

}  // namespace kr3::executive
