#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/component_map.hpp"

namespace kr3::refinement
{

/// The low-level description D_L of a domain: the high level read over components, with what the
/// refinement adds.
///
/// - A magnified sort's place in the signature of fluents and actions is taken by its components;
/// so it is in sorts that
///   contain it. Statics of the high level stay coarse.
/// - The high level's axioms are read over the fine sorts. A causal law of the refinement replaces
/// the high level's laws
///   of the same action and fluent.
/// - The bridge axioms (a coarse fluent is defined by its fine one) are the function `coarse`; they
/// add no fluents.
/// - Exogenous actions and defaults are the high level's business and are left out.
///
/// Source: Zhang et al. (2014), "LL domain representation"; Sridharan et al. (JAIR 65, 2019), sec.
/// 5-6. An immutable value.
class LowLevelDomain
{
public:
  /// @param refinement  as parseRefinement gives it
  /// @throws InvalidArgument  the three do not fit; each line of the message names file, line and
  /// column where it can,
  ///                          what was found and how to mend it
  LowLevelDomain(reasoner::Description high_level, reasoner::Description refinement,
                 ComponentMap map);

  [[nodiscard]] const reasoner::Description& highLevel() const { return high_level_; }
  [[nodiscard]] const reasoner::Description& refinement() const { return refinement_; }
  [[nodiscard]] const reasoner::Description& description() const { return description_; }  ///< D_L
  [[nodiscard]] const ComponentMap& map() const { return map_; }

  /// The element of a magnified sort that a component is part of; any other constant is itself.
  [[nodiscard]] const std::string& coarse(const std::string& constant) const;

  /// The components of an element of a magnified sort, in the order of the map; of any other
  /// constant, itself.
  [[nodiscard]] std::vector<std::string> components(const std::string& constant) const;

  [[nodiscard]] bool isMagnified(const std::string& constant) const;

  /// A fine ground literal seen from the high level: `loc(rob1) = office_c2` is `loc(rob1) =
  /// office`.
  [[nodiscard]] reasoner::Literal coarse(const reasoner::Literal& fine) const;

private:
  reasoner::Description high_level_;
  reasoner::Description refinement_;
  ComponentMap map_;
  reasoner::Description description_;
  std::unordered_map<std::string, std::vector<std::string>>
      components_;  // of each magnified element
};

}  // namespace kr3::refinement
