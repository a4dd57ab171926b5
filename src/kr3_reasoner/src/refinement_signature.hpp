#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"

/// The signature of a refinement. Private to the package.
namespace kr3::reasoner
{

/// The signature that a refinement's axioms use: the base's, with each magnified sort replaced by
/// its components, and one unnamed component where the refinement does not name any. A sort that
/// contains a magnified one, in part or as a whole, is replaced by a copy of it, `fine_` and its
/// name, that has the components instead.
///
/// @param problems  receives what is wrong with magnifications, and names of the base that the
///                  refinement declares again; both are left out of the signature
[[nodiscard]] Description fineSignature(const Description& refinement, const Description& base,
                                        std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
