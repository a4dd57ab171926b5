#pragma once

#include <set>
#include <string>
#include <vector>

#include "sparc_syntax.hpp"

namespace kr3::reasoner::sparc
{

/// What a program declares, as statements of KR3's language without their dots.
struct Signature
{
  std::vector<std::string> sorts;
  std::vector<std::string> statics;
  std::vector<std::string> fluents;
  std::vector<std::string> actions;
  std::vector<std::string> axioms;     ///< for the conditions on instances
  std::set<std::string> static_names;  ///< the predicates that become statics
  std::string step_sort;               ///< the second sort of holds and occurs
};

/// Which sorts hold fluents and actions is read from the declarations of holds and occurs; which of
/// the fluents are defined, from the rules that close their world.
[[nodiscard]] Signature signatureOf(const Program& program, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner::sparc
