#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kr3::sim
{

/// Which part of the world goes into an OctoMap, and how fine.
struct OctomapOptions
{
  double resolution_m = 0.1;
  double z_min_m = 0.0;  ///< layers of voxels whose centres are in [z_min_m, z_max_m)
  double z_max_m = 2.0;
};

/// Writes the bytes of World::octomap() to a file, replacing it as a whole.
/// @throws Unavailable  the file cannot be written
void saveOctomap(const std::vector<std::uint8_t>& bytes, const std::string& path);

}  // namespace kr3::sim
