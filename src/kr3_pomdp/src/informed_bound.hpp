#pragma once

#include <functional>
#include <vector>

#include "observed_model.hpp"
#include "undiscounted.hpp"

namespace kr3::pomdp
{

/// Vectors whose maximum at a belief is never below the optimal value:
/// [class][action][state].
using InformedVectors = std::vector<std::vector<std::vector<double>>>;

/// The fast informed bound, iterated from the bound of the fully observed
/// model; every iterate is a valid bound, so it may stop at any time.
///
/// @param keep_going  asked often; false ends it with what there is
/// @param first       where to start; needed where the discount is 1, not used elsewhere
/// Source: Hauskrecht (2000), Sec. 4.4.
[[nodiscard]] InformedVectors informedBound(const ObservedModel& model,
                                            const std::function<bool()>& keep_going,
                                            const UndiscountedBounds* first = nullptr);

/// The value of doing one action for ever, for each action:
/// [class][action][state]; every iterate is a valid lower bound. Where the discount is 1, the value
/// of doing an action and then what the base plan of `first` does.
[[nodiscard]] InformedVectors blindBound(const ObservedModel& model,
                                         const std::function<bool()>& keep_going,
                                         const UndiscountedBounds* first = nullptr);

}  // namespace kr3::pomdp
