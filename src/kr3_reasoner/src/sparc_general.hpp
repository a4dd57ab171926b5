#pragma once

#include <set>
#include <string>

#include "sparc_signature.hpp"
#include "sparc_syntax.hpp"

namespace kr3::reasoner::sparc
{

/// Whether a rule is one that every such program has, and that KR3 brings itself: inertia, closed
/// worlds, the planning module, what a history means.
[[nodiscard]] bool isGeneral(const Rule& rule);

/// Whether a rule about step 0 is a default: a CR-rule may make the contrary of its head true.
[[nodiscard]] bool isDefaultWithException(const Rule& rule, const Program& program);

/// What a program says about its states by rules that are general.
struct Completeness
{
  /// Whether every state decides every fluent, so that `not holds(F, I)` is `-holds(F, I)`.
  bool states_are_complete = false;
  /// The inertial fluents that are false initially unless the program says otherwise.
  std::set<std::string> closed_initially;
};

[[nodiscard]] Completeness completenessOf(const Program& program, const Signature& signature);

}  // namespace kr3::reasoner::sparc
