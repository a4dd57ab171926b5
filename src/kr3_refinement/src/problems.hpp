#pragma once

#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

namespace kr3::refinement
{

/// What is wrong with some files, collected so that one run reports all of it.
class Problems
{
public:
  /// @param position  a line or column of 0 is not printed
  void add(reasoner::SourcePosition position, std::string message);

  [[nodiscard]] bool empty() const { return problems_.empty(); }

  /// One line "file:line:column: message" for each problem; files in the order in which they came
  /// up, then by place.
  /// @throws InvalidArgument  when there is a problem
  void throwIfAny() const;

private:
  std::vector<reasoner::Diagnostic> problems_;
};

/// "; did you mean 'x'?" with the candidate nearest to a name, or nothing when none is near.
[[nodiscard]] std::string suggestion(const std::string& name,
                                     const std::vector<std::string>& candidates);

/// "'a', 'b'" of at most ten names, "none" of an empty list.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

}  // namespace kr3::refinement
