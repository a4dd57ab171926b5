#pragma once

#include <cstdint>
#include <vector>

#include "kr3_sim_ode/octomap.hpp"
#include "physics.hpp"

namespace kr3::sim
{

/// World::octomap(). @param hidden  a body that is left out; may be null
[[nodiscard]] std::vector<std::uint8_t> octomapOf(const Building& building, const Physics& physics,
                                                  dBodyID hidden, const OctomapOptions& options);

}  // namespace kr3::sim
