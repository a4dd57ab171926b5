#include "diagnostics.hpp"

#include <algorithm>
#include <tuple>

#include <kr3_common/error.hpp>
#include <kr3_common/nearest_name.hpp>

namespace kr3::reasoner
{

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates)
{
  const std::size_t limit = std::max<std::size_t>(2, name.size() / 3);
  // never so many edits that nothing of the name is left
  const std::string* nearest =
      name.empty() ? nullptr : nearestName(name, candidates, std::min(limit, name.size() - 1));
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

std::string toString(const Diagnostic& problem)
{
  const SourcePosition& at = problem.position;
  return at.file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
         problem.message;
}

std::string withoutNul(const std::string& text)
{
  std::string shown;
  for (const char c : text)
  {
    shown += c == '\0' ? std::string("\\x00") : std::string(1, c);
  }
  return shown;
}

void throwIfAny(std::vector<Diagnostic> problems, const std::vector<std::string>& files)
{
  constexpr std::size_t kMaxReported = 1000;
  if (problems.empty())
  {
    return;
  }
  const auto key = [&](const Diagnostic& problem) {
    const SourcePosition& at = problem.position;
    return std::make_tuple(std::find(files.begin(), files.end(), at.file), at.line, at.column);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return key(a) < key(b); });
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), kMaxReported); ++i)
  {
    text += (i == 0 ? "" : "\n") + toString(problems[i]);
  }
  if (problems.size() > kMaxReported)
  {
    text += "\n... and " + std::to_string(problems.size() - kMaxReported) + " more problems";
  }
  throw InvalidArgument(withoutNul(text));
}

}  // namespace kr3::reasoner
