#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "problems.hpp"

namespace kr3::refinement
{

/// Reads laws of the high level over fine sorts.
///
/// A variable at a position that became fine ranges over components. Where the same variable also
/// stands at a coarse position (a static of the high level), the whole that the component is part
/// of stands there. A constant of a magnified sort becomes "some component of it": `loc(R) =
/// kitchen` is `loc(R) = V, part_of(V) = kitchen`.
class AxiomLifter
{
public:
  /// @param magnified_sorts  sorts of the high level that are magnified or contain a magnified one
  /// @param problems         receives what cannot be lifted
  AxiomLifter(const reasoner::Description& high_level,
              const std::vector<reasoner::Magnification>& magnifications,
              const std::set<std::string>& magnified_sorts,
              const std::map<std::string, std::string>& fine_sorts, Problems& problems);

  [[nodiscard]] reasoner::CausalLaw lifted(const reasoner::CausalLaw& law);
  [[nodiscard]] reasoner::StateConstraint lifted(const reasoner::StateConstraint& law);
  [[nodiscard]] reasoner::Executability lifted(const reasoner::Executability& law);

private:
  class Law;

  [[nodiscard]] const reasoner::Magnification* magnificationOf(const std::string& constant) const;
  [[nodiscard]] bool isFine(const std::string& sort) const
  {
    return magnified_sorts_.count(sort) > 0;
  }
  void report(const reasoner::SourcePosition& position, const std::string& message);

  const reasoner::Description& high_level_;
  const std::set<std::string>& magnified_sorts_;
  const std::map<std::string, std::string>& fine_sorts_;
  std::map<std::string, const reasoner::Magnification*> magnified_constants_;
  Problems& problems_;
};

}  // namespace kr3::refinement
