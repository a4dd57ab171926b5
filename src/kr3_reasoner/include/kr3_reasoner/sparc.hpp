#pragma once

#include <string>
#include <vector>

/// Programs of SPARC (Balai, Gelfond and Zhang 2013, "Towards answer set programming with sorts")
/// that were written after the usual translation of the action language AL (Gelfond and Kahl 2014,
/// ch. 8 and 9), brought back to the action language. docs/language.md states the subset.
namespace kr3::reasoner
{

/// What a SPARC program says, in KR3's language.
struct SparcImport
{
  std::string description;         ///< of the domain
  std::string history;             ///< what the program states about step 0
  std::vector<std::string> goals;  ///< one for each rule `goal(I) :- ...`
};

/// Translates a program. What is general in such programs (inertia, closed worlds, the planning
/// module) is recognised and left out, since KR3 brings it.
///
/// @param file  the program's name, for messages
/// @throws InvalidArgument  with file, line, column and reason of every statement that is not in
/// the
///                          subset
[[nodiscard]] SparcImport importSparc(const std::string& text, const std::string& file);

/// Reads and translates a file. @throws NotFound  no such file; InvalidArgument as importSparc
[[nodiscard]] SparcImport readSparc(const std::string& path);

}  // namespace kr3::reasoner
