#include "problems.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/nearest_name.hpp>

namespace kr3::refinement
{

void Problems::add(reasoner::SourcePosition position, std::string message)
{
  problems_.push_back({std::move(position), std::move(message)});
}

void Problems::throwIfAny() const
{
  if (problems_.empty())
  {
    return;
  }
  std::vector<std::string> files;
  for (const reasoner::Diagnostic& problem : problems_)
  {
    if (std::find(files.begin(), files.end(), problem.position.file) == files.end())
    {
      files.push_back(problem.position.file);
    }
  }
  std::vector<reasoner::Diagnostic> sorted = problems_;
  const auto key = [&](const reasoner::Diagnostic& problem) {
    return std::make_tuple(std::find(files.begin(), files.end(), problem.position.file),
                           problem.position.line, problem.position.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
  std::set<std::string> told;
  std::string text;
  for (const reasoner::Diagnostic& problem : sorted)
  {
    const reasoner::SourcePosition& at = problem.position;
    std::string line = at.file;
    line += at.line > 0 ? ":" + std::to_string(at.line) : "";
    line += at.line > 0 && at.column > 0 ? ":" + std::to_string(at.column) : "";
    line += (line.empty() ? "" : ": ") + problem.message;
    if (told.insert(line).second)
    {
      text += (text.empty() ? "" : "\n") + line;
    }
  }
  throw InvalidArgument(text);
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates)
{
  const std::size_t limit = std::max<std::size_t>(2, name.size() / 3);
  const std::string* nearest =
      name.empty() ? nullptr : nearestName(name, candidates, std::min(limit, name.size() - 1));
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

std::string listed(const std::vector<std::string>& names)
{
  constexpr std::size_t kMost = 10;
  std::string result;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
  {
    result += (i == 0 ? "'" : ", '") + names[i] + "'";
  }
  if (names.size() > kMost)
  {
    result += " and " + std::to_string(names.size() - kMost) + " more";
  }
  return result.empty() ? "none" : result;
}

}  // namespace kr3::refinement
