#pragma once

#include <string>
#include <vector>

#include "sparc_general.hpp"
#include "sparc_signature.hpp"
#include "sparc_syntax.hpp"
#include "sparc_terms.hpp"

namespace kr3::reasoner::sparc
{

/// Writes bodies of rules as those of statements of KR3's language.
class BodyWriter
{
public:
  /// Both must outlive the writer.
  BodyWriter(const Signature& signature, const Completeness& completeness)
    : signature_(signature), completeness_(completeness)
  {
  }

  /// A body without what is about occurrences and steps.
  /// @param step  the step that all its fluents must be about
  /// @throws Refusal  a condition that is not in the subset
  [[nodiscard]] std::vector<std::string> conditions(const Rule& rule, const Step& step) const;

  /// Adds the condition under which the instance of a defined fluent in `holds(f(...), I)` exists.
  void addUnequal(const Literal& literal, std::vector<std::string>& conditions) const;

  [[nodiscard]] bool isStatic(const Literal& literal) const;

private:
  /// Whether `not l` is the contrary of l: of statics, of defined fluents, in complete states.
  [[nodiscard]] bool isDecided(const Literal& literal) const;

  const Signature& signature_;
  const Completeness& completeness_;
};

/// The fluent of `holds(f(...), I)`. @throws Refusal  it is a variable
[[nodiscard]] std::string fluentText(const Literal& literal);

/// ` if c1, c2`, or nothing.
[[nodiscard]] std::string ifText(const std::vector<std::string>& body);

}  // namespace kr3::reasoner::sparc
