#pragma once

#include <map>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"

namespace kr3::refinement
{

/// Which high-level constants no law of either level tells apart: they are in the same sorts, no
/// law, fact or map fact names them or a component of theirs, and their components are as many and
/// are neighbours in the same pattern. Defaults are not looked at: they do not bear on transitions.
class Symmetry
{
public:
  explicit Symmetry(const LowLevelDomain& domain);

  /// Constants with the same kind are interchangeable.
  [[nodiscard]] const std::string& kind(const std::string& constant) const
  {
    return kinds_.at(constant);
  }

  /// The tuple with each constant replaced by its kind and by its first place in the tuple: equal
  /// for tuples that are the same up to symmetry.
  [[nodiscard]] std::string pattern(const std::vector<std::string>& constants) const;

private:
  std::map<std::string, std::string> kinds_;
};

}  // namespace kr3::refinement
