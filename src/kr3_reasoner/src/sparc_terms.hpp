#pragma once

#include <cstddef>
#include <string>

#include "sparc_syntax.hpp"

namespace kr3::reasoner::sparc
{

/// A rule that is not in the subset, and why.
struct Refusal
{
  std::string why;
};

/// `I` is 0 steps after I, `I+1` one.
struct Step
{
  std::string base;
  bool next = false;
  bool initial = false;  // the number 0
};

/// Whether a literal is `[not] [-] name(...)` with so many arguments.
[[nodiscard]] bool isAtom(const Literal& literal, const std::string& name, std::size_t arity);

/// Whether a predicate names the exceptions to a default, by convention: `ab`, `ab_d1`, `ab1`.
[[nodiscard]] bool isAbnormality(const std::string& name);

/// The fluent f of `-holds(f(X, Y), I) :- not holds(f(X, Y), I).`, which is false unless a rule
/// says otherwise; empty of any other rule.
[[nodiscard]] std::string closedFluent(const Rule& rule);

/// A term in KR3's language. @throws Refusal  arithmetic, or functions in functions
[[nodiscard]] std::string text(const Term& term);

/// @throws Refusal  a term that is not I, I+1 or 0
[[nodiscard]] Step stepOf(const Term& term);

}  // namespace kr3::reasoner::sparc
