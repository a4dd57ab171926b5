#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sparc_syntax.hpp"

namespace kr3::reasoner::sparc
{

/// Two arguments of a fluent.
struct Unequal
{
  std::size_t first = 0;
  std::size_t second = 0;
};

/// What a program declares, as statements of KR3's language without their dots.
struct Signature
{
  std::vector<std::string> sorts;
  std::vector<std::string> statics;
  std::vector<std::string> fluents;
  std::vector<std::string> actions;
  std::vector<std::string> axioms;                           ///< for the conditions on instances
  std::set<std::string> static_names;                        ///< the predicates that become statics
  std::set<std::string> action_sorts;                        ///< sorts of actions, without '#'
  std::set<std::string> defined;                             ///< the names of the defined fluents
  std::map<std::string, std::vector<std::string>> inertial;  ///< names with the sorts of arguments
  /// The names of the fluents in a sort of fluents.
  std::map<std::string, std::set<std::string>> fluents_of;
  std::map<std::string, std::vector<std::string>> elements;  ///< of the sorts of constants
  /// Defined fluents without the instances in which two arguments are the same: their places.
  std::map<std::string, Unequal> unequal;
  std::string step_sort;  ///< the second sort of holds and occurs
};

/// Which sorts hold fluents and actions is read from the declarations of holds and occurs; which of
/// the fluents are defined, from the rules that close their world.
[[nodiscard]] Signature signatureOf(const Program& program, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner::sparc
