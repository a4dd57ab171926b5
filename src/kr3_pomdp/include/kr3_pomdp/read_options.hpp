#pragma once

#include <cstddef>
#include <functional>

namespace kr3::pomdp
{

/// What a reader of models takes in. A larger model is refused before memory is taken for it; 0 is
/// no limit.
struct ReadOptions
{
  std::size_t max_names = 0;  ///< of states, of actions, and of observations
  std::size_t max_rows = 0;   ///< of T, and of O: actions times states
  /// Of T and O that are written, wildcards expanded; in factors: of all tables.
  std::size_t max_entries = 0;
  /// Asked now and then; false ends the reading with Cancelled. May be empty.
  std::function<bool()> keep_going;
};

}  // namespace kr3::pomdp
