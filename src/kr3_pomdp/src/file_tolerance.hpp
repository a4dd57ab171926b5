#pragma once

namespace kr3::pomdp
{

/// How far from 1 a row in a file may sum: published files give numbers to six digits, so that long
/// rows are off by more than rounding.
inline constexpr double kFileSumTolerance = 1e-4;

}  // namespace kr3::pomdp
