#pragma once

#include <vector>

#include "commands.hpp"

namespace kr3::reasoner::tool
{

/// A proof as a tree of objects. The README has the fields.
[[nodiscard]] Json proofJson(const Reason& reason);

/// The laws that an explanation cites, each with the places of its rules.
[[nodiscard]] Json lawsJson(const std::vector<CitedLaw>& laws);

}  // namespace kr3::reasoner::tool
