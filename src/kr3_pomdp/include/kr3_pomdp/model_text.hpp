#pragma once

#include <string>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/read_options.hpp"

namespace kr3::pomdp
{

/// A model as its file's text.
struct ModelText
{
  std::string format;  ///< "pomdp" or "pomdpx"
  std::string text;
};

[[nodiscard]] inline bool operator==(const ModelText& a, const ModelText& b)
{
  return a.format == b.format && a.text == b.text;
}

/// "pomdpx" or "pomdp", by how the text begins.
[[nodiscard]] const char* detectedFormat(const std::string& text);

/// The text with its format, which is found out when `format` is empty.
///
/// @param max_bytes  of the text; 0 = no limit
/// @throws InvalidArgument    another format, or no text
/// @throws ResourceExhausted  a longer text
[[nodiscard]] ModelText checkedModelText(const std::string& format, std::string text,
                                         std::size_t max_bytes);

/// Reads a model in its format.
///
/// @param name  of the text, for messages
/// @throws InvalidArgument    malformed; the message begins `name:line:column:` where it has a
/// place
/// @throws ResourceExhausted  larger than the options allow; Cancelled  they said no
[[nodiscard]] Model readModel(const ModelText& text, const std::string& name,
                              const ReadOptions& options = {});

}  // namespace kr3::pomdp
