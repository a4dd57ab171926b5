#pragma once

#include <string>
#include <vector>

#include <clingo.hh>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// `rob1` or `3` as a symbol; `loc(rob1)` of a name with arguments.
[[nodiscard]] Clingo::Symbol toSymbol(const std::string& constant);
[[nodiscard]] Clingo::Symbol toSymbol(const std::string& name,
                                      const std::vector<std::string>& arguments);
[[nodiscard]] Clingo::Symbol toSymbol(const Atom& ground);

}  // namespace kr3::reasoner
