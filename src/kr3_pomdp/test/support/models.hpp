#pragma once

#include <cstddef>
#include <cstdint>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp::test
{

/// Two doors, a tiger behind one. Source: Cassandra, Kaelbling and Littman (1994).
[[nodiscard]] Model tiger(double discount = 0.95);

/// Search of a room of width * width cells for an object that is in one of them or elsewhere; the
/// robot's cell is observed after each move. It may grasp the object, or finish without it.
[[nodiscard]] Model roomSearch(std::size_t width);

struct RandomShape
{
  std::size_t num_states = 3;
  std::size_t num_actions = 2;
  std::size_t num_observations = 2;
  double discount = 0.6;
};

/// Some zeros in every table, rewards in [-1, 1].
[[nodiscard]] Model randomModel(const RandomShape& shape, std::uint64_t seed);

}  // namespace kr3::pomdp::test
