#pragma once

#include "kr3_pomdp/factored_model.hpp"
#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// What a flat model is made of, see FactoredModel::flattened.
[[nodiscard]] ModelParts flattened(const FactoredModel& model, double sum_tolerance);

}  // namespace kr3::pomdp
